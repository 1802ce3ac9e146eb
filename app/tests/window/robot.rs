//! The robot: nothing moves that was not shown and asked for, and STOP always gets through.

use std::sync::Arc;
use std::time::Duration;

use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{PlumblineWindow, Screen, ThemeChoice, WindowSettings};
use plumbline_engine::view::{
    BusView, Connection, InTheWay, JointView, MotionState, PortView, RobotView, TouchPhase, TouchView,
};
use plumbline_engine::{Command, Destination, RobotCommand, View};

use crate::fake::{Fake, click, says, shows};
use crate::made_up::{connected, everything, free_path, joint, preview, rig, with_robot};

fn on_robot() -> WindowSettings {
    WindowSettings { screen: Screen::Robot, ..WindowSettings::default() }
}

fn robot_commands(fake: &Fake) -> Vec<RobotCommand> {
    let only = |command| if let Command::Robot(command) = command { Some(command) } else { None };
    fake.take_sent().into_iter().filter_map(only).collect()
}

/// Presses the pointer on what has this label and leaves it there.
fn hold(window: &mut Harness<'_, PlumblineWindow>, label: &str, modifiers: Modifiers) {
    let center = window.get_by_label(label).rect().center();
    window.event(egui::Event::ModifiersChanged(modifiers));
    window.event(egui::Event::PointerMoved(center));
    window.run_steps(1);
    window.event(pointer(center, true, modifiers));
    window.run_steps(2);
}

fn pointer(pos: egui::Pos2, pressed: bool, modifiers: Modifiers) -> egui::Event {
    egui::Event::PointerButton { pos, button: egui::PointerButton::Primary, pressed, modifiers }
}

#[test]
fn a_dragged_joint_is_shown_and_does_not_move() {
    let fake = Fake::over(everything());
    let mut window = fake.window(on_robot());
    let slider = window.get_by_label("Right elbow goal").rect();
    let from = slider.center();
    window.event(egui::Event::PointerMoved(from));
    window.run_steps(1);
    window.event(pointer(from, true, Modifiers::NONE));
    window.run_steps(1);
    window.event(egui::Event::PointerMoved(from + egui::vec2(12.0, 0.0)));
    window.run_steps(1);
    window.event(pointer(from + egui::vec2(12.0, 0.0), false, Modifiers::NONE));
    window.run_steps(2);
    let sent = robot_commands(&fake);
    assert!(!sent.is_empty(), "a drag asks for something");
    for command in &sent {
        let to_elbow = matches!(
            command,
            RobotCommand::Preview(Destination::Joint { joint: j, .. }) if *j == joint("r_elbow_y")
        );
        assert!(to_elbow, "only previews of the elbow: {command:?}");
    }
}

#[test]
fn a_second_joint_is_added_to_the_shown_move() {
    let mut robot = connected();
    robot.preview = Some(preview(free_path()));
    let fake = Fake::over(with_robot(robot));
    let mut window = fake.window(on_robot());
    let at = window.get_by_label("Head left–right goal").rect().center();
    for pressed in [true, false] {
        window.event(egui::Event::PointerMoved(at));
        window.event(pointer(at, pressed, Modifiers::NONE));
        window.run_steps(2);
    }
    let sent = robot_commands(&fake);
    let Some(RobotCommand::Preview(Destination::Posture(posture))) = sent.last() else {
        panic!("a whole posture: {sent:?}")
    };
    let elbow = joint("r_elbow_y");
    assert_eq!(posture[elbow], preview(free_path()).end[elbow]);
}

#[test]
fn the_shown_move_runs_with_one_button_that_says_what_and_how_long() {
    let mut robot = connected();
    robot.preview = Some(preview(free_path()));
    let fake = Fake::over(with_robot(robot));
    let mut window = fake.window(on_robot());
    assert!(says(&window, "43.0 mm between right palm and table"));
    click(&mut window, "Move there: right elbow to 92°, 1.4 s");
    assert_eq!(robot_commands(&fake), [RobotCommand::RunPreview]);
}

