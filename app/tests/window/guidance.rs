//! The bottom line: the one button of every state asks for what it says.

use std::sync::Arc;
use std::time::Instant;

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{PlumblineWindow, Screen, WindowSettings};
use plumbline_engine::view::{
    BoardPlace, Connection, EyesView, GhostBoard, JobState, JobView, MotionState, ReplayView, RobotView,
    SourceStatus, SourceView, TouchPhase,
};
use plumbline_engine::{Command, EyesCommand, JobCommand, JobId, SourceCommand, SourceSpec, View};

use plumbline_model::touch_plan::PlanOptions;

use crate::fake::{Fake, click, says, shows};
use crate::made_up_touch::{area, planned, running, with_touch};

fn on(screen: Screen) -> WindowSettings {
    WindowSettings { screen, ..WindowSettings::default() }
}

fn folder_of(length: u64) -> Arc<SourceView> {
    let replay = ReplayView {
        position: Some(0),
        length,
        playing: true,
        looping: true,
        pairs_per_second: Some(4.0),
        growth: Default::default(),
    };
    Arc::new(SourceView {
        description: format!("{length} pairs in board"),
        status: SourceStatus::Running,
        replay: Some(replay),
        photographs: true,
        ..SourceView::default()
    })
}

#[test]
fn a_folder_of_pairs_is_collected_with_one_click() {
    let fake = Fake::over(View { source: folder_of(30), ..View::default() });
    let mut window = fake.window(on(Screen::Collect));
    click(&mut window, "Use all 30 pairs of this folder");
    assert_eq!(fake.take_sent(), [Command::from(EyesCommand::CollectRecording)]);
}

#[test]
fn an_uncalibrated_view_leads_to_the_calibration() {
    let fake = Fake::over(View { source: folder_of(30), ..View::default() });
    let mut window = fake.window(on(Screen::Live));
    assert!(says(&window, "nothing can be measured yet"));
    click(&mut window, "Calibrate the eyes");
    assert!(shows(&window, "Use all 30 pairs of this folder"));
}

#[test]
fn while_the_robot_is_being_connected_nobody_is_sent_for_images() {
    let connection =
        Connection::Connecting { to: "twin \"lab\"".to_owned(), doing: "building it".to_owned() };
    let robot = Arc::new(RobotView { connection, ..RobotView::default() });
    let fake = Fake::over(View { robot, ..View::default() });
    let window = fake.window(on(Screen::Live));
    assert!(says(&window, "Connecting to twin \"lab\": building it."));
    let offered = window.query_all_by_label("Open a folder of pairs…").count();
    let window = Fake::over(View::default()).window(on(Screen::Live));
    assert_eq!(window.query_all_by_label("Open a folder of pairs…").count(), offered + 1);
}

#[test]
fn a_lost_source_says_why_and_can_be_tried_again() {
    let reason = "The left camera was unplugged: plug it in again.".to_owned();
    let status = SourceStatus::Lost { reason: reason.clone(), since: Instant::now(), attempts: 2 };
    let source = Arc::new(SourceView { status, ..SourceView::default() });
    let fake = Fake::over(View { source, ..View::default() });
    let mut window = fake.window(on(Screen::Live));
    assert!(says(&window, &reason));
    click(&mut window, "Try again");
    assert_eq!(fake.take_sent(), [Command::from(SourceCommand::Retry)]);
}

#[test]
fn a_failed_job_stays_until_it_is_dismissed_and_a_done_one_does_not() {
    let job = |id, state| JobView {
        id: JobId(id),
        title: "Solve 3 pairs".to_owned(),
        state,
        elapsed: std::time::Duration::from_secs(1),
        by_itself: false,
    };
    let failed = job(1, JobState::Failed { reason: "three pairs are too few: collect more".to_owned() });
    let done = job(2, JobState::Done { summary: "solved".to_owned() });
    let fake = Fake::over(View { jobs: Arc::from([failed, done]), ..View::default() });
    let mut window = fake.window(on(Screen::Collect));
    assert!(says(&window, "three pairs are too few"));
    click(&mut window, "Dismiss");
    assert_eq!(fake.take_sent(), [Command::from(JobCommand::Dismiss(JobId(1)))]);
}

