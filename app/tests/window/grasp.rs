//! Grasping: one step after the other, and things that are chosen where they are drawn.

use std::sync::Arc;

use egui::{Key, Modifiers, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use nalgebra::Point3;
use plumbline::{PlumblineWindow, Screen, WindowSettings};
use plumbline_engine::view::{
    BetweenSteps, Connection, DetectView, Gate, GateState, GraspHand, GraspMethod, GraspPhase, GraspRun,
    GraspStep, GraspView, HandWaits, InHand, JointView, LampState, MotionState, Need, ObjectView, RobotView,
    StepNotMade, StepState, TouchPhase, TouchView, ToyView, TwinView,
};
use plumbline_engine::{Command, Destination, GraspCommand, GraspTarget, HandStep, RobotCommand, View};
use plumbline_model::frame::Point;
use plumbline_widgets::scene3d::SceneCamera;

use crate::fake::{Fake, click, says, shows};
use crate::made_up::{connected, everything, joint};
use crate::made_up_objects;

/// In front of everything else for who looks at the scene from where it is looked at first, m.
const TOMATO_M: [f64; 3] = [0.55, -0.25, 0.084];

fn with(grasp: GraspView) -> View {
    View { grasp: Arc::new(grasp), ..everything() }
}

fn on_grasp(fake: &Fake) -> Harness<'static, PlumblineWindow> {
    fake.window(WindowSettings { screen: Screen::Grasp, ..WindowSettings::default() })
}

/// An attempt that holds by itself between two steps.
fn held(stops_after_each: bool) -> GraspView {
    let lamps = [
        (GraspStep::Approach, LampState::Done),
        (GraspStep::Align, LampState::Done),
        (GraspStep::Lower, LampState::Dark),
    ];
    let run = GraspRun {
        name: "run".to_owned(),
        object: "Tomato".to_owned(),
        method: Some(GraspMethod::M5),
        hand: Some(GraspHand::Right),
        tries: [1, 3],
        lamps: lamps.to_vec(),
        between: Some(BetweenSteps { done: GraspStep::Approach, next: GraspStep::Lower }),
        ..GraspRun::default()
    };
    let phase = GraspPhase::Grasping { paused: true, ending: false };
    GraspView { phase, run: Some(Arc::new(run)), stops_after_each, ..GraspView::default() }
}

#[test]
fn the_switch_stands_beside_the_buttons_also_while_a_grasp_is_under_way() {
    let running = GraspPhase::Grasping { paused: false, ending: false };
    for (phase, on) in [(GraspPhase::Idle, false), (running, true)] {
        let fake = Fake::over(with(GraspView { phase, stops_after_each: on, ..GraspView::default() }));
        let mut window = on_grasp(&fake);
        click(&mut window, "Stop after each step");
        assert_eq!(fake.take_sent(), [Command::from(GraspCommand::StopAfterEachStep(!on))]);
    }
}

#[test]
fn who_can_hold_nothing_of_what_is_there_is_told_so_and_not_ready() {
    let with_seen = |objects: Vec<ObjectView>| {
        let found = Some(Arc::new(made_up_objects::found(objects)));
        let detect = Arc::new(DetectView { found, ..made_up_objects::detect() });
        let grasp = GraspView { classes: Arc::from(["Tomato", "Onion"]), ..GraspView::default() };
        View { detect, twin: Arc::default(), ..with(grasp) }
    };
    let says_ready = |objects: Vec<ObjectView>, words: &str| {
        let window = on_grasp(&Fake::over(with_seen(objects)));
        assert!(says(&window, words), "{words}");
        says(&window, "Ready.")
    };
    let (tomato, banana, hand) = (made_up_objects::tomato, made_up_objects::banana, made_up_objects::hand);
    assert!(says_ready(vec![tomato(), banana()], "Ready."));
    assert!(!says_ready(vec![banana(), hand()], "The hands cannot hold: banana. They hold: "));
    assert!(!says_ready(vec![hand()], "Nothing to grasp is seen."));
    let unplaced = ObjectView { place: banana().place, ..tomato() };
    assert!(!says_ready(vec![unplaced, banana()], "Seen, but not where on the table: tomato."));
}

