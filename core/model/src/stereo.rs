//! A calibrated pair of eyes.

use crate::camera::Camera;
use crate::frame::{LeftCamera, Point, Pose, RightCamera};
use crate::pixel::{Eye, Pixel, Raw};

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

    /// The point where the rays of two pixels come closest (middle of their shortest connection);
    /// `None` if they do not meet in front of both eyes.
    pub fn triangulate(&self, left: Pixel<Raw>, right: Pixel<Raw>) -> Option<Point<LeftCamera>> {
        let ray_left = self.left.unproject(left).ok()?;
        let left_from_right = self.right_from_left.isometry.inverse();
        let ray_right = left_from_right.rotation * self.right.unproject(right).ok()?;
        let origin = left_from_right.translation.vector;
        let cosine = ray_left.dot(&ray_right);
        let denominator = 1.0 - cosine * cosine;
        if denominator < 1e-12 {
            return None;
        }
        let (a, b) = (ray_left.dot(&origin), ray_right.dot(&origin));
        let (s, t) = ((a - cosine * b) / denominator, (cosine * a - b) / denominator);
        let middle = 0.5 * (ray_left * s + origin + ray_right * t);
        (s > 0.0 && t > 0.0).then(|| Point::new(middle.x, middle.y, middle.z))
    }

    /// Distance between the two optical centers, in meters.
    pub fn baseline_m(&self) -> f64 {
        self.right_from_left.translation_m().norm()
    }
}
