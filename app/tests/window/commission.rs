//! Commissioning: from every state the one button leads to the right screen and asks for the right thing.

use std::sync::Arc;
use std::time::Duration;

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use plumbline::{PlumblineWindow, Screen, WindowSettings};
use plumbline_engine::view::{
    AcceptedCalibration, CommissionDone, CommissionFigure, CommissionSpent, CommissionState, CommissionStep,
    CommissionStepView, CommissionView, EyesView, Gate, GateState, MotionState, MountView, Need,
    SourceStatus, SourceView, StepState, TouchPhase,
};
use plumbline_engine::{
    Command, CommissionCommand, EyesCommand, GraspCommand, HandEyeCommand, MountCommand, RobotCommand,
    SourceSpec, TouchCommand, TwinCommand, View,
};
use plumbline_model::StereoCalibration;
use plumbline_model::touch_plan::{PlanOptions, Purpose};

use crate::fake::{Fake, click, says, shows};
use crate::made_up::{everything, looked_at_hands, lying_board, rig, twin};
use crate::made_up_touch;

/// The steps before this one are done.
fn led_to(step: CommissionStep) -> Arc<CommissionView> {
    let done = CommissionDone { at: Some(jiff::Timestamp::now()), figure: CommissionFigure::Pixels(0.12) };
    let steps = CommissionStep::ALL.map(|one| {
        let state = match one.cmp(&step) {
            std::cmp::Ordering::Less => CommissionState::Done(done.clone()),
            std::cmp::Ordering::Equal => CommissionState::Now,
            std::cmp::Ordering::Greater => CommissionState::Waits(step),
        };
        CommissionStepView { step: one, state }
    });
    Arc::new(CommissionView {
        is_known: true,
        is_on: true,
        began: Some(jiff::Timestamp::now()),
        steps: Arc::from(steps),
        spent: CommissionSpent { time: Duration::from_secs(550), touches: 8, views: 14 },
    })
}

/// The twin is connected and looked through, its eyes warm.
fn at(step: CommissionStep) -> View {
    let source =
        SourceView { spec: Some(SourceSpec::Twin), status: SourceStatus::Running, ..SourceView::default() };
    let twin = plumbline_engine::view::TwinView { eyes_on_s: 1500.0, ..twin() };
    View { commission: led_to(step), source: Arc::new(source), twin: Arc::new(twin), ..everything() }
}

pub fn eyes_in_use() -> EyesView {
    let in_use = AcceptedCalibration {
        id: "first".to_owned(),
        calibration: Arc::new(StereoCalibration::bare(rig().eyes.cameras)),
        accepted: jiff::Timestamp::now(),
        uncertainty: None,
        stated_at_m: 0.45,
        depth_per_px_m: None,
    };
    EyesView { in_use: Some(Arc::new(in_use)), ..EyesView::default() }
}

fn on(screen: Screen) -> WindowSettings {
    WindowSettings { screen, ..WindowSettings::default() }
}

/// Presses the one button; what it is called, where that led, what was asked for.
fn press(view: View) -> (String, Harness<'static, PlumblineWindow>, Vec<Command>) {
    let fake = Fake::over(view);
    let mut window = fake.window(on(Screen::Commission));
    let labels: Vec<String> = window
        .query_all_by_label_contains("Next: ")
        .filter_map(|node| node.accesskit_node().label())
        .collect();
    assert_eq!(labels.len(), 1, "one button leads on: {labels:?}");
    window.get_by_label(&labels[0]).click();
    window.run_steps(3);
    (labels[0].clone(), window, fake.take_sent())
}

/// The screen that is open, by what its rail says.
fn is_on(window: &Harness<'_, PlumblineWindow>, pane: &str) {
    assert!(shows(window, pane), "the pane {pane} is open");
}

#[test]
fn it_is_begun_by_one_button_and_moves_nothing() {
    let view = CommissionView { is_known: true, ..CommissionView::default() };
    let (label, window, sent) = press(View { commission: Arc::new(view), ..everything() });
    assert_eq!(label, "Next: begin commissioning");
    assert_eq!(sent, [Command::from(CommissionCommand::Start { anew: false })]);
    assert!(says(&window, "From a robot just switched on"));
}

