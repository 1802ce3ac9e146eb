//! What the state asks the outer world to do.

use crate::ground::Nothing;
use crate::ground::jobs::JobId;
use crate::robot::RobotControl;
use crate::source::Control;
use crate::work::Work;

/// What the state asks the outer world to do.
#[derive(Clone, Debug)]
pub enum Action {
    /// Hand this to the source thread.
    Source(Control),
    /// Hand this to the robot's thread.
    Robot(RobotControl),
    /// Start this work; it ends with [`crate::state::State::work_ended`].
    Start(JobId, Work),
    /// Ask this work to stop.
    Cancel(JobId),
}

impl From<Control> for Action {
    fn from(control: Control) -> Self {
        Self::Source(control)
    }
}

impl From<RobotControl> for Action {
    fn from(control: RobotControl) -> Self {
        Self::Robot(control)
    }
}

impl From<Nothing> for Action {
    fn from(none: Nothing) -> Self {
        match none {}
    }
}