/// What is around something is let go, lifted off, and brought out of the picture before the next grasp.
#[test]
fn a_hand_that_was_stopped_is_led_home_step_by_step() {
    for (waits, words, step) in [
        (HandWaits::Around, "may be around something: open it first", HandStep::Open),
        (HandWaits::Carries, "may carry something", HandStep::Place),
        (HandWaits::Offers, "Take what the hand holds out", HandStep::Open),
        (HandWaits::Low, "lift it straight up", HandStep::Lift),
        (HandWaits::InView, "stands in the picture", HandStep::Home),
    ] {
        let fake = Fake::over(with(GraspView { hand_waits: Some(waits), ..GraspView::default() }));
        let mut window = on_grasp(&fake);
        assert!(says(&window, words), "{words}");
        window.run_steps(3);
        window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
        window.run_steps(2);
        assert_eq!(fake.take_sent(), [Command::from(GraspCommand::Hand(step))]);
    }
    // What could not be done is not offered again.
    for (waits, tried, step) in [
        (HandWaits::Around, HandStep::Open, HandStep::Lift),
        (HandWaits::Carries, HandStep::Place, HandStep::Give),
        (HandWaits::Low, HandStep::Lift, HandStep::Home),
    ] {
        let not_made =
            Some(StepNotMade { step: tried, why: "the thumb would run into touchscreen".to_owned() });
        let grasp = GraspView { hand_waits: Some(waits), not_made, ..GraspView::default() };
        let fake = Fake::over(with(grasp));
        let mut window = on_grasp(&fake);
        assert!(says(&window, "was not done: the thumb would run into touchscreen."), "{tried:?}");
        window.run_steps(3);
        window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
        window.run_steps(2);
        assert_eq!(fake.take_sent(), [Command::from(GraspCommand::Hand(step))]);
    }
    // Whatever shuts everything goes first.
    let limp =
        Gate { of: Need::Arm, state: GateState::Shut, text: "Joints of the arm do not hold.".to_owned() };
    let grasp =
        GraspView { hand_waits: Some(HandWaits::Around), gates: Arc::from([limp]), ..GraspView::default() };
    assert!(!says(&on_grasp(&Fake::over(with(grasp))), "open it first"));
}

/// What a hand holds goes along with the arm, and a hand that gets warm of it is put down in time.
#[test]
fn what_is_held_is_said_on_the_robot_too_and_a_hand_that_gets_warm_of_it_is_told() {
    let holds = InHand { object: "Tomato".to_owned(), hand: GraspHand::Right };
    let mut view = with(GraspView { held: Some(holds), ..GraspView::default() });
    let on_robot = || WindowSettings { screen: Screen::Robot, ..WindowSettings::default() };
    assert!(says(&Fake::over(view.clone()).window(on_robot()), "holds the tomato, which goes along"));
    assert!(!says(&on_grasp(&Fake::over(view.clone())), "from holding it"));
    let mut gives_way = view.clone();
    Arc::make_mut(&mut gives_way.grasp).gives_way_rad = Some(14.0_f64.to_radians());
    assert!(says(
        &on_grasp(&Fake::over(gives_way)),
        "have bent on by 14° since it was grasped: it may slip out"
    ));
    let (robot, thumb) = (Arc::make_mut(&mut view.robot), joint("r_thumb_x"));
    let warm = |one: &JointView| match one.joint == thumb {
        true => JointView { temperature_c: Some(58.0), ..one.clone() },
        false => one.clone(),
    };
    robot.joints = robot.joints.iter().map(warm).collect();
    assert!(says(&on_grasp(&Fake::over(view)), "is at 58 °C from holding it, and must not come to 70 °C"));
}

/// A step that the arm would refuse is not offered: what is limp is held first.
#[test]
fn a_full_hand_whose_arm_is_limp_is_held_before_anything_else() {
    let grasp = GraspView {
        hand_waits: Some(HandWaits::Carries),
        may_hold: Some(GraspHand::Right),
        ..GraspView::default()
    };
    let mut view = with(grasp);
    let robot = Arc::make_mut(&mut view.robot);
    let limp = |which: &str| {
        let which = joint(which);
        robot
            .joints
            .iter()
            .map(|one| JointView { torque_on: Some(one.joint != which), ..one.clone() })
            .collect::<Vec<_>>()
    };
    let (right, left) = (limp("r_shoulder_y"), limp("l_shoulder_y"));
    robot.joints = left.into();
    assert!(says(&on_grasp(&Fake::over(view.clone())), "may carry something"), "the other arm");
    Arc::make_mut(&mut view.robot).joints = right.into();
    let fake = Fake::over(view);
    let mut window = on_grasp(&fake);
    assert!(says(&window, "is limp: it gives way, and sinks"));
    window.run_steps(3);
    window.key_press_modifiers(Modifiers::COMMAND, Key::Enter);
    window.run_steps(2);
    assert_eq!(fake.take_sent(), [Command::from(RobotCommand::Torque { joints: vec![], on: true })]);
}

