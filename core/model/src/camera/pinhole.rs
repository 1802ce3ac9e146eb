//! Perspective camera with radial and tangential distortion (Brown 1966, as in OpenCV's
//! `calib3d`: k1, k2, p1, p2, k3).
//!
//! Assumes less than about 50° off the axis. Broken when the residuals grow towards the corners.

use nalgebra::{Matrix2, Matrix2x3, SMatrix, Vector2, Vector3};

use super::{MAX_PARAMETERS, ProjectError, ProjectionJacobian};
use crate::pixel::{Pixel, Raw};

/// Parameters of the pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinhole {
    /// Focal length in horizontal pixels.
    pub fx_px: f64,
    /// Focal length in vertical pixels.
    pub fy_px: f64,
    /// Column of the optical axis.
    pub cx_px: f64,
    /// Row of the optical axis.
    pub cy_px: f64,
    /// Radial distortion, r².
    pub k1: f64,
    /// Radial distortion, r⁴.
    pub k2: f64,
    /// Tangential distortion, first.
    pub p1: f64,
    /// Tangential distortion, second.
    pub p2: f64,
    /// Radial distortion, r⁶.
    pub k3: f64,
}

impl Pinhole {
    /// Without distortion.
    pub fn ideal(f_px: f64, cx_px: f64, cy_px: f64) -> Self {
        Self { fx_px: f_px, fy_px: f_px, cx_px, cy_px, k1: 0.0, k2: 0.0, p1: 0.0, p2: 0.0, k3: 0.0 }
    }

    fn distort(&self, n: Vector2<f64>) -> (Vector2<f64>, Matrix2<f64>) {
        let (x, y) = (n.x, n.y);
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (self.k1 + r2 * (self.k2 + r2 * self.k3));
        let slope = self.k1 + r2 * (2.0 * self.k2 + r2 * 3.0 * self.k3);
        let d = Vector2::new(
            x * radial + 2.0 * self.p1 * x * y + self.p2 * (r2 + 2.0 * x * x),
            y * radial + self.p1 * (r2 + 2.0 * y * y) + 2.0 * self.p2 * x * y,
        );
        let cross = 2.0 * x * y * slope + 2.0 * self.p1 * x + 2.0 * self.p2 * y;
        let jacobian = Matrix2::new(
            radial + 2.0 * x * x * slope + 2.0 * self.p1 * y + 6.0 * self.p2 * x,
            cross,
            cross,
            radial + 2.0 * y * y * slope + 6.0 * self.p1 * y + 2.0 * self.p2 * x,
        );
        (d, jacobian)
    }

    fn pixel_of(&self, d: Vector2<f64>) -> Pixel<Raw> {
        Pixel::new(self.fx_px * d.x + self.cx_px, self.fy_px * d.y + self.cy_px)
    }

    /// Normalized image point, refusing what lies behind or beyond a fold of the distortion.
    fn normalize(&self, point: &Vector3<f64>) -> Result<Vector2<f64>, ProjectError> {
        if !point.iter().all(|c| c.is_finite()) || point.norm_squared() == 0.0 {
            return Err(ProjectError::Undefined);
        }
        if point.z <= 0.0 {
            return Err(ProjectError::Behind { z: point.z });
        }
        let n = Vector2::new(point.x / point.z, point.y / point.z);
        let r = n.norm();
        let limit = self.limit_radius();
        if r >= limit {
            return Err(ProjectError::BeyondLens { theta_rad: r.atan(), limit_rad: limit.atan() });
        }
        Ok(n)
    }

    /// Radius (at z = 1) where the radial polynomial stops growing; infinite if it never does.
    fn limit_radius(&self) -> f64 {
        // d/dr (r + k1 r³ + k2 r⁵ + k3 r⁷) = 1 + 3 k1 s + 5 k2 s² + 7 k3 s³ with s = r².
        let slope = |s: f64| 1.0 + s * (3.0 * self.k1 + s * (5.0 * self.k2 + s * 7.0 * self.k3));
        if self.k1 >= 0.0 && self.k2 >= 0.0 && self.k3 >= 0.0 {
            return f64::INFINITY;
        }
        let mut low = 0.0;
        for i in 1..=200 {
            let s = 0.05 * f64::from(i);
            if slope(s) <= 0.0 {
                let mut high = s;
                for _ in 0..40 {
                    let middle = 0.5 * (low + high);
                    if slope(middle) > 0.0 { low = middle } else { high = middle }
                }
                return f64::sqrt(low);
            }
            low = s;
        }
        10f64.sqrt()
    }

    /// See [`super::CameraModel::project`].
    pub fn project(&self, point: &Vector3<f64>) -> Result<Pixel<Raw>, ProjectError> {
        let n = self.normalize(point)?;
        Ok(self.pixel_of(self.distort(n).0))
    }

    /// See [`super::CameraModel::unproject`].
    pub fn unproject(&self, pixel: Pixel<Raw>) -> Result<Vector3<f64>, ProjectError> {
        let none = ProjectError::NoDirection { u_px: pixel.u_px, v_px: pixel.v_px };
        let d = Vector2::new((pixel.u_px - self.cx_px) / self.fx_px, (pixel.v_px - self.cy_px) / self.fy_px);
        if !d.iter().all(|c| c.is_finite()) {
            return Err(none);
        }
        let mut n = d;
        for _ in 0..50 {
            let (value, jacobian) = self.distort(n);
            let error = value - d;
            if error.norm() < 1e-14 * (1.0 + d.norm()) {
                break;
            }
            let step = jacobian.try_inverse().ok_or(none)? * error;
            // A long step means that Newton left the basin; damp it rather than jump the fold.
            let damping = (0.5 * (1.0 + n.norm()) / step.norm().max(1e-300)).min(1.0);
            n -= step * damping;
        }
        let reached = (self.distort(n).0 - d).norm() < 1e-9 && n.norm() < self.limit_radius();
        if reached { Ok(Vector3::new(n.x, n.y, 1.0).normalize()) } else { Err(none) }
    }

    /// See [`super::CameraModel::project_with_jacobian`].
    pub fn project_with_jacobian(&self, point: &Vector3<f64>) -> Result<ProjectionJacobian, ProjectError> {
        let n = self.normalize(point)?;
        let (d, by_normalized) = self.distort(n);
        let iz = 1.0 / point.z;
        let normalized_by_point = Matrix2x3::new(iz, 0.0, -n.x * iz, 0.0, iz, -n.y * iz);
        let k = Matrix2::new(self.fx_px, 0.0, 0.0, self.fy_px);
        let (x, y) = (n.x, n.y);
        let r2 = x * x + y * y;
        let mut by_parameter = SMatrix::<f64, 2, MAX_PARAMETERS>::zeros();
        by_parameter[(0, 0)] = d.x;
        by_parameter[(1, 1)] = d.y;
        by_parameter[(0, 2)] = 1.0;
        by_parameter[(1, 3)] = 1.0;
        let by_distortion = [
            n * r2,
            n * (r2 * r2),
            Vector2::new(2.0 * x * y, r2 + 2.0 * y * y),
            Vector2::new(r2 + 2.0 * x * x, 2.0 * x * y),
            n * (r2 * r2 * r2),
        ];
        for (i, column) in by_distortion.iter().enumerate() {
            by_parameter.set_column(4 + i, &(k * column));
        }
        Ok(ProjectionJacobian {
            pixel_px: self.pixel_of(d).vector(),
            by_point: k * by_normalized * normalized_by_point,
            by_parameter,
        })
    }
}