#[test]
fn beginning_once_more_is_asked_first_with_what_goes() {
    let fake = Fake::over(at(CommissionStep::Touches));
    let mut window = fake.window(on(Screen::Commission));
    click(&mut window, "Commission once more, from the beginning");
    assert_eq!(fake.take_sent(), []);
    assert!(says(&window, "All eight steps count as not done"));
    click(&mut window, "Cancel");
    assert_eq!(fake.take_sent(), []);
    click(&mut window, "Commission once more, from the beginning");
    click(&mut window, "Begin anew");
    assert_eq!(fake.take_sent(), [Command::from(CommissionCommand::Start { anew: true })]);
}

#[test]
fn before_anything_is_known_nothing_can_be_begun() {
    let fake = Fake::over(everything());
    let window = fake.window(on(Screen::Commission));
    assert!(says(&window, "Looks how far commissioning is"));
    assert!(!says(&window, "Next: "));
}

#[test]
fn cold_eyes_are_warmed_then_shown_the_board() {
    let mut view = at(CommissionStep::Eyes);
    Arc::make_mut(&mut view.twin).eyes_on_s = 10.0;
    let (_, _, sent) = press(view);
    assert_eq!(sent, [Command::from(TwinCommand::AdvanceWarmUp { minutes: 20.0 })]);

    let (label, window, sent) = press(at(CommissionStep::Eyes));
    assert_eq!(label, "Next: show the board at 12 places");
    assert_eq!(sent, [Command::from(EyesCommand::AutoCapture(true)), Command::from(TwinCommand::TourFew)]);
    is_on(&window, "Coverage");
    assert!(says(&window, "Commissioning, 0 of 8 done: calibrate the eyes"));
    assert!(shows(&window, "9 min · 8 touches · 14 views"));
}

#[test]
fn a_joint_that_fell_silent_is_taken_hold_of_before_the_way_goes_on() {
    let silent = |is_back: bool| {
        let mut view = at(CommissionStep::Mount);
        let mut joints = view.robot.joints.to_vec();
        joints[0].let_go = true;
        joints[0].problem = Some("servo 1 did not answer for a while".to_owned());
        let robot = Arc::make_mut(&mut view.robot);
        if !is_back {
            robot.unknown = Arc::from([joints[0].joint]);
        }
        robot.joints = joints.into();
        view
    };
    let (label, window, sent) = press(silent(true));
    assert_eq!(label, "Next: hold all joints");
    assert!(says(&window, "did not answer for a while"));
    assert!(matches!(sent.as_slice(), [Command::Robot(_)]), "{sent:?}");
    // Until it answers there is nothing to take hold of.
    let fake = Fake::over(silent(false));
    let window = fake.window(on(Screen::Mount));
    assert!(!says(&window, "Next: ") && shows(&window, "Wait"));
}

#[test]
fn while_stop_is_latched_nothing_seems_to_be_waited_for() {
    let mut view = at(CommissionStep::Mount);
    Arc::make_mut(&mut view.robot).stopped = true;
    let window = Fake::over(view).window(on(Screen::Mount));
    assert!(shows(&window, "Stopped") && !shows(&window, "Wait") && !says(&window, "Next: "));
    assert!(says(&window, "nothing moves until you press Release STOP"));
}

#[test]
fn while_the_board_is_shown_there_is_nothing_to_press() {
    let mut view = at(CommissionStep::Eyes);
    Arc::make_mut(&mut view.twin).board = Some(lying_board());
    view.eyes = Arc::new(EyesView { auto_capture: true, ..EyesView::default() });
    let fake = Fake::over(view);
    let window = fake.window(on(Screen::Collect));
    assert!(!says(&window, "Next: ") && shows(&window, "Wait"));
    assert!(says(&window, "The board is shown to the eyes"));
}

#[test]
fn on_the_robot_a_person_is_told_how_to_hold_the_board() {
    let mut view = at(CommissionStep::Eyes);
    view.twin = Arc::default();
    let cameras = SourceSpec::Cameras { left_index: 0, right_index: 1 };
    view.source =
        Arc::new(SourceView { spec: Some(cameras), status: SourceStatus::Running, ..SourceView::default() });
    let (label, _, sent) = press(view.clone());
    assert_eq!(label, "Next: capture the board while I hold it");
    assert_eq!(sent, [Command::from(EyesCommand::AutoCapture(true))]);
    view.eyes = Arc::new(EyesView { auto_capture: true, ..EyesView::default() });
    let window = Fake::over(view).window(on(Screen::Collect));
    assert!(says(&window, "Hold the board still as the outline shows"));
}

