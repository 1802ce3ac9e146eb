//! The stages of the live pipeline: plain structs with `process`, run by a thread each.

mod corners;
mod detect;
mod probe;
mod rectify;
mod run;

use std::sync::Arc;
use std::time::Duration;

use plumbline_model::{AimedPair, LeftCamera, Pose, Robot, Stamp, StereoCalibration};

pub use corners::{CornersInput, CornersStage};
pub use detect::{DetectFailure, DetectInput, DetectOutput, DetectStage};
pub use probe::{ProbeInput, ProbeOutput, ProbeStage, other_size};
pub use rectify::{RectifyInput, RectifyOutput, RectifyStage};
pub use run::{StagePanic, StageThread, run_stage};

/// What rectification and measuring rest on. Results of an older one are not shown any more.
#[derive(Clone, Debug)]
pub struct LiveSetup {
    /// Counts up with every change.
    pub generation: u64,
    /// The calibration in use.
    pub calibration: Arc<StereoCalibration>,
    /// How the virtual pair looks at the workspace.
    pub pair: AimedPair,
    /// Largest disparity that is searched, pixels.
    pub max_disparity_px: u32,
    /// Where the left eye is.
    pub robot_from_left: Pose<Robot, LeftCamera>,
}

/// A result and how long it took.
#[derive(Clone, Debug)]
pub struct Timed<T> {
    /// Of the pair that it was made from.
    pub stamp: Stamp,
    /// Time spent on it.
    pub busy: Duration,
    /// The result.
    pub result: T,
}
