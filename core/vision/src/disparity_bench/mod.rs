//! Our live pipeline against the one published for this robot (`published`, with the feature
//! `peers` only), timed in turns on the same pair, with the same number of threads.

use std::time::Instant;

use image::GrayImage;
use plumbline_model::aim::{AimError, AimedPair, DISPARITY_STEP_PX};

use crate::depth::{PointMap, SizeMismatch};
use crate::disparity::{DisparityError, DisparityMap, Matcher, Settings};
use crate::rectify::{Rectifier, RectifyError};

#[cfg(feature = "peers")]
mod published;

#[cfg(feature = "peers")]
pub use published::PublishedPipeline;

/// Depth at which the steps are compared, meters: the far edge of the table.
pub const COMPARED_AT_M: f64 = 0.6;

/// Nearest depth along the axis that the live pipeline searches, meters. The nearest things on
/// the table that the robot works on (headroom included) are at 0.2 m.
pub const NEAREST_M: f64 = 0.17;

/// Focal length of the published rectified views, pixels.
pub(super) const PUBLISHED_F_PX: f64 = 35.0524;

/// Figures of one comparison.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ComparisonReport {
    /// Rectification, disparity and 3D of one pair by us, median, milliseconds.
    pub ours_ms: f64,
    /// Same by the published pipeline, milliseconds; `None` where the program was built without it.
    pub published_ms: Option<f64>,
    /// Depth of 1/16 px at [`COMPARED_AT_M`] in our view, meters.
    pub depth_step_ours_m: f64,
    /// Same in the published view, meters.
    pub depth_step_published_m: f64,
    /// Part of our view whose disparity was measured, 0..=1.
    pub measured_fraction: f64,
    /// Repetitions that the medians are over.
    pub rounds: usize,
    /// Threads that both were allowed.
    pub threads: usize,
}

/// Why the comparison could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ComparisonError {
    /// The published pipeline works on fisheye eyes only.
    #[error("the published pipeline is for fisheye eyes: compare with a fisheye calibration")]
    NotFisheye,
    /// See [`AimError`].
    #[error(transparent)]
    Aim(#[from] AimError),
    /// See [`RectifyError`].
    #[error(transparent)]
    Rectify(#[from] RectifyError),
    /// See [`DisparityError`].
    #[error(transparent)]
    Disparity(#[from] DisparityError),
    /// See [`SizeMismatch`].
    #[error(transparent)]
    Depth(#[from] SizeMismatch),
    /// OpenCV refused.
    #[error("OpenCV could not run the published pipeline: {0}")]
    OpenCv(#[from] opencv::Error),
}

/// Our live pipeline from a raw gray pair to points.
pub struct LivePipeline {
    rectifier: Rectifier,
    matcher: Matcher,
}

impl LivePipeline {
    /// For an aimed pair, searching up to `nearest_m` along its axis.
    pub fn new(pair: &AimedPair, nearest_m: f64) -> Result<Self, ComparisonError> {
        let settings = Settings::live(pair.disparity_at(nearest_m).ceil() as u32);
        Ok(Self { rectifier: Rectifier::new(pair)?, matcher: Matcher::new(settings)? })
    }

    /// Rectifies, matches and places one raw gray pair.
    pub fn run(
        &mut self,
        left: &GrayImage,
        right: &GrayImage,
    ) -> Result<(DisparityMap, PointMap), ComparisonError> {
        let views = self.rectifier.rectify_gray(left, right)?;
        let map = self.matcher.compute(&views.left, &views.right, Some(self.rectifier.masks()))?;
        let points = PointMap::new(&map, self.rectifier.aimed())?;
        Ok((map, points))
    }
}

impl ComparisonReport {
    /// Our time as a fraction of the published pipeline's.
    pub fn ratio(&self) -> Option<f64> {
        Some(self.ours_ms / self.published_ms?)
    }
}

/// Times both pipelines in turns on one raw gray pair, `rounds` times each after one unmeasured
/// round, with as many OpenCV threads as the rayon pool has. `pair` is our aimed pair, in which
/// depths from `nearest_m` on are searched.
pub fn compare_with_published(
    left: &GrayImage,
    right: &GrayImage,
    pair: &AimedPair,
    nearest_m: f64,
    rounds: usize,
) -> Result<ComparisonReport, ComparisonError> {
    let threads = rayon::current_num_threads();
    let threads_before = opencv::core::get_num_threads()?;
    opencv::core::set_num_threads(threads as i32)?;
    let report = compare(left, right, pair, nearest_m, rounds.max(1), threads);
    opencv::core::set_num_threads(threads_before)?;
    report
}

fn compare(
    left: &GrayImage,
    right: &GrayImage,
    pair: &AimedPair,
    nearest_m: f64,
    rounds: usize,
    threads: usize,
) -> Result<ComparisonReport, ComparisonError> {
    let mut ours = LivePipeline::new(pair, nearest_m)?;
    let measured_fraction = ours.run(left, right)?.0.measured_fraction();
    #[cfg(feature = "peers")]
    let mut published = PublishedPipeline::new(&pair.cameras)?;
    #[cfg(feature = "peers")]
    published.run(left, right)?;
    let (mut ours_ms, mut published_ms): (Vec<f64>, Vec<f64>) = (vec![], vec![]);
    for _ in 0..rounds {
        timed(&mut ours_ms, || ours.run(left, right))?;
        #[cfg(feature = "peers")]
        timed(&mut published_ms, || published.run(left, right))?;
    }
    Ok(ComparisonReport {
        ours_ms: median(&mut ours_ms).unwrap_or(f64::NAN),
        published_ms: median(&mut published_ms),
        depth_step_ours_m: pair.depth_step_m(COMPARED_AT_M),
        depth_step_published_m: COMPARED_AT_M * COMPARED_AT_M * DISPARITY_STEP_PX
            / (PUBLISHED_F_PX * pair.cameras.baseline_m()),
        measured_fraction,
        rounds,
        threads,
    })
}

/// Adds the milliseconds that something takes.
fn timed<T, E>(all_ms: &mut Vec<f64>, act: impl FnOnce() -> Result<T, E>) -> Result<(), E> {
    let start = Instant::now();
    std::hint::black_box(act()?);
    all_ms.push(start.elapsed().as_secs_f64() * 1e3);
    Ok(())
}

fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
