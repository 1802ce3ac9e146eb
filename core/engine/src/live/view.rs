//! The newest images and what was computed from them.

use std::sync::Arc;

use image::RgbImage;
use plumbline_model::frame::{LeftCamera, Robot};
use plumbline_model::{Eye, Pixel, Point, Raw, Rectified, Stamp, StereoFrame};
use plumbline_vision::disparity::DisparityMap;

use super::command::{AimChoice, HeadPose, ProbePoint, Products};
use super::no_reading::NoReading;
use crate::ground::statistics::StageStatistics;
use crate::ground::text::sentence;

/// Live images. Each product carries its own stamp; those of one stamp belong together.
#[derive(Clone, Debug, Default)]
pub struct LiveView {
    /// What is computed at present.
    pub wanted: Products,
    /// Newest pair as delivered.
    pub raw: Option<StereoFrame>,
    /// Newest rectified pair.
    pub rectified: Option<RectifiedView>,
    /// Newest disparity.
    pub disparity: Option<DisparityView>,
    /// Newest chessboard corners.
    pub corners: Option<CornersView>,
    /// The measured point.
    pub probe: Option<ProbeView>,
    /// What the virtual pair looks like; `None` without a calibration.
    pub aim: Option<AimView>,
    /// Why there is no rectified pair although it is wanted, and what to do.
    pub no_rectified_because: Option<String>,
    /// Whether rectification rests on the lens data of the rig file because these eyes were not
    /// calibrated yet.
    pub nominal_lenses: bool,
    /// Where the head is taken to look.
    pub head: HeadPose,
    /// Rates, ages, drops.
    pub statistics: Statistics,
}

/// A rectified pair: rows of left and right are epipolar lines.
#[derive(Clone, Debug)]
pub struct RectifiedView {
    /// Of the pair it was made from.
    pub stamp: Stamp,
    /// Left eye.
    pub left: Arc<RgbImage>,
    /// Right eye.
    pub right: Arc<RgbImage>,
}

/// Disparity of the left rectified image.
#[derive(Clone, Debug)]
pub struct DisparityView {
    /// Of the pair it was made from.
    pub stamp: Stamp,
    /// Width, height in pixels.
    pub size_px: (u32, u32),
    /// Row by row, pixels; not finite where there is none (as in a PFM file). Read single
    /// places with [`DisparityView::disparity_px`].
    pub values_px: Arc<[f32]>,
    /// Focal length of the virtual pair, pixels.
    pub focal_px: f64,
    /// Distance of the two eyes, meters.
    pub baseline_m: f64,
    /// Share of pixels that have a disparity, measured or filled in.
    pub valid_fraction: f64,
    /// Share of pixels on whose disparity both views agree.
    pub measured_fraction: f64,
    /// Smallest and largest disparity that was searched, pixels.
    pub search_px: (f64, f64),
    /// The same values with their origin: measured or filled in.
    pub map: Arc<DisparityMap>,
}

impl DisparityView {
    /// Disparity at a pixel.
    pub fn disparity_px(&self, u: u32, v: u32) -> Option<f64> {
        if u >= self.size_px.0 || v >= self.size_px.1 {
            return None;
        }
        let value = *self.values_px.get(v as usize * self.size_px.0 as usize + u as usize)?;
        value.is_finite().then_some(f64::from(value))
    }

    /// Depth along the virtual left eye's axis, meters.
    pub fn depth_m(&self, u: u32, v: u32) -> Option<f64> {
        let disparity_px = self.disparity_px(u, v)?;
        (disparity_px > 0.0).then(|| self.focal_px * self.baseline_m / disparity_px)
    }
}

/// Chessboard corners seen live, in the board's order.
#[derive(Clone, Debug)]
pub struct CornersView {
    /// Of the pair they were found in.
    pub stamp: Stamp,
    /// In the left eye; `None` when the board was not seen.
    pub left: Option<Arc<[Pixel<Raw>]>>,
    /// In the right eye.
    pub right: Option<Arc<[Pixel<Raw>]>>,
}

impl CornersView {
    /// Corners of one eye.
    pub fn corners(&self, eye: Eye) -> Option<&Arc<[Pixel<Raw>]>> {
        match eye {
            Eye::Left => self.left.as_ref(),
            Eye::Right => self.right.as_ref(),
        }
    }
}

/// The measured point on one pair.
#[derive(Clone, Debug)]
pub struct ProbeView {
    /// What was asked.
    pub asked: ProbePoint,
    /// Of the pair it was measured on; `None` before the first.
    pub stamp: Option<Stamp>,
    /// Where it is, or why that is not known.
    pub reading: Result<ProbeReading, NotMeasured>,
}

/// Why it is not known where a point is: a sentence.
#[derive(Clone, Debug, thiserror::Error)]
pub enum NotMeasured {
    /// This point of this pair was not measured.
    #[error("{}", sentence(&.0.to_string()))]
    Reading(#[from] NoReading),
    /// No point is at present, for the reason that the rectified pair or a thread gives.
    #[error("{0}")]
    Nothing(String),
}

/// Where a point of the image is.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeReading {
    /// In the raw left image.
    pub left_raw: Pixel<Raw>,
    /// Its match in the raw right image.
    pub right_raw: Pixel<Raw>,
    /// In the rectified left image; `None` when it lies outside.
    pub left_rectified: Option<Pixel<Rectified>>,
    /// Disparity on the rectified pair, pixels; `None` when it lies outside.
    pub disparity_px: Option<f64>,
    /// In the left camera's frame.
    pub point_in_left: Point<LeftCamera>,
    /// In the robot's frame, by the model in use.
    pub point_in_robot: Point<Robot>,
    /// One standard deviation of its distance from the left eye, meters.
    pub range_sigma_m: f64,
    /// One standard deviation of its place in the robot's frame, along its worst direction, with that
    /// of the model's effects and of what nobody measured of the eyes, meters.
    pub sigma_m: f64,
    /// Why that is wide, and what to do; `None`: all that the place rests on was measured.
    pub wide_because: Option<&'static str>,
    /// The model of the robot, for people: "as described", "with 2 effects".
    pub model: Arc<str>,
}

/// What the virtual pair looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AimView {
    /// How it was chosen.
    pub choice: AimChoice,
    /// Rotation about the baseline; positive looks down, radians.
    pub pitch_rad: f64,
    /// Width, height of the rectified images, pixels.
    pub size_px: (u32, u32),
    /// Focal length, pixels.
    pub focal_px: f64,
    /// Field of view (width, height), radians.
    pub field_of_view_rad: (f64, f64),
    /// Distance of the two eyes, meters.
    pub baseline_m: f64,
}

/// Rates, ages, drops of every stage.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// The source.
    pub source: StageStatistics,
    /// Rectification and disparity.
    pub rectify: StageStatistics,
    /// Chessboard corners.
    pub corners: StageStatistics,
    /// The measured point.
    pub probe: StageStatistics,
    /// Right capture time minus left, newest pair, seconds.
    pub time_difference_s: Option<f64>,
}
