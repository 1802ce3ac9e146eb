//! Proposing where a joint goes.

use plumbline_engine::Destination;
use plumbline_engine::view::{JointView, RobotView};
use plumbline_model::robot::{JointIndex, Posture};

use crate::panels::PanelContext;
use crate::panels::robot::parts::cannot_show;
use crate::panels::robot::state::Asked;

/// A joint that would move by more than this belongs to the shown move, rad. More than encoders
/// flicker and joints sag.
pub(super) const OTHER_MOVES_RAD: f64 = 0.01;

/// Shows the move; nothing moves by that.
pub(super) fn propose(cx: &mut PanelContext<'_>, joint: &JointView, angle_rad: f64) {
    if cannot_show(&cx.view.robot).is_some() {
        return;
    }
    cx.state.robot.chosen_joint = Some(joint.joint);
    let to = destination(&cx.view.robot, joint.joint, angle_rad);
    cx.preview(Asked::Joints, to);
}

pub(super) fn preview_angle(robot: &RobotView, joint: &JointView) -> Option<f64> {
    robot.preview.as_ref()?.end.angles_rad().get(joint.joint.0).copied()
}

/// Where the move goes: this joint, together with what is shown already.
fn destination(robot: &RobotView, joint: JointIndex, angle_rad: f64) -> Destination {
    let shown = robot.preview.as_ref().map(|preview| &preview.end);
    match shown.filter(|end| joint.0 < end.len() && others_move(robot, joint, end)) {
        Some(end) => Destination::Posture(end.with(&[joint], &[angle_rad])),
        None => Destination::Joint { joint, angle_rad },
    }
}

fn others_move(robot: &RobotView, joint: JointIndex, end: &Posture) -> bool {
    robot.joints.iter().filter(|other| other.joint != joint).any(|other| {
        let there = end.angles_rad().get(other.joint.0);
        there.zip(other.angle_rad).is_some_and(|(there, here)| (there - here).abs() > OTHER_MOVES_RAD)
    })
}
