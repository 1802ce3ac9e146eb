//! What is remembered of detection from start to start.

use std::path::{Path, PathBuf};

use plumbline_model::files;

use super::view::DetectionSettings;

/// A file of settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Store {
    file: PathBuf,
}

impl Store {
    /// In this folder.
    pub fn new(folder: &Path) -> Self {
        Self { file: folder.join("detection.json") }
    }

    /// What was kept; the usual settings if nothing was.
    ///
    /// # Errors
    /// A sentence.
    pub fn read(&self) -> Result<DetectionSettings, String> {
        let text = match files::read_text(&self.file, files::Size::SHORT) {
            Ok(text) => text,
            Err(error) if error.is_absent() => {
                return Ok(DetectionSettings::default());
            }
            Err(error) => return Err(self.unusable(&error)),
        };
        let settings: DetectionSettings =
            serde_json::from_str(&text).map_err(|error| self.unusable(&error))?;
        let shares = settings.class_confidence.values().chain([&settings.confidence, &settings.iou]);
        let bad = shares.copied().find(|share| !(0.0..=1.0).contains(share));
        match bad {
            Some(share) => Err(self.unusable(&format!("{share} is not between 0 and 1"))),
            None => Ok(settings),
        }
    }

    /// Keeps settings.
    ///
    /// # Errors
    /// A sentence.
    pub fn keep(&self, settings: &DetectionSettings) -> Result<(), String> {
        if let Some(folder) = self.file.parent() {
            std::fs::create_dir_all(folder).map_err(|error| self.cannot(&error))?;
        }
        let text = serde_json::to_string_pretty(settings).map_err(|error| self.cannot(&error))?;
        files::write(&self.file, text).map_err(|error| crate::ground::text::sentence(&error.to_string()))
    }

    fn unusable(&self, reason: &dyn std::fmt::Display) -> String {
        format!(
            "The settings of detection in {} cannot be used ({reason}). The usual ones are taken; they are written there with the next change.",
            self.file.display()
        )
    }

    fn cannot(&self, reason: &dyn std::fmt::Display) -> String {
        format!(
            "{} cannot be written ({reason}). Check that the disk has free space and can be written.",
            self.file.display()
        )
    }
}
