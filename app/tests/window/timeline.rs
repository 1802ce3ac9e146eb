//! The timeline of results: every entry says its error before and after, the last change of a kind is
//! taken back by its button, two are compared, and the report asks where to.

use std::sync::Arc;

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{PlumblineWindow, Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{EntryKind, Figure, InUseNow, Subject, TimelineEntry, TimelineView};
use plumbline_engine::{Command, EyesCommand, TimelineCommand, TimelineFormat, View};

use crate::fake::{Fake, click, picture_folder, says, shows};
use crate::made_up;

const DOUBT: &str = "The place of the screen is in doubt.";

fn on_timeline() -> WindowSettings {
    WindowSettings { screen: Screen::Timeline, ..WindowSettings::default() }
}

fn entry(number: u64, subject: Subject, title: &str, errors: [Option<Figure>; 2]) -> TimelineEntry {
    TimelineEntry {
        number,
        at: format!("2026-09-14T1{number}:02:00Z").parse().expect("a time"),
        subject,
        kind: EntryKind::PutInUse,
        title: title.to_owned(),
        before: errors[0],
        after: errors[1],
        basis: "mean error on the same held-out touches; before: without a model".to_owned(),
        id_before: None,
        id_after: Some(format!("id-{number}")),
        outside: false,
        by_undo: false,
    }
}

/// Two calibrations, a mount, a screen, a model, and a check of it.
pub fn results() -> TimelineView {
    let px = |px: f64| Some(Figure::Pixels(px));
    let mm = |mm: f64| Some(Figure::Meters(mm * 1e-3));
    let mut entries = vec![
        entry(1, Subject::Eyes, "calibration of 14 pairs", [None, px(0.214)]),
        entry(2, Subject::Eyes, "calibration of 31 pairs", [px(0.214), px(0.082)]),
        entry(3, Subject::Mount, "mount from 14 views", [None, px(0.121)]),
        entry(4, Subject::Screen, "place from 8 touches", [None, mm(1.9)]),
        entry(5, Subject::Correction, "M3 from 245 touches", [mm(5.88), mm(0.97)]),
        entry(6, Subject::Check, "25 touches at new targets, corrected with M3", [mm(5.93), mm(0.93)]),
    ];
    entries[1].id_before = Some("id-1".to_owned());
    entries[5].kind = EntryKind::Measured;
    let now = |at: usize| InUseNow {
        subject: entries[at].subject,
        title: entries[at].title.clone(),
        figure: entries[at].after,
        since: Some(entries[at].at),
        entry: Some(entries[at].number),
        against: if at == 2 { DOUBT.to_owned() } else { String::new() },
    };
    let nominal = InUseNow {
        subject: Subject::Effects,
        title: "the robot as it is described".to_owned(),
        figure: None,
        since: None,
        entry: None,
        against: String::new(),
    };
    let in_use = [1, 2, 3, 4].map(now).into_iter().chain([nominal]).collect();
    TimelineView { is_known: true, in_use, entries: entries.into() }
}

fn window_of(timeline: TimelineView) -> (Fake, Harness<'static, PlumblineWindow>) {
    let fake = Fake::over(View { timeline: Arc::new(timeline), ..made_up::everything() });
    let window = fake.window_of_size(on_timeline(), [1440.0, 900.0]);
    (fake, window)
}

#[test]
fn it_is_reached_by_the_rail_and_says_when_there_is_nothing() {
    let fake = Fake::over(View::default());
    let mut window = fake.window(WindowSettings::default());
    click(&mut window, "Timeline");
    assert!(says(&window, "The timeline is being read"));
    fake.show(View {
        timeline: Arc::new(TimelineView { is_known: true, ..TimelineView::default() }),
        ..View::default()
    });
    window.run_steps(3);
    assert!(shows(&window, "Nothing was put in use yet"));
    assert!(shows(&window, "Go to Commission"));
}

#[test]
fn each_entry_says_its_error_and_what_is_in_use_is_listed() {
    let (_, window) = window_of(results());
    for text in ["5.88 → 0.97 mm", "5.93 → 0.93 mm", "0.214 → 0.0820 px", "calibration of 31 pairs"] {
        assert!(says(&window, text), "{text}");
    }
    assert!(says(&window, "the robot as it is described"));
    assert!(says(&window, DOUBT), "what is in use and in doubt says so");
    assert!(says(&window, "6 entries. The newest, measured: 25 touches"));
}

#[test]
fn what_was_put_in_use_last_of_a_kind_is_taken_back_and_an_earlier_one_is_used_again() {
    let (fake, mut window) = window_of(results());
    // From the newest down: the check changes nothing; model (it went with no other), screen, mount, eyes.
    let buttons = window.get_all_by_label_contains("Undo: ").count();
    assert_eq!(
        buttons, 3,
        "screen, mount and eyes; the order of models is its workflow's, which knows none here"
    );
    let mut sent = vec![];
    for button in 0..buttons {
        let found = window.get_all_by_label_contains("Undo: ").nth(button).expect("a button");
        found.click();
        window.run_steps(3);
        sent.extend(fake.take_sent());
    }
    let back = |subject, to: Option<&str>| -> Command {
        TimelineCommand::TakeBack { subject, to: to.map(str::to_owned) }.into()
    };
    assert_eq!(
        sent,
        [back(Subject::Screen, None), back(Subject::Mount, None), back(Subject::Eyes, Some("id-1")),]
    );
    click(&mut window, "Use again: calibration of 14 pairs");
    assert_eq!(fake.take_sent(), [Command::from(EyesCommand::UseEarlier { id: Some("id-1".to_owned()) })]);
}

#[test]
fn who_clicks_twice_takes_one_result_back_and_not_the_one_that_slid_under_the_pointer() {
    let view = |timeline| View { timeline: Arc::new(timeline), ..made_up::everything() };
    let (fake, mut window) = window_of(results());
    // Frames are a quarter of a second apart.
    let click = |window: &mut Harness<'_, PlumblineWindow>| {
        window.get_all_by_label_contains("Undo: ").next().expect("a button").click();
        window.run_steps(1);
        fake.take_sent().len()
    };
    assert_eq!((click(&mut window), click(&mut window)), (1, 0), "once is meant");
    window.run_steps(3);
    // It is done: a row more stands on top, and every other one has slid down.
    let mut entries = results().entries.to_vec();
    let taken_back = entry(entries.len() as u64 + 1, Subject::Screen, "as it was built", [None, None]);
    entries.push(TimelineEntry { kind: EntryKind::TakenBack, ..taken_back });
    fake.show(view(TimelineView { entries: entries.into_iter().collect(), ..results() }));
    window.run_steps(1);
    assert_eq!(click(&mut window), 0, "what lies there is another one now");
    window.run_steps(3);
    assert_eq!(click(&mut window), 1, "and does what it says once that was seen");
}

