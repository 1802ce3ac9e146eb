//! What has failed inside is named on every screen, with what it means and what starts it again.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{Screen, WindowSettings};
use plumbline_engine::view::{Connection, JobState, JobView, KeptView, MotionState, RobotView, ThreadFault};
use plumbline_engine::watched::Trouble;
use plumbline_engine::{Command, JobId, View, WatchCommand, WatchedThread};

use crate::fake::{Fake, click, says, shows};
use crate::made_up::everything;

fn ended(thread: WatchedThread, has_let_go: bool) -> ThreadFault {
    let trouble = Trouble::Ended { said: "a speed of 1e-30".to_owned(), since: Instant::now() };
    ThreadFault::new(thread, trouble, has_let_go)
}

fn silent(thread: WatchedThread) -> ThreadFault {
    ThreadFault::new(thread, Trouble::Silent { since: Instant::now() }, false)
}

/// As the engine shows it when the robot's thread is gone.
fn robot_failed(fault: ThreadFault) -> View {
    let before = everything();
    let connection = Connection::Lost { to: "port".to_owned(), reason: fault.meaning.to_string() };
    let robot = RobotView {
        connection,
        motion: MotionState::Unknown,
        stopped: true,
        measured: None,
        bus: plumbline_engine::view::BusView::default(),
        ..RobotView::clone(&before.robot)
    };
    View { robot: Arc::new(robot), threads: Arc::from([fault]), ..before }
}

fn on(screen: Screen) -> WindowSettings {
    WindowSettings { screen, ..WindowSettings::default() }
}

fn start_again(thread: WatchedThread) -> Command {
    WatchCommand::StartAgain(thread).into()
}

#[test]
fn a_dead_robot_thread_is_said_on_every_screen_and_started_again_with_one_click() {
    for screen in Screen::ALL {
        let fake = Fake::over(robot_failed(ended(WatchedThread::Robot, true)));
        let mut window = fake.window(on(screen));
        assert!(shows(&window, "Program robot failed"), "{screen:?}");
        assert!(says(&window, "What talks to the arm has failed inside"), "{screen:?}");
        assert!(says(&window, "power switch in reach"), "{screen:?}");
        let stop = window.get_by_label("STOP").accesskit_node().value();
        assert_eq!(stop.as_deref(), Some("arm not known"), "{screen:?}");
        click(&mut window, "Start again");
        assert_eq!(fake.take_sent(), [start_again(WatchedThread::Robot)], "{screen:?}");
    }
}

#[test]
fn the_lamp_opens_what_was_said_and_the_button() {
    let fake = Fake::over(robot_failed(ended(WatchedThread::Robot, true)));
    let mut window = fake.window(on(Screen::Live));
    click(&mut window, "Program robot failed");
    assert!(says(&window, "It said: a speed of 1e-30."));
    click(&mut window, "Start again: what talks to the arm");
    assert_eq!(fake.take_sent(), [start_again(WatchedThread::Robot)]);
}

#[test]
fn work_that_goes_on_does_not_hide_it() {
    let state = JobState::Running {
        fraction: 0.4,
        doing: "iteration 3".to_owned(),
        remaining: None,
        cancelling: false,
    };
    let (id, title, elapsed) = (JobId(7), "Solve".to_owned(), Duration::from_secs(1));
    let job = JobView { id, title, state, elapsed, by_itself: false };
    let view = View { jobs: Arc::from([job]), ..robot_failed(ended(WatchedThread::Robot, true)) };
    let fake = Fake::over(view);
    let window = fake.window(on(Screen::Judge));
    assert!(says(&window, "What talks to the arm has failed inside"));
    assert!(shows(&window, "Start again"));
}

#[test]
fn while_it_lets_go_the_button_waits_and_a_silent_one_has_none() {
    let fake = Fake::over(robot_failed(ended(WatchedThread::Robot, false)));
    let mut window = fake.window(on(Screen::Robot));
    assert!(window.get_by_label("Start again").accesskit_node().is_disabled());
    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    window.run_steps(2);
    assert_eq!(fake.take_sent(), []);

    let fake = Fake::over(robot_failed(silent(WatchedThread::Robot)));
    let window = fake.window(on(Screen::Robot));
    assert!(shows(&window, "Program robot silent"));
    assert!(says(&window, "STOP was pressed for you"));
    assert!(!shows(&window, "Start again"));
}

#[test]
fn a_dead_stage_is_said_where_it_is_looked_at_and_named_everywhere() {
    let view = || View { threads: Arc::from([ended(WatchedThread::Rectify, true)]), ..everything() };
    let fake = Fake::over(view());
    let mut window = fake.window(on(Screen::Live));
    assert!(says(&window, "there are no rectified views and no depth"));
    click(&mut window, "Start again");
    assert_eq!(fake.take_sent(), [start_again(WatchedThread::Rectify)]);
    let fake = Fake::over(view());
    let window = fake.window(on(Screen::Gap));
    assert!(shows(&window, "Program rectify failed"));
    assert!(!shows(&window, "Start again"));
}

#[test]
fn several_faults_are_counted_and_the_worst_comes_first() {
    let threads = Arc::from([
        ended(WatchedThread::Engine, true),
        ended(WatchedThread::Robot, true),
        ended(WatchedThread::Journal, true),
    ]);
    let fake = Fake::over(View { threads, ..robot_failed(ended(WatchedThread::Robot, true)) });
    let mut window = fake.window(on(Screen::Live));
    assert!(shows(&window, "Program engine failed, 2 more"));
    assert!(says(&window, "The heart of the program has failed inside"));
    click(&mut window, "Start again");
    assert_eq!(fake.take_sent(), [start_again(WatchedThread::Engine)]);
}

