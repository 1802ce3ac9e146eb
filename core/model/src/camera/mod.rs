//! Camera models: from a direction in front of the lens to a raw pixel and back.

mod fisheye;
#[cfg(test)]
mod laws;
mod pinhole;

use nalgebra::{Vector2, Vector3};

pub use fisheye::Fisheye;
pub use pinhole::Pinhole;

use crate::pixel::{Pixel, Raw};
use crate::plausible::{self, Implausible};

/// Why a point has no pixel, or a pixel no direction.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ProjectError {
    /// A pinhole sees nothing at or behind its own plane.
    #[error("the point is behind the camera (z = {z} m)")]
    Behind {
        /// Depth in the camera's frame.
        z: f64,
    },
    /// The distortion polynomial folds over there: several directions share a pixel.
    #[error(
        "{theta_rad} rad off the optical axis is beyond {limit_rad} rad, where the lens model stops being one-to-one"
    )]
    BeyondLens {
        /// Angle off the optical axis asked for.
        theta_rad: f64,
        /// Largest angle at which the model can be inverted.
        limit_rad: f64,
    },
    /// The pixel lies outside everything that the lens model can reach.
    #[error("no direction projects to pixel ({u_px}, {v_px})")]
    NoDirection {
        /// Column.
        u_px: f64,
        /// Row.
        v_px: f64,
    },
    /// The optical center, or a number that is not finite.
    #[error("the point has no direction")]
    Undefined,
}

/// Largest number of intrinsic parameters of any model.
pub const MAX_PARAMETERS: usize = 9;

/// A projection with its derivatives.
#[derive(Clone, Copy, Debug)]
pub struct ProjectionJacobian {
    /// The pixel.
    pub pixel_px: Vector2<f64>,
    /// d(pixel) / d(point in the camera), 2×3, pixels per meter.
    pub by_point: nalgebra::Matrix2x3<f64>,
    /// d(pixel) / d(intrinsic parameter), 2×N; columns past the model's count are zero.
    pub by_parameter: nalgebra::SMatrix<f64, 2, MAX_PARAMETERS>,
}

/// The lens: how directions become pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraModel {
    /// Equidistant with four coefficients (OpenCV `fisheye`, ROS `equidistant`, Kalibr `pinhole-equi`).
    Fisheye(Fisheye),
    /// Perspective with radial-tangential distortion (OpenCV, ROS `plumb_bob`).
    Pinhole(Pinhole),
}

/// Which lens model to fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ModelKind {
    /// Equidistant fisheye, 8 parameters.
    #[default]
    Fisheye,
    /// Pinhole with five distortion coefficients, 9 parameters.
    Pinhole,
}

/// A lens in front of an image of known size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The lens.
    pub model: CameraModel,
    /// Image width in pixels.
    pub width_px: u32,
    /// Image height in pixels.
    pub height_px: u32,
}

impl CameraModel {
    /// Which model this is.
    pub fn kind(&self) -> ModelKind {
        match self {
            Self::Fisheye(_) => ModelKind::Fisheye,
            Self::Pinhole(_) => ModelKind::Pinhole,
        }
    }

    /// From the parameters in the order of [`ModelKind::parameter_names`]; skew zero.
    pub fn from_parameters(kind: ModelKind, p: &[f64]) -> Self {
        match kind {
            ModelKind::Fisheye => Self::Fisheye(Fisheye {
                fx_px: p[0],
                fy_px: p[1],
                cx_px: p[2],
                cy_px: p[3],
                skew_px: 0.0,
                k: [p[4], p[5], p[6], p[7]],
            }),
            ModelKind::Pinhole => Self::Pinhole(Pinhole {
                fx_px: p[0],
                fy_px: p[1],
                cx_px: p[2],
                cy_px: p[3],
                k1: p[4],
                k2: p[5],
                p1: p[6],
                p2: p[7],
                k3: p[8],
            }),
        }
    }

    /// The parameters in the order of [`ModelKind::parameter_names`].
    pub fn parameters(&self) -> Vec<f64> {
        match self {
            Self::Fisheye(m) => vec![m.fx_px, m.fy_px, m.cx_px, m.cy_px, m.k[0], m.k[1], m.k[2], m.k[3]],
            Self::Pinhole(m) => vec![m.fx_px, m.fy_px, m.cx_px, m.cy_px, m.k1, m.k2, m.p1, m.p2, m.k3],
        }
    }

