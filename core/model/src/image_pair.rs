//! One moment seen by both eyes.

use std::sync::Arc;
use std::time::Instant;

use image::RgbImage;
use serde::{Deserialize, Serialize};

use crate::plausible;

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
    /// What its source knows besides.
    pub beside: Beside,
}

/// What a source knows of a pair besides its images.
#[derive(Clone, Debug, Default)]
pub struct Beside {
    /// The images as the cameras have compressed them, left and right, where they did and left out nothing that
    /// decoders need.
    pub jpegs: Option<[Arc<[u8]>; 2]>,
    /// How the eyes were then, of a pair that was recorded; `None`: it comes as it is taken, or from a source that
    /// says nothing of the kind.
    pub then: Option<EyesThen>,
}

/// How the eyes were when a pair was taken, as far as that is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EyesThen {
    /// For how long they had been on, s.
    #[serde(default, rename = "eyes_on_s")]
    pub on_s: Option<f64>,
    /// How the head stood: pan and tilt, rad.
    #[serde(default)]
    pub head_rad: Option<[f64; 2]>,
}

impl EyesThen {
    /// Whether nothing is known.
    pub fn is_unknown(&self) -> bool {
        *self == Self::default()
    }

    /// The same without what cannot be: a file may say anything.
    #[must_use]
    pub fn as_can_be(self) -> Self {
        let head_rad = self.head_rad.filter(|angles| plausible::JOINT_ANGLE_RAD.check_all(angles).is_ok());
        let on_s = self.on_s.filter(|on_s| *on_s >= 0.0 && plausible::TIME_S.contains(*on_s));
        Self { on_s, head_rad }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_is_not_known() {
        let then = EyesThen { on_s: Some(-3.0), head_rad: Some([0.1, 99.0]) };
        assert!(then.as_can_be().is_unknown(), "{:?}", then.as_can_be());
        let then = EyesThen { on_s: Some(600.0), head_rad: Some([0.1, -0.6]) };
        assert_eq!(then.as_can_be(), then);
    }
}
