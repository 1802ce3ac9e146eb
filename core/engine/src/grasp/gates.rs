//! What is looked at before anything moves.

use plumbline_grasp::Method;

use super::around::GraspAround;
use super::method::lacks;
use super::view::{Gate, GateState};
use crate::robot::view::{Connection, RobotView};
use crate::source::view::SourceStatus;

/// All gates, in the order in which they are passed.
pub fn gates(around: &GraspAround, arm: &str, method: Method) -> Vec<Gate> {
    let robot = &around.robot;
    let mut gates = vec![connected(robot)];
    if robot.connection.is_connected() {
        gates.extend([stop(robot), joints(around, arm)]);
    }
    gates.extend([eyes(around), places(around), method_gate(around, method)]);
    gates
}

/// The first reason why nothing may move.
pub fn shut(gates: &[Gate]) -> Option<&Gate> {
    gates.iter().find(|gate| gate.state == GateState::Shut)
}

fn open(name: &'static str, text: impl Into<String>) -> Gate {
    Gate { name, state: GateState::Open, text: text.into() }
}

fn closed(name: &'static str, text: impl Into<String>) -> Gate {
    Gate { name, state: GateState::Shut, text: text.into() }
}

fn doubtful(name: &'static str, text: impl Into<String>) -> Gate {
    Gate { name, state: GateState::Doubtful, text: text.into() }
}

fn connected(robot: &RobotView) -> Gate {
    match &robot.connection {
        Connection::Connected { to, .. } => open("Robot", format!("Connected to {to}.")),
        Connection::Connecting { .. } => closed("Robot", "It is being connected: wait a moment."),
        Connection::Lost { reason, .. } => closed("Robot", reason.clone()),
        Connection::None => closed("Robot", "No robot is connected: connect it, or start the twin."),
    }
}

fn stop(robot: &RobotView) -> Gate {
    if robot.stopped {
        closed("STOP", "STOP is latched: release it, at the top right.")
    } else {
        open("STOP", "Not pressed. Esc or space presses it.")
    }
}

/// Every joint of the arm is known, holds, is not too hot and is not overloaded.
fn joints(around: &GraspAround, arm: &str) -> Gate {
    let (robot, rig) = (&around.robot, &around.described);
    let Some(arm) = rig.arm(arm) else { return closed("Arm", "The robot has no such arm.") };
    let mut of_arm = robot
        .joints
        .iter()
        .filter(|joint| arm.joints.contains(&joint.joint) || arm.hand.contains(&joint.joint));
    if robot.measured.is_none() {
        return closed("Arm", "The joints have not been read yet: wait a moment.");
    }
    let mut warm = None;
    let trouble = of_arm.find_map(|joint| {
        let title = &joint.title;
        if robot.unknown.contains(&joint.joint) {
            return Some(format!("It is not known where {title} is: look at its cable and power."));
        }
        if joint.torque_on != Some(true) || joint.let_go || joint.no_force {
            return Some(format!("{title} does not hold: choose Hold all joints in Robot."));
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
        (Some(trouble), _) => closed("Arm", trouble),
        (None, Some(warm)) => doubtful("Arm", warm),
        (None, None) => open("Arm", format!("{} holds, all joints are known.", arm.title)),
    }
}

fn eyes(around: &GraspAround) -> Gate {
    match &around.source.status {
        _ if !around.own_eyes => {
            closed("Eyes", "The images are not those of this robot's eyes: open its eyes at the top left.")
        }
        SourceStatus::Running => open("Eyes", "Both eyes deliver."),
        SourceStatus::Opening => closed("Eyes", "The eyes are being opened: wait a moment."),
        SourceStatus::Lost { reason, .. } => closed("Eyes", reason.clone()),
        SourceStatus::Paused => closed("Eyes", "The eyes are held still: let them go on."),
        SourceStatus::None | SourceStatus::Ended => {
            closed("Eyes", "No eyes are open: open them at the top left.")
        }
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
    if lacks.is_empty() {
        return open("Places", "Lenses, mount and screen were calibrated.");
    }
    let what = match lacks.as_slice() {
        [one] => (*one).to_owned(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
        [] => String::new(),
    };
    doubtful("Places", format!("Not calibrated, taken as described: {what}."))
}

fn method_gate(around: &GraspAround, method: Method) -> Gate {
    let name = method.name().to_uppercase();
    match lacks(method, &around.corrections) {
        Some(lacks) => closed("Method", lacks),
        None => open("Method", format!("{name} has what it needs.")),
    }
}