#[test]
fn what_the_journal_lacks_and_where_data_go_is_said() {
    let kept = KeptView {
        problem: Some("You have no home folder. What is accepted goes to a folder of its own.".into()),
        journal_lost: 12,
        ..KeptView::default()
    };
    let fake = Fake::over(View { kept: Arc::new(kept), lost_commands: 3, ..everything() });
    let window = fake.window(on(Screen::Live));
    assert!(shows(&window, "Journal 12 lost") && shows(&window, "Data at risk"));
    assert!(shows(&window, "Requests 3 lost"));
    let fake = Fake::over(everything());
    let window = fake.window(on(Screen::Live));
    for words in ["Journal", "Data at risk", "Requests", "Program"] {
        assert!(!says(&window, words), "while all is well nothing is said: {words}");
    }
}

/// Every state drawn into a PNG of `PLUMBLINE_WINDOW_PICTURES=<folder>`, with `--ignored pictures`.
#[test]
#[ignore = "draws pictures for people to look at"]
fn pictures_of_faults() {
    let folder = crate::fake::picture_folder();
    for theme in [plumbline::ThemeChoice::Dark, plumbline::ThemeChoice::Light] {
        let kept = |lost: u64| {
            Arc::new(KeptView {
                folder: "/data".into(),
                problem: Some("There is no home folder: data are kept in a folder that is gone after a restart.".into()),
                journal: None,
                no_journal_because: Some("The journal's folder cannot be written (No space left on device): make room, then start again.".into()),
                journal_lost: lost,
            })
        };
        let cases = [
            ("robot", Screen::Robot, robot_failed(ended(WatchedThread::Robot, true)), None),
            (
                "robot-lamp",
                Screen::Live,
                robot_failed(ended(WatchedThread::Robot, true)),
                Some("Program robot failed"),
            ),
            ("silent", Screen::Robot, robot_failed(silent(WatchedThread::Robot)), None),
            (
                "rectify",
                Screen::Live,
                View { threads: Arc::from([ended(WatchedThread::Rectify, true)]), ..everything() },
                None,
            ),
            ("kept", Screen::Gap, View { kept: kept(12), ..everything() }, None),
        ];
        for (name, screen, view, press) in cases {
            let fake = Fake::over(view);
            let mut window = fake.window_with(WindowSettings { theme, ..on(screen) }, [1280.0, 800.0], true);
            if let Some(press) = press {
                click(&mut window, press);
                window.run_steps(4);
            }
            let image = window.render().expect("the test renderer draws");
            image
                .save(folder.join(format!("fault-{name}-{theme:?}.png").to_lowercase()))
                .expect("the folder can be written");
        }
        // The bus's lamp, its sheet, and the sheet that asks.
        let before = everything();
        let bus = plumbline_engine::view::BusView { slow_answers: 20, ..before.robot.bus.clone() };
        let robot = RobotView { bus, motion: MotionState::Limp, ..RobotView::clone(&before.robot) };
        let fake = Fake::over(View { robot: Arc::new(robot), ..before });
        let mut window =
            fake.window_with(WindowSettings { theme, ..on(Screen::Robot) }, [1280.0, 800.0], true);
        window.key_press_modifiers(Modifiers::COMMAND, Key::K);
        window.run_steps(2);
        window.event(egui::Event::Text("Shorten".to_owned()));
        window.run_steps(3);
        window.key_press(Key::Enter);
        window.run_steps(4);
        let image = window.render().expect("the test renderer draws");
        image
            .save(folder.join(format!("fault-shorten-{theme:?}.png").to_lowercase()))
            .expect("the folder can be written");
    }
}

/// A window in which every lamp of the top line has something to say, STOP latched.
fn all_lamps() -> View {
    let before = robot_failed(ended(WatchedThread::Robot, true));
    let kept = KeptView { problem: Some("the disk is full".into()), journal_lost: 12, ..KeptView::default() };
    View { kept: Arc::new(kept), lost_commands: 3, ..before }
}

#[test]
fn nothing_in_the_top_line_covers_anything_else_at_any_width() {
    for (size, zoom) in [
        ([1440.0, 900.0], 1.0),
        ([1280.0, 800.0], 1.0),
        ([1024.0, 700.0], 1.0),
        ([960.0, 600.0], 1.0),
        ([1920.0, 1200.0], 2.0),
    ] {
        let fake = Fake::over(all_lamps());
        let mut window = fake.window_of_size(on(Screen::Live), size);
        window.ctx.set_zoom_factor(zoom);
        window.run_steps(4);
        let wide = size[0] / zoom;
        let buttons = window.query_all_by_role(egui::accesskit::Role::Button);
        let rects: Vec<_> = buttons
            .map(|button| (button.accesskit_node().label().unwrap_or_default(), button.rect()))
            .filter(|(_, rect)| rect.max.y < 100.0)
            .collect();
        assert!(rects.len() >= 10, "{size:?}: {rects:?}");
        for label in ["STOP", "Release STOP", "Commands", "Program robot failed", "Requests 3 lost"] {
            assert!(rects.iter().any(|(name, _)| name.starts_with(label)), "{label} of {size:?}: {rects:?}");
        }
        for (i, (name, rect)) in rects.iter().enumerate() {
            assert!(rect.min.x >= 0.0 && rect.max.x <= wide, "{name} of {size:?} at {zoom}: {rect}");
            for (other, covered) in &rects[i + 1..] {
                let both = rect.shrink(0.5).intersect(covered.shrink(0.5));
                assert!(
                    !both.is_positive(),
                    "{name} at {rect} and {other} at {covered} of {size:?} at {zoom}"
                );
            }
        }
    }
}