#[test]
fn a_move_shown_on_another_screen_with_a_scene_runs_there_too() {
    for screen in [Screen::Live, Screen::Mount] {
        let robot = RobotView { preview: Some(preview(free_path())), ..connected() };
        let fake = Fake::over(with_robot(robot));
        let mut window = fake.window(WindowSettings { screen, ..WindowSettings::default() });
        click(&mut window, "Move there: right elbow to 92°, 1.4 s");
        assert_eq!(robot_commands(&fake), [RobotCommand::RunPreview], "{screen:?}");
    }
}

#[test]
fn a_refused_path_disables_the_button_and_says_why() {
    let mut robot = connected();
    let (a, b) = ("The right palm".to_owned(), "the table".to_owned());
    let way = InTheWay::Collides { a, b, at_fraction: 0.4 };
    robot.preview = Some(preview(Err(way)));
    let fake = Fake::over(with_robot(robot));
    let mut window = fake.window(on_robot());
    assert!(says(&window, "The right palm would run into the table after 40 % of the way."));
    let button = window.get_by_label("Move there: right elbow to 92°, 1.4 s");
    assert!(button.accesskit_node().is_disabled());
    button.click();
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    window.run_steps(2);
    assert_eq!(robot_commands(&fake), []);
}

#[test]
fn a_refusal_is_shown_where_the_request_was_made() {
    let fake = Fake::over(everything());
    let mut window = fake.window(on_robot());
    click(&mut window, "Home");
    assert_eq!(robot_commands(&fake), [RobotCommand::Preview(Destination::Pose { name: "home".to_owned() })]);
    let why = "servo 5 is too hot (71 °C): let it cool";
    fake.show(with_robot(RobotView { refusal: Some(why.to_owned()), ..connected() }));
    window.run_steps(2);
    click(&mut window, "Dismiss");
    assert_eq!(robot_commands(&fake), [RobotCommand::DismissRefusal]);
}

#[test]
fn a_jog_button_without_the_enabling_key_moves_nothing() {
    let fake = Fake::over(everything());
    let mut window = fake.window(on_robot());
    hold(&mut window, "Forward", Modifiers::NONE);
    window.key_press(Key::ArrowUp);
    window.run_steps(2);
    assert_eq!(robot_commands(&fake), []);
}

#[test]
fn a_held_jog_key_is_renewed_and_released_at_once() {
    let fake = Fake::over(everything());
    let mut window = fake.window(on_robot());
    hold(&mut window, "Forward", Modifiers::SHIFT);
    let sent = robot_commands(&fake);
    assert!(
        matches!(sent.first(), Some(RobotCommand::Jog(rates)) if rates.velocity_m_s[0] > 0.0),
        "{sent:?}"
    );
    std::thread::sleep(Duration::from_millis(60));
    window.run_steps(1);
    assert!(matches!(robot_commands(&fake).as_slice(), [RobotCommand::Jog(_)]));
    // The enabling key alone is enough to end it.
    window.event(egui::Event::ModifiersChanged(Modifiers::NONE));
    window.run_steps(2);
    assert_eq!(robot_commands(&fake).last(), Some(&RobotCommand::EndJog));
}

#[test]
fn an_arm_that_a_run_moves_is_not_jogged_and_the_pad_says_why() {
    let touch = TouchView {
        phase: TouchPhase::Running { number: Some(3), doing: String::new() },
        ..TouchView::default()
    };
    let fake = Fake::over(View { touch: Arc::new(touch), ..everything() });
    let window = fake.window(on_robot());
    assert!(says(&window, "touches move the arm: pause them first"));
    assert!(!says(&window, "Hold to move"));
}

#[test]
fn an_arm_of_which_one_joint_is_not_known_cannot_be_jogged() {
    let of_arm = |arm: usize| RobotView { unknown: [rig().arms[arm].joints[3]].into(), ..connected() };
    let fake = Fake::over(with_robot(of_arm(0)));
    let mut window = fake.window(on_robot());
    let why = "it is not known where Right elbow is: check its cable and power";
    for label in [why, "Forward"] {
        assert!(window.get_by_label(label).accesskit_node().is_disabled(), "{label}");
    }
    assert!(!shows(&window, "Hold to move"));
    hold(&mut window, "Forward", Modifiers::SHIFT);
    assert_eq!(robot_commands(&fake), []);
    // The other arm is no reason.
    fake.show(with_robot(of_arm(1)));
    window.run_steps(2);
    let button = window.get_by_label("Hold to move");
    assert!(!button.accesskit_node().is_disabled());
    assert_eq!(robot_commands(&fake), [], "what was pressed before is pressed anew to move");
    window.event(pointer(window.get_by_label("Forward").rect().center(), false, Modifiers::SHIFT));
    window.run_steps(2);
    hold(&mut window, "Forward", Modifiers::SHIFT);
    assert!(matches!(robot_commands(&fake).first(), Some(RobotCommand::Jog(_))));
}

