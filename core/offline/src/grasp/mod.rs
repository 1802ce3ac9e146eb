//! Grasps on the twin: one, and the whole experiment.

mod attempt;
mod judge;
mod lab;
mod one;
#[cfg(test)]
mod tests;
mod tracked;
mod trials;

pub use one::{GraspArgs, GraspReport, grasp};
pub use plumbline_engine::trials::{Judged, MethodSummary, PositionSummary, Spread, Summary, TrialsError};
pub use plumbline_grasp::{HandChoice, Method as GraspMethod, PLACES_M};
pub use trials::{TrialsArgs, grasp_trials, merge_trials};
