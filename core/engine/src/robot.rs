//! The robot's side of the engine: a thread that connects, previews, jogs and moves.

mod jog;
mod poses;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use crate::command::{RobotCommand, TwinCommand};

/// What is handed to the robot's thread.
#[derive(Clone, Debug)]
pub enum RobotControl {
    /// The operator wants something of the robot.
    Robot(RobotCommand),
    /// The operator wants something of the twin.
    Twin(TwinCommand),
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
#[derive(Debug)]
pub struct Switches {
    /// Read in every cycle of the joint bus; set at once, released only by a command.
    pub stop: Arc<AtomicBool>,
    /// When the window last said that it is alive, milliseconds since `started`.
    pub alive_ms: Arc<AtomicU64>,
    started: Instant,
}

impl Default for Switches {
    fn default() -> Self {
        Self { stop: Arc::default(), alive_ms: Arc::default(), started: Instant::now() }
    }
}

impl Switches {
    /// Whatever moves has to hold, now.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::SeqCst);
    }

    /// The window is alive.
    pub fn heartbeat(&self) {
        let now_ms = u64::try_from(self.started.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.alive_ms.store(now_ms, Ordering::Relaxed);
    }
}
