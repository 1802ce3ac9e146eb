//! Touching the screen: plan, run, pause, go on after a restart, and measure where the screen lies.
//!
//! [`TouchWorkflow`] is driven by commands, by what the robot reports and by finished work; it owns
//! no thread and reads no clock.

mod choice;
pub mod command;
mod depth;
mod figures;
#[cfg(all(test, target_os = "linux"))]
mod kept_tests;
mod over;
#[cfg(test)]
mod path_tests;
#[cfg(test)]
mod patience_tests;
pub mod placement;
pub mod plan;
pub mod record;
pub mod refusal;
mod run;
mod seen;
mod shown;
mod standing;
pub mod store;
pub mod telling;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(test)]
mod tests;
pub mod view;
pub mod work;
mod workflow;

pub use depth::DEEPER_M;
pub use plumbline_effects::observability::{Addition, Advice, EffectVisibility, PlanScore};
pub use standing::RunStanding;
pub use workflow::{TouchAround, TouchWorkflow};
