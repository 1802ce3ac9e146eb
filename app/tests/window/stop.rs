//! STOP: always there, always works, whatever is open.

use std::sync::Arc;
use std::time::Duration;

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{PlumblineWindow, Screen, WindowSettings};
use plumbline_engine::view::{
    EyesView, HandEyeView, JobState, JobView, ModelsView, MotionState, MountTour, MountView, ReplayView,
    RobotView, SourceStatus, SourceView,
};
use plumbline_engine::{Command, EyesCommand, JobCommand, JobId, SourceCommand, View};

use crate::fake::{Fake, click, click_at, says, shows};
use crate::made_up::everything;
use crate::made_up_models;

/// A job, a playing recording and automatic capture: all that can run.
fn everything_runs() -> View {
    let replay = ReplayView {
        position: Some(3),
        length: 30,
        playing: true,
        looping: true,
        pairs_per_second: Some(4.0),
        growth: Default::default(),
    };
    let job = JobView {
        id: JobId(7),
        title: "Solve 30 pairs".to_owned(),
        state: JobState::Running {
            fraction: 0.4,
            doing: "iteration 3".to_owned(),
            remaining: Some(Duration::from_secs(2)),
            cancelling: false,
        },
        elapsed: Duration::from_secs(1),
        by_itself: false,
    };
    View {
        source: Arc::new(SourceView {
            status: SourceStatus::Running,
            replay: Some(replay),
            ..SourceView::default()
        }),
        eyes: Arc::new(EyesView { auto_capture: true, ..EyesView::default() }),
        jobs: Arc::from([job]),
        ..View::default()
    }
}

fn stopped() -> [Command; 3] {
    [JobCommand::Cancel(JobId(7)).into(), EyesCommand::AutoCapture(false).into(), SourceCommand::Pause.into()]
}

#[test]
fn the_button_stops_everything_that_runs() {
    let fake = Fake::over(everything_runs());
    let mut window = fake.window(WindowSettings::default());
    click(&mut window, "STOP");
    // Once when it is pressed down, and once more when it is let go.
    let sent = fake.take_sent();
    assert!(sent.starts_with(&stopped()), "{sent:?}");
}

#[test]
fn escape_and_space_stop_on_every_screen() {
    for screen in Screen::ALL {
        let fake = Fake::over(everything_runs());
        let mut window = fake.window(WindowSettings { screen, ..WindowSettings::default() });
        for key in [Key::Escape, Key::Space] {
            window.key_press(key);
            window.run_steps(2);
            assert_eq!(fake.take_sent(), stopped(), "{key:?} on {screen:?}");
        }
    }
}

#[test]
fn space_stops_and_does_not_press_the_button_that_has_the_focus() {
    let fake = Fake::over(everything_runs());
    let mut window = fake.window(WindowSettings::default());
    window.get_by_label("Forward").focus();
    window.run_steps(2);
    window.key_press(Key::Space);
    window.run_steps(2);
    assert_eq!(fake.take_sent(), stopped());
}

/// The arm moves, too.
fn moving() -> View {
    let motion = MotionState::Moving { what: "to Home".to_owned(), fraction: Some(0.2), remaining: None };
    View { robot: Arc::new(RobotView { motion, ..RobotView::default() }), ..everything_runs() }
}

/// The head stands at a pose of its tour, or the hands are looked at: it goes on moving by itself.
fn between_two_poses() -> [View; 2] {
    let motion = MotionState::Holding { why: None };
    let robot = Arc::new(RobotView { motion, ..RobotView::default() });
    let tour = Some(MountTour { pose: 3, of: 8, waits: false });
    let mount = Arc::new(MountView { tour, ..MountView::default() });
    let handeye = Arc::new(HandEyeView { is_looking: true, ..HandEyeView::default() });
    [View { robot: robot.clone(), mount, ..everything_runs() }, View { robot, handeye, ..everything_runs() }]
}

/// What Esc does with the palette open: what was stopped, and whether the palette is still there.
fn escape_in_the_palette(view: View, modifiers: Modifiers) -> (Vec<Command>, usize, bool) {
    let fake = Fake::over(view);
    let mut window = fake.window(WindowSettings::default());
    window.key_press_modifiers(Modifiers::COMMAND, Key::K);
    window.run_steps(3);
    assert!(shows(&window, "Search commands"), "the palette is open");
    fake.take_stops();
    window.key_press_modifiers(modifiers, Key::Escape);
    window.run_steps(3);
    (fake.take_sent(), fake.take_stops(), shows(&window, "Search commands"))
}