#[test]
fn what_failed_before_does_not_hide_what_moves() {
    let failed = JobView {
        id: JobId(1),
        title: "Train M2".to_owned(),
        state: JobState::Failed { reason: "15 touches are too few".to_owned() },
        elapsed: std::time::Duration::from_secs(1),
        by_itself: false,
    };
    let mut view = View { jobs: Arc::from([failed]), ..with_touch(running()) };
    let window = Fake::over(view.clone()).window(on(Screen::Touch));
    assert!(!says(&window, "15 touches are too few") && says(&window, "space stops"));
    Arc::make_mut(&mut view.touch).phase = TouchPhase::Finished;
    let window = Fake::over(view).window(on(Screen::Touch));
    assert!(says(&window, "15 touches are too few"), "it is still to be read");
}

#[test]
fn what_failed_is_said_where_it_was_begun_and_not_beside_what_moves() {
    let failed = JobView {
        id: JobId(1),
        title: "Find what is missing".to_owned(),
        state: JobState::Failed { reason: "7 rows are too few".to_owned() },
        elapsed: std::time::Duration::from_secs(1),
        by_itself: false,
    };
    let jobs: Arc<[JobView]> = Arc::from([failed]);
    let fake = Fake::over(View::default());
    let mut window = fake.window(on(Screen::Models));
    fake.show(View { jobs: jobs.clone(), ..View::default() });
    window.run_steps(3);
    assert!(shows(&window, "Dismiss"));
    click(&mut window, "Robot");
    assert!(!shows(&window, "Dismiss"), "here something else comes next");
    click(&mut window, "Models");
    assert!(shows(&window, "Dismiss"), "it is still to be read");
    // Where the next press moves the arm, that is what is said.
    let plan = planned(PlanOptions::first(area()));
    let window = Fake::over(View { jobs, ..with_touch(plan) }).window(on(Screen::Touch));
    assert!(!shows(&window, "Dismiss") && says(&window, "arm touches the glass"));
}

#[test]
fn a_screen_that_knows_nothing_of_it_says_that_the_robot_moves() {
    let view = with_touch(running());
    for (screen, says_it) in [(Screen::Drift, true), (Screen::Timeline, true), (Screen::Touch, false)] {
        let window = Fake::over(view.clone()).window(on(screen));
        assert_eq!(says(&window, "The robot moves meanwhile; Esc or space stops."), says_it, "{screen:?}");
        assert!(says(&window, "Esc or space stops."), "{screen:?}");
    }
}

#[test]
fn limp_joints_under_stop_are_not_said_to_stand_still() {
    let of = |motion| {
        let robot = RobotView { stopped: true, motion, ..crate::made_up::connected() };
        Fake::over(View { robot: Arc::new(robot), ..View::default() }).window(on(Screen::Robot))
    };
    let window = of(MotionState::Limp);
    assert!(says(&window, "they sink where nobody holds them") && !says(&window, "nothing moves until"));
    assert!(says(&of(MotionState::Holding { why: None }), "nothing moves until you press Release STOP"));
}

#[test]
fn only_a_person_is_told_where_to_hold_the_board() {
    let ghost = GhostBoard {
        left: vec![],
        right: vec![],
        reason: "upper left, near".to_owned(),
        place: BoardPlace { distance_m: 0.3, tilt_up_down_rad: 0.0, tilt_left_right_rad: 0.0 },
    };
    let eyes = Arc::new(EyesView { ghost: Some(Arc::new(ghost)), ..EyesView::default() });
    let of = |spec: Option<SourceSpec>| {
        let source = SourceView { status: SourceStatus::Running, spec, ..SourceView::default() };
        let view = View { eyes: eyes.clone(), source: Arc::new(source), ..View::default() };
        says(&Fake::over(view).window(on(Screen::Collect)), "Hold the board upper left, near.")
    };
    assert!(of(None) && !of(Some(SourceSpec::Twin)));
}

#[test]
fn empty_screens_say_how_to_fill_them() {
    for (screen, words) in [
        (Screen::Live, "Where do the images come from?"),
        (Screen::Collect, "No pairs yet"),
        (Screen::Judge, "Nothing to judge yet"),
        (Screen::Accept, "No calibration yet"),
    ] {
        let fake = Fake::over(View { eyes: Arc::new(EyesView::default()), ..View::default() });
        let window = fake.window(on(screen));
        assert!(shows(&window, words), "{screen:?}");
    }
}

