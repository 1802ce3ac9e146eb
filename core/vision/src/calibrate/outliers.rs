//! Finds single bad corners and leaves them out, one by one, instead of losing the view.

use super::optimizer::Optimizer;
use super::problem::{Problem, State};

/// A corner is bad when its residual exceeds this many times the typical one-axis residual of
/// the calibration and of its own view. For Gaussian residuals one corner in 65 million does.
const BAD_CORNER_SIGMAS: f64 = 6.0;
/// Median of a Rayleigh distribution in units of its one-axis standard deviation.
const RAYLEIGH_MEDIAN: f64 = 1.1774;
/// No more than this share of all corners is left out; beyond it the model is wrong, not the data.
const MOST_LEFT_OUT: f64 = 0.05;
/// Iterations after each corner: the solution barely moves.
const STEPS_AFTER_EACH: usize = 4;

/// Leaves out bad corners and returns the refitted state.
pub(super) fn leave_out_bad_corners(problem: &mut Problem, mut state: State) -> State {
    let most = (problem.active().count() as f64 * MOST_LEFT_OUT) as usize;
    for _ in 0..most {
        let Some((view, corner)) = worst_bad_corner(problem, &state) else { break };
        problem.views[view].corners[corner].left_out = true;
        let mut optimizer = Optimizer::new(problem, state);
        optimizer.run(STEPS_AFTER_EACH);
        state = optimizer.state;
    }
    state
}

/// The bad corner that stands out most.
fn worst_bad_corner(problem: &Problem, state: &State) -> Option<(usize, usize)> {
    let norms: Vec<Vec<(usize, f64)>> = problem
        .views
        .iter()
        .enumerate()
        .map(|(v, view)| {
            let active = view.corners.iter().enumerate().filter(|(_, c)| !c.left_out);
            active.map(|(i, c)| (i, state.residual(v, c).map_or(f64::INFINITY, |r| r.norm()))).collect()
        })
        .collect();
    let overall = median(norms.iter().flatten().map(|(_, r)| *r).collect())? / RAYLEIGH_MEDIAN;
    let mut worst: Option<((usize, usize), f64)> = None;
    for (v, view) in norms.iter().enumerate() {
        let Some(own) = median(view.iter().map(|(_, r)| *r).collect()) else { continue };
        let scale = overall.max(own / RAYLEIGH_MEDIAN);
        for &(i, norm) in view {
            let sigmas = norm / scale;
            if sigmas > BAD_CORNER_SIGMAS && worst.is_none_or(|(_, most)| sigmas > most) {
                worst = Some(((v, i), sigmas));
            }
        }
    }
    worst.map(|(place, _)| place)
}

/// Median; `None` of nothing.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}