#[test]
fn escape_stops_what_moves_while_a_text_is_typed_and_with_other_keys_held() {
    for modifiers in [Modifiers::NONE, Modifiers::SHIFT, Modifiers::COMMAND] {
        let (sent, stops, _) = escape_in_the_palette(moving(), modifiers);
        assert_eq!(sent, stopped(), "{modifiers:?}");
        assert!(stops > 0, "{modifiers:?}");
    }
}

#[test]
fn escape_stops_what_stands_between_two_poses_of_a_tour_and_closing_asks() {
    for view in between_two_poses() {
        let (sent, stops, _) = escape_in_the_palette(view.clone(), Modifiers::NONE);
        assert_eq!(sent, stopped());
        assert!(stops > 0);
        let fake = Fake::over(view);
        let mut window = fake.window(WindowSettings::default());
        close(&mut window);
        assert!(says(&window, "Close while the robot moves?"));
    }
}

#[test]
fn space_stops_what_moves_while_a_text_is_typed() {
    for (view, stops_it) in [(moving(), true), (everything_runs(), false)] {
        let fake = Fake::over(view);
        let mut window = fake.window(WindowSettings::default());
        window.key_press_modifiers(Modifiers::COMMAND, Key::K);
        window.run_steps(3);
        fake.take_stops();
        window.key_press(Key::Space);
        window.run_steps(3);
        assert_eq!(fake.take_stops() > 0, stops_it);
        assert_eq!(fake.take_sent() == stopped(), stops_it, "where nothing moves the text gets it");
    }
}

#[test]
fn where_nothing_moves_escape_closes_what_lies_on_top_and_stops_only_then() {
    assert_eq!(escape_in_the_palette(everything_runs(), Modifiers::NONE), (Vec::new(), 0, false));
    for key in [Key::L, Key::M] {
        let fake = Fake::over(everything_runs());
        let mut window = fake.window(WindowSettings::default());
        window.key_press_modifiers(Modifiers::COMMAND, key);
        window.run_steps(3);
        fake.take_sent();
        window.key_press(Key::Escape);
        window.run_steps(3);
        assert_eq!((fake.take_sent(), fake.take_stops()), (Vec::new(), 0), "{key:?}");
        window.key_press(Key::Escape);
        window.run_steps(3);
        assert_eq!(fake.take_sent(), stopped(), "nothing lies on top any more");
    }
}

/// As the system asks a window to close.
fn close(window: &mut Harness<'_, PlumblineWindow>) {
    let viewport = window.input_mut().viewports.entry(egui::ViewportId::ROOT).or_default();
    viewport.events.push(egui::ViewportEvent::Close);
    window.run_steps(1);
    let viewport = window.input_mut().viewports.entry(egui::ViewportId::ROOT).or_default();
    viewport.events.clear();
    window.run_steps(2);
}

#[test]
fn closing_while_something_moves_asks_and_stops_first() {
    let fake = Fake::over(moving());
    let mut window = fake.window(WindowSettings::default());
    close(&mut window);
    assert!(says(&window, "Close while the robot moves?"));
    assert_eq!(fake.take_stops(), 0, "nothing is done before it was answered");
    click(&mut window, "Stop and close");
    assert!(fake.take_stops() > 0);
    close(&mut window);
    assert!(!says(&window, "Close while the robot moves?"), "it is asked once");

    let fake = Fake::over(everything_runs());
    let mut window = fake.window(WindowSettings::default());
    close(&mut window);
    assert!(!says(&window, "Close while the robot moves?"), "nothing moves");
}

