//! How the right eye has turned in its place against the left one since a calibration.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use plumbline_model::{Pose, StereoCameras};

use super::matches::{HealthError, LEAST_MATCHES, Match};
use crate::locate::NoBaseline;

/// How an eye turns that nobody has dropped: standard deviation of each angle before anything is seen, rad.
const USUAL_TURN_RAD: f64 = 0.05;
/// Matches are never known better than this across their plane, px: lens blur and mosaic leave no trace in
/// the brightness of a patch.
const LEAST_SIGMA_PX: f64 = 0.05;
/// Residuals beyond this are what went wrong, in standard deviations (Cauchy; Huber and Ronchetti 2009).
const CAUCHY: f64 = 2.385;
const ROUNDS: usize = 20;
const CONVERGED_RAD: f64 = 1e-8;
const STEP_RAD: f64 = 1e-5;
/// Residuals count for no more than this in a mean, px: what is farther off is a wrong match.
const CAP_PX: f64 = 3.0;
/// Parts of the picture that are left out in turn to see how sure a turn is.
const PARTS: [usize; 2] = [4, 3];

/// A turn of the right eye about its own center, in its own axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Rotation vector, rad: x nods, y pans, z rolls.
    pub rotation_rad: Vector3<f64>,
    /// Covariance, rad².
    pub covariance_rad2: Matrix3<f64>,
}

impl Turn {
    /// Its size, rad.
    pub fn angle_rad(&self) -> f64 {
        self.rotation_rad.norm()
    }

    /// How far from none it is, in standard deviations (Mahalanobis 1936); `None`: they are not known.
    pub fn sigmas(&self) -> Option<f64> {
        let weighed = self.covariance_rad2.cholesky()?.solve(&self.rotation_rad);
        Some(self.rotation_rad.dot(&weighed).max(0.0).sqrt())
    }
}

/// The eyes after the right one has turned in its place.
pub fn turned(cameras: &StereoCameras, rotation_rad: &Vector3<f64>) -> StereoCameras {
    let mut isometry = cameras.right_from_left.isometry;
    let turn = UnitQuaternion::from_scaled_axis(*rotation_rad);
    isometry.rotation = turn * isometry.rotation;
    isometry.translation.vector = turn * isometry.translation.vector;
    StereoCameras { right_from_left: Pose::new(isometry), ..*cameras }
}

/// A match as directions.
struct Seen {
    left: Vector3<f64>,
    right: Vector3<f64>,
    sigma_px: f64,
    part: usize,
}

/// The planes through both eyes.
struct Planes {
    /// From the axes of the left eye to those with x along the baseline and z forward.
    from_left: Rotation3<f64>,
    left_from_right: Rotation3<f64>,
    focal_px: f64,
}

impl Planes {
    fn new(cameras: &StereoCameras) -> Result<Self, NoBaseline> {
        let left_from_right = cameras.right_from_left.isometry.inverse();
        let x = left_from_right.translation.vector.try_normalize(1e-9).ok_or(NoBaseline)?;
        let forward = Vector3::z() + left_from_right.rotation * Vector3::z();
        let z = (forward - x * forward.dot(&x)).try_normalize(1e-9).ok_or(NoBaseline)?;
        let axes = Matrix3::from_columns(&[x, z.cross(&x), z]);
        let (fx, fy) = cameras.left.model.focal_px();
        Ok(Self {
            from_left: Rotation3::from_matrix_unchecked(axes.transpose()),
            left_from_right: left_from_right.rotation.to_rotation_matrix(),
            focal_px: 0.5 * (fx + fy),
        })
    }

    /// How far the right ray leaves the plane of the left one, px of the left image, after the right eye has
    /// turned.
    fn residual_px(&self, seen: &Seen, rotation_rad: &Vector3<f64>) -> f64 {
        let before = Rotation3::new(*rotation_rad).inverse() * seen.right;
        let (left, right) = (self.from_left * seen.left, self.from_left * (self.left_from_right * before));
        let planes_rad = left.y.atan2(left.z) - right.y.atan2(right.z);
        planes_rad * left.y.hypot(left.z) * self.focal_px
    }
}

fn seen(cameras: &StereoCameras, matches: &[Match]) -> Vec<Seen> {
    let (width, height) = cameras.left.size_px();
    let part = |at: f64, side: u32, parts: usize| {
        ((at / f64::from(side) * parts as f64).max(0.0) as usize).min(parts.saturating_sub(1))
    };
    let directions = |found: &Match| {
        Some(Seen {
            left: cameras.left.unproject(found.left).ok()?,
            right: cameras.right.unproject(found.right).ok()?,
            sigma_px: found.sigma_px.hypot(LEAST_SIGMA_PX),
            part: part(found.left.v_px, height, PARTS[1]) * PARTS[0] + part(found.left.u_px, width, PARTS[0]),
        })
    };
    matches.iter().filter_map(directions).collect()
}

