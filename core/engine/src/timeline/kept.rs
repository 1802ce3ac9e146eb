//! The file of the timeline, in the folder of its world.

use std::path::{Path, PathBuf};

use plumbline_model::files::{self, FileError, Size};
use serde::{Deserialize, Serialize};

use super::view::TimelineEntry;

/// The file, in the folder of a world.
pub const FILE: &str = "timeline.json";
/// Version of the file.
const FORMAT: u32 = 1;

/// Why it cannot be kept, or read. Reads as a sentence.
#[derive(Debug, thiserror::Error)]
pub enum TimelineError {
    /// The file itself.
    #[error(transparent)]
    File(#[from] FileError),
    /// It is something else.
    #[error("{} is no timeline of results ({why}): move it away, and a new one begins", .file.display())]
    NoTimeline {
        /// Which.
        file: PathBuf,
        /// What is wrong with it.
        why: String,
    },
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept<'a> {
    format: u32,
    entries: std::borrow::Cow<'a, [TimelineEntry]>,
}

/// Reads it; empty where there is none.
///
/// # Errors
/// When there is a file that is no timeline.
pub fn read(file: &Path) -> Result<Vec<TimelineEntry>, TimelineError> {
    let text = match files::read_text(file, Size::TEXT) {
        Ok(text) => text,
        Err(error) if error.is_absent() => return Ok(Vec::new()),
        Err(error) => return Err(error.into()),
    };
    let wrong = |why: String| TimelineError::NoTimeline { file: file.to_owned(), why };
    let kept: Kept<'_> = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    if kept.format != FORMAT {
        return Err(wrong(format!("it has format {}, this program knows {FORMAT}", kept.format)));
    }
    let entries = kept.entries.into_owned();
    if entries.windows(2).any(|two| two[0].number >= two[1].number) {
        return Err(wrong("its entries are not numbered in their order".to_owned()));
    }
    let figures = entries.iter().flat_map(|entry| [entry.before, entry.after]).flatten();
    if let Some(figure) = figures.map(|figure| figure.value()).find(|value| !(0.0..1e6).contains(value)) {
        return Err(wrong(format!("an error of {figure} is none")));
    }
    Ok(entries)
}

/// Writes it in place of what was.
///
/// # Errors
/// When it cannot be written; then the old one is there.
pub fn write(file: &Path, entries: &[TimelineEntry]) -> Result<(), TimelineError> {
    let kept = Kept { format: FORMAT, entries: entries.into() };
    let text = serde_json::to_vec_pretty(&kept)
        .map_err(|error| TimelineError::NoTimeline { file: file.to_owned(), why: error.to_string() })?;
    if let Some(folder) = file.parent() {
        files::make_folder(folder)?;
    }
    Ok(files::write(file, text)?)
}
