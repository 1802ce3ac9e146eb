//! What is looked at before anything moves.

use plumbline_grasp::{Hand, HandChoice, Method};
use plumbline_model::counted;
use plumbline_model::robot::JointIndex;

use super::around::GraspAround;
use super::method::lacks;
use super::rest::rest;
use super::view::{Gate, GateState, HandWaits, InHand, Need};
use super::warmth::warmth;
use crate::ground::text::sentence;
use crate::robot::view::{Connection, RobotView};
use crate::source::view::SourceStatus;

/// All gates, in the order in which they are passed.
pub fn gates(around: &GraspAround, choice: HandChoice, method: Method) -> Vec<Gate> {
    let robot = &around.robot;
    let hands = method.hands(choice);
    let mut gates = vec![connected(robot)];
    if robot.connection.is_connected() {
        // A step of a hand needs no method: published ones are refused below.
        let hands = hands.unwrap_or(&[Hand::Left]);
        gates.push(stop(robot));
        gates.extend(run(around));
        gates.extend(of_any(around, hands));
    }
    gates.extend([eyes(around), places(around)]);
    let evidence = around.calibration.as_ref().and_then(|calibration| calibration.evidence.as_ref());
    gates.extend(warmth(around.eyes_on_min, evidence.and_then(|evidence| evidence.minutes_since_on)));
    gates.push(match hands {
        Ok(_) => method_gate(around, method),
        Err(why) => closed(Need::Method, sentence(&why.to_string())),
    });
    gates
}

/// A hand that holds something would drop it to grasp something else.
pub fn full_hand(held: &InHand) -> Gate {
    closed(
        Need::Hand,
        format!(
            "The {} is in the {} hand: put it down, or hand it over, first.",
            held.object.to_lowercase(),
            held.hand.name()
        ),
    )
}

/// Fingers that may be around something, which would fall where the hand opens for something else.
pub fn may_hold(waits: HandWaits) -> Option<Gate> {
    let text = match waits {
        HandWaits::Around => "Its fingers may be around something: open the hand first.",
        HandWaits::Carries => "Its fingers may carry something: put it down, or open the hand, first.",
        HandWaits::Offers => "It holds something out: take it and open the hand first.",
        HandWaits::Low | HandWaits::InView => return None,
    };
    Some(closed(Need::Hand, text))
}

/// What one hand has to pass.
fn of_hand(around: &GraspAround, hand: Hand) -> [Gate; 3] {
    [joints, load, rest].map(|gate| gate(around, hand.name()))
}

/// The same of the first hand that passes; of one that does not, the reason is said with it. Where none does, of the
/// first.
fn of_any(around: &GraspAround, hands: &[Hand]) -> Vec<Gate> {
    let all: Vec<[Gate; 3]> = hands.iter().map(|hand| of_hand(around, *hand)).collect();
    let Some(fit) = all.iter().find(|gates| shut(*gates).is_none()) else {
        return all.into_iter().next().map_or_else(Vec::new, Vec::from);
    };
    let said = |(i, gate): (usize, &Gate)| {
        let unfit = all.iter().map(|gates| &gates[i]).find(|gate| gate.state == GateState::Shut);
        match unfit {
            Some(unfit) => doubtful(gate.of, format!("{} Else the other hand grasps.", unfit.text)),
            None => gate.clone(),
        }
    };
    fit.iter().enumerate().map(said).collect()
}

/// The hand that is left where either might be taken and one of them may not move; else what was chosen.
pub fn able(around: &GraspAround, choice: HandChoice, method: Method) -> HandChoice {
    let may = |hand: &Hand| shut(&of_hand(around, *hand)).is_none();
    match method.hands(choice).unwrap_or_default() {
        [_] | [] => choice,
        hands => match hands.iter().copied().filter(may).collect::<Vec<_>>()[..] {
            [only] => only.into(),
            _ => choice,
        },
    }
}

