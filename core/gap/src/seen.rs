//! What the eyes saw, where they put it.

use nalgebra::Point3;
use plumbline_effects::EyesDeviation;
use plumbline_effects::measurements::{Measurements, Observation, What};
use plumbline_model::Pixel;

/// Where the nominal eyes put what they saw, robot frame, m.
pub fn nominal_place_m(measurements: &Measurements, row: &Observation) -> Option<Point3<f64>> {
    let eyes = measurements.apparatus(row).eyes.as_ref()?;
    let in_left = match row.what {
        What::Place => eyes.place(&row.measured)?,
        What::EyePoints => {
            let [left_u, left_v, right_u, right_v] = *row.measured.first_chunk::<4>()?;
            eyes.cameras.triangulate(Pixel::new(left_u, left_v), Pixel::new(right_u, right_v))?.coords
        }
        What::Touch | What::Pose | What::OrientedPose => return None,
    };
    Some(eyes.robot_from_left(&row.neck_rad, &EyesDeviation::none(eyes.neck.len())) * in_left)
}
