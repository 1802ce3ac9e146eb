//! What the eyes saw, where they put it.

use nalgebra::Point3;
use plumbline_effects::EyesDeviation;
use plumbline_effects::measurements::{Measurements, Observation, What};
use plumbline_model::Pixel;

/// Where the nominal eyes put what they saw, frame of the left camera, m.
pub fn nominal_in_left_m(measurements: &Measurements, row: &Observation) -> Option<Point3<f64>> {
    let eyes = measurements.apparatus(row).eyes.as_ref()?;
    match row.what {
        What::Place => eyes.place(&row.measured),
        What::EyePoints => {
            let [left_u, left_v, right_u, right_v] = *row.measured.first_chunk::<4>()?;
            let place = eyes.cameras.triangulate(Pixel::new(left_u, left_v), Pixel::new(right_u, right_v))?;
            Some(place.coords)
        }
        What::Touch | What::Pose | What::OrientedPose => None,
    }
}

/// The same, robot frame, m.
pub fn nominal_place_m(measurements: &Measurements, row: &Observation) -> Option<Point3<f64>> {
    let eyes = measurements.apparatus(row).eyes.as_ref()?;
    let in_left = nominal_in_left_m(measurements, row)?;
    Some(eyes.robot_from_left(&row.neck_rad, &EyesDeviation::none(eyes.neck.len())) * in_left)
}