/// The first reason why nothing may move.
pub fn shut(gates: &[Gate]) -> Option<&Gate> {
    gates.iter().find(|gate| gate.state == GateState::Shut)
}

pub(super) fn open(of: Need, text: impl Into<String>) -> Gate {
    Gate { of, state: GateState::Open, text: text.into() }
}

pub(super) fn closed(of: Need, text: impl Into<String>) -> Gate {
    Gate { of, state: GateState::Shut, text: text.into() }
}

pub(super) fn doubtful(of: Need, text: impl Into<String>) -> Gate {
    Gate { of, state: GateState::Doubtful, text: text.into() }
}

fn connected(robot: &RobotView) -> Gate {
    match &robot.connection {
        Connection::Connected { to, .. } => open(Need::Robot, format!("Connected to {to}.")),
        Connection::Connecting { .. } => closed(Need::Robot, "It is being connected: wait a moment."),
        Connection::Lost { reason, .. } => closed(Need::Robot, reason.clone()),
        Connection::None => closed(Need::Robot, "No robot is connected: connect it, or start the twin."),
    }
}

fn stop(robot: &RobotView) -> Gate {
    if robot.stopped {
        closed(Need::Stop, "STOP is latched: release it, at the top right.")
    } else {
        open(Need::Stop, "Not pressed. Esc or space presses it.")
    }
}

/// A run of touches that has the arm, or has left it for a while.
fn run(around: &GraspAround) -> Option<Gate> {
    let paused = "A run of touches is paused; it goes on from wherever the arm is left.";
    match around.goes_first {
        Some(why) => Some(closed(Need::Run, why)),
        None => around.touches_paused.then(|| open(Need::Run, paused)),
    }
}

/// Every joint of the arm is known, holds, is not too hot and has its force.
fn joints(around: &GraspAround, arm: &str) -> Gate {
    let (robot, rig) = (&around.robot, &around.described);
    let Some(arm) = rig.arm(arm) else { return closed(Need::Arm, "The robot has no such arm.") };
    let mut of_arm = robot
        .joints
        .iter()
        .filter(|joint| arm.joints.contains(&joint.joint) || arm.hand.contains(&joint.joint));
    if robot.measured.is_none() {
        return closed(Need::Arm, "The joints have not been read yet: wait a moment.");
    }
    let limp = of_arm.clone().filter(|joint| joint.has_to_be_held()).count();
    let mut warm = None;
    let trouble = of_arm.find_map(|joint| {
        let title = &joint.title;
        if robot.unknown.contains(&joint.joint) {
            let advice = robot.advice_for(joint.joint);
            return Some(format!("It is not known where {title} is: {advice}."));
        }
        if joint.has_to_be_held() {
            return Some(match limp {
                1 => format!("{title} does not hold: press Hold all joints."),
                n => format!("{} of the arm do not hold: press Hold all joints.", counted(n, "joint")),
            });
        }
        let temperature_c = joint.temperature_c?;
        if temperature_c >= rig.gate.hot_c {
            return Some(format!("{title} has {temperature_c:.0} °C: let it cool down."));
        }
        if temperature_c >= rig.gate.warm_c {
            warm = Some(format!("{title} has {temperature_c:.0} °C: it gets warm."));
        }
        None
    });
    match (trouble, warm) {
        (Some(trouble), _) => closed(Need::Arm, trouble),
        (None, Some(warm)) => doubtful(Need::Arm, warm),
        (None, None) => open(Need::Arm, format!("{} holds, all joints are known.", arm.title)),
    }
}

