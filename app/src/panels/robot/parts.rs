//! What the panes of the robot share.

use std::borrow::Cow;
use std::time::Duration;

use egui::Ui;
use plumbline_engine::view::{Connection, MotionState, RobotView};
use plumbline_engine::{Destination, RobotCommand};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::theme::space;

use super::state::Asked;
use crate::operator::{Action, RobotAction};
use crate::panels::PanelContext;
use crate::panels::parts::warning;

/// From this age on, a reading of the joints is called old.
pub const OLD: Duration = Duration::from_millis(1000);

impl PanelContext<'_> {
    /// Shows a move without running it.
    pub fn preview(&mut self, asked: Asked, to: Destination) {
        self.state.robot.asked = asked;
        self.outbox.send(RobotCommand::Preview(to));
    }
}

/// What stands in a tile while there are no joints to show; `true` when it was drawn. `purpose`
/// says what the tile is for; only the scene, which has none, offers to connect: the same button
/// four times helps nobody.
pub fn without_joints(ui: &mut Ui, cx: &mut PanelContext<'_>, purpose: Option<&str>) -> bool {
    let robot = &cx.view.robot;
    let clicked = match &robot.connection {
        _ if robot.rig.is_none() => EmptyState::failed(Message::new(
            "The robot's description cannot be read",
            "The messages say what is wrong with the rig file; nothing can be moved without it.",
        ))
        .show(ui),
        Connection::None if purpose.is_some() => {
            EmptyState::empty(Message::new("No robot is connected", purpose.unwrap_or_default())).show(ui)
        }
        Connection::None => EmptyState::empty(
            Message::new("No robot is connected", "Connect the twin to try everything, or a serial port.")
                .button("Connect…"),
        )
        .show(ui),
        Connection::Connecting { to, doing } => {
            let text = format!("Connecting to {to}: {doing}");
            EmptyState::loading(&text).show(ui)
        }
        Connection::Lost { reason, .. } if robot.joints.is_empty() => lost(ui, reason, purpose.is_none()),
        Connection::Connected { .. } if robot.joints.is_empty() => {
            EmptyState::loading("Waiting for the first answers of the servos").show(ui)
        }
        Connection::Connected { .. } | Connection::Lost { .. } => return false,
    };
    if clicked {
        cx.outbox.act(Action::Robot(RobotAction::Connect));
    }
    true
}

pub fn lost(ui: &mut Ui, reason: &str, with_button: bool) -> bool {
    let reason = crate::operator::words::capitalized(reason);
    let message = Message::new("The robot is lost", &reason);
    EmptyState::failed(if with_button { message.button("Connect…") } else { message }).show(ui)
}

/// Says that what is shown is old, and why; `None` while it is fresh.
pub fn stale_sentence(robot: &RobotView) -> Option<String> {
    if let Connection::Lost { reason, .. } = &robot.connection {
        return Some(format!("As last seen. {}", crate::operator::words::capitalized(reason)));
    }
    let oldest = robot.joints.iter().filter_map(|joint| joint.age).min()?;
    (oldest > OLD).then(|| format!("Last reading {}: the bus gives no new one.", format::age(oldest)))
}

/// The same as a line of a panel.
pub fn stale_line(ui: &mut Ui, robot: &RobotView) {
    if let Some(sentence) = stale_sentence(robot) {
        warning(ui, &sentence);
        ui.add_space(space::XS);
    }
}

/// The refusal of the last request, where it was made.
pub fn refusal_line(ui: &mut Ui, cx: &mut PanelContext<'_>, here: Asked) {
    let shown = cx.view.robot.refusal.as_deref().filter(|_| cx.state.robot.asked == here);
    let Some(why) = shown else { return };
    ui.horizontal_wrapped(|ui| {
        warning(ui, why);
        if ui.small_button("Dismiss").clicked() {
            cx.outbox.send(RobotCommand::DismissRefusal);
        }
    });
    ui.add_space(space::XS);
}

/// Why a move cannot even be shown; `None` when it can. While STOP is latched it can: nothing
/// moves by showing.
pub fn cannot_show(robot: &RobotView) -> Option<&'static str> {
    (!robot.connection.is_connected()).then_some("no robot is connected")
}

/// Why nothing can be moved just now; `None` when it can.
fn cannot_move(robot: &RobotView) -> Option<&'static str> {
    if !robot.connection.is_connected() {
        Some("no robot is connected")
    } else if robot.stopped {
        Some("STOP is latched: release it first")
    } else {
        None
    }
}

/// Why the chosen tip cannot be jogged just now; `None` when it can. Where one joint of an arm is not
/// known, the whole arm stays.
pub fn cannot_jog(robot: &RobotView) -> Option<Cow<'static, str>> {
    if let Some(why) = cannot_move(robot) {
        return Some(why.into());
    }
    if robot.measured.is_none() {
        return Some("the joints have not been read yet".into());
    }
    // A jog itself has no end that it could be a share of.
    if matches!(robot.motion, MotionState::Moving { fraction: Some(_), .. }) {
        return Some("a move is under way: stop it, or wait until the arm stands".into());
    }
    let rig = robot.rig.as_ref()?;
    let arm = rig.arms.iter().find(|arm| arm.tips.iter().any(|tip| tip.link == robot.tip))?;
    if robot.joints.iter().any(|joint| arm.joints.contains(&joint.joint) && joint.has_to_be_held()) {
        return Some("joints of the arm are limp: hold all joints first".into());
    }
    let mut joints = arm.joints.iter().chain(&arm.hand);
    let unknown = joints.find(|joint| robot.unknown.contains(joint))?;
    let title = rig.servo_of(*unknown).map_or("one of its joints", |servo| &servo.title);
    Some(format!("it is not known where {title} is: {}", robot.advice_for(*unknown)).into())
}
