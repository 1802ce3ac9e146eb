//! What is remembered of detection from start to start.

use std::path::{Path, PathBuf};

use plumbline_model::files::{self, FileError};

use super::view::DetectionSettings;
use crate::ground::text::sentence;

/// Why settings are not remembered.
#[derive(Debug, thiserror::Error)]
pub enum SettingsError {
    /// What was kept cannot be used.
    #[error(
        "The settings of detection in {} cannot be used ({reason}). The usual ones are taken; they are written there with the next change.",
        .file.display()
    )]
    Unusable {
        /// Which file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// The system says no.
    #[error("{} cannot be written ({reason}). Check that the disk has free space and can be written.", .file.display())]
    Unwritable {
        /// Which file.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The file itself.
    #[error("{}", sentence(&.0.to_string()))]
    File(#[from] FileError),
}

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
    pub fn read(&self) -> Result<DetectionSettings, SettingsError> {
        let text = match files::read_text(&self.file, files::Size::SHORT) {
            Ok(text) => text,
            Err(error) if error.is_absent() => {
                return Ok(DetectionSettings::default());
            }
            Err(error) => return Err(self.unusable(error)),
        };
        let settings: DetectionSettings =
            serde_json::from_str(&text).map_err(|error| self.unusable(error))?;
        let shares = settings.class_confidence.values().chain([&settings.confidence, &settings.iou]);
        let bad = shares.copied().find(|share| !(0.0..=1.0).contains(share));
        match bad {
            Some(share) => Err(self.unusable(format!("{share} is not between 0 and 1"))),
            None => Ok(settings),
        }
    }

    /// Keeps settings.
    ///
    /// # Errors
    /// A sentence.
    pub fn keep(&self, settings: &DetectionSettings) -> Result<(), SettingsError> {
        if let Some(folder) = self.file.parent() {
            std::fs::create_dir_all(folder).map_err(|error| self.cannot(error))?;
        }
        let text = serde_json::to_string_pretty(settings).map_err(|error| self.cannot(error))?;
        Ok(files::write(&self.file, text)?)
    }

    fn unusable(&self, reason: impl std::fmt::Display) -> SettingsError {
        SettingsError::Unusable { file: self.file.clone(), reason: reason.to_string() }
    }

    fn cannot(&self, reason: impl std::fmt::Display) -> SettingsError {
        SettingsError::Unwritable { file: self.file.clone(), reason: reason.to_string() }
    }
}