#[test]
fn the_mount_is_planned_after_the_board_lies() {
    let mut view = at(CommissionStep::Mount);
    view.eyes = Arc::new(eyes_in_use());
    let (_, window, sent) = press(view.clone());
    assert!(matches!(sent[..], [Command::Twin(TwinCommand::LayBoard { .. })]), "{sent:?}");
    is_on(&window, "Mount of the eyes");
    Arc::make_mut(&mut view.twin).board = Some(lying_board());
    assert_eq!(press(view.clone()).2, [Command::from(MountCommand::Plan)]);
    view.mount = Arc::new(MountView { planned: Arc::from([(0.1, -0.4)]), ..MountView::default() });
    let (label, _, sent) = press(view.clone());
    assert_eq!(label, "Next: turn the head to 1 pose");
    assert_eq!(sent, [Command::from(MountCommand::Tour)]);
    view.mount = Arc::new(MountView { step: StepState::Running, ..MountView::default() });
    assert!(!says(&Fake::over(view).window(on(Screen::Mount)), "Next: "));
}

/// Where the one button stands, by its middle.
fn button_x(view: View) -> f32 {
    let window = Fake::over(view).window(on(Screen::Commission));
    window.get_by_label_contains("Next: ").rect().center().x
}

#[test]
fn accepting_is_never_where_collecting_was() {
    let mut view = at(CommissionStep::Mount);
    view.eyes = Arc::new(eyes_in_use());
    let collecting = button_x(view.clone());
    view.mount = Arc::new(crate::made_up::mount());
    let accepting = button_x(view);
    assert!(collecting > 800.0 && accepting < 480.0, "{collecting} and {accepting} of 1280");
}

#[test]
fn touches_are_planned_begun_and_waited_for() {
    let (label, window, sent) = press(at(CommissionStep::Screen));
    assert_eq!(label, "Next: plan to touch the corners");
    let [Command::Touch(TouchCommand::Plan(plan))] = &sent[..] else { panic!("{sent:?}") };
    assert_eq!(plan.purpose, Purpose::PlaceScreen);
    is_on(&window, "Place of the screen");

    let mut view = at(CommissionStep::Touches);
    let (_, _, sent) = press(view.clone());
    let [Command::Touch(TouchCommand::Plan(plan))] = &sent[..] else { panic!("{sent:?}") };
    assert_eq!(plan.purpose, Purpose::Train);
    view.touch = Arc::new(made_up_touch::planned(PlanOptions::quick(made_up_touch::area())));
    let (label, _, sent) = press(view.clone());
    assert!(label.starts_with("Next: touch ") && label.ends_with(" targets"), "{label}");
    assert_eq!(sent, [Command::from(TouchCommand::Start)]);
    // From elsewhere the first press only leads to where it is said what will move, and says so.
    let fake = Fake::over(view.clone());
    let mut elsewhere = fake.window(on(Screen::Gap));
    click(&mut elsewhere, "Next: go to Touch");
    assert_eq!(fake.take_sent(), []);
    assert!(says(&elsewhere, &label) && shows(&elsewhere, "Place of the screen"));
    // Planned for something else: not begun.
    let mut other = view.clone();
    other.commission = led_to(CommissionStep::Check);
    let (label, _, sent) = press(other);
    assert_eq!(label, "Next: plan touches to check");
    assert!(matches!(sent[..], [Command::Touch(TouchCommand::CorrectWith(None)), Command::Touch(_)]));

    // A run that ended too early says why it is planned once more.
    let mut early = view.clone();
    let touch = Arc::make_mut(&mut early.touch);
    (touch.phase, touch.counts.touched) = (TouchPhase::Finished, 11);
    let (label, window, _) = press(early.clone());
    assert_eq!(label, "Next: plan touches to learn from");
    assert!(says(&window, "11 touches of the run before are too few: at least 12 are needed."));
    Arc::make_mut(&mut early.touch).counts.touched = 12;
    let (_, window, _) = press(early);
    assert!(!says(&window, "too few"));

    let touch = Arc::make_mut(&mut view.touch);
    touch.phase = TouchPhase::Running { number: Some(3), doing: "above target 3".to_owned() };
    touch.counts.touched = 2;
    let mut window = Fake::over(view).window(on(Screen::Touch));
    assert!(!says(&window, "Next: ") && says(&window, "2 of "));
    assert!(shows(&window, "Pause"), "what moves can be held");
    window.run_steps(1);
}

