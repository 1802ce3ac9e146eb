//! A calibrated pair of eyes.

use crate::camera::Camera;
use crate::frame::{LeftCamera, Pose, RightCamera};
use crate::pixel::Eye;

/// Two cameras and how they sit to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StereoCameras {
    /// Left eye.
    pub left: Camera,
    /// Right eye.
    pub right: Camera,
    /// Takes points in the left camera's frame to the right camera's (OpenCV's R, T).
    pub right_from_left: Pose<RightCamera, LeftCamera>,
}

impl StereoCameras {
    /// One of the two cameras.
    pub fn camera(&self, eye: Eye) -> &Camera {
        match eye {
            Eye::Left => &self.left,
            Eye::Right => &self.right,
        }
    }

    /// Distance between the two optical centers, in meters.
    pub fn baseline_m(&self) -> f64 {
        self.right_from_left.translation_m().norm()
    }
}
