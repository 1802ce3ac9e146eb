//! Rays of both eyes in coordinates that follow the epipolar geometry, for any lens.
//!
//! Both eyes are turned so that x runs along the baseline. A ray then has a *plane angle* (rad,
//! about the baseline; the same for both eyes and every range) and an *along angle* (rad, from the
//! plane at right angles to the baseline, towards the right eye). A point's along angle is smaller
//! in the right eye than in the left; the difference gives its range. No pixel of the fisheye is
//! resampled to a flat image, so nothing is stretched.

use nalgebra::{Isometry3, Matrix3, Rotation3, Vector3};
use plumbline_model::{Eye, LeftCamera, Pixel, Point, ProjectError, Raw, StereoCameras};

/// Direction in epipolar coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EpipolarRay {
    /// Angle of the epipolar plane about the baseline, rad.
    pub plane_rad: f64,
    /// Angle from the plane at right angles to the baseline, towards the right eye, rad.
    pub along_rad: f64,
}

/// Turns pixels of either eye into epipolar rays and back.
#[derive(Clone, Debug)]
pub(crate) struct EpipolarGeometry {
    pub cameras: StereoCameras,
    /// From each eye's axes to the epipolar axes.
    epipolar_from_eye: [Rotation3<f64>; 2],
    pub baseline_m: f64,
}

impl EpipolarGeometry {
    /// `None` for a rig without a baseline.
    pub fn new(cameras: &StereoCameras) -> Option<Self> {
        let left_from_right: Isometry3<f64> = cameras.right_from_left.isometry.inverse();
        let x = left_from_right.translation.vector.try_normalize(1e-9)?;
        // Forward is half way between the two optical axes, made square to the baseline.
        let forward = Vector3::z() + left_from_right.rotation * Vector3::z();
        let z = (forward - x * forward.dot(&x)).try_normalize(1e-9)?;
        let y = z.cross(&x);
        let epipolar_from_left =
            Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z]).transpose());
        let left_from_right = left_from_right.rotation.to_rotation_matrix();
        Some(Self {
            cameras: *cameras,
            epipolar_from_eye: [epipolar_from_left, epipolar_from_left * left_from_right],
            baseline_m: cameras.baseline_m(),
        })
    }

    /// Ray of a raw pixel.
    pub fn ray(&self, eye: Eye, pixel: Pixel<Raw>) -> Result<EpipolarRay, ProjectError> {
        let direction = self.epipolar_from_eye[eye.index()] * self.cameras.camera(eye).unproject(pixel)?;
        Ok(EpipolarRay {
            plane_rad: direction.y.atan2(direction.z),
            along_rad: direction.x.atan2(direction.y.hypot(direction.z)),
        })
    }

    /// Raw pixel of a ray, whether or not it falls on the image.
    pub fn pixel(&self, eye: Eye, ray: &EpipolarRay) -> Result<Pixel<Raw>, ProjectError> {
        let (sin_along, cos_along) = ray.along_rad.sin_cos();
        let (sin_plane, cos_plane) = ray.plane_rad.sin_cos();
        let direction = Vector3::new(sin_along, cos_along * sin_plane, cos_along * cos_plane);
        self.cameras.camera(eye).project(&(self.epipolar_from_eye[eye.index()].inverse() * direction))
    }

    /// The point seen along `left` whose along angle in the right eye is smaller by
    /// `disparity_rad`; `None` if the rays do not meet in front of the eyes.
    pub fn point(&self, left: &EpipolarRay, disparity_rad: f64) -> Option<Point<LeftCamera>> {
        let spread = left.along_rad.tan() - (left.along_rad - disparity_rad).tan();
        if !(spread > 1e-9) {
            return None;
        }
        let distance_from_baseline_m = self.baseline_m / spread;
        let (sin_plane, cos_plane) = left.plane_rad.sin_cos();
        let in_epipolar = Vector3::new(left.along_rad.tan(), sin_plane, cos_plane) * distance_from_baseline_m;
        let in_left = self.epipolar_from_eye[0].inverse() * in_epipolar;
        Some(Point::new(in_left.x, in_left.y, in_left.z))
    }

    /// Ray in the other eye of the point that lies along `ray` of the eye `from`, this far from the
    /// baseline.
    pub fn in_other_eye(&self, from: Eye, ray: &EpipolarRay, distance_from_baseline_m: f64) -> EpipolarRay {
        let shift = self.baseline_m / distance_from_baseline_m;
        let along_rad = match from {
            Eye::Left => (ray.along_rad.tan() - shift).atan(),
            Eye::Right => (ray.along_rad.tan() + shift).atan(),
        };
        EpipolarRay { along_rad, ..*ray }
    }

    /// Disparity of a point this far from the baseline, rad.
    pub fn disparity_rad(&self, left: &EpipolarRay, distance_from_baseline_m: f64) -> f64 {
        left.along_rad - (left.along_rad.tan() - self.baseline_m / distance_from_baseline_m).atan()
    }
}