#[test]
fn the_tomato_is_laid_out_then_grasped_then_judged_by_a_person() {
    let mut view = at(CommissionStep::Grasp);
    let (label, window, sent) = press(view.clone());
    assert_eq!(label, "Next: lay the tomato on the table");
    let [Command::Grasp(GraspCommand::Target(target)), Command::Twin(TwinCommand::PlaceToy { toy, .. })] =
        &sent[..]
    else {
        panic!("{sent:?}")
    };
    assert_eq!((target.class.as_deref(), toy.as_str()), (Some("Tomato"), "tomato"));
    is_on(&window, "Attempts");

    let tomato = |view: &mut View| {
        let toys = &mut Arc::make_mut(&mut view.twin).toys;
        let place = plumbline_model::frame::Point::new(0.31, -0.06, 0.08);
        toys.iter_mut().filter(|toy| toy.name == "tomato").for_each(|toy| toy.place = Some(place));
        Arc::make_mut(&mut view.grasp).target.class = Some("Tomato".to_owned());
    };
    tomato(&mut view);
    assert_eq!(press(view.clone()).2, [Command::from(GraspCommand::Grasp)]);
    let run = plumbline_engine::view::GraspRun {
        name: "run".to_owned(),
        outcome: Some(plumbline_engine::view::GraspOutcome::Success),
        ..Default::default()
    };
    // What has slipped out since is not held: it is laid out once more.
    let slipped = plumbline_engine::view::GraspRun {
        object: "Tomato".to_owned(),
        since: plumbline_engine::view::SinceHeld::Slipped(std::time::Duration::from_secs(6)),
        ..run.clone()
    };
    let mut lost = view.clone();
    Arc::make_mut(&mut lost.grasp).run = Some(Arc::new(slipped));
    let window = Fake::over(lost.clone()).window(on(Screen::Grasp));
    assert!(shows(&window, "The tomato was held and has slipped out."), "in the pane");
    assert!(says(&window, "It was held and has slipped out. It is tried once more."), "in the strip");
    assert!(!says(&window, "the tomato is held."));
    assert_eq!(press(lost).0, "Next: grasp the tomato");

    Arc::make_mut(&mut view.grasp).run = Some(Arc::new(run));
    let (label, _, sent) = press(view.clone());
    assert_eq!(label, "Next: say that it is held");
    assert_eq!(sent, [Command::from(GraspCommand::Judge { attempt: "run".to_owned(), held: true })]);
    // The other answer stands beside it.
    let fake = Fake::over(view);
    let mut window = fake.window(on(Screen::Grasp));
    click(&mut window, "It was not held");
    assert_eq!(
        fake.take_sent(),
        [Command::from(GraspCommand::Judge { attempt: "run".to_owned(), held: false })]
    );
}

#[test]
fn the_hands_are_looked_at_then_what_was_learned_is_accepted() {
    let mut view = at(CommissionStep::Hands);
    let (label, window, sent) = press(view.clone());
    assert_eq!(label, "Next: look at the hands");
    assert_eq!(sent, [Command::from(HandEyeCommand::Look)]);
    is_on(&window, "Hands over the table");
    let window = Fake::over(view.clone()).window(on(Screen::HandEye));
    assert!(says(&window, "The head turns, then each open hand is held over the table"), "what moves");

    Arc::make_mut(&mut view.handeye).proposal = Some(Arc::new(looked_at_hands()));
    let (label, window, sent) = press(view.clone());
    assert_eq!(label, "Next: tie the arms to the eyes");
    assert_eq!(sent, [Command::from(HandEyeCommand::Accept)]);
    assert!(says(&window, "1.40 mm beside its arm with what was learned, 12.1 mm before"));
    assert!(says(&window, "found at 11 of 12 places"));
    assert!(says(&window, "its arm stays as it was: it was not seen"));

    // What lacks is said, and where it is made.
    Arc::make_mut(&mut view.handeye).proposal = None;
    let text = "No touches to learn from were found in lab/sessions: touch the screen.".to_owned();
    let gate = Gate { of: Need::Touches, state: GateState::Shut, text };
    Arc::make_mut(&mut view.handeye).gates = Arc::from([gate]);
    let window = Fake::over(view).window(on(Screen::HandEye));
    assert!(says(&window, "No touches to learn from were found in lab/sessions"));
}

