//! Calibrates both eyes at once from chessboard pairs: all lens parameters, the pose of the eyes
//! to each other and every board pose in one least-squares problem.
//!
//! Needs no guess: the lens starts from a ladder of focal lengths, board poses come straight from
//! viewing rays, and no view can make the solution fail. Assumes a flat board and still eyes.
//! Broken when residuals of one pair point the same way (board or eyes moved between the two
//! images) or bend with the board (not flat).

mod check;
mod cross_validation;
mod initial;
mod optimizer;
mod outliers;
mod problem;
mod report;
mod start;
mod stereo_start;
#[cfg(test)]
mod tests;

use plumbline_model::{
    CalibrationOptions, Camera, Cancelled, Chessboard, Evidence, Eye, JobContext, PairObservation,
    ParameterCovariance, Pose, RejectedPair, StereoCalibration, StereoCameras,
};

pub use check::{CheckReport, check};
pub use optimizer::Termination;

pub(crate) use initial::pose_from_rays;
use optimizer::Optimizer;
pub(crate) use outliers::median;
use problem::{Problem, State};

/// Fewest pairs, seen by both eyes, that determine a stereo calibration with anything to spare.
pub const FEWEST_PAIRS: usize = 4;
/// Fewest board poses that differ from each other.
const FEWEST_POSES: usize = 3;

/// Why no calibration came out.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// Stopped on request.
    #[error("cancelled")]
    Cancelled(#[from] Cancelled),
    /// Not enough to work with.
    #[error(
        "both eyes see the board in {found} pairs, at least {FEWEST_PAIRS} are needed (15 to 40 make a good calibration): collect more"
    )]
    TooFewPairs {
        /// Pairs in which both eyes saw the board.
        found: usize,
    },
    /// The board was held in one place.
    #[error(
        "the board was held in only {distinct} different place(s), at least {FEWEST_POSES} are needed: move it over the whole image, near and far, and tilt it"
    )]
    AllViewsAlike {
        /// Poses that differ from each other.
        distinct: usize,
    },
    /// Left and right are exchanged.
    #[error(
        "the eyes are swapped: the images given as left come from the right eye. Exchange the two folders or cameras"
    )]
    EyesSwapped,
    /// One image is mirrored.
    #[error(
        "the images of the {0} eye are mirrored: switch off mirroring (flip) in that camera's settings, or flip its images left to right"
    )]
    Mirrored(Eye),
    /// Each eye is fine alone, but no two pairs agree.
    #[error(
        "the two eyes do not agree on where the board was ({agreeing} of {pairs} pairs do): were left and right images taken at the same moment, and are the files of both eyes in the same order?"
    )]
    EyesDisagree {
        /// Pairs that agree on the relative pose.
        agreeing: usize,
        /// Pairs seen by both.
        pairs: usize,
    },
    /// One eye alone could not be calibrated.
    #[error(
        "the {0} eye could not be calibrated with this lens model: check the board size and try the other model (fisheye or pinhole)"
    )]
    EyeFailed(Eye),
    /// The data leave a combination of parameters open.
    #[error(
        "the pairs do not determine all parameters of the lens: add pairs with the board tilted and near the edge of the image"
    )]
    Undetermined,
    /// A corner list of the wrong length.
    #[error(
        "pair \"{name}\" has {found} corners in the {eye} image, the board has {expected}: solve with the board that was used for finding them"
    )]
    WrongCornerCount {
        /// Pair.
        name: String,
        /// Eye.
        eye: Eye,
        /// Corners in the list.
        found: usize,
        /// Corners on the board.
        expected: usize,
    },
}

