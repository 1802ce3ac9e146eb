//! What made room on the twin's screen comes back when nobody touches it any more.

use std::time::Duration;

use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;

use super::super::over::{TO_REACH, is_away};
use super::super::view::ContactSource;
use super::super::work::Context;
use super::{TouchAround, TouchWorkflow, source};
use crate::robot::view::{MotionState, RobotView};
use crate::twin::command::TwinCommand;

/// For so long the arms have rested before anything is put down.
const RESTS_FOR: Duration = Duration::from_secs(1);

impl TouchWorkflow {
    /// Once a run is over or was closed, and the arms rest where nothing is put beside or into a hand. A run that is taken
    /// up again asks for room again (`Run::tell_twin`).
    pub(super) fn give_room_back(&mut self, around: &TouchAround, context: &mut Context<'_>) {
        let is_over = self.run.as_ref().is_none_or(|run| run.is_over() && run.left_to_put_back().is_none());
        if !self.owes_room || self.starting.is_some() || !is_over {
            return;
        }
        // Without a connection nobody knows where the hands are.
        let is_free = source(&around.robot) == ContactSource::Twin
            && is_free(&around.rig, &self.placed_screen(&around.rig), &around.robot);
        let now = context.time.instant;
        let since = *self.free_since.get_or_insert(now);
        self.free_since = is_free.then_some(since);
        // Between two of its orders an arm rests for a moment, too.
        if !is_free || now.saturating_duration_since(since) < RESTS_FOR {
            return;
        }
        (self.owes_room, self.free_since) = (false, None);
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
