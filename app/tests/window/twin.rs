//! The twin's controls: its toys, its board, its clock.

use std::sync::Arc;

use plumbline::{Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{
    BoardTour, CaptureEnded, CollectedPair, EyesView, SourceStatus, SourceView, TourWaits, TwinView,
};
use plumbline_engine::{Command, EyesCommand, RobotCommand, SourceCommand, SourceSpec, TwinCommand, View};

use crate::fake::{Fake, click, says, shows};
use crate::made_up::{everything, lying_board, twin};

fn on(screen: Screen) -> WindowSettings {
    WindowSettings { screen, ..WindowSettings::default() }
}

const TALL: [f32; 2] = [1440.0, 1700.0];

#[test]
fn a_chosen_toy_is_put_where_the_table_is_clicked() {
    let fake = Fake::over(everything());
    let mut window = fake.window_of_size(on(Screen::Live), TALL);
    assert!(says(&window, "nothing real moves"));
    click(&mut window, "orange");
    let map = egui_kittest::kittest::Queryable::get_by_label(&window, "Twin's table").rect();
    let at = map.center();
    for pressed in [true, false] {
        window.event(egui::Event::PointerMoved(at));
        window.event(egui::Event::PointerButton {
            pos: at,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        });
        window.run_steps(2);
    }
    let sent = fake.take_sent();
    let [Command::Twin(TwinCommand::PlaceToy { toy, x_m, y_m })] = sent.as_slice() else {
        panic!("one toy is placed: {sent:?}")
    };
    assert_eq!(toy, "orange");
    assert!((0.1..0.6).contains(x_m) && y_m.abs() < 0.15, "{x_m} {y_m}");
}

#[test]
fn board_clock_and_faults_ask_for_what_they_say() {
    let fake = Fake::over(View {
        twin: Arc::new(TwinView { board: Some(lying_board()), ..twin() }),
        ..everything()
    });
    let mut window = fake.window_of_size(on(Screen::Live), TALL);
    for (label, wanted) in [
        ("Hold it there", TwinCommand::HoldBoard { place: 0 }),
        ("Hold it there", TwinCommand::HoldBoard { place: 1 }),
        ("Show at all 24 places", TwinCommand::TourBoard(true)),
        ("Put away", TwinCommand::HideBoard),
        ("+10 min", TwinCommand::AdvanceWarmUp { minutes: 10.0 }),
        ("×20", TwinCommand::WarmUpPace { times: 20.0 }),
        ("Cool", TwinCommand::CoolEyes),
    ] {
        click(&mut window, label);
        assert_eq!(fake.take_sent(), [Command::from(wanted)], "{label}");
    }
    click(&mut window, "Faults of the servo bus");
    window.run_steps(12);
    click(&mut window, "Answers come late");
    assert_eq!(fake.take_sent(), [Command::from(TwinCommand::Fault { name: "late".to_owned(), on: true })]);
}

#[test]
fn the_eyes_of_the_twin_are_calibrated_from_clicks() {
    let source =
        SourceView { spec: Some(SourceSpec::Twin), status: SourceStatus::Running, ..SourceView::default() };
    let fake = Fake::over(View { source: Arc::new(source), ..everything() });
    let mut window = fake.window(on(Screen::Live));
    assert!(says(&window, "This is the twin"));
    click(&mut window, "Calibrate the eyes");
    click(&mut window, "Show the board at all places");
    let sent = fake.take_sent();
    assert_eq!(
        sent,
        [Command::from(EyesCommand::AutoCapture(true)), Command::from(TwinCommand::TourBoard(true))]
    );
}

#[test]
fn a_tour_of_the_board_is_counted_and_goes_on_where_it_was_broken_off() {
    let source =
        SourceView { spec: Some(SourceSpec::Twin), status: SourceStatus::Running, ..SourceView::default() };
    let view = |twin: TwinView| View {
        source: Arc::new(source.clone()),
        eyes: Arc::new(EyesView { auto_capture: true, ..EyesView::default() }),
        twin: Arc::new(twin),
        ..everything()
    };
    let tour = Some(BoardTour { place: 9, of: 24, waits: None });
    let fake = Fake::over(view(TwinView { board: Some(lying_board()), board_tour: tour, ..twin() }));
    let mut window = fake.window(on(Screen::Collect));
    assert!(says(&window, "The board is at place 9 of 24: 0 pairs captured by themselves."));
    for (waits, words) in [
        (TourWaits::Look, "It waits until it is looked for"),
        (TourWaits::Sight, "It waits until both eyes see it sharp and still"),
    ] {
        let tour = Some(BoardTour { place: 9, of: 24, waits: Some(waits) });
        fake.show(view(TwinView { board: Some(lying_board()), board_tour: tour, ..twin() }));
        window.run_steps(40);
        assert!(says(&window, words), "{words}");
        fake.take_sent();
        click(&mut window, "Skip this place");
        assert_eq!(fake.take_sent(), [Command::from(TwinCommand::SkipPlace)]);
    }
    // Who looks elsewhere is told that, and not that the computer is slow.
    let tour = Some(BoardTour { place: 9, of: 24, waits: Some(TourWaits::Look) });
    for (spec, words) in [
        (Some(SourceSpec::Folder("pairs".into())), "another source is shown, not the twin's eyes"),
        (None, "the twin's eyes are closed"),
    ] {
        let elsewhere = SourceView { spec, ..source.clone() };
        let twin = TwinView { board: Some(lying_board()), board_tour: tour, ..twin() };
        fake.show(View { source: Arc::new(elsewhere), ..view(twin) });
        window.run_steps(40);
        assert!(says(&window, words) && !says(&window, "this computer has much to do"), "{words}");
        fake.take_sent();
        click(&mut window, "Look through the twin's eyes");
        assert_eq!(fake.take_sent(), [Command::from(SourceCommand::Open(SourceSpec::Twin))]);
    }
    fake.show(view(TwinView { board: Some(lying_board()), board_places_left: 16, ..twin() }));
    window.run_steps(40);
    assert!(says(&window, "the board was not shown at 16 places yet"));
    fake.take_sent();
    click(&mut window, "Show the board at the other places");
    assert_eq!(fake.take_sent(), [Command::from(TwinCommand::TourRest)]);
    // Enough pairs can be solved, whatever places are left.
    let mut enough = view(TwinView { board: Some(lying_board()), board_places_left: 9, ..twin() });
    let pair = |number: usize| CollectedPair {
        name: format!("pair {number}"),
        left: None,
        right: None,
        left_image: None,
        right_image: None,
        place: None,
        taken: None,
    };
    let pairs = (0..12).map(|number| Arc::new(pair(number))).collect();
    enough.eyes = Arc::new(EyesView { collected: pairs, ..(*enough.eyes).clone() });
    fake.show(enough);
    window.run_steps(3);
    assert!(shows(&window, "Solve 12 pairs"));
}

#[test]
fn what_ended_capturing_stands_at_its_switch_and_pairs_say_how_warm_the_eyes_were() {
    let pair = |name: &str| CollectedPair {
        name: name.to_owned(),
        left: None,
        right: None,
        left_image: None,
        right_image: None,
        place: None,
        taken: None,
    };
    let eyes = EyesView {
        capture_ended: Some(CaptureEnded::Accepted),
        collected: [Arc::new(pair("first")), Arc::new(pair("later")), Arc::new(pair("file"))].into(),
        minutes_on: [Some(3.0), Some(25.0), None].into(),
        ..EyesView::default()
    };
    let over = |eyes: EyesView| Fake::over(View { eyes: Arc::new(eyes), ..everything() });
    let ended = "Capturing by itself ended when the calibration was accepted";
    let window = over(eyes.clone()).window_of_size(on(Screen::Collect), TALL);
    assert!(says(&window, ended) && says(&window, "cold, 3 min") && says(&window, "warm, 25 min"));
    let of_mount = EyesView { capture_ended: Some(CaptureEnded::MountLooks), ..eyes.clone() };
    let window = over(of_mount).window_of_size(on(Screen::Collect), TALL);
    assert!(!says(&window, ended) && says(&window, "ended when the head began to turn for the mount"));
    let plain = EyesView { capture_ended: None, minutes_on: [None; 3].into(), ..eyes };
    let window = over(plain).window_of_size(on(Screen::Collect), TALL);
    assert!(shows(&window, "later") && !says(&window, ended));
    assert!(!says(&window, "cold, 3") && !says(&window, "warm, 25"), "what is not known is not said");
}

#[test]
fn a_twin_that_failed_says_why_and_can_be_started_again() {
    let failed = TwinView {
        failed: Some("no graphics device answers: see the doctor".to_owned()),
        ..TwinView::default()
    };
    let fake = Fake::over(View { twin: Arc::new(failed), ..View::default() });
    let mut window = fake.window(on(Screen::Robot));
    click(&mut window, "Twin");
    assert!(says(&window, "see the doctor"));
    click(&mut window, "Start the twin");
    assert_eq!(fake.take_sent(), [Command::from(RobotCommand::ConnectTwin { scenario: "lab".to_owned() })]);
}

/// Every state drawn into a PNG of `PLUMBLINE_WINDOW_PICTURES=<folder>`, with `--ignored pictures`.
#[test]
#[ignore = "draws pictures for people to look at"]
fn pictures_of_live_with_the_twin() {
    let folder = crate::fake::picture_folder();
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        for screen in [Screen::Live, Screen::Collect] {
            let view =
                View { twin: Arc::new(TwinView { board: Some(lying_board()), ..twin() }), ..everything() };
            let fake = Fake::over(view);
            let mut window = fake.window_with(WindowSettings { theme, ..on(screen) }, [1280.0, 800.0], true);
            assert!(shows(&window, "STOP"));
            let image = window.render().expect("the test renderer draws");
            let file = format!("twin {screen:?} {theme:?}.png").to_lowercase().replace(' ', "-");
            image.save(folder.join(file)).expect("the folder can be written");
        }
    }
}
