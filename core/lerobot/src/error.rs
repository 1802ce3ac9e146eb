//! Why a recording cannot be exported.

use std::path::{Path, PathBuf};

use plumbline_model::files::FileError;
use plumbline_recording::RecordingError;

/// Why a recording cannot be exported, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// It cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// Nothing of it makes a frame.
    #[error("{} has no pair of images with angles read before it: record with the robot connected", .0.display())]
    NoFrames(PathBuf),
    /// What is there is not touched.
    #[error("{} is not empty: choose another folder, or empty it", .0.display())]
    NotEmpty(PathBuf),
    /// A file cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// An image is none.
    #[error("pair {pair} of {} has an image that cannot be read ({reason}): record anew", .recording.display())]
    Image {
        /// Which recording.
        recording: PathBuf,
        /// Which pair, from 1.
        pair: usize,
        /// What is wrong.
        reason: String,
    },
    /// A table cannot be written.
    #[error("{} cannot be written ({reason}): check that the disk has room", .file.display())]
    Table {
        /// Which file.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// Stopped on request.
    #[error(transparent)]
    Cancelled(#[from] plumbline_model::Cancelled),
}

impl ExportError {
    pub(crate) fn table(file: &Path) -> impl FnOnce(parquet::errors::ParquetError) -> Self {
        let file = file.to_owned();
        move |error| Self::Table { file, reason: error.to_string() }
    }
}
