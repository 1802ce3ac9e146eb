//! Commands of the timeline of results. What is on it is taken back by the workflow that made it.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::view::Subject;

/// The timeline of results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimelineCommand {
    /// Writes what is in use and how it came to that.
    Report {
        /// Where to.
        file: PathBuf,
        /// As what.
        format: TimelineFormat,
    },
    /// Undo: puts in use again what was before. A step back, and no step of its own, as it would be if the same were
    /// used again on purpose; where the workflow of that kind refuses it, nothing is noted.
    TakeBack {
        /// Of which kind.
        subject: Subject,
        /// What is in use again then: its id in its workflow; `None`: as it is described.
        to: Option<String>,
    },
}

/// As what the timeline is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimelineFormat {
    /// Every entry, a line each.
    Csv,
    /// A page that a browser shows.
    Html,
    /// The same as PDF.
    Pdf,
}
