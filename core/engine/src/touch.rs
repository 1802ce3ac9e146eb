//! Touching the screen: plan, run, pause, go on after a restart, and measure where the screen lies.
//!
//! [`TouchWorkflow`] is driven by commands, by what the robot reports and by finished work; it owns
//! no thread and reads no clock.

mod figures;
#[cfg(all(test, target_os = "linux"))]
mod kept_tests;
pub mod path;
#[cfg(test)]
mod path_tests;
mod placement;
mod plan;
mod record;
mod run;
mod state;
mod store;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod view;
pub mod work;

pub use state::{Surroundings, TouchWorkflow};
