//! Watching drift: every state is drawn, and the one button asks for the right thing.

use std::sync::Arc;

use egui::Key;
use nalgebra::Vector3;
use plumbline::{Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{
    Anew, BeganAnew, DriftCourse, DriftPoint, DriftVerdict, DriftView, GridCorrection, GridDoing, GridErrors,
    GridFigure, GridPlace, GridRunView, GridView, Judged, PlaceError, SourceStatus, SourceView, StepState,
};
use plumbline_engine::{Command, DriftCommand, GridCommand, View};
use plumbline_model::Point;

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
    let now = std::time::Instant::now();
    DriftView {
        looks_at: course.is_some().then_some([now, now]),
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
    let now = std::time::Instant::now();
    let looks_at = [now - std::time::Duration::from_secs(70), now + std::time::Duration::from_secs(40)];
    let seldom = DriftView { looks_at: Some(looks_at), ..watching(Some(course(0.1))) };
    let anew = Anew { why: BeganAnew::SwitchedOn, moved_before: None };
    let anew = DriftView { anew: Some(anew), ..watching(Some(course(0.1))) };
    for (drift, words) in [
        (watching(None), "Looks for the first time"),
        (waits, "it looks again when it rests"),
        (failed, "Only 3 places"),
        (old, "Not watched any more: old."),
        (anew, "Watching began anew when the cameras were switched on again"),
        (seldom, "The last look was 1 min ago. This computer is busy, so it looks seldom"),
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
    assert!(says(&window, "Matches off, as told last"));
}

/// Places of the grid that come out farther away than they are, by so many times what the paper saw.
fn judged(times: f64) -> Arc<Judged> {
    let place = |k: usize| {
        let (x_m, y_m) = (0.2 + 0.1 * (k / 9) as f64, 0.1 * ((k % 9) as f64 - 4.0));
        let off_m = times * 0.05 * x_m;
        let estimate = Point::new(x_m + off_m, y_m + 0.4 * off_m * y_m, 0.05 + 0.3 * off_m);
        GridPlace { target: Point::new(x_m, y_m, 0.05), estimate, range_m: 0.6 }
    };
    let places: Vec<GridPlace> = (0..35).map(place).collect();
    let errors = GridErrors::of(&places).expect("places");
    Arc::new(Judged { places, errors, not_seen: 1 })
}

fn evaluated() -> GridView {
    let session = std::path::PathBuf::from("/lab/sessions/2026-05-01T10-00-00_grid");
    let figure = |correction, judged| {
        Some(GridFigure {
            session: session.clone(),
            title: "2026-05-01T10-00-00_grid".to_owned(),
            correction,
            judged: Some(judged),
        })
    };
    GridView {
        figures: [
            figure(GridCorrection::Described, Ok(judged(1.5))),
            figure(GridCorrection::Model, Ok(judged(0.2))),
        ],
        sessions: [(session.clone(), "2026-05-01T10-00-00_grid".to_owned())].into(),
        ..GridView::default()
    }
}

fn run(doing: GridDoing, places_by_itself: bool) -> GridView {
    let run = GridRunView {
        object: "Tomato",
        place: 12,
        of: 36,
        at_m: [0.3, -0.2],
        places_by_itself,
        doing,
        measured: 11,
        session: None,
        unkept: None,
    };
    GridView { run: Some(run), unable: Some("one is under way"), ..evaluated() }
}

/// The screen with the evaluation in front.
fn on_the_grid(grid: GridView) -> (Fake, egui_kittest::Harness<'static, plumbline::PlumblineWindow>) {
    let fake = Fake::over(with(DriftView { grid, ..watching(Some(course(12.0))) }));
    let mut window = fake.window(on(Screen::Drift));
    click(&mut window, "9×4 evaluation");
    fake.take_sent();
    (fake, window)
}

#[test]
fn an_operator_is_led_from_place_to_place_of_the_grid() {
    let (fake, mut window) = on_the_grid(GridView { unable: None, ..evaluated() });
    click(&mut window, "Begin 36 places");
    let begin = DriftCommand::Grid(GridCommand::Begin { object: "Tomato".to_owned() });
    assert_eq!(fake.take_sent(), [Command::from(begin)]);
    let (fake, mut window) = on_the_grid(run(GridDoing::Asks, false));
    assert!(
        says(&window, "Place 12 of 36: x 300, y -200 mm")
            || says(&window, "Place 12 of 36: x 300, y −200 mm")
    );
    assert!(says(&window, "200 mm to the robot's right"));
    for (label, command) in
        [("Placed", GridCommand::Placed), ("Leave out", GridCommand::LeaveOut), ("End", GridCommand::End)]
    {
        click(&mut window, label);
        assert_eq!(fake.take_sent(), [Command::from(DriftCommand::Grid(command))], "{label}");
    }
    let (_, window) = on_the_grid(run(GridDoing::NotSeen, false));
    assert!(says(&window, "lay it again and press Placed, or leave the place out"));
    let (_, window) = on_the_grid(run(GridDoing::Looks { looks: 2, of: 5 }, true));
    assert!(says(&window, "2 of 5") && !shows(&window, "Placed"), "the twin lays it by itself");
}

#[test]
fn two_corrections_stand_side_by_side_with_one_scale() {
    let (_, window) = on_the_grid(evaluated());
    let all =
        |k: usize| evaluated().figures[k].clone().expect("a figure").judged.expect("judged").expect("places");
    for k in 0..2 {
        let mean = plumbline_widgets::format::mm(all(k).errors.mean_m);
        assert!(shows(&window, &format!("Mean {mean}")), "{mean}");
    }
    assert!(says(&window, "35 places, 1 not seen"));
    assert!(says(&window, "the same in both"));
    let (_, window) = on_the_grid(GridView::default());
    assert!(says(&window, "No evaluation yet"));
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
        click(&mut window, "9×4 evaluation");
        fake.show(with(DriftView { grid: run(GridDoing::Asks, false), ..watching(Some(course(12.0))) }));
        window.run_steps(4);
        let file = crate::fake::picture_folder().join(format!("grid-{name}.png"));
        window.render().expect("drawn").save(file).expect("written");
    }
}

#[test]
fn what_a_correction_by_time_states_is_said_in_millimeters_and_only_where_one_is_in_use() {
    let corrected = DriftView { stated_m: Some([0.004, 0.007, 0.012]), ..watching(Some(course(12.0))) };
    let fake = Fake::over(with(corrected));
    let window = fake.window(on(Screen::Drift));
    assert!(says(&window, "stated to lie within 4 mm near, 7 mm in the middle, 12 mm far"));
    let fake = Fake::over(with(watching(Some(course(12.0)))));
    assert!(!says(&fake.window(on(Screen::Drift)), "stated to lie within"));
}