#[test]
fn hands_are_not_looked_at_with_cold_eyes_unwarned() {
    let mut view = at(CommissionStep::Hands);
    let text = "The eyes have been on for 2 min and were calibrated after 25 min: places are off.".to_owned();
    let gate = Gate { of: Need::Warmth, state: GateState::Doubtful, text };
    Arc::make_mut(&mut view.handeye).gates = Arc::from([gate]);
    let real = Fake::over(view.clone()).window(on(Screen::HandEye));
    assert!(says(&real, "calibrated after 25 min: places are off. The head turns"), "before anything moves");
    // Eyes of the twin get warm at a press.
    Arc::make_mut(&mut view.eyes).health.colder_wait_min = Some(10.0);
    let (label, window, sent) = press(view);
    assert_eq!(label, "Next: warm the twin's eyes up");
    assert_eq!(sent, [Command::from(TwinCommand::AdvanceWarmUp { minutes: 10.0 })]);
    assert!(says(&window, "Warming moves nothing"));
}

/// A calibration made warm is not good while the eyes are cold, and the top line says so, too.
#[test]
fn the_lamp_of_the_calibration_warns_while_the_eyes_are_colder_than_then() {
    let mut view = View { eyes: Arc::new(eyes_in_use()), ..everything() };
    let lamp = |view: &View| {
        let window = Fake::over(view.clone()).window(on(Screen::Live));
        let lamps = window.query_all_by_label_contains("Calibration ");
        let words: Vec<String> = lamps.filter_map(|lamp| lamp.accesskit_node().value()).collect();
        assert!(!words.is_empty(), "there is one");
        words.iter().any(|word| word == "warning")
    };
    Arc::make_mut(&mut view.grasp).gates = Arc::from([]);
    assert!(!lamp(&view));
    let text = "The eyes have been on for 1 min and were calibrated after 21 min: places are off until they are as warm.";
    let gate = Gate { of: Need::Warmth, state: GateState::Doubtful, text: text.to_owned() };
    Arc::make_mut(&mut view.grasp).gates = Arc::from([gate]);
    assert!(lamp(&view));
}

/// Limp joints sink whatever else waits to be gone on with.
#[test]
fn limp_joints_are_taken_hold_of_before_anything_goes_on() {
    let mut view = at(CommissionStep::Touches);
    view.touch = Arc::new(made_up_touch::after(3, TouchPhase::Paused { why: None }));
    assert_ne!(press(view.clone()).0, "Next: hold all joints");
    Arc::make_mut(&mut view.robot).motion = MotionState::Limp;
    let (label, window, sent) = press(view.clone());
    assert_eq!(label, "Next: hold all joints");
    assert!(
        sent.iter().any(|command| matches!(command, Command::Robot(RobotCommand::Torque { .. }))),
        "{sent:?}"
    );
    assert!(says(&window, "limp: they can be turned by hand, and sink"));
    // STOP holds nothing that is limp.
    Arc::make_mut(&mut view.robot).stopped = true;
    let window = Fake::over(view.clone()).window(on(Screen::Touch));
    assert!(says(&window, "they sink where nobody holds them") && !says(&window, "nothing moves until"));
    // What sank beyond its limit turns when it is held, which is said before.
    Arc::make_mut(&mut view.robot).stopped = false;
    let joint = &mut Arc::make_mut(&mut Arc::make_mut(&mut view.robot).joints)[0];
    joint.angle_rad = Some(joint.limits.upper_rad + 0.03);
    let window = Fake::over(view).window(on(Screen::Touch));
    assert!(says(&window, "turns back to it") && says(&window, "by 1.72°"));
}

