//! What is asked of the cameras.

use serde::{Deserialize, Serialize};

use super::capture::Delivered;
use crate::error::SourceError;
use crate::source::Report;

/// What is asked of both cameras alike. A camera that cannot do it delivers what it can, and
/// that is reported.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CameraSettings {
    /// Width and height in pixels; `None` leaves the camera's own.
    pub size: Option<(u32, u32)>,
    /// Frames per second; `None` leaves the camera's own.
    pub rate_hz: Option<f64>,
    /// Asks for JPEG-compressed frames: needs a tenth of the bandwidth, so that two cameras
    /// fit on one USB 2 controller, but costs sharpness.
    pub compressed: bool,
    /// Left and right frames further apart than this are no pair, seconds; `None` takes half
    /// the distance of two frames.
    pub time_difference_limit_s: Option<f64>,
    /// A camera that sends nothing for this long counts as lost, seconds.
    pub silence_limit_s: f64,
}

impl Default for CameraSettings {
    /// As the eyes of NICO are used: 640x480 px, 30 frames per second, uncompressed.
    fn default() -> Self {
        Self {
            size: Some((640, 480)),
            rate_hz: Some(30.0),
            compressed: false,
            time_difference_limit_s: None,
            silence_limit_s: 3.0,
        }
    }
}

impl CameraSettings {
    /// Refuses what is no setting.
    pub(crate) fn check(&self) -> Result<(), SourceError> {
        let refuse = |setting, problem: String| Err(SourceError::CameraSetting { setting, problem });
        match *self {
            Self { size: Some((width, height)), .. }
                if width.min(height) == 0 || width.max(height) > 16384 =>
            {
                refuse("size", format!("{width}x{height} px is no image size; give for example 640x480"))
            }
            Self { rate_hz: Some(rate_hz), .. } if !(0.1..=1000.0).contains(&rate_hz) => {
                refuse("rate", format!("{rate_hz} frames per second; give between 0.1 and 1000"))
            }
            Self { time_difference_limit_s: Some(limit_s), .. } if !(limit_s > 0.0 && limit_s <= 1.0) => {
                refuse("time difference limit", format!("{limit_s} s; give more than 0 and at most 1 s"))
            }
            Self { silence_limit_s, .. } if !(0.1..=600.0).contains(&silence_limit_s) => {
                refuse("silence limit", format!("{silence_limit_s} s; give between 0.1 and 600 s"))
            }
            _ => Ok(()),
        }
    }

    /// Says where the cameras deliver something else than asked.
    pub(super) fn compare(&self, delivered: [Delivered; 2]) -> Vec<Report> {
        let mut reports = Vec::new();
        for (eye, got) in plumbline_model::Eye::BOTH.into_iter().zip(delivered) {
            if let Some(size) = self.size
                && size != got.size
            {
                reports.push(Report::Unlike(format!(
                    "the {eye} camera delivers {}x{} px instead of the {}x{} px asked for",
                    got.size.0, got.size.1, size.0, size.1
                )));
            }
            if let Some(rate_hz) = self.rate_hz
                && (rate_hz - got.rate_hz).abs() > 0.5
            {
                reports.push(Report::Unlike(format!(
                    "the {eye} camera runs at {:.1} frames per second instead of the {rate_hz:.1} asked for",
                    got.rate_hz
                )));
            }
        }
        reports
    }
}
