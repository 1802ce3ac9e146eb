//! From lines across the rim to the place of the hand: Gauss–Newton with robust weights, and what
//! was known before as regularization.
//!
//! Beside the three coordinates that are asked for, the hand's turn and the sizes of its parts are
//! unknown too: they have assumptions of their own and are integrated out, so that a palm that is
//! narrower than described, or a wrist that is off by some degrees, does not pass for a shift, and
//! the size of the hand does not pass for its distance.

use nalgebra::{
    DMatrix, DVector, Isometry3, Matrix3, Matrix3xX, Point3, Translation3, UnitQuaternion, Vector3,
};
use plumbline_model::frame::{Robot, Tip};
use plumbline_model::{Camera, Pose, decompose};

use super::HandOptions;
use super::lines::Crossing;
use super::shape::{Part, Solid};
use super::view::RimPoint;

/// Shift (robot axes, m), turn (rotation vector about the tip, robot axes, rad), half extents of the
/// palm beyond the description (its own axes, m), radius of digits beyond the description (m), and of
/// every digit its shift on the hand (axes of the tip, m).
pub(super) type Unknowns = DVector<f64>;
type Square = DMatrix<f64>;

/// Places in [`Unknowns`].
const TURN: usize = 3;
const PALM: usize = 6;
const RADIUS: usize = 9;
const DIGITS: usize = 10;

/// Nothing found yet.
pub(super) fn nothing(solids: &[Solid]) -> Unknowns {
    Unknowns::zeros(DIGITS + 3 * solids.iter().filter(|solid| solid.digit.is_some()).count())
}

/// Coordinates `first` to `first + 2`.
pub(super) fn three(unknowns: &Unknowns, first: usize) -> Vector3<f64> {
    unknowns.fixed_rows::<3>(first).into_owned()
}

/// Shapes of the description, resized, and real ones differ by this much at a point of the rim, px.
const SHAPE_PX: f64 = 0.6;
/// Over this length of rim they differ in the same way, px.
const ALIKE_PX: f64 = 5.0;
/// Residuals beyond this many robust standard deviations count less and less (Tukey's biweight).
const TUKEY: f64 = 4.0;

/// A line across the rim with what was found on it.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    pub eye: plumbline_model::Eye,
    pub point: RimPoint,
    pub crossing: Crossing,
    /// How the place of the rim along the line changes with the unknowns, px per unit.
    pub slope: Unknowns,
}

/// What is assumed before looking.
#[derive(Clone, Debug)]
pub(super) struct Prior {
    information: Square,
}

impl Prior {
    /// `None` when the covariance cannot be inverted.
    pub fn new(covariance_m2: &Matrix3<f64>, solids: &[Solid], options: &HandOptions) -> Option<Self> {
        let symmetric = 0.5 * (covariance_m2 + covariance_m2.transpose());
        let eigenvalues = decompose::symmetric_eigenvalues(symmetric)?;
        if !(eigenvalues.min() > 0.0) {
            return None;
        }
        let count = nothing(solids).len();
        let mut information = Square::zeros(count, count);
        information.fixed_view_mut::<3, 3>(0, 0).copy_from(&symmetric.try_inverse()?);
        for k in 0..3 {
            information[(TURN + k, TURN + k)] = options.sigma_turn_rad.powi(-2);
            information[(PALM + k, PALM + k)] = options.sigma_palm_m.powi(-2);
        }
        information[(RADIUS, RADIUS)] = options.sigma_radius_m.powi(-2);
        for (digit, solid) in solids.iter().filter_map(|solid| Some((solid.digit?, solid))) {
            let sigma_m = options.sigma_digit_m + options.sigma_bent_m * solid.bend_rad;
            for k in DIGITS + 3 * digit..DIGITS + 3 * digit + 3 {
                information[(k, k)] = sigma_m.powi(-2);
            }
        }
        Some(Self { information })
    }
}

/// What was found.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    pub unknowns: Unknowns,
    pub covariance: Square,
    /// Robust standard deviation of the lines' residuals, px.
    pub spread_px: f64,
    /// Weight that each line had against one with nothing odd about it, 0–1.
    pub weights: Vec<f64>,
    /// Residuals, px.
    pub residuals: Vec<f64>,
}

/// The predicted place, moved.
pub(super) fn moved(predicted: &super::Predicted<'_>, unknowns: &Unknowns) -> Pose<Robot, Tip> {
    let shift = predicted.robot_from_tip.translation_m() + three(unknowns, 0);
    let turn = UnitQuaternion::from_scaled_axis(three(unknowns, TURN));
    Pose::new(Isometry3::from_parts(
        Translation3::from(shift),
        turn * predicted.robot_from_tip.isometry.rotation,
    ))
}

/// The hand's solids with other sizes.
pub(super) fn resized(solids: &[Solid], unknowns: &Unknowns) -> Vec<Solid> {
    let palm_m = three(unknowns, PALM);
    let of_part = |solid: &Solid| match (solid.part, solid.digit) {
        (Part::Palm, _) => solid.grown(&palm_m),
        (Part::Digit, Some(digit)) => {
            let mut solid = solid.grown(&Vector3::repeat(unknowns[RADIUS]));
            solid.tip_from_shape.translation.vector += three(unknowns, DIGITS + 3 * digit);
            solid
        }
        _ => *solid,
    };
    solids.iter().map(of_part).collect()
}

