//! Equidistant fisheye with four coefficients, after Kannala and Brandt (2006) as in OpenCV's
//! `fisheye` module: θ_d = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸).
//!
//! Assumes one center of projection and a lens symmetric about its axis. Broken when the
//! residuals grow towards the rim in a pattern that turns with the lens.

use nalgebra::{Matrix2x3, SMatrix, Vector2, Vector3};

use super::{MAX_PARAMETERS, ProjectError, ProjectionJacobian};
use crate::pixel::{Pixel, Raw};

/// Parameters of the fisheye lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fisheye {
    /// Pixels per radian near the axis, horizontally.
    pub fx_px: f64,
    /// Same, vertically.
    pub fy_px: f64,
    /// Column of the optical axis.
    pub cx_px: f64,
    /// Row of the optical axis.
    pub cy_px: f64,
    /// Element (0, 1) of the camera matrix: horizontal pixels per vertical radian. Kept when a
    /// file has it; never fitted (a sensor has square angles).
    pub skew_px: f64,
    /// Distortion k1..k4.
    pub k: [f64; 4],
}

/// Directions at least this far off the axis (rad) get the general formula; closer ones its limit.
const NEAR_AXIS_RAD: f64 = 1e-9;

impl Fisheye {
    fn theta_d(&self, theta: f64) -> f64 {
        let t2 = theta * theta;
        let [k1, k2, k3, k4] = self.k;
        theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))))
    }

    fn theta_d_slope(&self, theta: f64) -> f64 {
        let t2 = theta * theta;
        let [k1, k2, k3, k4] = self.k;
        1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)))
    }

    /// Largest angle off the axis (rad, at most π) up to which the model is one-to-one.
    pub fn limit_rad(&self) -> f64 {
        const STEPS: usize = 256;
        let step = std::f64::consts::PI / STEPS as f64;
        for i in 1..=STEPS {
            let theta = i as f64 * step;
            if self.theta_d_slope(theta) <= 0.0 {
                let (mut low, mut high) = (theta - step, theta);
                for _ in 0..40 {
                    let middle = 0.5 * (low + high);
                    if self.theta_d_slope(middle) > 0.0 { low = middle } else { high = middle }
                }
                return low;
            }
        }
        std::f64::consts::PI
    }

    /// See [`super::CameraModel::project`].
    pub fn project(&self, point: &Vector3<f64>) -> Result<Pixel<Raw>, ProjectError> {
        let r = point.x.hypot(point.y);
        let theta = r.atan2(point.z);
        self.check(point, theta)?;
        let (x, y) = if r > NEAR_AXIS_RAD * point.z.abs() {
            let scale = self.theta_d(theta) / r;
            (point.x * scale, point.y * scale)
        } else {
            (point.x / point.z, point.y / point.z)
        };
        Ok(self.pixel_of(x, y))
    }

    fn pixel_of(&self, x: f64, y: f64) -> Pixel<Raw> {
        Pixel::new(self.fx_px * x + self.skew_px * y + self.cx_px, self.fy_px * y + self.cy_px)
    }

    /// The cheap part of the one-to-one test: exact only where it matters, near the fold.
    fn check(&self, point: &Vector3<f64>, theta: f64) -> Result<(), ProjectError> {
        if !point.iter().all(|c| c.is_finite()) || point.norm_squared() == 0.0 {
            return Err(ProjectError::Undefined);
        }
        // Lenses are made for less than 2 rad off the axis; a fold closer than that shows as a
        // slope that is not positive, and further out only the full search can tell.
        if self.theta_d_slope(theta) <= 0.0 || theta > 2.0 {
            let limit_rad = self.limit_rad();
            if theta > limit_rad {
                return Err(ProjectError::BeyondLens { theta_rad: theta, limit_rad });
            }
        }
        Ok(())
    }

    /// See [`super::CameraModel::unproject`].
    pub fn unproject(&self, pixel: Pixel<Raw>) -> Result<Vector3<f64>, ProjectError> {
        let none = ProjectError::NoDirection { u_px: pixel.u_px, v_px: pixel.v_px };
        let y = (pixel.v_px - self.cy_px) / self.fy_px;
        let x = (pixel.u_px - self.cx_px - self.skew_px * y) / self.fx_px;
        let theta_d = x.hypot(y);
        if !theta_d.is_finite() {
            return Err(none);
        }
        if theta_d < NEAR_AXIS_RAD {
            return Ok(Vector3::new(x, y, 1.0).normalize());
        }
        let theta = self.invert(theta_d).ok_or(none)?;
        let (sin, cos) = theta.sin_cos();
        Ok(Vector3::new(x / theta_d * sin, y / theta_d * sin, cos))
    }

    /// θ of θ_d by Newton's method, falling back to bisection inside the one-to-one range.
    fn invert(&self, theta_d: f64) -> Option<f64> {
        let mut theta = theta_d.min(1.5);
        for _ in 0..12 {
            let error = self.theta_d(theta) - theta_d;
            let slope = self.theta_d_slope(theta);
            if slope <= 0.05 {
                break;
            }
            let step = error / slope;
            theta -= step;
            if !(0.0..2.0).contains(&theta) {
                break;
            }
            if step.abs() < 1e-14 {
                return Some(theta);
            }
        }
        self.invert_by_bisection(theta_d)
    }

    fn invert_by_bisection(&self, theta_d: f64) -> Option<f64> {
        let limit = self.limit_rad();
        if self.theta_d(limit) < theta_d {
            return None;
        }
        let (mut low, mut high) = (0.0, limit);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if self.theta_d(middle) < theta_d { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    }

    /// See [`super::CameraModel::project_with_jacobian`].
    pub fn project_with_jacobian(&self, point: &Vector3<f64>) -> Result<ProjectionJacobian, ProjectError> {
        let (px, py, pz) = (point.x, point.y, point.z);
        let r2 = px * px + py * py;
        let r = r2.sqrt();
        let theta = r.atan2(pz);
        self.check(point, theta)?;
        // x = px·s, y = py·s with s = θ_d / r; on the axis s → 1/z and its slope vanishes.
        let (s, ds_dr, ds_dz) = if r > NEAR_AXIS_RAD * pz.abs() {
            let d2 = r2 + pz * pz;
            let theta_d = self.theta_d(theta);
            let slope = self.theta_d_slope(theta);
            (theta_d / r, slope * pz / (d2 * r) - theta_d / r2, -slope / d2)
        } else {
            (1.0 / pz, 0.0, -1.0 / (pz * pz))
        };
        let (ux, uy) = if r > 0.0 { (px / r, py / r) } else { (0.0, 0.0) };
        let (x, y) = (px * s, py * s);
        let normal = Matrix2x3::new(
            s + px * ds_dr * ux,
            px * ds_dr * uy,
            px * ds_dz,
            py * ds_dr * ux,
            s + py * ds_dr * uy,
            py * ds_dz,
        );
        let k = nalgebra::Matrix2::new(self.fx_px, self.skew_px, 0.0, self.fy_px);
        let mut by_parameter = SMatrix::<f64, 2, MAX_PARAMETERS>::zeros();
        by_parameter[(0, 0)] = x;
        by_parameter[(1, 1)] = y;
        by_parameter[(0, 2)] = 1.0;
        by_parameter[(1, 3)] = 1.0;
        let t2 = theta * theta;
        let mut power = theta * t2;
        for column in 4..8 {
            let d = k * Vector2::new(ux * power, uy * power);
            by_parameter.set_column(column, &d);
            power *= t2;
        }
        Ok(ProjectionJacobian { pixel_px: self.pixel_of(x, y).vector(), by_point: k * normal, by_parameter })
    }
}
