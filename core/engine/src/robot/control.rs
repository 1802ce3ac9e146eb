//! What is handed to the robot's thread.

use std::sync::Arc;

use plumbline_effects::RobotModel;
use plumbline_hardware::joints::Touch;

use super::command::RobotCommand;
use super::lead::Led;
use super::touch_order::{TouchOrder, WithdrawOrder};
use crate::twin::BoardLook;
use crate::twin::command::TwinCommand;

/// What is handed to the robot's thread.
#[derive(Clone, Debug)]
pub enum RobotControl {
    /// The operator wants something of the robot.
    Robot(RobotCommand),
    /// The operator wants something of the twin.
    Twin(TwinCommand),
    /// The robot is known otherwise than before: what was calibrated, and the effects of the model.
    UseModel(Arc<RobotModel>),
    /// The twin's eyes have looked for the board that it shows.
    BoardLooked(BoardLook),
    /// Touch the screen once.
    Touch(Box<TouchOrder>),
    /// Go away from the screen.
    Withdraw(Box<WithdrawOrder>),
    /// End the touch that is under way: up again, if the arm may move.
    AbandonTouch,
    /// The touch window felt a contact.
    Contact(Touch),
    /// Somebody leads the arm, order by order.
    Lead(Led),
    /// A workflow turns the head.
    TurnHead {
        /// Positive to the left, rad.
        pan_rad: f64,
        /// Positive up, rad.
        tilt_rad: f64,
    },
}

impl From<RobotCommand> for RobotControl {
    fn from(command: RobotCommand) -> Self {
        Self::Robot(command)
    }
}

impl From<TwinCommand> for RobotControl {
    fn from(command: TwinCommand) -> Self {
        Self::Twin(command)
    }
}