#[test]
fn closing_asks_where_what_was_solved_would_be_lost() {
    let trained = ModelsView { in_use: None, ..made_up_models::trained() };
    let open = View { models: Arc::new(trained), ..moving() };
    let still = |view: View| View { robot: View::default().robot, ..view };
    let fake = Fake::over(open.clone());
    let mut window = fake.window(WindowSettings::default());
    close(&mut window);
    assert!(says(&window, "Close while the robot moves?"), "what moves comes first");
    assert!(says(&window, "Closing loses that."), "and what is lost is said as well");

    let in_use = made_up_models::in_use();
    let together = made_up_models::trained().proposals;
    let one_of_them = ModelsView { proposals: together, ..in_use.clone() };
    for (models, asks) in [
        (ModelsView { in_use: None, ..made_up_models::trained() }, true),
        (one_of_them, false),
        (in_use, false),
    ] {
        let fake = Fake::over(still(View { models: Arc::new(models), ..open.clone() }));
        let mut window = fake.window(WindowSettings::default());
        close(&mut window);
        assert_eq!(says(&window, "Closing loses that."), asks);
        if asks {
            assert!(says(&window, "Solved and not accepted: the correction models."));
            click(&mut window, "Cancel");
            assert!(!says(&window, "Closing loses that."), "the window stays");
            close(&mut window);
            click(&mut window, "Close all the same");
            close(&mut window);
            assert!(!says(&window, "Closing loses that."), "it is asked once");
            assert_eq!(fake.take_stops(), 0, "nothing moves that could be stopped");
        }
    }
}

#[test]
fn a_second_press_on_messages_closes_them() {
    let fake = Fake::over(everything_runs());
    let mut window = fake.window(WindowSettings::default());
    let at = window.get_by_label("Messages").rect().center();
    click_at(&mut window, at);
    assert!(shows(&window, "Clear messages"));
    click_at(&mut window, at);
    assert!(!shows(&window, "Clear messages"), "it does not open anew");
    click_at(&mut window, at);
    assert!(shows(&window, "Clear messages"));
}

#[test]
fn what_turns_is_said_to_be_the_head() {
    let tour = MountTour { pose: 2, of: 8, waits: false };
    let connected = everything();
    let robot = Arc::new(RobotView { motion: moving().robot.motion.clone(), ..(*connected.robot).clone() });
    let moving = View { robot, ..connected };
    let turning = MountView { tour: Some(tour), ..(*moving.mount).clone() };
    let turning = View { mount: Arc::new(turning), ..moving.clone() };
    for (view, said) in [(turning, "head moving"), (moving, "arm moving")] {
        let window = Fake::over(view).window(WindowSettings::default());
        let stop = window.get_by_label("STOP");
        assert_eq!(stop.accesskit_node().value().as_deref(), Some(said));
    }
}

#[test]
fn nothing_ever_covers_the_button() {
    let open: [(&str, Option<Key>); 6] = [
        ("", None),
        ("palette", Some(Key::K)),
        ("path", Some(Key::L)),
        ("messages", Some(Key::M)),
        ("log", Some(Key::J)),
        ("frame times", Some(Key::F12)),
    ];
    for size in [[1280.0, 800.0], [960.0, 600.0], [3840.0, 2160.0]] {
        for (what, key) in open {
            let fake = Fake::over(everything_runs());
            let mut window = fake.window_of_size(WindowSettings::default(), size);
            if let Some(key) = key {
                let modifiers = if key == Key::F12 { Modifiers::NONE } else { Modifiers::COMMAND };
                window.key_press_modifiers(modifiers, key);
                window.run_steps(3);
            }
            let rect = window.get_by_label("STOP").rect();
            let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
            assert!(screen.contains_rect(rect), "STOP is at {rect} of {size:?} with {what}");
            // With the pointer, as a hand does it: whatever lies on top gets the click.
            let center = rect.center();
            window.hover_at(center);
            window.run_steps(1);
            for pressed in [true, false] {
                window.event(egui::Event::PointerButton {
                    pos: center,
                    button: egui::PointerButton::Primary,
                    pressed,
                    modifiers: Modifiers::NONE,
                });
                window.run_steps(1);
            }
            let sent = fake.take_sent();
            assert!(sent.starts_with(&stopped()), "with {what} open at {size:?}: {sent:?}");
        }
    }
}

#[test]
fn it_says_that_no_arm_is_connected() {
    let fake = Fake::over(View::default());
    let window = fake.window(WindowSettings::default());
    let value = window.get_by_label("STOP").accesskit_node().value();
    assert_eq!(value.as_deref(), Some("no arm connected"));
}
