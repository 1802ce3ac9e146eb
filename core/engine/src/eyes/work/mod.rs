//! The long parts of calibrating the eyes.

mod accept;
mod capture;
mod export;
mod health;
mod keep;
mod open;
mod recording;
mod restore;
mod solve;

use plumbline_model::{JobContext, counted};

use super::view::BoardSeen;
use crate::ground;
use crate::ground::LongWork;
use crate::ground::jobs::JobError;

pub use accept::{Accept, Accepted};
pub use capture::{Capture, Captured, Recognize, board_seen, find_in_both, glimpse_in_both, gray};
pub use export::Export;
pub use health::{Health, HealthEnded, Pictures, at_most_busy};
pub use keep::Keep;
pub use open::{Open, OpenWhat, Opened};
pub use recording::{CollectRecording, Collected, collect_folder};
pub use restore::{Restore, Restored, UseEarlier};
pub use solve::{Solve, Solved};

/// Something to do beside the window.
#[derive(Clone, Debug)]
pub enum EyesWork {
    /// Find the board in the newest pair.
    Capture(Capture),
    /// Say which board the newest pair shows.
    Recognize(Recognize),
    /// Keep a captured pair on disk.
    Keep(Keep),
    /// Find the board in all pairs of a recording.
    CollectRecording(CollectRecording),
    /// Solve the collected pairs.
    Solve(Solve),
    /// Read a calibration as a proposal.
    Open(Open),
    /// Judge the calibration in use, and a proposed one.
    Health(Health),
    /// Keep a calibration and make it the one in use.
    Accept(Accept),
    /// Write a calibration to a file.
    Export(Export),
    /// Read what was accepted before.
    Restore(Restore),
    /// Put what was accepted earlier in use again.
    UseEarlier(UseEarlier),
}

/// What came out.
#[derive(Clone, Debug)]
pub enum EyesResult {
    /// A pair in which both eyes see the board.
    Captured(Captured),
    /// The board that is seen.
    Recognized(BoardSeen),
    /// A captured pair was written to this session.
    Kept(std::path::PathBuf),
    /// Pairs of a recording.
    Collected(Collected),
    /// A calibration solved from pairs.
    Solved(Solved),
    /// A calibration read from a file.
    Opened(Opened),
    /// What ordinary pairs say of the calibrations.
    Health(HealthEnded),
    /// A calibration that is kept.
    Accepted(Accepted),
    /// Files that were written.
    Exported(Vec<std::path::PathBuf>),
    /// What was accepted before.
    Restored(Restored),
    /// What is in use again.
    UsedEarlier(Restored),
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, EyesWork>;

impl LongWork for EyesWork {
    type Result = EyesResult;

    fn title(&self) -> String {
        match self {
            Self::Capture(_) => "Capture pair".to_owned(),
            Self::Recognize(_) => "Look which board is seen".to_owned(),
            Self::Keep(_) => "Keep the captured pair".to_owned(),
            Self::CollectRecording(_) => "Collect the pairs of the recording".to_owned(),
            Self::Solve(solve) => format!("Solve {}", counted(solve.pair_count(), "pair")),
            Self::Open(open) => open.title(),
            Self::Health(_) => "Judge the calibration by what the eyes see".to_owned(),
            Self::Accept(_) => "Accept calibration".to_owned(),
            Self::Export(export) => format!("Write {}", export.file.display()),
            Self::Restore(_) => "Read the calibration in use".to_owned(),
            Self::UseEarlier(UseEarlier { id: None, .. }) => "Use no calibration".to_owned(),
            Self::UseEarlier(_) => "Go back to an earlier calibration".to_owned(),
        }
    }

    fn is_quiet(&self) -> bool {
        match self {
            Self::Capture(_) | Self::Recognize(_) | Self::Keep(_) | Self::Restore(_) | Self::Health(_) => {
                true
            }
            Self::CollectRecording(_)
            | Self::Accept(_)
            | Self::Solve(_)
            | Self::Open(_)
            | Self::Export(_)
            | Self::UseEarlier(_) => false,
        }
    }

    fn run(self, context: &dyn JobContext) -> Result<EyesResult, JobError> {
        Ok(match self {
            Self::Capture(work) => EyesResult::Captured(work.run()?),
            Self::Recognize(work) => EyesResult::Recognized(work.run()),
            Self::Keep(work) => EyesResult::Kept(work.run()?),
            Self::CollectRecording(work) => EyesResult::Collected(work.run(context)?),
            Self::Solve(work) => EyesResult::Solved(work.run(context)?),
            Self::Open(work) => EyesResult::Opened(work.run(context)?),
            Self::Health(work) => EyesResult::Health(work.run(context)?),
            Self::Accept(work) => EyesResult::Accepted(work.run()?),
            Self::Export(work) => EyesResult::Exported(work.run()?),
            Self::Restore(work) => EyesResult::Restored(work.run(context)?),
            Self::UseEarlier(work) => EyesResult::UsedEarlier(work.run(context)?),
        })
    }
}

impl EyesResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Captured(captured) => format!("Captured {}.", captured.pair.name),
            Self::Recognized(seen) => seen.text.clone(),
            Self::Kept(folder) => format!("Captured pairs are kept in {}.", folder.display()),
            Self::Collected(collected) => collected.summary(),
            Self::Solved(solved) => solved.summary(),
            Self::Opened(opened) => format!("Read {}.", opened.what()),
            Self::Health(_) => "The calibration was judged by what the eyes see.".to_owned(),
            Self::Accepted(_) => "The calibration is in use.".to_owned(),
            Self::Exported(files) => {
                let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
                format!("Wrote {}.", names.join(" and "))
            }
            Self::Restored(_) => "Read the calibration in use.".to_owned(),
            Self::UsedEarlier(Restored { in_use: None, .. }) => {
                "No calibration is in use: the eyes are as their description has them.".to_owned()
            }
            Self::UsedEarlier(_) => "The earlier calibration is in use again.".to_owned(),
        }
    }
}
