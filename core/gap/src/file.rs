//! Findings as files.

use std::path::{Path, PathBuf};

use plumbline_model::FormatError;
use plumbline_model::files::{self, told};
use plumbline_model::formats::read_text;

use crate::finding::{FORMAT, Finding};

/// Why a finding could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FindingFileError {
    /// The file itself.
    #[error(transparent)]
    File(#[from] FormatError),
    /// Not a finding.
    #[error("{} is not a saved gap finding ({reason}): choose a file that this program wrote, or look for the gap again", file.display())]
    NotFinding {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Of another version.
    #[error(
        "{} was written by another version of the program (format {found}, this one reads {FORMAT}): look for the gap \
         again, or use the version {version} that wrote it",
        file.display()
    )]
    OtherFormat {
        /// The file.
        file: PathBuf,
        /// Its format.
        found: u32,
        /// The program that wrote it.
        version: String,
    },
}

/// What every version of a finding has.
#[derive(serde::Deserialize)]
struct Head {
    format: u32,
    #[serde(default)]
    version: String,
}

impl Finding {
    /// Reads a finding.
    ///
    /// # Errors
    /// When the file is none, or of another version.
    pub fn read(file: &Path) -> Result<Self, FindingFileError> {
        let text = read_text(file)?;
        let misfit = |error: serde_json::Error| FindingFileError::NotFinding {
            file: file.to_owned(),
            reason: told(&error.to_string()),
        };
        let head: Head = serde_json::from_str(&text).map_err(misfit)?;
        if head.format != FORMAT {
            return Err(FindingFileError::OtherFormat {
                file: file.to_owned(),
                found: head.format,
                version: head.version,
            });
        }
        serde_json::from_str(&text).map_err(misfit)
    }

    /// Writes it as JSON, in one step: the old file stays until the new one is whole.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), FindingFileError> {
        let text = serde_json::to_string_pretty(self).map_err(|error| FindingFileError::NotFinding {
            file: file.to_owned(),
            reason: told(&error.to_string()),
        })?;
        Ok(files::write(file, text).map_err(FormatError::from)?)
    }
}