/// No joint of the arm pushes against anything. A step of the hand may be what ends that.
fn load(around: &GraspAround, arm: &str) -> Gate {
    let (robot, rig) = (&around.robot, &around.described);
    let of_arm = |joint: JointIndex| {
        rig.arm(arm).is_some_and(|arm| arm.joints.contains(&joint) || arm.hand.contains(&joint))
    };
    let pushes = robot.joints.iter().filter(|joint| of_arm(joint.joint)).find(|joint| {
        // NaN is no load.
        joint.load.is_some_and(|load| load.abs() >= rig.gate.load)
    });
    match pushes {
        Some(joint) => closed(
            Need::Load,
            format!("{} pushes against something: move the arm to where nothing is in its way.", joint.title),
        ),
        None => open(Need::Load, "No joint of the arm pushes hard against anything."),
    }
}

/// A pair of images is old from this age on, s: eyes deliver thirty a second.
const OLD_PAIR_S: f64 = 1.5;
/// What is this old shows nothing of where things are now, s.
const STALE_PAIR_S: f64 = 5.0;

/// Eyes that run, by how old their newest pair is.
fn fresh(pair_age_s: Option<f64>) -> Gate {
    match pair_age_s {
        Some(age_s) if age_s >= STALE_PAIR_S => closed(
            Need::Eyes,
            format!(
                "The newest picture is {age_s:.0} s old: wait for the eyes, or open them again at the top left."
            ),
        ),
        Some(age_s) if age_s >= OLD_PAIR_S => doubtful(
            Need::Eyes,
            format!(
                "The newest picture is {age_s:.1} s old: pictures come late (a busy computer, or slow eyes)."
            ),
        ),
        Some(_) => open(Need::Eyes, "Both eyes deliver."),
        None => closed(Need::Eyes, "No picture came yet: wait a moment."),
    }
}

fn eyes(around: &GraspAround) -> Gate {
    match &around.source.status {
        SourceStatus::None => closed(Need::Eyes, "No eyes are open: open them at the top left."),
        _ if !around.own_eyes => closed(
            Need::Eyes,
            "The images are not those of this robot's eyes: open its eyes at the top left.",
        ),
        SourceStatus::Running => fresh(around.pair_age_s),
        SourceStatus::Opening => closed(Need::Eyes, "The eyes are being opened: wait a moment."),
        SourceStatus::Lost { reason, .. } => closed(Need::Eyes, reason.clone()),
        SourceStatus::Paused => closed(Need::Eyes, "The eyes are held still: let them go on."),
        SourceStatus::Ended => closed(Need::Eyes, "No eyes are open: open them at the top left."),
    }
}

/// How well places on the table are known.
fn places(around: &GraspAround) -> Gate {
    let lacks: Vec<&str> = [
        (around.calibration.is_none(), "the lenses"),
        (!around.has_mount, "the mount of the eyes"),
        (!around.has_screen, "the place of the screen"),
    ]
    .into_iter()
    .filter_map(|(lacks, what)| lacks.then_some(what))
    .collect();
    if let Some(said) = &around.in_doubt {
        return doubtful(Need::Places, said.clone());
    }
    if lacks.is_empty() {
        return open(Need::Places, "Lenses, mount and screen were calibrated.");
    }
    let what = plumbline_model::listed(&lacks);
    let wide = if around.model.unmeasured().mount { WIDE } else { "" };
    doubtful(Need::Places, format!("Not calibrated, taken as described: {what}.{wide}"))
}

/// Said while nobody measured how the eyes sit in the head.
const WIDE: &str = " The ± of places holds how far mounts usually are off: calibrate it in step 2, Mount.";

