//! Residuals as arrows on the table.

use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_effects::measurements::{Measurements, Observation, What};

/// Where a row was measured, robot frame, m.
pub fn at_m(measurements: &Measurements, row: &Observation, placement: &Isometry3<f64>) -> [f64; 3] {
    let place = match row.what {
        What::Touch => measurements.apparatus(row).surface.as_ref().map(|surface| {
            let [u, v, normal] = surface.axes();
            surface.middle_m() + u * row.measured[0] + v * row.measured[1] + normal * row.screen_height_m
        }),
        What::Pose | What::OrientedPose => {
            let [x, y, z] = row.measured.first_chunk().copied().unwrap_or_default();
            Some(placement.inverse() * Point3::new(x, y, z))
        }
        What::Place | What::EyePoints => row.truth_m,
    };
    place.map_or([0.0; 3], |place| place.coords.into())
}

/// Measured less predicted natural coordinates of an arm's row as a displacement, robot frame, m:
/// for touches in the screen's plane, and the height along its normal.
pub fn of_arm(
    measurements: &Measurements,
    row: &Observation,
    placement: &Isometry3<f64>,
    residual: &[f64],
) -> Option<Vector3<f64>> {
    let residual = Vector3::new(*residual.first()?, *residual.get(1)?, *residual.get(2)?);
    match row.what {
        What::Touch => {
            let [u, v, normal] = measurements.apparatus(row).surface.as_ref()?.axes();
            Some(u * residual.x + v * residual.y + normal * residual.z)
        }
        What::Pose | What::OrientedPose => Some(placement.rotation.inverse() * residual),
        What::Place | What::EyePoints => None,
    }
}
