//! The virtual pair of parallel eyes that images are rectified to.
//!
//! Both virtual eyes keep the optical centers of the real ones and are turned to common axes:
//! x along the baseline, z where the view is aimed at. A point then lies on the same row of
//! both views, and its depth is f·B/d for a disparity d. Turning the pair *about* the baseline
//! keeps that: so the pair can look down at the table although the lenses look ahead, and
//! spends its pixels there.
//!
//! Assumes one center of projection per lens. Broken when rows disagree by more than some
//! tenths of a pixel (see the epipolar error of the calibration).
//!
//! Source: Fusiello, Trucco, Verri: A compact algorithm for rectification of stereo pairs (2000).

use nalgebra::{Matrix3, Vector3};

use crate::camera::{ModelKind, ProjectError};
use crate::frame::{LeftCamera, LeftRectified, Point, Pose, RightCamera, RightRectified};
use crate::pixel::{Eye, Pixel, Raw, Rectified};
use crate::stereo::StereoCameras;
use crate::workspace::Workspace;

/// Smallest step of a disparity kept as a fixed-point number with four binary places, pixels;
/// the unit in which depth steps are quoted.
pub const DISPARITY_STEP_PX: f64 = 1.0 / 16.0;

/// Size of the aimed views unless asked otherwise (width, height), pixels. For NICO it shows
/// the table at 153 px/rad, which is what the lenses resolve (more would only be blown up, and
/// take longer), from the robot's lap to the far wall.
pub const DEFAULT_SIZE_PX: (u32, u32) = (496, 240);

/// Views of more pixels are not made: their maps alone would take a gigabyte.
const MOST_PIXELS: u64 = 32_000_000;

/// Part of the view left free around the workspace, on each side.
const MARGIN: f64 = 0.01;

/// Two virtual pinhole eyes with common axes, rows and focal length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AimedPair {
    /// The real eyes.
    pub cameras: StereoCameras,
    /// Rotation of the left virtual eye; no translation.
    pub left_rectified_from_left: Pose<LeftRectified, LeftCamera>,
    /// Rotation of the right virtual eye; no translation.
    pub right_rectified_from_right: Pose<RightRectified, RightCamera>,
    /// Focal length of both, pixels.
    pub f_px: f64,
    /// Column of the axis in both views, pixels.
    pub cx_px: f64,
    /// Row of the axis in both views, pixels.
    pub cy_px: f64,
    /// Width of both views, pixels.
    pub width_px: u32,
    /// Height of both views, pixels.
    pub height_px: u32,
    /// Distance between the two optical centers, meters.
    pub baseline_m: f64,
}

/// Why a pair cannot be aimed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AimError {
    /// Optical centers (nearly) coincide.
    #[error(
        "the eyes are only {baseline_m} m apart, so no depth can be seen: calibrate again with pairs in which both eyes see the board"
    )]
    NoBaseline {
        /// Distance of the optical centers, meters.
        baseline_m: f64,
    },
    /// The right eye is not to the right of the left one.
    #[error(
        "by this calibration the right eye is not to the right of the left eye (it sits at x = {x_m} m of the left camera): the left and right images were probably swapped; swap them and calibrate again"
    )]
    NotSideBySide {
        /// x of the right optical center in the left camera's frame, meters.
        x_m: f64,
    },
    /// No width or no height.
    #[error("a view of {width_px}x{height_px} px is too small: ask for at least 16x16")]
    Size {
        /// Width asked for.
        width_px: u32,
        /// Height asked for.
        height_px: u32,
    },
    /// More pixels than can be worked on.
    #[error(
        "a view of {width_px}x{height_px} px is larger than any that can be worked on ({} million pixels): the focal length or the size of the images in the calibration is probably wrong; calibrate again, or use a copy of the file as it was", MOST_PIXELS / 1_000_000
    )]
    TooLarge {
        /// Width asked for.
        width_px: u32,
        /// Height asked for.
        height_px: u32,
    },
    /// The workspace reaches beside or behind the eyes.
    #[error(
        "the workspace spans {span_deg:.0} degrees seen from the eyes, more than one flat view can hold: make it smaller or check the place of the eyes over the table"
    )]
    TooWide {
        /// Angle about the baseline that the workspace takes up, degrees.
        span_deg: f64,
    },
    /// The view would be coarser than the lens.
    #[error(
        "a view of {width_px}x{height_px} px shows the workspace at {f_px:.0} px/rad, coarser than the lens ({lens_px:.0} px/rad): ask for at least {needed_width_px}x{needed_height_px} px"
    )]
    Coarse {
        /// Width asked for.
        width_px: u32,
        /// Height asked for.
        height_px: u32,
        /// What that gives, pixels per radian at the center.
        f_px: f64,
        /// What the lens gives, pixels per radian.
        lens_px: f64,
        /// Smallest width that keeps the lens's detail.
        needed_width_px: u32,
        /// Smallest height that keeps the lens's detail.
        needed_height_px: u32,
    },
}

