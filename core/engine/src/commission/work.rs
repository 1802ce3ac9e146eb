//! What takes long in commissioning: reading and writing its file.

use std::path::PathBuf;

use plumbline_model::JobContext;

use super::kept::Kept;
use crate::ground::jobs::JobError;
use crate::ground::{self, LongWork};

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum CommissionWork {
    /// Reads how far it is.
    Restore {
        /// The file.
        file: PathBuf,
    },
    /// Writes how far it is.
    Keep {
        /// The file.
        file: PathBuf,
        /// How far it is.
        kept: Box<Kept>,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum CommissionResult {
    /// How far it is; `None`: never begun.
    Restored(Option<Box<Kept>>),
    /// It is on disk.
    Kept,
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, CommissionWork>;

impl LongWork for CommissionWork {
    type Result = CommissionResult;

    fn title(&self) -> String {
        match self {
            Self::Restore { .. } => "Read how far commissioning is".to_owned(),
            Self::Keep { .. } => "Write how far commissioning is".to_owned(),
        }
    }

    fn is_quiet(&self) -> bool {
        true
    }

    fn run(self, _: &dyn JobContext) -> Result<CommissionResult, JobError> {
        match self {
            Self::Restore { file } => {
                let kept = Kept::read(&file).map_err(JobError::told)?;
                Ok(CommissionResult::Restored(kept.map(Box::new)))
            }
            Self::Keep { file, kept } => {
                kept.write(&file).map_err(JobError::told)?;
                Ok(CommissionResult::Kept)
            }
        }
    }
}

impl CommissionResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Restored(Some(kept)) => {
                format!("Commissioning was begun on {}.", kept.began.strftime("%Y-%m-%d"))
            }
            Self::Restored(None) => "Commissioning was not begun yet.".to_owned(),
            Self::Kept => "How far commissioning is, is on disk.".to_owned(),
        }
    }
}
