//! The error of one row, as an operator would measure it.

use nalgebra::{DMatrix, DVector, Matrix2, Matrix3, Point3, Vector2, Vector3};
use plumbline_effects::Assumed;
use plumbline_effects::measurements::{Measurements, Observation, What};
use plumbline_model::decompose;

use crate::compare::of_arm;
use crate::floor::Floor;
use crate::seen::nominal_place_m;

/// Steps of the search for a place, at most.
const STEPS: usize = 20;
/// Step of its differences, m.
const STEP_M: f64 = 1e-4;

/// The error of a row under a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Judged {
    /// Touches: in the plane of the screen; places: on the table, of the place that the model makes
    /// of what the eyes saw; poses: in space; m. Eye points: mean of both eyes, px.
    pub error: f64,
    /// Measured less predicted as a displacement, robot frame, m.
    pub arrow_m: Vector3<f64>,
}

/// Judges a row; `None` where the model cannot say anything of it.
pub(crate) fn judged(measurements: &Measurements, row: &Observation, assumed: &Assumed) -> Option<Judged> {
    let residual = || -> Option<Vec<f64>> {
        let predicted = measurements.predict(row, assumed)?;
        Some(row.measured.iter().zip(&predicted).map(|(m, p)| m - p).collect())
    };
    match row.what {
        What::Touch | What::Pose | What::OrientedPose => {
            let residual = residual()?;
            let arrow_m = of_arm(measurements, row, &assumed.placements[row.session], &residual)?;
            let error = if row.what == What::Touch { residual[0].hypot(residual[1]) } else { arrow_m.norm() };
            Some(Judged { error, arrow_m })
        }
        What::Place => {
            let arrow_m = inferred_place_m(measurements, row, assumed)? - row.truth_m?;
            Some(Judged { error: arrow_m.x.hypot(arrow_m.y), arrow_m })
        }
        What::EyePoints => {
            let residual = residual()?;
            let error = 0.5 * (residual[0].hypot(residual[1]) + residual[2].hypot(residual[3]));
            let arrow_m = inferred_place_m(measurements, row, assumed)? - row.truth_m?;
            Some(Judged { error, arrow_m })
        }
    }
}

/// The place that a model infers from what the eyes saw, robot frame, m: where it would have to be
/// to be seen so. Gauss–Newton from where the nominal eyes put it.
pub(crate) fn inferred_place_m(
    measurements: &Measurements,
    row: &Observation,
    assumed: &Assumed,
) -> Option<Point3<f64>> {
    let mut at = nominal_place_m(measurements, row)?;
    for _ in 0..STEPS {
        let (miss, slope) = seen_from(measurements, row, assumed, at)?;
        let step = decompose::svd(slope, true, true)?.solve(&miss, 1e-12).ok()?;
        let step = Vector3::new(step[0], step[1], step[2]);
        if !step.iter().all(|value| value.is_finite()) {
            return None;
        }
        // Farther than this the tangent does not reach.
        at += step * (0.3 / step.norm().max(0.3));
        if step.norm() < 1e-7 {
            return Some(at);
        }
    }
    None
}

/// Measured less predicted if the place were there, and the slope of the prediction.
fn seen_from(
    measurements: &Measurements,
    row: &Observation,
    assumed: &Assumed,
    at: Point3<f64>,
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let mut there = row.clone();
    let mut seen = |at: Point3<f64>| {
        there.truth_m = Some(at);
        measurements.predict(&there, assumed).map(DVector::from_vec)
    };
    let here = seen(at)?;
    let mut slope = DMatrix::zeros(here.len(), 3);
    for k in 0..3 {
        let step = Vector3::ith(k, STEP_M);
        slope.set_column(k, &((seen(at + step)? - seen(at - step)?) / (2.0 * STEP_M)));
    }
    Some((DVector::from_column_slice(&row.measured) - here, slope))
}

