//! Why an experiment cannot be run or put together.

use std::path::{Path, PathBuf};

use plumbline_grasp::attempt::NoHand;
use plumbline_model::files::FileError;

use crate::OfflineError;

/// Why an experiment cannot be run or put together, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum TrialsError {
    /// Nothing is known of such a thing.
    #[error("nothing is known of a thing called {object}: choose one of tomato, mushroom, onion, orange")]
    Unknown {
        /// Its name.
        object: String,
    },
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
    #[error("{} holds another experiment (other twin, methods, positions, object or seed): choose a new folder", .folder.display())]
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
    /// The hand has no shape.
    #[error(transparent)]
    Hand(#[from] NoHand),
}

impl TrialsError {
    pub(super) fn unknown(object: &str) -> Self {
        Self::Unknown { object: object.to_owned() }
    }

    pub(super) fn other(folder: &Path) -> Self {
        Self::OtherExperiment { folder: folder.to_owned() }
    }

    pub(super) fn disagree(folder: &Path, file: &str) -> Self {
        Self::Disagree { folder: folder.to_owned(), file: file.to_owned() }
    }
}

impl From<TrialsError> for OfflineError {
    fn from(error: TrialsError) -> Self {
        Self::OnTwin(Box::new(error))
    }
}
