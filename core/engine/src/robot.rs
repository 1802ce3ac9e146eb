//! The robot's side of the engine: a thread that connects, previews, jogs and moves.

pub mod arm;
mod connect;
mod destination;
mod history;
mod jog;
mod path;
mod poses;
mod publish;
#[cfg(test)]
mod tests;
mod thread;
pub mod touch_order;
mod touching;
mod twin_desk;
mod twin_eyes;
mod worker;

use plumbline_hardware::joints::{Heartbeat, StopSwitch, Touch};
use plumbline_model::frame::{Head, LeftCamera, Pose};
use plumbline_model::session::Touchscreen;

pub use poses::PoseLibrary;
pub use thread::{RobotThread, Wires as RobotWires};
pub use touch_order::{TouchMeasurement, TouchNews, TouchOrder, TouchRun, TouchStage};
pub use twin_desk::TwinDesk;
pub use twin_eyes::TwinEyesPlug;
pub use worker::{News, Worker};

use crate::command::{RobotCommand, TwinCommand};

/// Names of the twin's scenarios that come with the program.
pub fn scenarios() -> impl Iterator<Item = &'static str> {
    plumbline_twin::Scenario::built_in_names()
}

/// What is handed to the robot's thread.
#[derive(Clone, Debug)]
pub enum RobotControl {
    /// The operator wants something of the robot.
    Robot(RobotCommand),
    /// The operator wants something of the twin.
    Twin(TwinCommand),
    /// The eyes sit elsewhere in the head: looking at a point needs to know.
    PlaceEyes {
        /// Place of the left eye.
        head_from_left: Pose<Head, LeftCamera>,
    },
    /// The touchscreen lies elsewhere.
    PlaceScreen(Touchscreen),
    /// Touch the screen once.
    Touch(Box<touch_order::TouchOrder>),
    /// End the touch that is under way: up again, if the arm may move.
    AbandonTouch,
    /// The touch window felt a contact.
    Contact(Touch),
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

/// What goes past every queue: the latched STOP and the window's sign of life.
#[derive(Clone, Debug, Default)]
pub struct Switches {
    /// Read in every cycle of the joint bus; pressed at once, released only by a command.
    pub stop: StopSwitch,
    /// Without it the arm holds.
    pub heartbeat: Heartbeat,
}
