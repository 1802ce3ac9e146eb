//! Grasps on the twin: one, and the whole experiment.

mod attempt;
#[cfg(test)]
mod bad_inputs;
mod body;
mod judge;
mod lab;
mod one;
mod page;
mod summary;
#[cfg(test)]
mod tests;
mod trial_error;
mod trials;

pub use judge::Judged;
pub use one::{GraspArgs, GraspReport, grasp};
pub use plumbline_grasp::{Method as GraspMethod, PLACES_M};
pub use summary::{MethodSummary, PositionSummary, Spread, Summary};
pub use trial_error::TrialsError;
pub use trials::{TrialsArgs, grasp_trials, merge_trials};
