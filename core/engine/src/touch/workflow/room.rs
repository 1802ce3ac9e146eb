//! What made room on the twin's screen comes back when nobody touches it any more.

use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;

use super::super::over::{TO_REACH, is_away};
use super::super::view::ContactSource;
use super::super::work::Context;
use super::{TouchAround, TouchWorkflow, source};
use crate::robot::view::{MotionState, RobotView};
use crate::twin::command::TwinCommand;

impl TouchWorkflow {
    /// Once a run is over or was closed, and the arms rest where nothing is put beside or into a hand. A run that is taken
    /// up again asks for room again (`Run::tell_twin`).
    pub(super) fn give_room_back(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        let is_over = self.run.as_ref().is_none_or(|run| run.is_over() && run.left_to_put_back().is_none());
        if !self.owes_room || self.starting.is_some() || !is_over {
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
        robot.known(&arm.joints).is_some_and(|posture| is_away(rig, arm, screen, posture, TO_REACH))
    })
}
