//! Numbers that are typed: one that cannot be is refused in words, and none is put in its place.

use egui_kittest::kittest::Queryable as _;
use plumbline::{Screen, WindowSettings};
use plumbline_engine::{Command, EyesCommand};

use crate::fake::{Fake, says};
use crate::made_up;

#[test]
fn a_number_outside_its_range_is_refused_in_words_and_nothing_is_put_in_its_place() {
    let fake = Fake::over(made_up::everything());
    let settings = WindowSettings { screen: Screen::Collect, ..WindowSettings::default() };
    let mut window = fake.window_of_size(settings, [1024.0, 700.0]);
    window.run_steps(4);
    let mut typed = |field: &str, text: &str| {
        window.get_by_label(field).focus();
        window.run_steps(2);
        window.event(egui::Event::Text(text.to_owned()));
        window.run_steps(2);
        window.key_press(egui::Key::Enter);
        window.run_steps(3);
        let said = ["is not between", "is not a number"].map(|words| says(&window, words));
        (fake.take_sent(), said)
    };
    for (field, text) in
        [("Squares across", "9999999"), ("Squares down", "-3"), ("Side of a square", "−99999")]
    {
        assert_eq!(typed(field, text), (vec![], [true, false]), "{field}: {text}");
    }
    assert_eq!(typed("Side of a square", "abc"), (vec![], [false, true]));
    let (sent, said) = typed("Side of a square", "24,5 mm");
    assert_eq!(said, [false, false]);
    assert!(
        matches!(
            sent.as_slice(),
            [Command::Eyes(EyesCommand::ChooseBoard { square_m, .. })] if (square_m - 0.0245).abs() < 1e-12
        ),
        "{sent:?}"
    );
}