/// Extent of something in a view, as tangents relative to the axis.
struct Extent {
    x: [f64; 2],
    y: [f64; 2],
}

impl AimedPair {
    /// Fisheye eyes are aimed at the workspace in a view of [`DEFAULT_SIZE_PX`]; pinhole eyes,
    /// which see little more than what is in front of them, are only made parallel.
    pub fn suited(cameras: &StereoCameras, workspace: &Workspace) -> Result<Self, AimError> {
        match cameras.left.model.kind() {
            ModelKind::Fisheye => Self::at_workspace(cameras, workspace, DEFAULT_SIZE_PX),
            ModelKind::Pinhole => Self::parallel(cameras, cameras.left.size_px()),
        }
    }

    /// Turned about the baseline so that the workspace lies in the middle rows, with the
    /// narrowest view that shows the table's patch whole to both eyes and every row in which
    /// something up to the headroom can appear.
    ///
    /// # Errors
    /// [`AimError::Coarse`] when `size_px` (width, height) shows it with less detail than the
    /// lens has.
    pub fn at_workspace(
        cameras: &StereoCameras,
        workspace: &Workspace,
        size_px: (u32, u32),
    ) -> Result<Self, AimError> {
        check_size(size_px)?;
        let level = Axes::level(cameras)?;
        let table = workspace.corners_in_left(0.0);
        let above = workspace.corners_in_left(workspace.headroom_m);
        // The angle about the baseline of a point is the row it falls on, however far aside it is.
        let (mut lowest_rad, mut highest_rad) = (f64::INFINITY, f64::NEG_INFINITY);
        for corner in table.iter().chain(&above) {
            let p = (level.left_rectified_from_left * *corner).coords;
            let angle_rad = p.y.atan2(p.z);
            lowest_rad = lowest_rad.min(angle_rad);
            highest_rad = highest_rad.max(angle_rad);
        }
        let span_rad = highest_rad - lowest_rad;
        if span_rad > 2.8 {
            return Err(AimError::TooWide { span_deg: span_rad.to_degrees() });
        }
        let axes = level.turned(0.5 * (lowest_rad + highest_rad));
        let half = (0.5 * span_rad).tan();
        let extent = Extent { x: axes.column_range(&table)?, y: [-half, half] };
        axes.framing(cameras, &extent, size_px)
    }

    /// Looking where the lenses look on average, with the lens's own detail at the center.
    pub fn parallel(cameras: &StereoCameras, size_px: (u32, u32)) -> Result<Self, AimError> {
        check_size(size_px)?;
        let axes = Axes::level(cameras)?;
        Ok(axes.pair(cameras, lens_px(cameras), [center(size_px.0), center(size_px.1)], size_px))
    }

    /// Turned about the baseline by hand: `down_rad` below where the lenses look on average, with
    /// a field of view of `across_rad` from the left edge to the right one. May be coarser than
    /// the lens: whoever turns by hand sees what he gets.
    ///
    /// # Errors
    /// [`AimError::TooWide`] when the view would reach beside the eyes.
    pub fn turned_down(
        cameras: &StereoCameras,
        down_rad: f64,
        across_rad: f64,
        size_px: (u32, u32),
    ) -> Result<Self, AimError> {
        check_size(size_px)?;
        // Also catches NaN.
        if !(across_rad > 0.01 && across_rad < 2.8 && down_rad.abs() < std::f64::consts::PI) {
            return Err(AimError::TooWide { span_deg: across_rad.to_degrees() });
        }
        let axes = Axes::level(cameras)?.turned(down_rad);
        let f_px = 0.5 * (f64::from(size_px.0) - 1.0) / (0.5 * across_rad).tan();
        Ok(axes.pair(cameras, f_px, [center(size_px.0), center(size_px.1)], size_px))
    }

    /// How far the views are turned about the baseline, below where the lenses look on average.
    pub fn down_rad(&self) -> f64 {
        let mean_axis = Vector3::z() + self.cameras.right_from_left.inverse().rotation() * Vector3::z();
        let ahead = self.left_rectified_from_left.rotation() * mean_axis;
        // Looking down puts what is straight ahead into the upper rows.
        -ahead.y.atan2(ahead.z)
    }

