//! Why a twin is not commissioned.

use std::path::PathBuf;

use plumbline_engine::gap::search::SearchError;
use plumbline_engine::ground::jobs::JobError;
use plumbline_engine::models::ModelError;
use plumbline_engine::motion::NoWay;
use plumbline_engine::touch::refusal::{RunError, Unplaced};
use plumbline_handeye::HandEyeError;
use plumbline_model::files::FileError;
use plumbline_model::robot::DescriptionError;
use plumbline_model::robot::ik::SolverError;
use plumbline_model::{Cancelled, SessionError};
use plumbline_twin::TwinError;
use plumbline_twin::eyes::RenderError;
use plumbline_vision::calibrate::SolveError;
use plumbline_vision::detect::DetectError;
use plumbline_vision::mount::{MountError, MountFileError};

use crate::OfflineError;

/// Why a twin is not commissioned, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum CommissionError {
    /// Stopped on request.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// There is no such twin.
    #[error(transparent)]
    Twin(#[from] TwinError),
    /// Nothing can be drawn.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The folder has the commissioning of another robot.
    #[error(
        "{} holds the commissioning of {found}, not of {wanted}: give another folder with --out, or remove it",
        .folder.display()
    )]
    OtherTwin {
        /// The folder.
        folder: PathBuf,
        /// Of whom it is.
        found: String,
        /// Who is to be commissioned.
        wanted: String,
    },
    /// A lab of another twin than the one that is to grasp.
    #[error(
        "{} was commissioned on the twin \"{of}\", and \"{asked}\" is another one or has changed since: name the twin that it was commissioned on with --twin, or commission \"{asked}\"",
        .folder.display()
    )]
    LabOfOther {
        /// The lab.
        folder: PathBuf,
        /// Its twin.
        of: String,
        /// The twin that was asked for.
        asked: String,
    },
    /// A lab of a scenario that is in a file, which the lab cannot name, or that has changed since.
    #[error(
        "{} was commissioned on the twin \"{of}\" of a file, or as it was before: name the file with --twin, or commission it anew",
        .folder.display()
    )]
    LabOfFile {
        /// The lab.
        folder: PathBuf,
        /// Its twin.
        of: String,
    },
    /// A folder that does not say of which twin it is.
    #[error("{} does not say on which twin it was commissioned: name it with --twin", .folder.display())]
    NoTwin {
        /// The folder.
        folder: PathBuf,
    },
    /// What was written about the steps cannot be read.
    #[error("{} cannot be used ({reason}): give another folder with --out, or remove it", .file.display())]
    Steps {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A step needs what an earlier one left, and it is gone.
    #[error("{what} is not in {} any more: remove the folder and begin again", .folder.display())]
    Gone {
        /// What.
        what: &'static str,
        /// The folder.
        folder: PathBuf,
    },
    /// What the published methods know cannot be read.
    #[error("{} cannot be used ({reason}): remove it, and it is made anew", .file.display())]
    Published {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The eyes cannot be solved.
    #[error(transparent)]
    Eyes(#[from] SolveError),
    /// The mount cannot be solved.
    #[error(transparent)]
    Mount(#[from] MountError),
    /// The mount cannot be kept.
    #[error(transparent)]
    MountFile(#[from] MountFileError),
    /// What a room of the window refused.
    #[error("{0}")]
    Room(String),
    /// The finger touches too little.
    #[error(
        "the finger met the glass at {touched} of {planned} places, which tell nothing: is the screen where the rig file has it? {example}"
    )]
    TooFewTouches {
        /// Contacts.
        touched: usize,
        /// Places that it was sent to.
        planned: usize,
        /// What became of the first one that was missed.
        example: String,
    },
    /// Nothing can be planned.
    #[error(transparent)]
    NoWay(#[from] NoWay),
    /// The robot has no such finger.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The robot has no such part.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// The session cannot be read.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The detector cannot be opened.
    #[error(transparent)]
    Detect(#[from] DetectError),
    /// There is no detector to look for the object with.
    #[error("the detector that comes with the program is not beside it: install it whole")]
    NoDetector,
}

impl CommissionError {
    /// From an error of a room, whose words are a sentence.
    pub(crate) fn room(error: impl std::fmt::Display) -> Self {
        Self::Room(error.to_string())
    }
}

impl From<JobError> for CommissionError {
    fn from(error: JobError) -> Self {
        match error {
            JobError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            JobError::Failed(why) => Self::Room(why),
        }
    }
}

impl From<HandEyeError> for CommissionError {
    fn from(error: HandEyeError) -> Self {
        match error {
            HandEyeError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::room(other),
        }
    }
}

impl From<RunError> for CommissionError {
    fn from(error: RunError) -> Self {
        Self::room(error)
    }
}

impl From<Unplaced> for CommissionError {
    fn from(error: Unplaced) -> Self {
        Self::room(error)
    }
}

impl From<ModelError> for CommissionError {
    fn from(error: ModelError) -> Self {
        Self::room(error)
    }
}

impl From<SearchError> for CommissionError {
    fn from(error: SearchError) -> Self {
        match error {
            SearchError::Gap(plumbline_gap::GapError::Cancelled(cancelled)) => Self::Cancelled(cancelled),
            other => Self::room(other),
        }
    }
}

impl From<CommissionError> for OfflineError {
    fn from(error: CommissionError) -> Self {
        match error {
            CommissionError::Cancelled(cancelled) => cancelled.into(),
            other => Self::OnTwin(Box::new(other)),
        }
    }
}
