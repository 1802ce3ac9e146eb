//! One moment seen by both eyes.

use std::sync::Arc;
use std::time::Instant;

use image::RgbImage;

/// When something was captured. Frames of different stamps are never joined into a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Counts up by one per pair delivered by a source.
    pub seq: u64,
    /// Host clock at capture.
    pub captured_at: Instant,
}

/// A pair of images of the same moment.
#[derive(Clone, Debug)]
pub struct StereoFrame {
    /// When.
    pub stamp: Stamp,
    /// Left eye, 8-bit RGB, as delivered by the camera.
    pub left: Arc<RgbImage>,
    /// Right eye, same.
    pub right: Arc<RgbImage>,
    /// Right capture time minus left, seconds; `None` where the source does not know
    /// (a folder of pairs).
    pub time_difference_s: Option<f64>,
    /// Name of the pair in its source (file name), if it has one.
    pub name: Option<String>,
}
