//! The file of the timeline, in the folder of its world.

use std::path::{Path, PathBuf};

use plumbline_model::files::{FileError, Size};
use serde::{Deserialize, Serialize};

use super::view::TimelineEntry;
use crate::ground::own_file::{self, NotOwn, Own};

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

impl TimelineError {
    fn of(file: &Path, why: NotOwn) -> Self {
        match why {
            NotOwn::File(error) => Self::File(error),
            NotOwn::Other(why) => Self::NoTimeline { file: file.to_owned(), why },
        }
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept<'a> {
    format: u32,
    entries: std::borrow::Cow<'a, [TimelineEntry]>,
}

impl Own for Kept<'_> {
    const FORMAT: u32 = FORMAT;
    const LONGEST: Size = Size::TEXT;

    fn format(&self) -> u32 {
        self.format
    }
}

/// Reads it; empty where there is none.
///
/// # Errors
/// When there is a file that is no timeline.
pub fn read(file: &Path) -> Result<Vec<TimelineEntry>, TimelineError> {
    let kept = own_file::read::<Kept<'_>>(file).map_err(|why| TimelineError::of(file, why))?;
    let Some(kept) = kept else { return Ok(Vec::new()) };
    let wrong = |why: String| TimelineError::NoTimeline { file: file.to_owned(), why };
    let entries = kept.entries.into_owned();
    let mut numbers: Vec<u64> = entries.iter().map(|entry| entry.number).collect();
    numbers.sort_unstable();
    if let Some(two) = numbers.windows(2).find(|two| two[0] == two[1]) {
        return Err(wrong(format!("two of its entries have the number {}", two[0])));
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
    own_file::write(file, &kept).map_err(|why| TimelineError::of(file, why))
}