    /// Where both views show a point.
    ///
    /// # Errors
    /// [`ProjectError::Behind`] when the virtual eyes look away from it.
    pub fn project(
        &self,
        point_in_left: Point<LeftCamera>,
    ) -> Result<(Pixel<Rectified>, Pixel<Rectified>), ProjectError> {
        let p = (self.left_rectified_from_left * point_in_left).coords;
        let left = self.pixel_of(&p.coords)?;
        let right = self.pixel_of(&(p.coords - Vector3::x() * self.baseline_m))?;
        Ok((left, right))
    }

    /// The point that the left view shows at `pixel` and the right view `disparity_px` further
    /// left; `None` where the disparity is not a positive number (at or beyond infinity).
    pub fn point(&self, pixel: Pixel<Rectified>, disparity_px: f64) -> Option<Point<LeftCamera>> {
        if !(disparity_px > 0.0 && disparity_px.is_finite()) {
            return None;
        }
        let depth_m = self.f_px * self.baseline_m / disparity_px;
        let in_rectified = Point::<LeftRectified>::from(nalgebra::Point3::from(self.ray(pixel) * depth_m));
        Some(self.left_rectified_from_left.inverse() * in_rectified)
    }

    /// Disparity (pixels) of something at depth `range_m` along the aimed axis.
    pub fn disparity_at(&self, range_m: f64) -> f64 {
        self.f_px * self.baseline_m / range_m
    }

    /// How much depth (meters) one step of [`DISPARITY_STEP_PX`] makes at depth `range_m`.
    pub fn depth_step_m(&self, range_m: f64) -> f64 {
        range_m * range_m * DISPARITY_STEP_PX / (self.f_px * self.baseline_m)
    }

    /// Size of both views (width, height) in pixels.
    pub fn size_px(&self) -> (u32, u32) {
        (self.width_px, self.height_px)
    }

    /// Where the raw image of an eye shows what its aimed view shows at `pixel`; may fall
    /// outside the raw image.
    ///
    /// # Errors
    /// When the lens cannot look in that direction.
    pub fn raw_from_rectified(&self, eye: Eye, pixel: Pixel<Rectified>) -> Result<Pixel<Raw>, ProjectError> {
        self.cameras.camera(eye).project(&(self.rotation(eye).transpose() * self.ray(pixel)))
    }

    /// Where the aimed view of an eye shows what its raw image shows at `pixel`; may fall
    /// outside the view.
    ///
    /// # Errors
    /// When the pixel has no direction, or one that the virtual eye looks away from.
    pub fn rectified_from_raw(&self, eye: Eye, pixel: Pixel<Raw>) -> Result<Pixel<Rectified>, ProjectError> {
        self.pixel_of(&(self.rotation(eye) * self.cameras.camera(eye).unproject(pixel)?))
    }

    /// Rotation matrix from the real to the virtual eye.
    fn rotation(&self, eye: Eye) -> Matrix3<f64> {
        match eye {
            Eye::Left => self.left_rectified_from_left.rotation(),
            Eye::Right => self.right_rectified_from_right.rotation(),
        }
    }

    /// The direction a pixel looks in, scaled to unit depth.
    fn ray(&self, pixel: Pixel<Rectified>) -> Vector3<f64> {
        Vector3::new((pixel.u_px - self.cx_px) / self.f_px, (pixel.v_px - self.cy_px) / self.f_px, 1.0)
    }

    fn pixel_of(&self, in_rectified: &Vector3<f64>) -> Result<Pixel<Rectified>, ProjectError> {
        if in_rectified.z > 0.0 {
            let (x, y) = (in_rectified.x / in_rectified.z, in_rectified.y / in_rectified.z);
            Ok(Pixel::new(self.f_px * x + self.cx_px, self.f_px * y + self.cy_px))
        } else {
            Err(ProjectError::Behind { z: in_rectified.z })
        }
    }
}

/// Common axes of the two virtual eyes.
struct Axes {
    left_rectified_from_left: Pose<LeftRectified, LeftCamera>,
    right_rectified_from_right: Pose<RightRectified, RightCamera>,
    baseline_m: f64,
}

