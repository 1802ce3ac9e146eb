//! Truth mode: off at first, asked for by name, and marked on every screen for as long as it is on.

use std::sync::Arc;

use plumbline::{Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{TruthOf, TruthRow, TruthView};
use plumbline_engine::{Command, TruthCommand, View};

use crate::fake::{Fake, click, picture_folder, says, shows};
use crate::made_up;

const TITLE: &str = "TRUTH of the simulation";

/// Toys, a finger, the mount, zeros and axes.
pub fn truth() -> TruthView {
    let row = |of, name: &str, off_m, off_rad| TruthRow { of, name: name.to_owned(), off_m, off_rad };
    let rows = vec![
        row(TruthOf::Toy, "Tomato", Some([2.1e-3, -1.7e-3, 0.4e-3]), None),
        row(TruthOf::Toy, "Duck", Some([1.0e-3, 0.2e-3, 0.0]), None),
        row(TruthOf::Finger, "right index tip", Some([3.2e-3, 1.1e-3, -4.5e-3]), None),
        row(TruthOf::Mount, "left eye in the head", Some([1.4e-3, 0.0, 0.0]), Some(0.012)),
        row(TruthOf::Zero, "Right elbow", None, Some(-0.014)),
        row(TruthOf::Zero, "Right shoulder", None, Some(0.004)),
        row(TruthOf::Axis, "Right elbow", None, Some(0.006)),
    ];
    TruthView { is_on: true, waits_because: None, rows: rows.into() }
}

fn with(truth: TruthView) -> View {
    View { truth: Arc::new(truth), ..made_up::everything() }
}

#[test]
fn it_is_off_at_first_and_switched_on_beside_the_twin() {
    let fake = Fake::over(made_up::everything());
    let mut window = fake.window_of_size(WindowSettings::default(), [1440.0, 1300.0]);
    assert!(!shows(&window, TITLE));
    click(&mut window, "Show the truth");
    assert_eq!(fake.take_sent(), [Command::from(TruthCommand::Show(true))]);
}

#[test]
fn while_it_is_on_every_screen_says_so_and_hides_it_by_one_button() {
    for screen in Screen::ALL {
        let fake = Fake::over(with(truth()));
        let settings = WindowSettings { screen, ..WindowSettings::default() };
        let mut window = fake.window_of_size(settings, [1440.0, 900.0]);
        assert!(shows(&window, TITLE), "{screen:?}");
        assert!(says(&window, "measured − true: Toys up to 2.73 mm"), "{screen:?}");
        click(&mut window, "Hide the truth");
        assert_eq!(fake.take_sent(), [Command::from(TruthCommand::Show(false))], "{screen:?}");
    }
}

#[test]
fn all_differences_are_listed_with_their_axes() {
    let fake = Fake::over(with(truth()));
    let mut window = fake.window_of_size(WindowSettings::default(), [1440.0, 900.0]);
    click(&mut window, "All");
    for text in ["right index tip", "x +3.2, y +1.1, z −4.5 mm", "left eye in the head", "Right shoulder"] {
        assert!(says(&window, text), "{text}");
    }
}

#[test]
fn where_nothing_can_be_compared_it_says_why() {
    let why = "No twin is connected: of a real robot nobody knows the truth.";
    let waits = TruthView { is_on: true, waits_because: Some(why.to_owned()), rows: Arc::default() };
    let fake = Fake::over(with(waits));
    let window = fake.window_of_size(WindowSettings::default(), [1440.0, 900.0]);
    assert!(says(&window, "No twin is connected"));
}

/// Pictures for people: `PLUMBLINE_WINDOW_PICTURES=FOLDER`.
#[test]
#[ignore = "draws pictures for people"]
fn pictures_of_truth_mode() {
    let folder = picture_folder();
    for (theme, size) in [(ThemeChoice::Light, [1440.0, 900.0]), (ThemeChoice::Dark, [1024.0, 700.0])] {
        let fake = Fake::over(with(truth()));
        let settings = WindowSettings { theme, ..WindowSettings::default() };
        let mut window = fake.window_with(settings, size, true);
        window.run_steps(2);
        let image = window.render().expect("the test renderer draws");
        image
            .save(folder.join(format!("truth-{theme:?}.png").to_lowercase()))
            .expect("the folder can be written");
    }
}