fn method_gate(around: &GraspAround, method: Method) -> Gate {
    let name = method.name().to_uppercase();
    match lacks(method, &around.corrections) {
        Some(lacks) => closed(Need::Method, lacks),
        // It can grasp so, but not with what it is for.
        None if method == Method::M5 && around.model.is_nominal() => doubtful(
            Need::Method,
            "No effect is in use: M5 sends the arm as it is described and trusts to its eyes alone. Look for what makes the arm miss in step 5, Gap.",
        ),
        None => open(Need::Method, format!("{name} has what it needs.")),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_effects::RobotModel;
    use plumbline_effects::robot_model::Unmeasured;
    use plumbline_model::robot::{Limits, Rig};

    use super::*;
    use crate::robot::view::JointView;

    /// A robot whose elbow gives this load, and is this warm.
    fn around(load: f64, temperature_c: f64) -> GraspAround {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let joint = |servo: &plumbline_model::robot::Servo| {
            let is_elbow = servo.joint_name == "r_elbow_y";
            let limits = Limits { lower_rad: -3.0, upper_rad: 3.0 };
            JointView {
                angle_rad: Some(0.0),
                load: Some(if is_elbow { load } else { 0.1 }),
                temperature_c: Some(if is_elbow { temperature_c } else { 31.0 }),
                torque_on: Some(true),
                ..JointView::unheard(servo, limits)
            }
        };
        let robot = RobotView {
            joints: rig.servos.iter().map(joint).collect(),
            measured: Some(rig.home()),
            ..RobotView::default()
        };
        GraspAround { robot: Arc::new(robot), ..GraspAround::bare(&rig) }
    }

    #[test]
    fn eyes_of_which_no_new_picture_comes_do_not_deliver() {
        assert_eq!(fresh(Some(0.2)).state, GateState::Open);
        assert_eq!(fresh(Some(2.0)).state, GateState::Doubtful);
        let stale = fresh(Some(17.0));
        assert!(stale.state == GateState::Shut && stale.text.contains("17 s old"), "{}", stale.text);
        assert_eq!(fresh(None).state, GateState::Shut);
    }

    #[test]
    fn nothing_is_grasped_while_a_run_of_touches_moves_the_arm() {
        let connected = |goes_first| {
            let still = around(0.0, 31.0);
            let connection = Connection::Connected { to: "twin".to_owned(), twin: true };
            let robot = Arc::new(RobotView { connection, ..(*still.robot).clone() });
            GraspAround { robot, goes_first, ..still }
        };
        let run = |around: &GraspAround| {
            let gates = gates(around, HandChoice::Auto, Method::M5);
            gates.into_iter().find(|gate| gate.of == Need::Run).map(|gate| gate.state)
        };
        assert_eq!(run(&connected(Some("A run of touches moves the arm."))), Some(GateState::Shut));
        assert_eq!(run(&connected(None)), None);
    }

    #[test]
    fn where_a_joint_is_not_known_power_is_looked_at_only_where_its_servo_is_silent() {
        let unheard = |late: bool| {
            let mut around = around(0.0, 31.0);
            let elbow = around.described.description.find_joint("r_elbow_y").expect("an elbow");
            let robot = Arc::make_mut(&mut around.robot);
            robot.unknown = Arc::from([elbow]);
            robot.late = if late { Arc::from([elbow]) } else { Arc::from([]) };
            joints(&around, "right")
        };
        for (late, says, does_not_say) in [(false, "cable and power", "busy"), (true, "busy", "cable")] {
            let gate = unheard(late);
            assert_eq!(gate.state, GateState::Shut);
            assert!(gate.text.contains("where Right elbow is") && gate.text.contains(says), "{}", gate.text);
            assert!(!gate.text.contains(does_not_say), "{}", gate.text);
        }
    }

    #[test]
    fn what_was_calibrated_and_is_in_doubt_is_no_green_light() {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let of = |in_doubt: Option<&str>| {
            let calibrated = plumbline_model::StereoCalibration::bare(rig.eyes.cameras);
            places(&GraspAround {
                calibration: Some(Arc::new(calibrated)),
                has_mount: true,
                has_screen: true,
                in_doubt: in_doubt.map(str::to_owned),
                ..GraspAround::bare(&rig)
            })
        };
        assert_eq!(of(None).state, GateState::Open);
        let gate = of(Some("The place of the screen is in doubt."));
        assert_eq!(
            (gate.state, gate.text.as_str()),
            (GateState::Doubtful, "The place of the screen is in doubt.")
        );
    }

    #[test]
    fn a_paused_run_of_touches_is_said_and_does_not_keep_from_grasping() {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let of = |touches_paused| run(&GraspAround { touches_paused, ..GraspAround::bare(&rig) });
        assert_eq!(of(false), None);
        assert!(of(true).is_some_and(|gate| gate.state == GateState::Open && gate.text.contains("paused")));
    }

    #[test]
    fn a_mount_that_nobody_measured_is_told_with_what_it_does_to_places() {
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let of = |not_calibrated| {
            let model = RobotModel::nominal(rig.clone()).with_not_calibrated(not_calibrated);
            places(&GraspAround { model: Arc::new(model), ..GraspAround::bare(&rig) })
        };
        let gate = of(Unmeasured::ALL);
        assert_eq!(gate.state, GateState::Doubtful, "published methods grasp without it");
        assert!(
            gate.text.contains("the mount of the eyes") && gate.text.contains("step 2, Mount"),
            "{}",
            gate.text
        );
        assert!(!of(Unmeasured::default()).text.contains("step 2"));
    }

    #[test]
    fn what_is_hot_or_pushes_is_named_and_nothing_else_is() {
        let of_arm = |load, temperature_c| joints(&around(load, temperature_c), "right");
        assert_eq!(of_arm(0.0, 31.0).state, GateState::Open);
        let warm = of_arm(0.0, 60.0);
        assert_eq!(warm.state, GateState::Doubtful);
        assert!(warm.text.contains("Right elbow has 60 °C"), "{}", warm.text);
        let hot = of_arm(0.0, 72.0);
        assert_eq!(hot.state, GateState::Shut);
        assert!(hot.text.contains("Right elbow has 72 °C: let it cool down"), "{}", hot.text);
        let pushes = |of, name| load(&around(of, 31.0), name);
        assert_eq!(pushes(0.5, "right").state, GateState::Open);
        for of in [0.9, -0.9] {
            let shut = pushes(of, "right");
            assert_eq!(shut.state, GateState::Shut);
            assert!(shut.text.contains("Right elbow pushes against something"), "{}", shut.text);
            assert_eq!(pushes(of, "left").state, GateState::Open, "the other arm is not used");
        }
    }

    #[test]
    fn where_one_arm_may_not_move_the_other_one_is_sent_and_not_merely_said_to_be() {
        let hand = |around: &GraspAround, choice, method| able(around, choice, method);
        let fit = around(0.0, 31.0);
        assert_eq!(hand(&fit, HandChoice::Auto, Method::M5), HandChoice::Auto);
        for unfit in [around(0.9, 31.0), around(0.0, 72.0)] {
            assert_eq!(hand(&unfit, HandChoice::Auto, Method::M5), HandChoice::Left);
            // What was asked for is not exchanged, and published methods know one hand.
            assert_eq!(hand(&unfit, HandChoice::Right, Method::M5), HandChoice::Right);
            assert_eq!(hand(&unfit, HandChoice::Auto, Method::M3), HandChoice::Auto);
        }
        // One arm that pushes, and another one that is limp: neither may move, and none is said to grasp.
        let mut neither = around(0.9, 31.0);
        let robot = Arc::make_mut(&mut neither.robot);
        let let_go =
            |joint: &JointView| JointView { torque_on: Some(!joint.name.starts_with("l_")), ..joint.clone() };
        robot.joints = robot.joints.iter().map(let_go).collect();
        assert_eq!(hand(&neither, HandChoice::Auto, Method::M5), HandChoice::Auto);
        assert!(shut(&of_any(&neither, &Hand::BOTH)).is_some());
        let unfit = of_any(&around(0.9, 31.0), &Hand::BOTH);
        assert!(shut(&unfit).is_none());
        assert!(unfit.iter().any(|gate| gate.text.ends_with("Else the other hand grasps.")), "{unfit:?}");
    }
}