    /// Focal lengths (fx, fy) in pixels; pixels per radian at the image center.
    pub fn focal_px(&self) -> (f64, f64) {
        match self {
            Self::Fisheye(m) => (m.fx_px, m.fy_px),
            Self::Pinhole(m) => (m.fx_px, m.fy_px),
        }
    }

    /// Principal point (cx, cy).
    pub fn principal_point(&self) -> Pixel<Raw> {
        match self {
            Self::Fisheye(m) => Pixel::new(m.cx_px, m.cy_px),
            Self::Pinhole(m) => Pixel::new(m.cx_px, m.cy_px),
        }
    }

    /// Pixel of a point (or direction) given in the camera's frame.
    pub fn project(&self, point: &Vector3<f64>) -> Result<Pixel<Raw>, ProjectError> {
        match self {
            Self::Fisheye(m) => m.project(point),
            Self::Pinhole(m) => m.project(point),
        }
    }

    /// Unit direction, in the camera's frame, of a pixel.
    pub fn unproject(&self, pixel: Pixel<Raw>) -> Result<Vector3<f64>, ProjectError> {
        match self {
            Self::Fisheye(m) => m.unproject(pixel),
            Self::Pinhole(m) => m.unproject(pixel),
        }
    }

    /// [`Self::project`] with derivatives.
    pub fn project_with_jacobian(&self, point: &Vector3<f64>) -> Result<ProjectionJacobian, ProjectError> {
        match self {
            Self::Fisheye(m) => m.project_with_jacobian(point),
            Self::Pinhole(m) => m.project_with_jacobian(point),
        }
    }
}

impl ModelKind {
    /// Names of the fitted parameters, in order.
    pub fn parameter_names(self) -> &'static [&'static str] {
        match self {
            Self::Fisheye => &["fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"],
            Self::Pinhole => &["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"],
        }
    }

    /// How many intrinsic parameters are fitted.
    pub fn parameter_count(self) -> usize {
        self.parameter_names().len()
    }
}

impl Camera {
    /// Image size (width, height) in pixels.
    pub fn size_px(&self) -> (u32, u32) {
        (self.width_px, self.height_px)
    }

    /// Refuses a lens that no camera has: what every reader asks.
    ///
    /// # Errors
    /// With the first number that cannot be.
    pub fn check_plausible(&self) -> Result<(), Implausible> {
        let (width, height) = (f64::from(self.width_px), f64::from(self.height_px));
        plausible::IMAGE_SIDE_PX.check_all(&[width, height])?;
        let longer = width.max(height);
        let shares = |quantity: plausible::Quantity, [least, most]: [f64; 2], side: f64| {
            quantity.within(least * side, most * side, quantity.reason)
        };
        let (fx, fy) = self.model.focal_px();
        shares(plausible::FOCAL_PX, plausible::FOCAL_SHARES, longer).check_all(&[fx, fy])?;
        let center = self.model.principal_point();
        shares(plausible::CENTER_PX, plausible::CENTER_SHARES, width).check(center.u_px)?;
        shares(plausible::CENTER_PX, plausible::CENTER_SHARES, height).check(center.v_px)?;
        match &self.model {
            CameraModel::Fisheye(lens) => {
                shares(plausible::SKEW_PX, [-1.0, 1.0], longer).check(lens.skew_px)?;
                plausible::FISHEYE_K.check_all(&lens.k)
            }
            CameraModel::Pinhole(lens) => {
                plausible::PINHOLE_K.check_all(&[lens.k1, lens.k2, lens.p1, lens.p2, lens.k3])
            }
        }
    }

    /// Pixel of a point in the camera's frame, whether or not it falls on the image.
    pub fn project(&self, point: &Vector3<f64>) -> Result<Pixel<Raw>, ProjectError> {
        self.model.project(point)
    }

    /// Unit direction of a pixel in the camera's frame.
    pub fn unproject(&self, pixel: Pixel<Raw>) -> Result<Vector3<f64>, ProjectError> {
        self.model.unproject(pixel)
    }
}
