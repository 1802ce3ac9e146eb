//! Views in which the board was elsewhere, and single bad points: found by their residuals.

use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::{JobContext, RejectedPair};

use super::error::MountError;
use super::optimizer::converge;
use super::prepare::{Prepared, sentences};
use super::problem::{Problem, State};
use crate::calibrate::median;

/// A view is out when its typical residual is this many times that of all views.
const TIMES_TYPICAL: f64 = 3.0;
/// Or when its head angles would have to be off by this many standard deviations.
const ANGLE_SIGMAS: f64 = 6.0;
/// Residuals below this never reject a view, px.
const ALWAYS_GOOD_PX: f64 = 0.15;
/// Share of the views that must agree.
const LEAST_AGREEING: f64 = 0.6;
/// A point is bad beyond this many standard deviations.
const BAD_POINT_SIGMAS: f64 = 6.0;
/// Median of a Rayleigh distribution in units of its one-axis standard deviation.
const RAYLEIGH_MEDIAN: f64 = 1.1774;

/// Takes out views that do not agree with the others, the worst first, until all do.
pub(super) fn reject_views(
    mut prepared: Prepared,
    fewest: usize,
    context: &dyn JobContext,
) -> Result<Prepared, MountError> {
    let offered = prepared.problem.views.len();
    loop {
        let state = converge(&prepared.problem, prepared.state.clone(), context)?;
        prepared.state = state;
        let Some(worst) = worst_view(&prepared.problem, &prepared.state) else { return Ok(prepared) };
        let reason = reason(&prepared, worst);
        let Prepared { problem, state, mut left_from_target, mut rejected } = prepared;
        rejected.push(RejectedPair { name: problem.views[worst].name.clone(), reason });
        left_from_target.remove(worst);
        let agreeing = problem.views.len() - 1;
        if agreeing < fewest || (agreeing as f64) < LEAST_AGREEING * offered as f64 {
            return Err(MountError::NoAgreement { agreeing, views: offered, rejected: sentences(&rejected) });
        }
        let (problem, state) = (problem.without_view(worst), state.without_view(worst));
        prepared = Prepared { problem, state, left_from_target, rejected };
    }
}

/// Lengths of the residuals of a view's points that count, px; infinite where the lens cannot see.
fn norms(problem: &Problem, state: &State, view: usize) -> Vec<f64> {
    let seen = problem.views[view].seen.iter().zip(problem.residuals(state, view));
    seen.filter(|(s, _)| !s.left_out).map(|(_, r)| r.map_or(f64::INFINITY, |r| r.norm())).collect()
}

fn worst_view(problem: &Problem, state: &State) -> Option<usize> {
    let medians: Vec<f64> =
        (0..problem.views.len()).map(|v| median(norms(problem, state, v)).unwrap_or(f64::INFINITY)).collect();
    let typical_px = median(medians.clone())?.max(ALWAYS_GOOD_PX);
    let angle_sd = [0, 1].map(|k| {
        let errors = state.angle_error_rad.iter().map(|e| e[k].abs()).collect();
        // 1.4826 times the median absolute value is the standard deviation of a normal.
        (1.4826_f64 * median(errors).unwrap_or(0.0)).max(problem.priors.angle_rad[k])
    });
    let badness = |v: usize| {
        let angle = (0..2).map(|k| state.angle_error_rad[v][k].abs() / angle_sd[k]).fold(0.0, f64::max);
        (medians[v] / typical_px / TIMES_TYPICAL).max(angle / ANGLE_SIGMAS)
    };
    let worst = (0..problem.views.len()).max_by(|a, b| badness(*a).total_cmp(&badness(*b)))?;
    (badness(worst) > 1.0).then_some(worst)
}

/// Why a view is out, from how far its target is from where the other views see it.
fn reason(prepared: &Prepared, view: usize) -> String {
    let Prepared { problem, state, left_from_target, .. } = prepared;
    let off_px = median(norms(problem, state, view)).unwrap_or(f64::INFINITY);
    if problem.priors.tip_m.is_some() {
        return format!(
            "its point is {off_px:.1} px from where the other views expect it: another point was marked, or the arm is not where its encoders say"
        );
    }
    let Some(seen) = &left_from_target[view] else {
        return format!(
            "its points are {off_px:.1} px from where the other views expect them: another point was marked, or the robot's base moved"
        );
    };
    let (moved_m, turned_rad) = displacement(problem, state, view, seen);
    format!(
        "sees the board {:.1} mm and {:.2}° away from where the other views see it: the board or the robot's base was moved, or the head was still turning",
        moved_m * 1e3,
        turned_rad.to_degrees()
    )
}

/// How far from its shared place a view sees the target's middle (m), and how much turned (rad).
fn displacement(problem: &Problem, state: &State, view: usize, seen: &Isometry3<f64>) -> (f64, f64) {
    let mut by_encoder = state.clone();
    by_encoder.angle_error_rad[view] = [0.0; 2];
    let place = problem.robot_from_head(&by_encoder, view) * state.head_from_left * seen;
    let middle = Point3::from(problem.points.iter().sum::<Vector3<f64>>() / problem.points.len() as f64);
    let moved = place * middle - state.robot_from_target * middle;
    (moved.norm(), place.rotation.angle_to(&state.robot_from_target.rotation))
}

/// Leaves out single points that are far off where the others of all views and of their own fit.
pub(super) fn leave_out_bad_points(problem: &mut Problem, state: &State) {
    let all: Vec<Vec<f64>> = (0..problem.views.len()).map(|v| norms(problem, state, v)).collect();
    let Some(overall) = median(all.iter().flatten().copied().collect()) else { return };
    for (v, norms) in all.into_iter().enumerate() {
        let own = median(norms.clone()).unwrap_or(overall);
        let limit_px = BAD_POINT_SIGMAS * overall.max(own) / RAYLEIGH_MEDIAN;
        let counted = problem.views[v].seen.iter_mut().filter(|s| !s.left_out);
        for (seen, norm_px) in counted.zip(norms) {
            seen.left_out = norm_px > limit_px.max(0.05);
        }
    }
}
