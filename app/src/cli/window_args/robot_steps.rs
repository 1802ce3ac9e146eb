//! Steps of a script that speak of the robot, its twin, and the mount of its eyes.

use plumbline_engine::{Command, Destination, RobotCommand, TwinCommand};

use crate::operator::{Action, MountAction, RobotAction, Screen};
use crate::window::ScriptStep;

type Step = Result<ScriptStep, String>;

/// The step of this name; `None` when there is none.
pub(super) fn step(name: &str, value: &str) -> Option<Step> {
    without_value(name).map(Ok).or_else(|| robot(name, value)).or_else(|| twin(name, value))
}

fn without_value(name: &str) -> Option<ScriptStep> {
    let robot = |action| Some(ScriptStep::Act(Action::Robot(action)));
    let mount = |action| Some(ScriptStep::Act(Action::Mount(action)));
    match name {
        "robot" => Some(ScriptStep::Act(Action::Go(Screen::Robot))),
        "mount" => Some(ScriptStep::Act(Action::Go(Screen::Mount))),
        "connect" => robot(RobotAction::Connect),
        "connect-twin" => robot(RobotAction::ConnectTwin),
        "disconnect" => robot(RobotAction::Disconnect),
        "move" => robot(RobotAction::Move),
        "forget" => robot(RobotAction::ForgetMove),
        "release" => robot(RobotAction::ReleaseStop),
        "hold" => robot(RobotAction::TorqueOn),
        "twin-board-tour" => robot(RobotAction::TourBoard),
        "twin-board-lay" => robot(RobotAction::LayBoard),
        "twin-board-away" => robot(RobotAction::HideBoard),
        "twin-cool" => robot(RobotAction::CoolEyes),
        "twin-reset" => robot(RobotAction::ResetTwin),
        "mount-plan" => mount(MountAction::Plan),
        "mount-tour" => mount(MountAction::Tour),
        "mount-capture" => mount(MountAction::Capture),
        "mount-solve" => mount(MountAction::Solve),
        "mount-accept" => mount(MountAction::Accept),
        "mount-discard" => mount(MountAction::Discard),
        _ => None,
    }
}

fn send(command: impl Into<Command>) -> Step {
    Ok(ScriptStep::Send(command.into()))
}

fn preview(to: Destination) -> Step {
    send(RobotCommand::Preview(to))
}

fn robot(name: &str, value: &str) -> Option<Step> {
    let point = || numbers(value).ok_or_else(|| format!("{name}:X,Y,Z wants three numbers in meters"));
    Some(match name {
        "connect-port" => send(RobotCommand::ConnectPort { path: value.into() }),
        "preview-pose" => preview(Destination::Pose { name: value.to_owned() }),
        "preview-joint" => named(name, value, |joint, degrees| Ok(ScriptStep::PreviewJoint(joint, degrees))),
        "joint" => Ok(ScriptStep::ChooseJoint(value.to_owned())),
        "look-at" => point().and_then(|point_m| preview(Destination::LookAt { point_m })),
        "reach" => point().and_then(|point_m| preview(Destination::TipPosition { point_m })),
        "speed" => match value.parse() {
            Ok(share) if (0.01..=2.0).contains(&share) => send(RobotCommand::Speed(share)),
            _ => Err("speed:SHARE wants a number between 0.01 and 2, 1 is usual".to_owned()),
        },
        _ => return None,
    })
}

fn twin(name: &str, value: &str) -> Option<Step> {
    Some(match name {
        "twin-board" => match value.parse::<usize>() {
            Ok(place) if place > 0 => send(TwinCommand::HoldBoard { place: place - 1 }),
            _ => Err("twin-board:N wants the number of a place, from 1".to_owned()),
        },
        "twin-board-at" => match numbers(value) {
            Some([x_m, y_m, turn_deg]) => {
                send(TwinCommand::LayBoard { x_m, y_m, yaw_rad: turn_deg.to_radians() })
            }
            None => Err("twin-board-at:X,Y,DEGREES wants a place in meters and a turn".to_owned()),
        },
        "twin-toy" => place_toy(value),
        "twin-toy-away" => send(TwinCommand::RemoveToy { toy: value.to_owned() }),
        "twin-warm-up" => match value.parse() {
            Ok(minutes) if minutes > 0.0 && minutes <= 600.0 => send(TwinCommand::AdvanceWarmUp { minutes }),
            _ => Err("twin-warm-up:MINUTES wants a number up to 600".to_owned()),
        },
        "twin-fault" => match value.split_once('=') {
            Some((fault, on @ ("on" | "off"))) => {
                send(TwinCommand::Fault { name: fault.to_owned(), on: on == "on" })
            }
            _ => Err("twin-fault:NAME=on or =off".to_owned()),
        },
        _ => return None,
    })
}

fn place_toy(value: &str) -> Step {
    let parts = value.split_once(',').and_then(|(toy, at)| {
        let (x, y) = at.split_once(',')?;
        Some((toy, x.trim().parse().ok()?, y.trim().parse().ok()?))
    });
    match parts {
        Some((toy, x_m, y_m)) => send(TwinCommand::PlaceToy { toy: toy.to_owned(), x_m, y_m }),
        None => Err("twin-toy:NAME,X,Y wants a toy and a place in meters".to_owned()),
    }
}

/// NAME=NUMBER.
fn named(step: &str, value: &str, then: impl FnOnce(String, f64) -> Step) -> Step {
    match value.split_once('=').and_then(|(name, number)| Some((name, number.trim().parse::<f64>().ok()?))) {
        Some((name, number)) if number.is_finite() => then(name.trim().to_owned(), number),
        _ => Err(format!("{step}:NAME=NUMBER wants a name and a number")),
    }
}

fn numbers(text: &str) -> Option<[f64; 3]> {
    let finite = |part: &str| part.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let all: Option<Vec<f64>> = text.split(',').map(finite).collect();
    all?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_say_what_they_want() {
        assert_eq!(step("move", ""), Some(Ok(ScriptStep::Act(Action::Robot(RobotAction::Move)))));
        let elbow = ScriptStep::PreviewJoint("r_elbow_y".to_owned(), 92.5);
        assert_eq!(step("preview-joint", "r_elbow_y=92.5"), Some(Ok(elbow)));
        let toy = TwinCommand::PlaceToy { toy: "tomato".to_owned(), x_m: 0.3, y_m: -0.1 };
        assert_eq!(step("twin-toy", "tomato,0.3,-0.1"), Some(Ok(ScriptStep::Send(toy.into()))));
        assert!(step("look-at", "1,2").expect("known").expect_err("two numbers").contains("meters"));
        assert!(step("twin-board", "0").expect("known").is_err());
        assert_eq!(step("dance", ""), None);
        for bad in ["1e-30", "0", "-1", "NaN", "inf", "2.1", "fast"] {
            let why = step("speed", bad).expect("known").expect_err(bad);
            assert!(why.contains("between 0.01 and 2"), "{why}");
        }
        for bad in ["0", "-1", "NaN", "1e9"] {
            assert!(step("twin-warm-up", bad).expect("known").is_err(), "{bad}");
        }
    }
}