#[test]
fn leaving_the_screen_ends_a_jog() {
    let fake = Fake::over(everything());
    let mut window = fake.window(on_robot());
    hold(&mut window, "Up", Modifiers::SHIFT);
    assert!(!robot_commands(&fake).is_empty());
    window.key_press_modifiers(Modifiers::COMMAND, Key::Num1);
    window.run_steps(3);
    assert_eq!(robot_commands(&fake).last(), Some(&RobotCommand::EndJog));
}

#[test]
fn stop_reaches_the_robot_by_key_and_button() {
    for screen in Screen::ALL {
        let fake = Fake::over(everything());
        let mut window = fake.window(WindowSettings { screen, ..WindowSettings::default() });
        for key in [Key::Escape, Key::Space] {
            window.key_press(key);
            window.run_steps(1);
            assert!(fake.take_stops() > 0, "{key:?} on {screen:?}");
        }
        click(&mut window, "STOP");
        assert!(fake.take_stops() > 0, "button on {screen:?}");
    }
}

#[test]
fn a_latched_stop_is_released_by_a_click_and_never_by_a_key() {
    let robot = RobotView { stopped: true, preview: Some(preview(free_path())), ..connected() };
    let fake = Fake::over(with_robot(robot));
    let mut window = fake.window(on_robot());
    assert_eq!(window.get_by_label("STOP").accesskit_node().value().as_deref(), Some("stopped"));
    assert!(says(&window, "nothing moves until you press Release STOP"));
    window.get_by_label("Release STOP").focus();
    window.run_steps(2);
    window.key_press(Key::Space);
    window.run_steps(2);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    window.run_steps(2);
    assert_eq!(robot_commands(&fake), []);
    assert!(fake.take_stops() > 0, "space stops once more");
    click(&mut window, "Release STOP");
    assert_eq!(robot_commands(&fake), [RobotCommand::ReleaseStop]);
}

#[test]
fn every_frame_is_a_sign_of_life() {
    let motion = MotionState::Moving { what: "to Home".to_owned(), fraction: Some(0.4), remaining: None };
    let fake = Fake::over(with_robot(RobotView { motion, ..connected() }));
    let mut window = fake.window(on_robot());
    assert_eq!(window.get_by_label("STOP").accesskit_node().value().as_deref(), Some("arm moving"));
    assert!(says(&window, "Moving to Home, 40 %. Esc or space stops."));
    let before = fake.heartbeats();
    window.run_steps(5);
    assert!(fake.heartbeats() >= before + 5);
}

#[test]
fn connecting_says_that_nothing_moves_and_keeps_the_sheet_open() {
    let mut robot = RobotView { rig: connected().rig, ..RobotView::default() };
    robot.ports = Some([PortView { path: "/dev/ttyUSB0".to_owned(), what: "FTDI, U2D2".to_owned() }].into());
    let view = with_robot(robot);
    let fake = Fake::over(view);
    let mut window = fake.window(on_robot());
    click(&mut window, "Connect the robot…");
    assert_eq!(robot_commands(&fake), [RobotCommand::ListPorts]);
    assert!(says(&window, "Nothing moves"));
    click(&mut window, "Serial port");
    assert!(says(&window, "U2D2"));
    click(&mut window, "Connect");
    assert_eq!(robot_commands(&fake), [RobotCommand::ConnectPort { path: "/dev/ttyUSB0".into() }]);
    let bus = BusView {
        missing: vec![31],
        late: vec![5, 7],
        unexpected: vec![(77, "MX-28".to_owned())],
        warnings: vec!["the latency timer of the adapter is 16 ms: set it to 1 ms".to_owned()],
        ..BusView::default()
    };
    fake.show(with_robot(RobotView { bus, ..connected() }));
    window.run_steps(3);
    assert!(says(&window, "Servo 31 (Right wrist turn) does not answer"));
    assert!(says(&window, "Servos 5, 7 answer too late: the computer was too busy"), "load is named load");
    let cables = window.query_all_by_label_contains("look at its cable and its supply").count();
    assert_eq!(cables, 1, "nobody is sent to look at the cables of those that are late");
    assert!(says(&window, "Servo 77 (MX-28) is not in the description of this robot"));
    assert!(says(&window, "latency timer"));
}

