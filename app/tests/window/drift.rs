//! Watching drift: every state is drawn, and the one button asks for the right thing.

use std::sync::Arc;

use egui::Key;
use nalgebra::Vector3;
use plumbline::{Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{
    DriftCourse, DriftPoint, DriftVerdict, DriftView, PlaceError, SourceStatus, SourceView, StepState,
};
use plumbline_engine::{Command, DriftCommand, View};

use crate::fake::{Fake, click, says, shows};
use crate::made_up::everything;

fn on(screen: Screen) -> WindowSettings {
    WindowSettings { screen, ..WindowSettings::default() }
}

/// Eyes that warm up for so many minutes.
pub fn course(minutes: f64) -> DriftCourse {
    let off_mm = |at_s: f64| 40.0 * (1.0 - (-at_s / 400.0).exp());
    let points = (0..(minutes * 20.0) as usize).map(|k| {
        let at_s = 3.0 * k as f64;
        let far_m = 1e-3 * off_mm(at_s);
        let rows = [0.25 * far_m, 0.5 * far_m, far_m];
        DriftPoint { at_s, off_m: rows, along_m: rows.map(|m| 0.9 * m), across_m: rows.map(|m| -0.3 * m) }
    });
    let points: Vec<DriftPoint> = points.collect();
    let last = *points.last().expect("some time");
    let place = |x_m: f64, row: usize, y_m: f64| PlaceError {
        at_m: Vector3::new(x_m, y_m, 0.05),
        error_m: Vector3::new(last.along_m[row], last.across_m[row], 0.0),
        along_m: last.along_m[row],
        across_m: last.across_m[row],
    };
    let row = |row: usize, x_m: f64| [-0.27, 0.0, 0.27].map(|y_m| place(x_m, row, y_m));
    DriftCourse {
        from_switching_on: true,
        table: [row(0, 0.2), row(1, 0.4), row(2, 0.6)],
        points,
        band_m: Some([0.0015, 0.002, 0.003]),
        verdict: DriftVerdict::Steady { cost_m: last.off_m },
        sentence: "Places stay where they were: 0.4 mm off at the far end of the table.".to_owned(),
        turns_rad: [[0.0002, 0.004, 0.0001], [-0.0001, -0.006, 0.0002]],
        epipolar_px: Some(0.21),
        references: vec![("Touchscreen".to_owned(), Some(0.021)), ("Tomato".to_owned(), None)],
        alarms: vec![],
        own_motions: vec![(
            300.0,
            "Tomato: was moved by 20 mm at minute 5; the eyes stand still.".to_owned(),
        )],
    }
}

fn watching(course: Option<DriftCourse>) -> DriftView {
    DriftView {
        step: StepState::Running,
        is_watching: true,
        course: course.map(Arc::new),
        ..DriftView::default()
    }
}

fn with(drift: DriftView) -> View {
    let source = SourceView { status: SourceStatus::Running, ..SourceView::clone(&everything().source) };
    View { drift: Arc::new(drift), source: Arc::new(source), ..everything() }
}

#[test]
fn the_one_button_starts_and_stops_and_so_does_a_key() {
    let fake = Fake::over(with(DriftView::default()));
    let mut window = fake.window(on(Screen::Drift));
    assert!(shows(&window, "Not watched yet"));
    click(&mut window, "Start watching");
    assert_eq!(fake.take_sent(), [Command::from(DriftCommand::Start)]);
    let fake = Fake::over(with(watching(Some(course(12.0)))));
    let mut window = fake.window(on(Screen::Drift));
    click(&mut window, "Stop watching");
    window.key_press(Key::W);
    window.run_steps(2);
    assert_eq!(fake.take_sent(), [DriftCommand::Stop, DriftCommand::Stop].map(Command::from));
}

#[test]
fn every_state_says_what_it_is() {
    let waits = DriftView {
        waits_because: Some("The arm moves: it looks again when it rests.".to_owned()),
        ..watching(None)
    };
    let failed = DriftView { failed: Some("Only 3 places could be matched.".to_owned()), ..watching(None) };
    let old = DriftView { is_watching: false, step: StepState::Done, ..watching(Some(course(3.0))) };
    for (drift, words) in [
        (watching(None), "Looks for the first time"),
        (waits, "it looks again when it rests"),
        (failed, "Only 3 places"),
        (old, "Not watched any more: old."),
        (watching(Some(course(0.1))), "Places stay where they were"),
        (watching(Some(course(20.0))), "Tomato: was moved by 20 mm"),
    ] {
        let fake = Fake::over(with(drift));
        assert!(says(&fake.window(on(Screen::Drift)), words), "{words}");
    }
}

#[test]
fn curves_and_map_tell_their_newest_values_to_who_cannot_see_them() {
    let fake = Fake::over(with(watching(Some(course(10.0)))));
    let window = fake.window(on(Screen::Drift));
    assert!(says(&window, "How far places are off, mm: near 7.8, middle 15.5, far 31.0"));
    assert!(shows(&window, "Drift over the table"));
    assert!(says(&window, "Vertical error"));
}

/// For people: `PLUMBLINE_WINDOW_PICTURES=FOLDER`.
#[test]
#[ignore = "draws pictures for people"]
fn pictures_of_drift() {
    for (name, theme) in [("dark", ThemeChoice::Dark), ("light", ThemeChoice::Light)] {
        let fake = Fake::over(with(watching(Some(course(12.0)))));
        let settings = WindowSettings { theme, ..on(Screen::Drift) };
        let mut window = fake.window_with(settings, [1280.0, 800.0], true);
        let file = crate::fake::picture_folder().join(format!("drift-{name}.png"));
        window.render().expect("drawn").save(file).expect("written");
    }
}
