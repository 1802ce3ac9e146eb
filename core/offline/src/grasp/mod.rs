//! Grasps on the twin: one, and the whole experiment.

mod attempt;
mod body;
mod judge;
mod lab;
mod one;
mod summary;
#[cfg(test)]
mod tests;
mod trial_error;
mod trials;

pub use judge::Judged;
pub use one::{GraspArgs, GraspReport, grasp};
pub use plumbline_grasp::Method as GraspMethod;
pub use summary::{MethodSummary, PositionSummary, Spread, Summary};
pub use trial_error::TrialsError;
pub use trials::{TrialsArgs, grasp_trials, merge_trials};

/// The published positions: x and y, robot frame, m. The nine by four grid of 10 cm as far as the right
/// arm reaches.
pub const PLACES_M: [[f64; 2]; 22] = [
    [0.2, -0.4],
    [0.3, -0.4],
    [0.2, -0.3],
    [0.3, -0.3],
    [0.4, -0.3],
    [0.2, -0.2],
    [0.3, -0.2],
    [0.4, -0.2],
    [0.2, -0.1],
    [0.3, -0.1],
    [0.4, -0.1],
    [0.2, 0.0],
    [0.3, 0.0],
    [0.4, 0.0],
    [0.2, 0.1],
    [0.3, 0.1],
    [0.4, 0.1],
    [0.2, 0.2],
    [0.3, 0.2],
    [0.4, 0.2],
    [0.2, 0.3],
    [0.3, 0.3],
];