/// A screen whose own next thing is elsewhere has not two things that come next.
#[test]
fn while_one_is_led_no_other_screen_leads_elsewhere() {
    let led = |is_on| {
        let mut view = at(CommissionStep::Hands);
        Arc::make_mut(&mut view.commission).is_on = is_on;
        let touch = made_up_touch::after(30, TouchPhase::Finished);
        Fake::over(View { touch: Arc::new(touch), ..view }).window(on(Screen::Touch))
    };
    assert!(says(&led(false), "Next: train models on them"));
    let window = led(true);
    assert!(!says(&window, "Next: train models"));
    assert!(says(&window, "Next: go to Hand-eye") && says(&window, "The head turns, then each open hand"));
}

/// The strip stands on every screen; what moves is said on the step's own.
#[test]
fn from_another_screen_what_moves_is_said_before_it_moves() {
    let fake = Fake::over(at(CommissionStep::Hands));
    let mut window = fake.window(on(Screen::Live));
    assert!(!shows(&window, "Hands over the table"), "another screen");
    click(&mut window, "Next: go to Hand-eye");
    window.run_steps(3);
    assert_eq!(fake.take_sent(), [], "nothing moves yet");
    is_on(&window, "Hands over the table");
    assert!(says(&window, "The head turns, then each open hand is held over the table"), "it is said");
    std::thread::sleep(std::time::Duration::from_millis(1000));
    window.run_steps(3);
    click(&mut window, "Next: look at the hands");
    window.run_steps(3);
    assert_eq!(fake.take_sent(), [Command::from(HandEyeCommand::Look)]);
}

#[test]
fn stop_leaves_nothing_to_press() {
    let mut view = at(CommissionStep::Touches);
    Arc::make_mut(&mut view.robot).stopped = true;
    let window = Fake::over(view).window(on(Screen::Touch));
    assert!(!says(&window, "Next: ") && says(&window, "nothing moves until you press Release STOP"));
}

#[test]
fn looking_elsewhere_that_screen_says_its_own() {
    let window = Fake::over(at(CommissionStep::Screen)).window(on(Screen::Robot));
    assert!(says(&window, "Commissioning, 2 of 8 done: place the screen"));
    assert!(says(&window, "Drag a joint or choose a pose"));
}

#[test]
fn before_a_second_try_it_is_said_why_and_what_will_move() {
    let mut view = at(CommissionStep::Grasp);
    let run = plumbline_engine::view::GraspRun {
        name: "run".to_owned(),
        tries: [2, 3],
        again: Some("the hand closed beside the tomato, which is where it was".to_owned()),
        ..Default::default()
    };
    let grasp = Arc::make_mut(&mut view.grasp);
    grasp.phase = plumbline_engine::view::GraspPhase::Grasping { paused: false, ending: false };
    grasp.run = Some(Arc::new(run));
    let window = Fake::over(view).window(on(Screen::Grasp));
    assert!(says(&window, "The hand closed beside the tomato, which is where it was."));
    assert!(says(&window, "Try 2 of 3: the hand opens, the arm goes back to where it began"));
    assert!(!says(&window, "Next: "), "nothing is to be pressed but what stops it");
}

#[test]
fn a_first_grasp_that_goes_step_by_step_names_the_step_that_the_button_does() {
    let mut view = at(CommissionStep::Grasp);
    let between = plumbline_engine::view::BetweenSteps {
        done: plumbline_engine::view::GraspStep::Approach,
        next: plumbline_engine::view::GraspStep::Lower,
    };
    let run = plumbline_engine::view::GraspRun {
        object: "Tomato".to_owned(),
        between: Some(between),
        ..Default::default()
    };
    let grasp = Arc::make_mut(&mut view.grasp);
    grasp.phase = plumbline_engine::view::GraspPhase::Grasping { paused: true, ending: false };
    (grasp.run, grasp.stops_after_each) = (Some(Arc::new(run)), true);
    let fake = Fake::over(view);
    let mut window = fake.window(on(Screen::Grasp));
    click(&mut window, "Next: lower");
    assert_eq!(fake.take_sent(), [Command::from(GraspCommand::Resume)]);
}
