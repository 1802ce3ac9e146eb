//! Levenberg–Marquardt, and the standard deviations of pixels and head angles from the residuals.

use nalgebra::{DMatrix, DVector};
use plumbline_model::{Cancelled, JobContext};

use super::problem::{Problem, State};

const MOST_ITERATIONS: usize = 200;
const RELATIVE_IMPROVEMENT: f64 = 1e-11;
const MOST_DAMPING: f64 = 1e12;
/// No image measures better than this; keeps perfect data from claiming infinite weight.
const LEAST_PIXEL_PX: f64 = 0.003;
/// Rounds of estimating standard deviations and solving again.
const ROUNDS: usize = 6;

/// Solves for the state of least cost near `state`.
pub(super) fn converge(
    problem: &Problem,
    mut state: State,
    context: &dyn JobContext,
) -> Result<State, Cancelled> {
    let mut cost = problem.cost(&state);
    let mut damping = 1e-4;
    for _ in 0..MOST_ITERATIONS {
        context.checkpoint()?;
        let (matrix, right) = problem.normal_equations(&state);
        let mut improvement = 0.0;
        while damping < MOST_DAMPING {
            let mut damped = matrix.clone();
            for i in 0..damped.nrows() {
                damped[(i, i)] *= 1.0 + damping;
            }
            if let Some(factor) = damped.cholesky() {
                let next = problem.moved(&state, &factor.solve(&right));
                let next_cost = problem.cost(&next);
                if next_cost.is_finite() && next_cost <= cost {
                    improvement = (cost - next_cost) / cost.max(f64::MIN_POSITIVE);
                    (state, cost) = (next, next_cost);
                    damping = (damping * 0.1).max(1e-12);
                    break;
                }
            }
            damping *= 10.0;
        }
        if improvement < RELATIVE_IMPROVEMENT {
            break;
        }
    }
    Ok(state)
}

/// Inverse of the normal matrix; `None` if some combination of parameters is left open.
pub(super) fn covariance(problem: &Problem, state: &State) -> Option<DMatrix<f64>> {
    let (matrix, _) = problem.normal_equations(state);
    // Scale to unit diagonal first: radians, meters and weak priors differ by many orders.
    let scale = DVector::from_iterator(matrix.nrows(), matrix.diagonal().iter().map(|d| 1.0 / d.sqrt()));
    if !scale.iter().all(|s| s.is_finite()) {
        return None;
    }
    let d = DMatrix::from_diagonal(&scale);
    let inverse = (&d * matrix * &d).cholesky()?.inverse();
    Some(&d * inverse * &d)
}

/// A solution with standard deviations that agree with its residuals.
pub(super) struct Solved {
    pub problem: Problem,
    pub state: State,
    /// Of all parameters.
    pub covariance: DMatrix<f64>,
}

/// Solves, and lets the residuals tell how large pixel and angle errors are (estimation of
/// variance components, Förstner 1979). Angle errors are never taken for smaller than the options
/// say, and for larger only when chance does not explain them.
pub(super) fn solve_with_noise(
    mut problem: Problem,
    mut state: State,
    context: &dyn JobContext,
) -> Result<Option<Solved>, Cancelled> {
    let stated_rad = problem.priors.angle_rad;
    for _ in 0..ROUNDS {
        state = converge(&problem, state, context)?;
        let Some(covariance) = covariance(&problem, &state) else { return Ok(None) };
        let next = noise(&problem, &state, &covariance, stated_rad);
        let Some((pixel_px, angle_rad)) = next else { return Ok(None) };
        let change = (pixel_px / problem.priors.pixel_px).ln().abs()
            + (0..2).map(|k| (angle_rad[k] / problem.priors.angle_rad[k]).ln().abs()).sum::<f64>();
        problem.priors.pixel_px = pixel_px;
        problem.priors.angle_rad = angle_rad;
        if change < 1e-3 {
            break;
        }
    }
    state = converge(&problem, state, context)?;
    Ok(covariance(&problem, &state).map(|covariance| Solved { problem, state, covariance }))
}

/// Standard deviations of a pixel's coordinate (px) and of pan and tilt (rad), from residuals and
/// the share of them that the parameters have swallowed.
fn noise(
    problem: &Problem,
    state: &State,
    covariance: &DMatrix<f64>,
    stated_rad: [f64; 2],
) -> Option<(f64, [f64; 2])> {
    let priors = problem.priors(state);
    // Trace of the hat matrix of the pixels: all parameters less what the priors determine.
    let by_priors: f64 = priors.iter().map(|p| covariance[(p.index, p.index)] / p.sd.powi(2)).sum();
    let redundancy = problem.measurement_count() as f64 - (covariance.nrows() as f64 - by_priors);
    if redundancy < 1.0 {
        return None;
    }
    let mut squares = 0.0;
    for (v, view) in problem.views.iter().enumerate() {
        for (seen, residual) in view.seen.iter().zip(problem.residuals(state, v)) {
            if !seen.left_out {
                squares += residual?.norm_squared();
            }
        }
    }
    let pixel_px = (squares / redundancy).sqrt().max(LEAST_PIXEL_PX);
    let layout = problem.layout();
    let angle_rad = [0, 1].map(|k| {
        let sd = problem.priors.angle_rad[k];
        let of_views = 0..problem.views.len();
        let swallowed: f64 =
            of_views.map(|v| layout.angle(v, k)).map(|i| covariance[(i, i)] / sd.powi(2)).sum();
        let redundancy = problem.views.len() as f64 - swallowed;
        let squares: f64 = state.angle_error_rad.iter().map(|e| e[k].powi(2)).sum();
        // Below one degree of freedom nothing can be told.
        if redundancy < 1.0 {
            return stated_rad[k];
        }
        let estimate = (squares / redundancy).sqrt();
        // 99 % of a chi-square of that redundancy lie below (Wilson and Hilferty 1931).
        let c = 2.0 / (9.0 * redundancy);
        let limit = (1.0 - c + 2.33 * c.sqrt()).powi(3).sqrt();
        if estimate > limit * stated_rad[k] { estimate } else { stated_rad[k] }
    });
    Some((pixel_px, angle_rad))
}
