//! What takes long in tying the arms to the eyes.

use std::path::PathBuf;

use plumbline_handeye::Tied;
use plumbline_model::JobContext;

use super::kept::Kept;
use super::look::Look;
use crate::ground::jobs::JobError;
use crate::ground::{self, LongWork};
use crate::robot::RobotControl;

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum HandEyeWork {
    /// Reads what was accepted last.
    Restore {
        /// From where.
        file: PathBuf,
    },
    /// Looks.
    Look(Box<Look>),
    /// Keeps what was accepted.
    Keep {
        /// Where.
        file: PathBuf,
        /// What.
        kept: Box<Kept>,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum HandEyeResult {
    /// What was accepted last.
    Restored(Option<Box<Kept>>),
    /// A proposal.
    Looked(Box<Tied>),
    /// It is on disk.
    Kept,
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, HandEyeWork, RobotControl>;

impl LongWork for HandEyeWork {
    type Result = HandEyeResult;

    fn title(&self) -> String {
        match self {
            Self::Restore { .. } => "Read how arms and eyes were tied",
            Self::Look(_) => "Look at the hands",
            Self::Keep { .. } => "Keep how arms and eyes are tied",
        }
        .to_owned()
    }

    fn is_quiet(&self) -> bool {
        !matches!(self, Self::Look(_))
    }

    fn run(self, context: &dyn JobContext) -> Result<HandEyeResult, JobError> {
        match self {
            Self::Restore { file } => {
                let kept = Kept::read(&file).map_err(JobError::told)?;
                Ok(HandEyeResult::Restored(kept.map(Box::new)))
            }
            Self::Look(look) => Ok(HandEyeResult::Looked(Box::new(look.carry_out(context)?))),
            Self::Keep { file, kept } => {
                kept.write(&file).map_err(JobError::told)?;
                Ok(HandEyeResult::Kept)
            }
        }
    }
}

impl HandEyeResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Restored(_) => "How arms and eyes were tied was read.",
            Self::Looked(_) => "The eyes have looked at the hands: accept what came of it.",
            Self::Kept => "How arms and eyes are tied is kept.",
        }
        .to_owned()
    }
}
