//! Why an experiment cannot be run or put together.

use std::path::{Path, PathBuf};

use plumbline_model::files::FileError;
use plumbline_report::ReportError;

/// Why an experiment cannot be run or put together, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum TrialsError {
    /// The folder cannot be used.
    #[error("{} cannot be used: {error}. Choose another folder", .folder.display())]
    Folder {
        /// Which.
        folder: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file is none of this program's.
    #[error("{} is no file of an experiment: {error}. Delete it, and that attempt is made again", .file.display())]
    Unreadable {
        /// Which.
        file: PathBuf,
        /// What is wrong.
        error: serde_json::Error,
    },
    /// Two folders hold different experiments.
    #[error("{} holds another experiment (other twin, lab, methods, positions, object or seed): choose a new folder", .folder.display())]
    OtherExperiment {
        /// Which.
        folder: PathBuf,
    },
    /// Two folders say different things of one attempt.
    #[error("{} says something else of {file} than a folder before it: they come from different versions or labs", .folder.display())]
    Disagree {
        /// Which.
        folder: PathBuf,
        /// The attempt.
        file: String,
    },
    /// Nothing was given.
    #[error("name the folders to be merged")]
    NothingToMerge,
    /// It is of a newer program.
    #[error("{} has format {format}: read it with a newer program", .file.display())]
    Newer {
        /// Which.
        file: PathBuf,
        /// Its format.
        format: u32,
    },
    /// It says what cannot be.
    #[error("{} is no file of an experiment ({why}): delete it, and what it says is made again", .file.display())]
    Implausible {
        /// Which.
        file: PathBuf,
        /// What cannot be.
        why: String,
    },
    /// The page cannot be made.
    #[error(transparent)]
    Report(#[from] ReportError),
}

impl TrialsError {
    pub(super) fn other(folder: &Path) -> Self {
        Self::OtherExperiment { folder: folder.to_owned() }
    }

    pub(super) fn disagree(folder: &Path, file: &str) -> Self {
        Self::Disagree { folder: folder.to_owned(), file: file.to_owned() }
    }
}
