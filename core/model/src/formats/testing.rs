//! A made-up pair of eyes for the tests of this module.

use nalgebra::Vector3;

use crate::camera::{Camera, CameraModel, Fisheye};
use crate::frame::Pose;
use crate::stereo::StereoCameras;

/// Fisheye eyes with about NICO's field of view and baseline, slightly toed in.
pub(crate) fn nico_like() -> StereoCameras {
    let lens = |cx_px, k1| Fisheye {
        fx_px: 150.123_456_789_012_3,
        fy_px: 149.987_654_321_098_7,
        cx_px,
        cy_px: 238.1,
        skew_px: 0.0,
        k: [k1, -0.008, 1.7e-3, -2.6e-4],
    };
    let camera =
        |cx_px, k1| Camera { model: CameraModel::Fisheye(lens(cx_px, k1)), width_px: 640, height_px: 480 };
    StereoCameras {
        left: camera(321.3, -0.0084),
        right: camera(317.7, -0.0091),
        right_from_left: Pose::from_rotation_vector(
            Vector3::new(0.004, -0.021, 0.013),
            Vector3::new(-0.069_93, 0.000_4, -0.000_7),
        ),
    }
}