/// Mean error that noise alone leaves in a row, in the unit of [`Judged::error`].
pub(crate) fn noise_of(
    measurements: &Measurements,
    row: &Observation,
    assumed: &Assumed,
    floor: &Floor,
    scale: f64,
) -> Option<f64> {
    let floor = floor.of(row.what)?;
    let sd: Vec<f64> = (0..row.what.len()).map(|c| floor.of_row(row, c) * scale).collect();
    match row.what {
        What::Touch => Some(mean_length_2d(Matrix2::from_diagonal(&[sd[0] * sd[0], sd[1] * sd[1]].into()))),
        What::Pose | What::OrientedPose => {
            Some(mean_length_3d(Matrix3::from_diagonal(&Vector3::from_fn(|c, _| sd[c] * sd[c]))))
        }
        What::EyePoints => {
            let eye = |a: f64, b: f64| mean_length_2d(Matrix2::from_diagonal(&[a * a, b * b].into()));
            Some(0.5 * (eye(sd[0], sd[1]) + eye(sd[2], sd[3])))
        }
        What::Place => {
            let (_, slope) = seen_from(measurements, row, assumed, row.truth_m?)?;
            let back = decompose::pseudo_inverse(slope, 1e-12)?;
            let noise = DMatrix::from_diagonal(&DVector::from_iterator(3, sd.iter().map(|s| s * s)));
            let spread = &back * noise * back.transpose();
            Some(mean_length_2d(spread.fixed_view::<2, 2>(0, 0).into_owned()))
        }
    }
}

/// Mean length of a normal vector in the plane: that of a round one, stretched by direction.
fn mean_length_2d(covariance: Matrix2<f64>) -> f64 {
    let eigen =
        decompose::symmetric_eigenvalues(covariance).unwrap_or_else(|| Vector2::repeat(f64::INFINITY));
    let count = 64;
    let sum: f64 = (0..count)
        .map(|k| {
            let (sine, cosine) = (std::f64::consts::TAU * f64::from(k) / f64::from(count)).sin_cos();
            (eigen[0] * cosine * cosine + eigen[1] * sine * sine).max(0.0).sqrt()
        })
        .sum();
    (std::f64::consts::PI / 2.0).sqrt() * sum / f64::from(count)
}

/// The same in space.
fn mean_length_3d(covariance: Matrix3<f64>) -> f64 {
    let eigen =
        decompose::symmetric_eigenvalues(covariance).unwrap_or_else(|| Vector3::repeat(f64::INFINITY));
    let count = 400;
    // Evenly over the sphere: the golden angle around, equal steps along the axis.
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let sum: f64 = (0..count)
        .map(|k| {
            let z = 1.0 - 2.0 * (f64::from(k) + 0.5) / f64::from(count);
            let (sine, cosine) = (golden * f64::from(k)).sin_cos();
            let flat = 1.0 - z * z;
            (flat * (eigen[0] * cosine * cosine + eigen[1] * sine * sine) + eigen[2] * z * z).max(0.0).sqrt()
        })
        .sum();
    (8.0 / std::f64::consts::PI).sqrt() * sum / f64::from(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_noise_has_the_mean_length_of_rayleigh_and_maxwell() {
        let sigma = 2.0e-3;
        let flat = mean_length_2d(Matrix2::identity() * sigma * sigma);
        assert!((flat - sigma * (std::f64::consts::PI / 2.0).sqrt()).abs() < 1e-9);
        let space = mean_length_3d(Matrix3::identity() * sigma * sigma);
        assert!((space - sigma * (8.0 / std::f64::consts::PI).sqrt()).abs() < 1e-9);
        // Along one direction only it is the mean of |x|.
        let line = mean_length_2d(Matrix2::new(sigma * sigma, 0.0, 0.0, 0.0));
        assert!((line - sigma * (2.0 / std::f64::consts::PI).sqrt()).abs() < 2e-3 * sigma);
    }
}
