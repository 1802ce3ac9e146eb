//! Touching the screen: plan, run, pause, go on after a restart, and measure where the screen lies.
//!
//! [`TouchWorkflow`] is driven by commands, by what the robot reports and by finished work; it owns
//! no thread and reads no clock.

mod state;
pub mod work;

pub use state::{Surroundings, TouchWorkflow};