#[test]
fn a_button_that_means_something_new_rests_for_half_a_second() {
    let status = SourceStatus::Lost { reason: "Unplugged.".to_owned(), since: Instant::now(), attempts: 2 };
    let source = Arc::new(SourceView { status, ..SourceView::default() });
    let fake = Fake::over(View { source, ..View::default() });
    let mut window = fake.window(on(Screen::Collect));
    fake.show(View { source: folder_of(30), ..View::default() });
    // Time goes on by a quarter of a second with each frame.
    window.run_steps(1);
    let enabled = |window: &Harness<'_, PlumblineWindow>| {
        !window.get_by_label("Use all 30 pairs of this folder").accesskit_node().is_disabled()
    };
    assert!(!enabled(&window));
    let pos = window.get_by_label("Use all 30 pairs of this folder").rect().center();
    let modifiers = egui::Modifiers::COMMAND;
    let button = |pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    let key = egui::Event::Key {
        key: egui::Key::Enter,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    };
    // All of it within one frame, and on and on.
    for _ in 0..6 {
        let hammered = [egui::Event::PointerMoved(pos), button(true), button(false), key.clone()];
        window.input_mut().events.extend(hammered);
        window.run_steps(1);
    }
    assert_eq!(fake.take_sent(), [], "who hammers the button before presses nothing, however long");
    window.run_steps(2);
    assert!(enabled(&window));
    click(&mut window, "Use all 30 pairs of this folder");
    assert_eq!(fake.take_sent(), [Command::from(EyesCommand::CollectRecording)]);
    // What means the same as before does not rest, and the same within one frame counts.
    window.input_mut().events.extend([egui::Event::PointerMoved(pos), button(true), button(false)]);
    window.run_steps(1);
    assert_eq!(fake.take_sent().len(), 1);
}

#[test]
fn who_hammers_the_button_that_began_work_does_not_cancel_it() {
    let fake = Fake::over(View { source: folder_of(30), ..View::default() });
    let mut window = fake.window(on(Screen::Collect));
    let job = JobView {
        id: JobId(7),
        title: "Solve 19 pairs".to_owned(),
        state: JobState::Running {
            fraction: 0.1,
            doing: "starting".to_owned(),
            remaining: None,
            cancelling: false,
        },
        elapsed: std::time::Duration::from_secs(1),
        by_itself: false,
    };
    fake.show(View { source: folder_of(30), jobs: Arc::from([job]), ..View::default() });
    window.run_steps(1);
    let enabled =
        |window: &Harness<'_, PlumblineWindow>| !window.get_by_label("Cancel").accesskit_node().is_disabled();
    assert!(!enabled(&window), "it stands where the button stood");
    window.run_steps(3);
    assert!(enabled(&window));
    click(&mut window, "Cancel");
    assert_eq!(fake.take_sent(), [Command::from(JobCommand::Cancel(JobId(7)))]);
}

#[test]
fn work_that_began_by_itself_takes_neither_the_bottom_line_nor_cancel_from_what_was_asked_for() {
    let job = |id: u64, title: &str, by_itself| JobView {
        id: JobId(id),
        title: title.to_owned(),
        state: JobState::Running {
            fraction: 0.4,
            doing: "at work".to_owned(),
            remaining: None,
            cancelling: false,
        },
        elapsed: std::time::Duration::from_secs(1),
        by_itself,
    };
    let judging = job(1, "Judge the calibration by what the eyes see", true);
    let view = View { jobs: Arc::from([judging.clone()]), ..View::default() };
    let window = Fake::over(view.clone()).window(on(Screen::Collect));
    assert!(!says(&window, "by what the eyes see: at work"));
    assert_eq!(plumbline::Action::CancelJob.refusal(&view).as_deref(), Some("no job is running"));

    let jobs = Arc::from([judging, job(2, "Solve 30 pairs", false)]);
    let fake = Fake::over(View { jobs, ..View::default() });
    let mut window = fake.window(on(Screen::Collect));
    assert!(says(&window, "Solve 30 pairs: at work") && !says(&window, "by what the eyes see: at work"));
    click(&mut window, "Cancel");
    assert_eq!(fake.take_sent(), [Command::from(JobCommand::Cancel(JobId(2)))]);
}
