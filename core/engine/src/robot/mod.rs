//! The robot's side of the engine: a thread that connects, previews, jogs and moves.

pub mod arm;
pub mod command;
mod connect;
pub mod control;
mod destination;
mod history;
mod jog;
pub mod lead;
mod path;
pub(crate) mod patience;
mod poses;
mod publish;
mod said;
#[cfg(test)]
mod tests;
mod thread;
mod touch_once;
pub mod touch_order;
mod touching;
mod unable;
pub mod view;
mod worker;

use plumbline_hardware::joints::{Heartbeat, StopSwitch};

pub use control::RobotControl;
#[cfg(test)]
pub(crate) use lead::made_up;
pub use lead::{GivenUp, LeadAnswer, LeadOrder, Leader, Led, Reins};
pub use path::duration;
pub use poses::PoseLibrary;
pub use thread::{RobotThread, Wires as RobotWires};
pub use touch_order::{TouchMeasurement, TouchNews, TouchOrder, TouchRun, TouchStage, WithdrawOrder};
pub use worker::{News, Worker};

pub use crate::twin::{check_scenario, scenarios};

/// What goes past every queue: the latched STOP and the window's sign of life.
#[derive(Clone, Debug, Default)]
pub struct Switches {
    /// Read in every cycle of the joint bus; pressed at once, released only by a command.
    pub stop: StopSwitch,
    /// Without it the arm holds.
    pub heartbeat: Heartbeat,
}