/// Solves for both eyes.
///
/// `sizes_px` are the image sizes (width, height) of the left and the right eye; `dropped` names
/// pairs that are kept as evidence but not used.
pub fn solve(
    board: &Chessboard,
    observations: &[PairObservation],
    sizes_px: [(u32, u32); 2],
    options: &CalibrationOptions,
    dropped: &[String],
    context: &dyn JobContext,
) -> Result<StereoCalibration, SolveError> {
    let start = start::find(board, observations, sizes_px, options.model, dropped, context)?;
    let start::Start { mut problem, state, mut rejected } = start;

    context.report(0.3, "solving both eyes together");
    let state = converge(&problem, state, context)?;
    let state = reject_bad_pairs(&mut problem, state, &mut rejected);
    problem.robust_px = None;
    let state = if options.leave_out_bad_corners {
        context.report(0.6, "looking for bad corners");
        // Bad corners are judged against the robust solution, which they cannot bend.
        let state = converge(&Problem { robust_px: Some(ROBUST_PX), ..problem.clone() }, state, context)?;
        outliers::leave_out_bad_corners(&mut problem, state)
    } else {
        state
    };
    let state = converge(&problem, state, context)?;

    context.report(0.8, "estimating uncertainty");
    let covariance = covariance(&problem, &state).ok_or(SolveError::Undetermined)?;
    let cameras = cameras_of(&state, sizes_px);
    let cross_validated_px = if options.cross_validation_folds > 1 {
        context.report(0.85, "cross-validating");
        cross_validation::rms_px(&problem, &state, options.cross_validation_folds, context)?
    } else {
        None
    };
    let summary = report::summary(&problem, &state, &cameras, board, cross_validated_px)
        .ok_or(SolveError::Undetermined)?;
    Ok(StereoCalibration {
        cameras,
        covariance: Some(covariance),
        summary: Some(summary),
        per_pair: report::per_pair(&problem, &state, &cameras),
        rejected,
        evidence: Some(Evidence {
            board: *board,
            options: options.clone(),
            observations: observations.to_vec(),
            dropped_pairs: dropped.to_vec(),
            created: jiff::Timestamp::now(),
            software: concat!("plumbline ", env!("CARGO_PKG_VERSION")).to_owned(),
            minutes_since_on: None,
            source: String::new(),
        }),
    })
}

/// Scale of the robust loss while bad corners may still be among the good ones.
const ROBUST_PX: f64 = 0.5;
const MOST_ITERATIONS: usize = 100;

fn converge(problem: &Problem, state: State, context: &dyn JobContext) -> Result<State, Cancelled> {
    let mut optimizer = Optimizer::new(problem, state);
    for _ in 0..MOST_ITERATIONS {
        context.checkpoint()?;
        if optimizer.step().is_some() {
            break;
        }
    }
    Ok(optimizer.state)
}

/// Takes out pairs that do not fit as a whole (the board moved between the two images): most of
/// their corners are far off while the other pairs fit.
fn reject_bad_pairs(problem: &mut Problem, state: State, rejected: &mut Vec<RejectedPair>) -> State {
    const TIMES_TYPICAL: f64 = 8.0;
    let medians: Vec<f64> = (0..problem.views.len())
        .map(|v| {
            let norms =
                problem.views[v].corners.iter().filter_map(|c| state.residual(v, c)).map(|r| r.norm());
            outliers::median(norms.collect()).unwrap_or(f64::INFINITY)
        })
        .collect();
    let Some(typical) = outliers::median(medians.clone()) else { return state };
    let mut keep = medians.iter().map(|m| *m <= TIMES_TYPICAL * typical).collect::<Vec<_>>();
    if keep.iter().filter(|k| **k).count() < FEWEST_PAIRS {
        keep.fill(true);
    }
    for (v, view) in problem.views.iter().enumerate() {
        if !keep[v] {
            rejected.push(RejectedPair {
                name: view.name.clone(),
                reason: format!(
                    "half of its corners are more than {:.2} px off where the other pairs have {typical:.2} px: \
                     the board or the head moved between the two images, or a part of the board was mistaken",
                    medians[v]
                ),
            });
        }
    }
    let mut of_pose = keep.iter();
    let mut of_view = keep.iter();
    let mut state = state;
    state.left_from_board.retain(|_| *of_pose.next().unwrap_or(&true));
    problem.views.retain(|_| *of_view.next().unwrap_or(&true));
    state
}

fn cameras_of(state: &State, sizes_px: [(u32, u32); 2]) -> StereoCameras {
    let camera =
        |i: usize| Camera { model: state.models[i], width_px: sizes_px[i].0, height_px: sizes_px[i].1 };
    StereoCameras { left: camera(0), right: camera(1), right_from_left: Pose::new(state.right_from_left) }
}

/// Covariance of the shared parameters, scaled by the residuals' variance.
fn covariance(problem: &Problem, state: &State) -> Option<ParameterCovariance> {
    let measurements = 2 * problem.active().count();
    let spare = measurements.checked_sub(problem.free_count()).filter(|&n| n > 0)?;
    let variance_px2 = problem.cost(state) / spare as f64;
    Some(ParameterCovariance { matrix: optimizer::shared_covariance(problem, state)? * variance_px2 })
}
