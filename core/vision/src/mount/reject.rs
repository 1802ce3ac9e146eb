//! Views in which the board was elsewhere, and single bad points: found by their residuals.

use nalgebra::{Isometry3, Matrix2, Point3, Vector2, Vector3};
use plumbline_model::{Cancelled, JobContext, RejectedPair};

use super::error::MountError;
use super::optimizer::{converge, covariance};
use super::prepare::{Prepared, sentences};
use super::problem::{Problem, State, View};
use crate::calibrate::median;

/// A view of many points is out when its typical residual is this many times that of views fitted
/// alone.
const TIMES_TYPICAL: f64 = 3.0;
/// More is allowed to the median of few points: this, over the root of their number.
const TIMES_OF_FEW: f64 = 6.0;
/// Rounds of adapting the scatter of the head angles.
const WIDENINGS: usize = 3;
/// Largest scatter of head angles that gears explain, rad: a third of a degree of slack.
const MOST_SLACK_RAD: f64 = 0.005;
/// Or when its head angles would have to be off by this many standard deviations.
const ANGLE_SIGMAS: f64 = 6.0;
/// Views beyond this many standard deviations are judged by the others, this many at a time.
const SUSPECT_SIGMAS: f64 = 2.5;
const SUSPECTS: usize = 3;
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
    let stated_rad = prepared.problem.priors.angle_rad;
    loop {
        widen(&mut prepared, stated_rad, context)?;
        let worst = worst_view(&prepared, stated_rad, context)?;
        prepared.problem.priors.angle_rad = stated_rad;
        let Some(worst) = worst else { return Ok(prepared) };
        let Prepared { mut problem, state, mut own_fit, mut rejected } = prepared;
        let off_px = median(norms(&problem, &state, worst)).unwrap_or(f64::INFINITY);
        let view = problem.views.remove(worst);
        let own = own_fit.remove(worst);
        let state = converge(&problem, state.without_view(worst), context)?;
        let reason = reason(&problem, &state, &view, own.map(|fit| fit.left_from_target), off_px);
        rejected.push(RejectedPair { name: view.name, reason });
        let agreeing = problem.views.len();
        if agreeing < fewest || (agreeing as f64) < LEAST_AGREEING * offered as f64 {
            return Err(MountError::NoAgreement { agreeing, views: offered, rejected: sentences(&rejected) });
        }
        prepared = Prepared { problem, state, own_fit, rejected };
    }
}

/// Solves, and adapts the scatter of the head angles: where all of them scatter more than stated,
/// no single view is to blame for it.
fn widen(prepared: &mut Prepared, stated_rad: [f64; 2], context: &dyn JobContext) -> Result<(), Cancelled> {
    prepared.state = converge(&prepared.problem, prepared.state.clone(), context)?;
    for _ in 0..WIDENINGS {
        let scatter_rad = scatter(&prepared.state, stated_rad, None);
        if scatter_rad == prepared.problem.priors.angle_rad {
            break;
        }
        prepared.problem.priors.angle_rad = scatter_rad;
        prepared.state = converge(&prepared.problem, prepared.state.clone(), context)?;
    }
    Ok(())
}

/// Lengths of the residuals of a view's points that count, px; infinite where the lens cannot see.
fn norms(problem: &Problem, state: &State, view: usize) -> Vec<f64> {
    let seen = problem.views[view].seen.iter().zip(problem.residuals(state, view));
    seen.filter(|(s, _)| !s.left_out).map(|(_, r)| r.map_or(f64::INFINITY, |r| r.norm())).collect()
}

/// The view that agrees least with the others, if it does not agree.
fn worst_view(
    prepared: &Prepared,
    stated_rad: [f64; 2],
    context: &dyn JobContext,
) -> Result<Option<usize>, Cancelled> {
    let Prepared { problem, state, own_fit, .. } = prepared;
    let count = problem.views.len();
    let medians: Vec<f64> =
        (0..count).map(|v| median(norms(problem, state, v)).unwrap_or(f64::INFINITY)).collect();
    // What views miss a board by that may be anywhere for each of them is what is left of the noise,
    // even if the board never lay still.
    let alone = own_fit.iter().flatten().map(|fit| RAYLEIGH_MEDIAN / std::f64::consts::SQRT_2 * fit.rms_px);
    let Some(typical_px) = median(alone.collect()).or_else(|| median(medians.clone())) else {
        return Ok(None);
    };
    let by_residual = |v: &usize| {
        let points = problem.views[*v].seen.len().max(1) as f64;
        let limit = TIMES_TYPICAL + TIMES_OF_FEW / points.sqrt();
        medians[*v] / (limit * typical_px.max(ALWAYS_GOOD_PX))
    };
    let worst = (0..count).max_by(|a, b| by_residual(a).total_cmp(&by_residual(b)));
    if let Some(worst) = worst.filter(|v| by_residual(v) > 1.0) {
        return Ok(Some(worst));
    }
    // A small push of the board looks like an error of the head angles, and bends the others' too:
    // the views whose angles stand out are judged by the others alone.
    let mut by_angle: Vec<(usize, f64)> = (0..count)
        .map(|v| (v, angle_sigmas(&state.angle_error_rad[v], &scatter(state, stated_rad, Some(v)))))
        .collect();
    by_angle.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut worst: Option<(usize, f64)> = None;
    for (v, _) in by_angle.into_iter().take(SUSPECTS).filter(|(_, sigmas)| *sigmas > SUSPECT_SIGMAS) {
        let sigmas = sigmas_by_others(problem, state, v, stated_rad, context)?;
        if sigmas > ANGLE_SIGMAS && worst.is_none_or(|(_, most)| sigmas > most) {
            worst = Some((v, sigmas));
        }
    }
    Ok(worst.map(|(v, _)| v))
}

