//! The error on pairs that were not used for solving: what a calibration is worth.

use plumbline_model::{Cancelled, JobContext};

use super::optimizer::Optimizer;
use super::problem::{Free, Problem, State};
use super::report::{SquareSum, square_sums};

/// Rms residual over all pairs, each predicted by a solution that has not seen it (only its board
/// pose is fitted). `None` with too few pairs for this many folds.
pub(super) fn rms_px(
    problem: &Problem,
    state: &State,
    folds: usize,
    context: &dyn JobContext,
) -> Result<Option<f64>, Cancelled> {
    let folds = folds.min(problem.views.len());
    let mut sum = SquareSum::default();
    for fold in 0..folds {
        context.checkpoint()?;
        context.report(
            0.85 + 0.15 * fold as f64 / folds as f64,
            &format!("cross-validating, part {} of {folds}", fold + 1),
        );
        // Every folds-th pair, so that each part spans the whole capture.
        let (held, kept) = split(problem, state, |view| view % folds == fold);
        if kept.0.views.len() < super::FEWEST_PAIRS {
            return Ok(None);
        }
        let mut refit = Optimizer::new(&kept.0, kept.1);
        refit.run(20);
        let held_state = State {
            models: refit.state.models,
            right_from_left: refit.state.right_from_left,
            left_from_board: held.1.left_from_board,
        };
        let mut poses_only = held.0;
        poses_only.free = Free { intrinsics: [false, false], right_from_left: false };
        let mut posed = Optimizer::new(&poses_only, held_state);
        posed.run(20);
        for eye in square_sums(&poses_only, &posed.state) {
            sum.merge(eye);
        }
    }
    Ok(sum.rms())
}

/// (views for which `pick` holds, the others).
fn split(
    problem: &Problem,
    state: &State,
    pick: impl Fn(usize) -> bool,
) -> ((Problem, State), (Problem, State)) {
    let part = |wanted: bool| {
        let mut part = (problem.clone(), state.clone());
        part.0.views = problem
            .views
            .iter()
            .enumerate()
            .filter(|(i, _)| pick(*i) == wanted)
            .map(|(_, v)| v.clone())
            .collect();
        part.1.left_from_board = state
            .left_from_board
            .iter()
            .enumerate()
            .filter(|(i, _)| pick(*i) == wanted)
            .map(|(_, p)| *p)
            .collect();
        part
    };
    (part(true), part(false))
}