/// How the right eye has turned, from places that both eyes see.
///
/// The covariance is that of leaving out one part of the picture at a time (jackknife; Efron 1982): it holds
/// what a lens errs here and there, which the scatter of single matches does not.
///
/// # Errors
/// When there are too few matches, or they lie too close together.
pub fn fit_turn(cameras: &StereoCameras, matches: &[Match]) -> Result<Turn, HealthError> {
    let planes = Planes::new(cameras)?;
    let seen = seen(cameras, matches);
    if seen.len() < LEAST_MATCHES {
        return Err(HealthError::TooFew { found: seen.len(), needed: LEAST_MATCHES, pairs: pairs(matches) });
    }
    let (rotation_rad, inverse) =
        solve(&planes, &seen, None, Vector3::zeros()).ok_or(HealthError::NotDetermined)?;
    let parts: Vec<usize> =
        (0..PARTS[0] * PARTS[1]).filter(|part| seen.iter().any(|one| one.part == *part)).collect();
    let mut spread = Matrix3::zeros();
    for part in &parts {
        let (without, _) =
            solve(&planes, &seen, Some(*part), rotation_rad).ok_or(HealthError::NotDetermined)?;
        let off = without - rotation_rad;
        spread += off * off.transpose();
    }
    let count = parts.len() as f64;
    let covariance_rad2 = if parts.len() < 2 { inverse } else { spread * ((count - 1.0) / count) + inverse };
    Ok(Turn { rotation_rad, covariance_rad2 })
}

fn pairs(matches: &[Match]) -> usize {
    matches.iter().map(|found| found.pair + 1).max().unwrap_or(0)
}

/// Robust Gauss–Newton; the turn and the inverse of its normal equations.
fn solve(
    planes: &Planes,
    seen: &[Seen],
    without: Option<usize>,
    start: Vector3<f64>,
) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    let used: Vec<&Seen> = seen.iter().filter(|one| Some(one.part) != without).collect();
    let mut turn = start;
    for _ in 0..ROUNDS {
        let residuals: Vec<f64> = used.iter().map(|one| planes.residual_px(one, &turn)).collect();
        let scale = scale(&used, &residuals)?;
        let mut normal = Matrix3::identity() * USUAL_TURN_RAD.powi(-2);
        let mut right = -turn * USUAL_TURN_RAD.powi(-2);
        for (one, residual) in used.iter().zip(&residuals) {
            let slope = Vector3::from_fn(|axis, _| {
                let mut moved = turn;
                moved[axis] += STEP_RAD;
                (planes.residual_px(one, &moved) - residual) / STEP_RAD
            });
            let sigma_px = one.sigma_px * scale;
            let weight = 1.0 / (1.0 + (residual / (CAUCHY * sigma_px)).powi(2)) / sigma_px.powi(2);
            normal += slope * slope.transpose() * weight;
            right -= slope * (*residual * weight);
        }
        let factor = normal.cholesky()?;
        let delta = factor.solve(&right);
        turn += delta;
        if delta.norm() < CONVERGED_RAD {
            return Some((turn, factor.inverse()));
        }
    }
    None
}

/// By what stated standard deviations have to be multiplied so that the middle half fits; at least 1.
fn scale(used: &[&Seen], residuals: &[f64]) -> Option<f64> {
    let mut relative: Vec<f64> =
        used.iter().zip(residuals).map(|(one, residual)| (residual / one.sigma_px).abs()).collect();
    relative.sort_by(f64::total_cmp);
    relative.get(relative.len() / 2).map(|median| (1.4826 * median).max(1.0))
}

/// How far places leave the planes of a calibration, root of the mean square, px; wrong matches count for
/// three at most.
///
/// # Errors
/// When the eyes are in one place.
pub fn epipolar_px(cameras: &StereoCameras, matches: &[Match]) -> Result<f64, HealthError> {
    let planes = Planes::new(cameras)?;
    let seen = seen(cameras, matches);
    let square = |one: &Seen| planes.residual_px(one, &Vector3::zeros()).abs().min(CAP_PX).powi(2);
    Ok((seen.iter().map(square).sum::<f64>() / seen.len().max(1) as f64).sqrt())
}

/// By how many standard deviations the second calibration fits better than the first on the same matches;
/// negative: worse. Parts of the picture are left out in turn, because neighbors err together.
///
/// # Errors
/// When the eyes of a calibration are in one place.
pub fn fits_better_by(
    first: &StereoCameras,
    second: &StereoCameras,
    matches: &[Match],
) -> Result<f64, HealthError> {
    let mut parts = vec![(0.0, 0.0); PARTS[0] * PARTS[1]];
    let planes = [Planes::new(first)?, Planes::new(second)?];
    for found in matches {
        let one = std::slice::from_ref(found);
        let (Some(a), Some(b)) = (seen(first, one).pop(), seen(second, one).pop()) else { continue };
        // A robust loss: what is wrong by pixels tells nothing of tenths.
        let loss = |planes: &Planes, one: &Seen| {
            (planes.residual_px(one, &Vector3::zeros()) / (CAUCHY * one.sigma_px)).powi(2).ln_1p()
        };
        parts[a.part].0 += loss(&planes[0], &a) - loss(&planes[1], &b);
        parts[a.part].1 += 1.0;
    }
    let filled: Vec<(f64, f64)> = parts.into_iter().filter(|(_, count)| *count > 0.0).collect();
    let (sum, count) = filled.iter().fold((0.0, 0.0), |(s, n), (part, many)| (s + part, n + many));
    if filled.len() < 2 {
        return Ok(0.0);
    }
    let mean = sum / count;
    let without = |(part, many): &(f64, f64)| ((sum - part) / (count - many) - mean).powi(2);
    let groups = filled.len() as f64;
    let variance = filled.iter().map(without).sum::<f64>() * (groups - 1.0) / groups;
    Ok(if variance > 0.0 { mean / variance.sqrt() } else { 0.0 })
}