#[test]
fn where_it_stands_in_a_pose_of_its_own_that_is_said() {
    let rig = rig();
    let home = rig.home();
    for (measured, is_home) in [(home.clone(), true), (home.with(&rig.arms[0].joints[..1], &[0.4]), false)] {
        let at = RobotView { measured: Some(measured), ..connected() };
        let window = Fake::over(with_robot(at)).window(on_robot());
        assert_eq!(says(&window, "It stands in the pose Home."), is_home);
        assert!(says(&window, "Drag a joint or choose a pose"));
    }
}

#[test]
fn a_sheet_on_which_nothing_is_left_to_do_ends_with_done() {
    let fake = Fake::over(with_robot(RobotView { rig: connected().rig, ..RobotView::default() }));
    let mut window = fake.window(on_robot());
    click(&mut window, "Connect the robot…");
    assert!(shows(&window, "Connect the twin") && !shows(&window, "Done"));
    fake.show(everything());
    window.run_steps(3);
    assert!(says(&window, "Connected to twin") && !shows(&window, "Connect the twin"));
    robot_commands(&fake);
    click(&mut window, "Done");
    assert!(!says(&window, "Nothing moves, and torque stays as it is."));
    assert_eq!(robot_commands(&fake), []);
}

/// One joint that gives way is as much of a danger, and is not hidden behind all that hold.
#[test]
fn a_single_joint_that_goes_limp_is_asked_about_and_said() {
    let fake = Fake::over(everything());
    let mut window = fake.window(on_robot());
    click(&mut window, "Right elbow");
    click(&mut window, "Let this joint go limp…");
    assert_eq!(robot_commands(&fake), []);
    assert!(says(&window, "It sinks by its own weight"));
    click(&mut window, "Let it go limp");
    let asked = robot_commands(&fake);
    assert!(
        matches!(asked.as_slice(), [RobotCommand::Torque { joints, on: false }] if joints.len() == 1),
        "{asked:?}"
    );
    let mut robot = connected();
    let limp = |(i, joint): (usize, &JointView)| JointView { torque_on: Some(i != 5), ..joint.clone() };
    robot.joints = robot.joints.iter().enumerate().map(limp).collect();
    let fake = Fake::over(with_robot(robot));
    let mut window = fake.window(on_robot());
    assert!(says(&window, "is limp: it gives way, and sinks"));
    window.run_steps(3);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    window.run_steps(2);
    assert_eq!(robot_commands(&fake), [RobotCommand::Torque { joints: vec![], on: true }]);
}

#[test]
fn letting_go_asks_first() {
    let fake = Fake::over(everything());
    let mut window = fake.window(on_robot());
    click(&mut window, "Let all joints go limp…");
    assert_eq!(robot_commands(&fake), []);
    click(&mut window, "Let all go limp");
    assert_eq!(robot_commands(&fake), [RobotCommand::Torque { joints: vec![], on: false }]);
}

#[test]
fn a_click_beside_a_sheet_closes_it_and_does_nothing_else() {
    let fake = Fake::over(everything());
    let mut window = fake.window(on_robot());
    click(&mut window, "Let all joints go limp…");
    assert!(shows(&window, "Let all go limp"));
    click(&mut window, "Home");
    window.run_steps(2);
    assert_eq!(robot_commands(&fake), [], "nothing was asked for with a sheet open");
    assert!(!shows(&window, "Let all go limp"), "the sheet is closed");
    click(&mut window, "Home");
    assert_eq!(robot_commands(&fake), [RobotCommand::Preview(Destination::Pose { name: "home".to_owned() })]);
    // STOP is no such thing.
    click(&mut window, "Let all joints go limp…");
    fake.take_stops();
    click(&mut window, "STOP");
    assert!(fake.take_stops() > 0);
}

