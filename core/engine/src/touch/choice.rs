//! What the operator chose to correct targets with, kept over a restart.

use std::path::Path;

use plumbline_model::files::{self, FileError, Size};
use serde::{Deserialize, Serialize};

use super::command::Correction;
use crate::ground::shelf::InUse;

/// As it stands in its file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    correct_with: Option<Correction>,
}

/// Why what was chosen is not known.
#[derive(Debug, thiserror::Error)]
pub enum NoChoice {
    /// The file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// It says something else.
    #[error("{file} does not say what targets are corrected with ({reason}): choose it anew in Touch")]
    Unclear {
        /// Which file.
        file: String,
        /// What is wrong.
        reason: String,
    },
}

/// Where a world keeps it.
pub fn choice_in(folder: &Path) -> InUse {
    InUse::new(folder.join("touch_correction.json"))
}

/// Reads it; inside: nothing may have been chosen as well.
///
/// # Errors
/// When there is a file that is not one.
pub fn read(kept: &InUse) -> Result<Option<Option<Correction>>, NoChoice> {
    kept.read(|file| {
        let text = files::read_text(file, Size::SHORT)?;
        let unclear = |error: serde_json::Error| NoChoice::Unclear {
            file: file.display().to_string(),
            reason: error.to_string(),
        };
        Ok(serde_json::from_str::<Kept>(&text).map_err(unclear)?.correct_with)
    })
}

/// Keeps it.
///
/// # Errors
/// When it cannot be written; what was kept stays.
pub fn write(kept: &InUse, correct_with: Option<Correction>) -> Result<(), NoChoice> {
    let text = serde_json::to_string(&Kept { correct_with }).expect("two words are JSON");
    if let Some(folder) = kept.file().parent() {
        files::make_folder(folder)?;
    }
    Ok(files::write(kept.file(), text)?)
}
