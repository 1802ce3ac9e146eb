//! Judges a calibration on pairs it has not seen.

use plumbline_model::{Chessboard, Eye, PairFit, PairObservation, StereoCameras};

use super::SolveError;
use super::initial::pose_of_view;
use super::optimizer::Optimizer;
use super::outliers::leave_out_bad_corners;
use super::problem::{Corner, Free, Problem, State, View};
use super::report::{SquareSum, epipolar, per_pair, square_sums, squares_m};
use super::start::corners_of;

/// How a calibration does on other pairs. Only the board poses are fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckReport {
    /// Rms residual per corner over both eyes, pixels.
    pub reprojection_px: f64,
    /// Rms distance from the partner's epipolar curve, raw pixels.
    pub epipolar_px: f64,
    /// Mean side of the squares, triangulated, meters.
    pub square_mean_m: f64,
    /// Its standard deviation, meters.
    pub square_sd_m: f64,
    /// Each pair.
    pub per_pair: Vec<PairFit>,
}

/// Judges `cameras` on `observations`; pairs that only one eye saw do not count. Bad corners
/// count unless `leave_out_bad` is set.
pub fn check(
    cameras: &StereoCameras,
    board: &Chessboard,
    observations: &[PairObservation],
    leave_out_bad: bool,
) -> Result<CheckReport, SolveError> {
    let mut views = Vec::new();
    let mut left_from_board = Vec::new();
    for observation in observations {
        let left = corners_of(board, observation, Eye::Left)?;
        let right = corners_of(board, observation, Eye::Right)?;
        if right.len() < 6 {
            continue;
        }
        let Some(pose) = pose_of_view(&cameras.left.model, &left) else { continue };
        left_from_board.push(pose);
        views.push(View { name: observation.name.clone(), corners: left.into_iter().chain(right).collect() });
    }
    if views.is_empty() {
        return Err(SolveError::TooFewPairs { found: 0 });
    }
    let mut problem = Problem {
        kind: cameras.left.model.kind(),
        views,
        free: Free { intrinsics: [false, false], right_from_left: false },
        robust_px: Some(0.5),
    };
    let mut state = State::from_cameras(cameras, left_from_board);
    for robust_px in [Some(0.5), None] {
        problem.robust_px = robust_px;
        let mut optimizer = Optimizer::new(&problem, state);
        optimizer.run(50);
        state = optimizer.state;
        if leave_out_bad && robust_px.is_some() {
            state = leave_out_bad_corners(&mut problem, state);
        }
    }
    report(cameras, board, &problem, &state).ok_or(SolveError::Undetermined)
}

fn report(
    cameras: &StereoCameras,
    board: &Chessboard,
    problem: &Problem,
    state: &State,
) -> Option<CheckReport> {
    let [mut both, right] = square_sums(problem, state);
    both.merge(right);
    let mut epipolar_sum = SquareSum::default();
    for view in &problem.views {
        epipolar_sum.merge(epipolar(cameras, &view.corners));
    }
    let views: Vec<Vec<Corner>> = problem.views.iter().map(|v| v.corners.clone()).collect();
    let (square_mean_m, square_sd_m) = squares_m(cameras, board, &views)?;
    Some(CheckReport {
        reprojection_px: both.rms()?,
        epipolar_px: epipolar_sum.rms()?,
        square_mean_m,
        square_sd_m,
        per_pair: per_pair(problem, state, cameras),
    })
}