/// Typical error of the head angles in all views, or all but one, rad: rms of the smaller four
/// fifths, as large as that of all would be if they were normal; not below what is stated, nor
/// beyond what gears do.
fn scatter(state: &State, stated_rad: [f64; 2], without: Option<usize>) -> [f64; 2] {
    const SHARE: f64 = 0.8;
    const OF_NORMAL: f64 = 1.511;
    [0, 1].map(|k| {
        let others = state.angle_error_rad.iter().enumerate().filter(|(v, _)| Some(*v) != without);
        let mut squares: Vec<f64> = others.map(|(_, e)| e[k].powi(2)).collect();
        squares.sort_by(f64::total_cmp);
        squares.truncate((SHARE * squares.len() as f64).ceil() as usize);
        let mean = squares.iter().sum::<f64>() / f64::max(squares.len() as f64, 1.0);
        (OF_NORMAL * mean.sqrt()).min(MOST_SLACK_RAD).max(stated_rad[k])
    })
}

fn angle_sigmas(error_rad: &[f64; 2], sd_rad: &[f64; 2]) -> f64 {
    (error_rad[0] / sd_rad[0]).hypot(error_rad[1] / sd_rad[1])
}

/// By how many standard deviations a view's head angles miss what the other views expect of them.
fn sigmas_by_others(
    problem: &Problem,
    state: &State,
    view: usize,
    stated_rad: [f64; 2],
    context: &dyn JobContext,
) -> Result<f64, Cancelled> {
    let asked = Problem { unknown_angles: Some(view), ..problem.clone() };
    let free = converge(&asked, state.clone(), context)?;
    let sd_rad = scatter(&free, stated_rad, Some(view));
    let Some(covariance) = covariance(&asked, &free) else { return Ok(0.0) };
    let at = asked.layout().angle(view, 0);
    let own = Matrix2::from_diagonal(&Vector2::new(sd_rad[0].powi(2), sd_rad[1].powi(2)));
    let total: Matrix2<f64> = covariance.fixed_view::<2, 2>(at, at) + own;
    let error = Vector2::from(free.angle_error_rad[view]);
    Ok(total.cholesky().map_or(0.0, |factor| error.dot(&factor.solve(&error)).sqrt()))
}

/// Why a view is out, from how far its target is from where the other views see it.
fn reason(
    problem: &Problem,
    state: &State,
    view: &View,
    left_from_target: Option<Isometry3<f64>>,
    off_px: f64,
) -> String {
    if problem.priors.tip_m.is_some() {
        return format!(
            "its point is {off_px:.1} px from where the other views expect it: another point was marked, or the arm is not where its encoders say"
        );
    }
    let Some(seen) = left_from_target else {
        return format!(
            "its points are {off_px:.1} px from where the other views expect them: another point was marked, or the robot's base moved"
        );
    };
    let mut angles = view.encoder_rad.clone();
    for (joint, zero_rad) in problem.neck.pan_tilt.into_iter().zip(state.zeros_rad) {
        angles[joint] += zero_rad;
    }
    let place = problem.neck.chain.robot_from_tip(&angles).isometry * state.head_from_left * seen;
    let middle = Point3::from(problem.points.iter().sum::<Vector3<f64>>() / problem.points.len() as f64);
    format!(
        "sees the board {:.1} mm and {:.2}° away from where the other views see it: the board or the robot's base was moved, or the head was still turning",
        (place * middle - state.robot_from_target * middle).norm() * 1e3,
        place.rotation.angle_to(&state.robot_from_target.rotation).to_degrees()
    )
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