#[test]
fn a_doubt_about_places_leads_to_where_it_is_mended() {
    let gate =
        |state| Gate { of: Need::Places, state, text: "The place of the screen is in doubt.".to_owned() };
    let of = |state| {
        let mut view = with(GraspView { gates: Arc::from([gate(state)]), ..GraspView::default() });
        view.eyes = Arc::new(crate::commission::eyes_in_use());
        Arc::make_mut(&mut view.mount).step = StepState::Done;
        on_grasp(&Fake::over(view))
    };
    let mut window = of(GateState::Doubtful);
    assert!(says(&window, "Places: note"));
    click(&mut window, "Go to Touch");
    assert!(shows(&window, "No run yet"));
    assert!(!shows(&of(GateState::Open), "Go to Touch"));
}

#[test]
fn toys_that_made_room_are_not_simply_missing() {
    let twin = |made_room: &[&str]| {
        let toy = |name: &str, place| {
            let name = name.to_owned();
            ToyView { name, place, radius_m: 0.03, rgb: [200, 40, 30] }
        };
        // What no hand can hold may stand beside the screen.
        let toys = vec![toy("tomato", None), toy("banana", Some(Point::new(0.3, 0.4, 0.08)))];
        let made_room = made_room.iter().map(|name| (*name).to_owned()).collect();
        Arc::new(TwinView { running: true, toys, made_room, ..TwinView::default() })
    };
    let view = |made_room: &[&str]| View {
        twin: twin(made_room),
        ..with(GraspView { classes: Arc::from(["Tomato"]), ..GraspView::default() })
    };
    let room =
        "Tomato made room for touches and comes back once no hand is over the screen. Bring the arm home";
    let fake = Fake::over(view(&["tomato"]));
    let mut window = on_grasp(&fake);
    assert!(says(&window, room));
    fake.take_sent();
    click(&mut window, "Show the way home");
    assert!(shows(&window, "Poses") && !shows(&window, room));
    let home = Destination::Pose { name: "home".to_owned() };
    assert_eq!(fake.take_sent(), [Command::from(RobotCommand::Preview(home))]);
    // A doubt does not hide that nothing lies there.
    let doubtful = |mut view: View| {
        let gate = Gate { of: Need::Places, state: GateState::Doubtful, text: "Not calibrated.".to_owned() };
        let grasp = GraspView { gates: Arc::from([gate]), ..(*view.grasp).clone() };
        view.grasp = Arc::new(grasp);
        view
    };
    let window = on_grasp(&Fake::over(doubtful(view(&["tomato"]))));
    assert!(says(&window, room) && !says(&window, "Ready, in doubt"));
    // A run that is only paused keeps its room.
    let touch = TouchView { phase: TouchPhase::Paused { why: None }, ..TouchView::default() };
    let paused = View { touch: Arc::new(touch), ..view(&["tomato"]) };
    let window = on_grasp(&Fake::over(paused));
    assert!(says(&window, "comes back once the run of touches is over.") && shows(&window, "Go to Touch"));
    // Another robot has other things before it.
    let real = || Connection::Connected { to: "USB0".to_owned(), twin: false };
    let real = View { robot: Arc::new(RobotView { connection: real(), ..connected() }), ..view(&["tomato"]) };
    assert!(!says(&on_grasp(&Fake::over(real)), "made room"));
    // Put away by the operator: nothing moves for it.
    assert!(!says(&on_grasp(&Fake::over(view(&[]))), "made room"));
}

#[test]
fn a_grasp_that_holds_says_what_is_done_what_comes_next_and_what_moves_and_one_button_goes_on() {
    let fake = Fake::over(with(held(true)));
    let mut window = on_grasp(&fake);
    assert!(says(&window, "The hand is above the tomato; the arm holds."));
    assert!(says(&window, "Next, lower: the arm goes straight down at the tomato."));
    assert!(shows(&window, "Approach done") && shows(&window, "Lower to come"));
    assert!(!shows(&window, "Go on"));
    click(&mut window, "Next step: lower");
    click(&mut window, "End");
    let sent = [GraspCommand::Resume, GraspCommand::End].map(Command::from);
    assert_eq!(fake.take_sent(), sent);
}

#[test]
fn with_the_switch_turned_off_meanwhile_the_button_goes_on_to_the_end() {
    let fake = Fake::over(with(held(false)));
    let mut window = on_grasp(&fake);
    assert!(says(&window, "All that comes after follows without a stop."));
    click(&mut window, "Go on");
    assert_eq!(fake.take_sent(), [Command::from(GraspCommand::Resume)]);
}

/// What STOP says of the arm.
fn said_of_the_arm(window: &Harness<'_, PlumblineWindow>) -> Option<String> {
    window.get_by_label("STOP").accesskit_node().value()
}

