//! What made room on the twin's screen comes back when nobody touches it any more.

use plumbline_model::frame::{Point, Robot};
use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;

use super::super::view::ContactSource;
use super::super::work::Context;
use super::{TouchAround, TouchWorkflow, source};
use crate::robot::view::{MotionState, RobotView};
use crate::twin::command::TwinCommand;

/// Nothing that stands on the screen is so high, m: a hand above that meets none of it.
const ABOVE_M: f64 = 0.12;
/// Nor, with what is as wide as a hand, so far beside it, m.
const BESIDE_M: f64 = 0.10;

impl TouchWorkflow {
    /// Once a run was closed, and the arms rest where nothing is put beside or into a hand.
    pub(super) fn give_room_back(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        if !self.owes_room || self.starting.is_some() || self.run.is_some() {
            return;
        }
        // Without a connection nobody knows where the hands are.
        if source(&around.robot) != ContactSource::Twin
            || !is_free(&around.rig, &self.placed_screen(&around.rig), &around.robot)
        {
            return;
        }
        self.owes_room = false;
        context.control(TwinCommand::EndTouch.into());
    }
}

/// Whether the arms rest and no hand is on the screen or near it.
fn is_free(rig: &Rig, screen: &Touchscreen, robot: &RobotView) -> bool {
    if matches!(robot.motion, MotionState::Moving { .. }) {
        return false;
    }
    rig.arms.iter().all(|arm| {
        let Some(posture) = robot.known(&arm.joints) else { return false };
        let links = rig.description.forward(posture);
        arm.tips.iter().all(|tip| {
            let Ok(link) = rig.description.find_link(&tip.link) else { return false };
            let at = links.of(link).isometry.translation.vector;
            is_away(screen, Point::new(at.x, at.y, at.z))
        })
    })
}

/// Whether a place is beside the screen, or high above it.
fn is_away(screen: &Touchscreen, at: Point<Robot>) -> bool {
    let pixel = screen.pixel_at(at);
    let [pitch_u_m, pitch_v_m] = screen.pitch_m();
    let is_over = |at_m: f64, size_m: f64| at_m > -BESIDE_M && at_m < size_m + BESIDE_M;
    let is_over =
        is_over(pixel.u_px * pitch_u_m, screen.width_m) && is_over(pixel.v_px * pitch_v_m, screen.height_m);
    !is_over || screen.height_above_m(at) > ABOVE_M
}