#[test]
fn what_was_only_measured_stands_there_with_its_share_and_has_no_undo() {
    let share = |share| Some(Figure::Share(share));
    let kinds = [
        (Subject::Health, "still good", [None, Some(Figure::Meters(4e-3))]),
        (
            Subject::Places,
            "tomato at 36 of 36 places",
            [Some(Figure::Meters(36e-3)), Some(Figure::Meters(6e-3))],
        ),
        (Subject::Experiment, "suggested and made: a weight", [None, Some(Figure::Meters(5e-3))]),
        (Subject::Grasps, "tomato lifted: M1 30 %, M5 90 %", [share(0.3), share(0.9)]),
        (Subject::Detectors, "yolo.onnx 71.2 %", [None, share(0.712)]),
    ];
    let entries = kinds.iter().enumerate().map(|(k, (subject, title, errors))| TimelineEntry {
        kind: EntryKind::Measured,
        ..entry(k as u64 + 1, *subject, title, *errors)
    });
    let entries = entries.collect();
    let (_, window) = window_of(TimelineView { is_known: true, entries, ..TimelineView::default() });
    for (_, title, _) in kinds {
        assert!(says(&window, title), "{title}");
    }
    assert!(says(&window, "30 → 90 %") && says(&window, "36.0 → 6.00 mm"));
    assert_eq!(window.query_all_by_label_contains("Undo: ").count(), 0);
    assert_eq!(window.query_all_by_label_contains("Use again: ").count(), 0);
}

#[test]
fn two_entries_are_compared() {
    let (_, mut window) = window_of(results());
    assert!(shows(&window, "Nothing to compare"));
    for title in ["calibration of 14 pairs", "calibration of 31 pairs"] {
        let rows: Vec<_> = window.get_all_by_label_contains(title).collect();
        rows.iter()
            // Not the button in it, which says whose it is.
            .filter(|row| row.accesskit_node().role() == egui::accesskit::Role::Button)
            .find(|row| row.accesskit_node().label().is_some_and(|label| label.starts_with(title)))
            .expect("a row")
            .click();
        window.run_steps(3);
    }
    assert!(says(&window, "0.214 px → 0.0820 px: 38 % of the error, each on its own data."));
}

#[test]
fn the_report_asks_where_to() {
    let (fake, mut window) = window_of(results());
    click(&mut window, "PDF…");
    assert!(shows(&window, "Write the report of the setup"));
    click(&mut window, "Save");
    let report = TimelineCommand::Report { file: "setup.pdf".into(), format: TimelineFormat::Pdf };
    assert_eq!(fake.take_sent(), [Command::from(report)]);
}

/// Pictures for people: `PLUMBLINE_WINDOW_PICTURES=FOLDER`.
#[test]
#[ignore = "draws pictures for people"]
fn pictures_of_the_timeline() {
    let folder = picture_folder();
    for (theme, size) in [(ThemeChoice::Light, [1440.0, 900.0]), (ThemeChoice::Dark, [1024.0, 700.0])] {
        let fake = Fake::over(View { timeline: Arc::new(results()), ..made_up::everything() });
        let mut window = fake.window_with(WindowSettings { theme, ..on_timeline() }, size, true);
        window.run_steps(2);
        let image = window.render().expect("the test renderer draws");
        let file = format!("timeline-{theme:?}.png").to_lowercase();
        image.save(folder.join(file)).expect("the folder can be written");
    }
}