impl Axes {
    /// x along the baseline, z as close as possible to the mean of the two optical axes.
    fn level(cameras: &StereoCameras) -> Result<Self, AimError> {
        let left_from_right = cameras.right_from_left.inverse();
        let right_center_in_left = left_from_right.translation_m();
        let baseline_m = right_center_in_left.norm();
        // Also catches NaN.
        if !(baseline_m > 1e-6 && baseline_m.is_finite()) {
            return Err(AimError::NoBaseline { baseline_m });
        }
        let x = right_center_in_left / baseline_m;
        if x.x < 0.5 {
            return Err(AimError::NotSideBySide { x_m: right_center_in_left.x });
        }
        let mean_axis = Vector3::z() + left_from_right.isometry.rotation * Vector3::z();
        let z = (mean_axis - x * x.dot(&mean_axis)).normalize();
        let y = z.cross(&x);
        let rotation = Matrix3::from_rows(&[x.transpose(), y.transpose(), z.transpose()]);
        Ok(Self::from_left(Pose::from_matrix(&rotation, Vector3::zeros()), cameras, baseline_m))
    }

    fn from_left(
        left_rectified_from_left: Pose<LeftRectified, LeftCamera>,
        cameras: &StereoCameras,
        baseline_m: f64,
    ) -> Self {
        let rotation =
            left_rectified_from_left.isometry.rotation * cameras.right_from_left.isometry.rotation.inverse();
        let right = nalgebra::Isometry3::from_parts(nalgebra::Translation3::identity(), rotation);
        Self { left_rectified_from_left, right_rectified_from_right: Pose::new(right), baseline_m }
    }

    /// Turned about the baseline; positive looks down.
    fn turned(&self, down_rad: f64) -> Self {
        let turn = nalgebra::UnitQuaternion::from_scaled_axis(Vector3::x() * down_rad);
        Self {
            left_rectified_from_left: Pose::new(turn * self.left_rectified_from_left.isometry),
            right_rectified_from_right: Pose::new(turn * self.right_rectified_from_right.isometry),
            baseline_m: self.baseline_m,
        }
    }

    /// Smallest and largest column (as tangents) at which either eye shows one of the points.
    fn column_range(&self, points: &[Point<LeftCamera>]) -> Result<[f64; 2], AimError> {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for point in points {
            let p = (self.left_rectified_from_left * *point).coords;
            if p.z <= 0.0 {
                return Err(AimError::TooWide { span_deg: 180.0 });
            }
            for x in [p.x, p.x - self.baseline_m] {
                range = [range[0].min(x / p.z), range[1].max(x / p.z)];
            }
        }
        Ok(range)
    }

    /// The narrowest view of the given size that holds the extent.
    fn framing(
        &self,
        cameras: &StereoCameras,
        extent: &Extent,
        size_px: (u32, u32),
    ) -> Result<AimedPair, AimError> {
        let [width, height] =
            [&extent.x, &extent.y].map(|range| (range[1] - range[0]) * (1.0 + 2.0 * MARGIN));
        let (columns, rows) = (f64::from(size_px.0) - 1.0, f64::from(size_px.1) - 1.0);
        let (f_px, lens_px) = ((columns / width).min(rows / height), lens_px(cameras));
        if f_px < lens_px {
            return Err(AimError::Coarse {
                width_px: size_px.0,
                height_px: size_px.1,
                f_px,
                lens_px,
                needed_width_px: ((lens_px * width).ceil() as u32).saturating_add(1),
                needed_height_px: ((lens_px * height).ceil() as u32).saturating_add(1),
            });
        }
        let middle = |range: &[f64; 2]| 0.5 * (range[0] + range[1]) * f_px;
        let axis = [center(size_px.0) - middle(&extent.x), center(size_px.1) - middle(&extent.y)];
        Ok(self.pair(cameras, f_px, axis, size_px))
    }

    fn pair(&self, cameras: &StereoCameras, f_px: f64, axis_px: [f64; 2], size_px: (u32, u32)) -> AimedPair {
        AimedPair {
            cameras: *cameras,
            left_rectified_from_left: self.left_rectified_from_left,
            right_rectified_from_right: self.right_rectified_from_right,
            f_px,
            cx_px: axis_px[0],
            cy_px: axis_px[1],
            width_px: size_px.0,
            height_px: size_px.1,
            baseline_m: self.baseline_m,
        }
    }
}

/// Detail of the finer lens at its center, pixels per radian.
fn lens_px(cameras: &StereoCameras) -> f64 {
    Eye::BOTH
        .iter()
        .map(|eye| cameras.camera(*eye).model.focal_px())
        .fold(0.0, |most, (fx, fy)| fx.max(fy).max(most))
}

fn center(pixels: u32) -> f64 {
    0.5 * (f64::from(pixels) - 1.0)
}

fn check_size((width_px, height_px): (u32, u32)) -> Result<(), AimError> {
    if width_px < 16 || height_px < 16 {
        Err(AimError::Size { width_px, height_px })
    } else if u64::from(width_px) * u64::from(height_px) > MOST_PIXELS {
        Err(AimError::TooLarge { width_px, height_px })
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod laws;