/// Slopes of a rim point for a hand at `robot_from_tip`.
pub(super) fn slope(
    point: &RimPoint,
    solid: &Solid,
    camera: &Camera,
    camera_from_robot: &Isometry3<f64>,
    robot_from_tip: &Pose<Robot, Tip>,
    count: usize,
) -> Option<Unknowns> {
    let arm = robot_from_tip.isometry.rotation * point.in_tip;
    let in_camera = camera_from_robot * Point3::from(robot_from_tip.translation_m() + arm);
    let projection = camera.model.project_with_jacobian(&in_camera.coords).ok()?;
    let turn = camera_from_robot.rotation.to_rotation_matrix();
    let by_point = point.normal.transpose() * projection.by_point;
    let by_shift = by_point * turn.matrix();
    let by_turn = -(by_shift * arm.cross_matrix());
    let mut slope = Unknowns::zeros(count);
    for k in 0..3 {
        slope[k] = by_shift[k];
        slope[TURN + k] = by_turn[k];
    }
    if solid.part == Part::Palm {
        let in_shape = solid.tip_from_shape.inverse() * Point3::from(point.in_tip);
        let axes = (robot_from_tip.isometry.rotation * solid.tip_from_shape.rotation).to_rotation_matrix();
        let half_m = solid.half_m();
        for k in 0..3 {
            let outward = axes.matrix().column(k) * (in_shape[k] / half_m[k]).clamp(-1.0, 1.0);
            slope[PALM + k] = by_shift.dot(&outward.transpose());
        }
    } else {
        slope[RADIUS] = by_point.norm();
    }
    if let Some(digit) = solid.digit {
        let by_digit = by_shift * robot_from_tip.isometry.rotation.to_rotation_matrix().matrix();
        (0..3).for_each(|k| slope[DIGITS + 3 * digit + k] = by_digit[k]);
    }
    Some(slope)
}

/// One step from where the rim was taken (`at`).
pub(super) fn solve(lines: &[Measured], prior: &Prior, at: &Unknowns) -> Option<Solution> {
    let target: Vec<f64> = lines.iter().map(|line| line.crossing.shift_px + line.slope.dot(at)).collect();
    let mut weights = vec![1.0; lines.len()];
    let mut solution = None;
    for _ in 0..ROUNDS {
        let mut normal = prior.information.clone();
        let mut right = Unknowns::zeros(at.len());
        for ((line, target), weight) in lines.iter().zip(&target).zip(&weights) {
            let weight = weight * information(line);
            normal.syger(weight, &line.slope, &line.slope, 1.0);
            right.axpy(weight * target, &line.slope, 1.0);
        }
        let covariance = normal.cholesky()?.inverse();
        let unknowns = &covariance * right;
        let residuals: Vec<f64> =
            lines.iter().zip(&target).map(|(line, target)| target - line.slope.dot(&unknowns)).collect();
        let spread_px = spread(&residuals);
        for (weight, residual) in weights.iter_mut().zip(&residuals) {
            let share = residual / (TUKEY * spread_px);
            *weight = if share.abs() < 1.0 { (1.0 - share * share).powi(2) } else { 0.0 };
        }
        solution = Some(Solution { unknowns, covariance, spread_px, weights: weights.clone(), residuals });
    }
    let mut solution = solution.filter(|found| found.unknowns.iter().all(|value| value.is_finite()))?;
    scale(&mut solution, lines, prior);
    Some(solution)
}

/// Rounds of weighting.
const ROUNDS: usize = 6;

/// Weight of a line, 1/px²: what it says, no better than shapes are known, and shared with its neighbors.
fn information(line: &Measured) -> f64 {
    let variance = 1.0 / line.crossing.information + SHAPE_PX * SHAPE_PX;
    line.point.length_px / ALIKE_PX / variance
}

/// Where lines disagree by more than was assumed, they count for less.
fn scale(solution: &mut Solution, lines: &[Measured], prior: &Prior) {
    let (mut square, mut count) = (0.0, 0.0);
    for ((line, residual), weight) in lines.iter().zip(&solution.residuals).zip(&solution.weights) {
        let weight = weight * information(line);
        square += weight * residual * residual;
        count += weight * (1.0 / line.crossing.information + SHAPE_PX * SHAPE_PX);
    }
    let factor = if count > 0.0 { (square / count).max(1.0) } else { 1.0 };
    let mut normal = prior.information.clone();
    for (line, weight) in lines.iter().zip(&solution.weights) {
        normal.syger(weight * information(line) / factor, &line.slope, &line.slope, 1.0);
    }
    if let Some(factors) = normal.cholesky() {
        solution.covariance = factors.inverse();
    }
}

/// Robust standard deviation about zero; no less than half a pixel.
fn spread(residuals: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = residuals.iter().map(|residual| residual.abs()).collect();
    if sizes.is_empty() {
        return 0.5;
    }
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f64::total_cmp);
    (1.4826 * *median).max(0.5)
}

/// Candidate shifts (columns, m) within some standard deviations of a prior covariance, no farther
/// apart than `step_m` unless that would be too many.
pub(super) fn candidates(covariance_m2: &Matrix3<f64>, step_m: f64) -> Option<Matrix3xX<f64>> {
    let found = decompose::symmetric_eigen(*covariance_m2)?;
    let mut columns = vec![Vector3::zeros()];
    for k in 0..3 {
        let sigma = found.eigenvalues[k].max(0.0).sqrt();
        let axis: Vector3<f64> = found.eigenvectors.column(k).into_owned();
        let steps = ((SIGMAS * sigma / step_m).ceil() as i32).clamp(1, MOST_STEPS);
        let step = SIGMAS * sigma / f64::from(steps);
        columns = columns
            .iter()
            .flat_map(|from| (-steps..=steps).map(move |i| from + axis * (step * f64::from(i))))
            .collect();
    }
    Some(Matrix3xX::from_columns(&columns))
}

/// Candidates go this far, in standard deviations.
pub(super) const SIGMAS: f64 = 2.5;
/// Steps to each side along an axis.
const MOST_STEPS: i32 = 12;
