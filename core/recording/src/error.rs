//! What goes wrong with a recording.

use std::io;
use std::path::{Path, PathBuf};

/// Why a recording cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// The file system says no.
    #[error("{}: {error}; check that the disk is there and has room", .file.display())]
    Io {
        /// Which file.
        file: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// It is no recording, or not one of this program.
    #[error("{} is not a recording that can be read ({what}): record anew, or open another file", .file.display())]
    NotARecording {
        /// Which file.
        file: PathBuf,
        /// What is wrong.
        what: String,
    },
    /// What is to be recorded does not fit the format.
    #[error("{} cannot be recorded: {what}", .topic)]
    Message {
        /// Where it was to go.
        topic: &'static str,
        /// What is wrong.
        what: String,
    },
    /// A pair beyond the end.
    #[error("there is no pair number {index}: the recording has {pairs}, counted from 0")]
    NoSuchPair {
        /// Asked for.
        index: usize,
        /// Number of pairs.
        pairs: usize,
    },
}

impl RecordingError {
    pub(crate) fn io(file: &Path) -> impl FnOnce(io::Error) -> Self {
        let file = file.to_owned();
        move |error| Self::Io { file, error }
    }

    /// An error of the library, which wraps those of the system.
    pub(crate) fn mcap(file: &Path) -> impl FnOnce(mcap::McapError) -> Self {
        let file = file.to_owned();
        move |error| match error {
            mcap::McapError::Io(error) => Self::Io { file, error },
            other => Self::NotARecording { file, what: other.to_string() },
        }
    }
}
