//! A JSON file that a workflow keeps in the folder of its world, with the version of its format.

use std::path::Path;

use plumbline_model::files::{self, FileError, Size};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// What is kept in a file.
pub trait Own: Serialize + DeserializeOwned {
    /// Version of the file.
    const FORMAT: u32;
    /// It is never longer.
    const LONGEST: Size;

    /// The version that a file has.
    fn format(&self) -> u32;
}

/// Why it cannot be read or written. The workflow knows what the file should be, and says so.
#[derive(Debug)]
pub enum NotOwn {
    /// The file itself.
    File(FileError),
    /// It is something else: why.
    Other(String),
}

impl From<FileError> for NotOwn {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}

/// Reads it; `None` where there is none.
///
/// # Errors
/// When there is a file that is something else.
pub fn read<T: Own>(file: &Path) -> Result<Option<T>, NotOwn> {
    let text = match files::read_text(file, T::LONGEST) {
        Ok(text) => text,
        Err(error) if error.is_absent() => return Ok(None),
        Err(error) => return Err(error.into()),
    };
    let kept: T = serde_json::from_str(&text).map_err(|error| NotOwn::Other(error.to_string()))?;
    let (format, known) = (kept.format(), T::FORMAT);
    if format != known {
        return Err(NotOwn::Other(format!("it has format {format}, this program knows {known}")));
    }
    Ok(Some(kept))
}

/// Writes it in place of what was.
///
/// # Errors
/// When it cannot be written; then the old one is there.
pub fn write<T: Own>(file: &Path, kept: &T) -> Result<(), NotOwn> {
    let text = serde_json::to_vec_pretty(kept).map_err(|error| NotOwn::Other(error.to_string()))?;
    if let Some(folder) = file.parent() {
        files::make_folder(folder)?;
    }
    Ok(files::write(file, text)?)
}