#[test]
fn above_the_button_of_a_grasp_that_holds_the_arm_is_not_said_to_move() {
    let motion = MotionState::Moving { what: "grasping".to_owned(), fraction: None, remaining: None };
    let moving = RobotView { motion, ..connected() };
    for (rests_on_the_way, said) in [(true, "arm held"), (false, "arm moving")] {
        let robot = Arc::new(RobotView { rests_on_the_way, ..moving.clone() });
        let fake = Fake::over(View { robot, ..with(held(true)) });
        let mut window = on_grasp(&fake);
        assert_eq!(said_of_the_arm(&window).as_deref(), Some(said));
        assert!(says(&window, "the arm holds"));
        // It goes on moving by itself or by a click: Esc stops it, as always.
        window.key_press(egui::Key::Escape);
        window.run_steps(2);
        assert!(fake.take_stops() > 0);
    }
    // Another screen leads back to where it is gone on with; on its own screen it is gone on with.
    let robot = Arc::new(RobotView { rests_on_the_way: true, ..moving.clone() });
    let fake = Fake::over(View { robot, ..with(held(true)) });
    let mut window = fake.window(WindowSettings { screen: Screen::Robot, ..WindowSettings::default() });
    click(&mut window, "Back to the grasp");
    assert!(!shows(&window, "Back to the grasp") && fake.take_sent().is_empty());
    // Which joint is not known comes before that it stands.
    let unknown = Arc::from([moving.joints[0].joint]);
    let robot = Arc::new(RobotView { rests_on_the_way: true, unknown, ..moving });
    let window = on_grasp(&Fake::over(View { robot, ..with(held(true)) }));
    assert_eq!(said_of_the_arm(&window).as_deref(), Some("arm partly known"));
}

/// A toy stands on the twin's table, in sight.
fn with_tomato(phase: GraspPhase) -> View {
    let mut view = with(GraspView { phase, classes: Arc::from(["Tomato", "Onion"]), ..GraspView::default() });
    let [x_m, y_m, z_m] = TOMATO_M;
    for toy in &mut Arc::make_mut(&mut view.twin).toys {
        toy.place = (toy.name == "tomato").then(|| Point::new(x_m, y_m, z_m));
    }
    view
}

/// Where the tomato is drawn in the scene.
fn tomato_in(window: &Harness<'_, PlumblineWindow>) -> Pos2 {
    let scene = window.get_by_role_and_label(egui::accesskit::Role::Image, "Robot").rect();
    let mapping = SceneCamera::default().view(scene.size());
    let (place, _) = mapping.project(&Point3::from(TOMATO_M)).expect("in view");
    scene.min + place.to_vec2()
}

fn button(pos: Pos2, pressed: bool) -> egui::Event {
    let (button, modifiers) = (egui::PointerButton::Primary, Modifiers::NONE);
    egui::Event::PointerButton { pos, button, pressed, modifiers }
}

/// Presses the pointer at one place and lets it go at another.
fn press(window: &mut Harness<'_, PlumblineWindow>, from: Pos2, to: Pos2) {
    window.event(egui::Event::PointerMoved(from));
    window.run_steps(2);
    window.event(button(from, true));
    window.run_steps(1);
    window.event(egui::Event::PointerMoved(to));
    window.run_steps(1);
    window.event(button(to, false));
    window.run_steps(2);
}

#[test]
fn a_thing_that_is_clicked_in_the_scene_is_what_is_grasped() {
    let fake = Fake::over(with_tomato(GraspPhase::Idle));
    let mut window = on_grasp(&fake);
    let at = tomato_in(&window);
    press(&mut window, at, at);
    let near_m = Some([TOMATO_M[0], TOMATO_M[1]]);
    let target = GraspTarget { class: Some("Tomato".to_owned()), near_m };
    assert_eq!(fake.take_sent(), [Command::from(GraspCommand::Target(target))]);
    assert!(!shows(&window, "Look here"), "it is no point to look at");
}

#[test]
fn neither_a_drag_over_it_nor_a_click_while_something_is_under_way_chooses_a_thing() {
    let fake = Fake::over(with_tomato(GraspPhase::Idle));
    let mut window = on_grasp(&fake);
    let at = tomato_in(&window);
    press(&mut window, at - vec2(70.0, 0.0), at);
    assert_eq!(fake.take_sent(), [], "that has turned the scene");
    let fake = Fake::over(with_tomato(GraspPhase::Planning));
    let mut window = on_grasp(&fake);
    let at = tomato_in(&window);
    press(&mut window, at, at);
    assert_eq!(fake.take_sent(), []);
}
