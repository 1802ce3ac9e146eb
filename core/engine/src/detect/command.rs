//! Detecting objects, live.

use std::path::PathBuf;

pub use plumbline_vision::detect::Provider;
use serde::{Deserialize, Serialize};

/// Detecting objects, live.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DetectCommand {
    /// Uses another detector, or none; it is read in the background, and the one in use stays
    /// until that is done.
    Use(DetectorChoice),
    /// Reads the chosen detector anew.
    Retry,
    /// Where the network is computed.
    Provider(Provider),
    /// Least confidence of all classes without one of their own, 0–1.
    Confidence(f32),
    /// Least confidence of one class; `None` takes that of all.
    ClassConfidence {
        /// Its name.
        class: String,
        /// 0–1.
        confidence: Option<f32>,
    },
    /// Overlap from which two boxes of a class are one thing, 0–1.
    Iou(f32),
    /// Shows a class, or not.
    Show {
        /// Its name.
        class: String,
        /// Whether it is shown.
        shown: bool,
    },
    /// Shows all classes.
    ShowAll,
    /// Thresholds and filter as they come with the program.
    UsualThresholds,
    /// Counts how often classes are seen from here on.
    ResetRates,
}

/// Which detector.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DetectorChoice {
    /// The one that comes with the program.
    #[default]
    Shipped,
    /// An ONNX file.
    File(PathBuf),
    /// None.
    Off,
}

impl DetectorChoice {
    /// Short name.
    pub fn name(&self) -> String {
        match self {
            Self::Shipped => "Plumbline's own".to_owned(),
            Self::File(file) => match file.file_name() {
                Some(name) => name.to_string_lossy().into_owned(),
                None => file.display().to_string(),
            },
            Self::Off => "none".to_owned(),
        }
    }
}
