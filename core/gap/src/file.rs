//! Findings as files.

use std::path::{Path, PathBuf};

use plumbline_model::FormatError;
use plumbline_model::files::{self, told};
use plumbline_model::formats::read_text;

use crate::finding::{FORMAT, Finding, ShownUnit};

/// The oldest format that is read.
const OLDEST: u32 = 1;

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
        if !(OLDEST..=FORMAT).contains(&head.format) {
            return Err(FindingFileError::OtherFormat {
                file: file.to_owned(),
                found: head.format,
                version: head.version,
            });
        }
        let mut finding: Self = serde_json::from_str(&text).map_err(misfit)?;
        if finding.format == OLDEST {
            finding.take_as_millimeters();
        }
        Ok(finding)
    }

    /// Makes meters of its lengths, and the newest format of it.
    fn take_as_millimeters(&mut self) {
        self.format = FORMAT;
        let shown = &mut self.shown;
        if shown.unit == ShownUnit::Pixel {
            return;
        }
        let of_unseen = shown.unseen.iter_mut().flat_map(|of| [&mut of.before, &mut of.after, &mut of.floor]);
        [&mut shown.before, &mut shown.after, &mut shown.floor]
            .into_iter()
            .chain(&mut shown.worst_tenth)
            .chain(of_unseen)
            .chain(self.effects.iter_mut().map(|effect| &mut effect.size_m))
            .for_each(|length| *length *= 1e-3);
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