#[test]
fn an_own_pose_is_deleted_at_the_second_click() {
    let fake = Fake::over(everything());
    let mut window = fake.window_of_size(on_robot(), [1440.0, 1400.0]);
    click(&mut window, "Delete: Above the screen");
    assert_eq!(robot_commands(&fake), []);
    click(&mut window, "Delete for good: Above the screen");
    assert_eq!(robot_commands(&fake), [RobotCommand::DeletePose { name: "own-1".to_owned() }]);
}

#[test]
fn what_was_lost_is_looked_for_where_it_was() {
    let lost = Connection::Lost {
        to: "twin \"lab\"".to_owned(),
        reason: "The port is gone: plug it in.".to_owned(),
    };
    let scan = "Look for servos again";
    for (connection, offered) in [(lost, true), (Connection::None, false)] {
        let fake = Fake::over(with_robot(RobotView { connection, ..connected() }));
        let mut window = fake.window(on_robot());
        assert_eq!(shows(&window, "Bus lost"), offered);
        if offered {
            click(&mut window, "Bus lost");
            click(&mut window, scan);
            assert_eq!(robot_commands(&fake), [RobotCommand::Scan]);
        }
    }
}

/// Every state of the connection, with what has to be said in it.
fn states() -> Vec<(&'static str, View, &'static str)> {
    let rig = connected().rig;
    let bare = |connection| RobotView { rig: rig.clone(), connection, ..RobotView::default() };
    let lost = Connection::Lost {
        to: "/dev/ttyUSB0".to_owned(),
        reason: "the adapter was unplugged: plug it in and connect again".to_owned(),
    };
    let connecting =
        Connection::Connecting { to: "/dev/ttyUSB0".to_owned(), doing: "looking for servos".to_owned() };
    let mut stale = connected();
    stale.joints = stale
        .joints
        .iter()
        .cloned()
        .map(|mut joint| {
            joint.age = Some(Duration::from_secs(4));
            joint
        })
        .collect();
    let motion = MotionState::Moving { what: "grasping".to_owned(), fraction: None, remaining: None };
    let paused = RobotView { motion, rests_on_the_way: true, ..connected() };
    vec![
        ("none", with_robot(bare(Connection::None)), "No robot is connected"),
        ("connecting", with_robot(bare(connecting)), "looking for servos"),
        ("lost", with_robot(bare(lost.clone())), "plug it in and connect again"),
        ("lost-late", with_robot(RobotView { connection: lost, ..connected() }), "As last seen"),
        ("stale", with_robot(stale), "Last reading 4 s ago"),
        ("no-rig", with_robot(RobotView::default()), "description cannot be read"),
        ("holding", everything(), "it is shown first"),
        ("paused", with_robot(paused), "Paused in the middle of grasping: the arm holds."),
        ("limp", with_robot(RobotView { motion: MotionState::Limp, ..connected() }), "The joints are limp"),
        (
            "preview",
            with_robot(RobotView { preview: Some(preview(free_path())), ..connected() }),
            "Shown as a ghost",
        ),
        ("stopped", with_robot(RobotView { stopped: true, ..connected() }), "Release STOP"),
    ]
}

#[test]
fn every_state_of_the_robot_is_drawn_on_purpose() {
    for (name, view, words) in states() {
        let fake = Fake::over(view);
        let window = fake.window(on_robot());
        assert!(says(&window, words), "{name} says {words:?}");
        assert!(shows(&window, "STOP"), "{name}");
    }
}

/// Every state drawn into a PNG of `PLUMBLINE_WINDOW_PICTURES=<folder>`, with `--ignored pictures`.
#[test]
#[ignore = "draws pictures for people to look at"]
fn pictures_of_every_state() {
    let folder = crate::fake::picture_folder();
    for theme in [ThemeChoice::Dark, ThemeChoice::Light] {
        for (name, view, _) in states() {
            let fake = Fake::over(view);
            let mut window = fake.window_with(WindowSettings { theme, ..on_robot() }, [1280.0, 800.0], true);
            window.run_steps(3);
            let image = window.render().expect("the test renderer draws");
            let file = format!("robot {name} {theme:?}.png").to_lowercase().replace(' ', "-");
            image.save(folder.join(file)).expect("the folder can be written");
        }
    }
}
