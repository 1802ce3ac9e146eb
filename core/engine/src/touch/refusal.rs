//! Why something cannot be done with touches: sentences that say what to do.

use std::path::{Path, PathBuf};

use plumbline_correction::Method;
use plumbline_model::files::FileError;
use plumbline_model::robot::DescriptionError;
use plumbline_model::session::names;
use plumbline_model::{FormatError, PlacementError, SessionError};

use crate::ground::text::sentence;

/// Why nothing can be touched now.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Trouble {
    /// There is no arm.
    #[error("No robot is connected. Connect to the robot or the twin, then go on.")]
    NotConnected,
    /// The operator said so.
    #[error("STOP is latched. Release it, look that the arm is free, then go on.")]
    Stopped,
    /// Nobody knows where the arm is.
    #[error("The joints have not been read yet. Wait a moment, then go on.")]
    NotRead,
    /// It sinks.
    #[error("The joints are limp and sink. Hold all joints, on the screen Robot, then go on.")]
    Limp,
    /// Nothing would be felt.
    #[error(
        "The touch window is closed, so no contact can be felt. Open it full screen on the touch monitor, then go on."
    )]
    WindowClosed,
    /// A finger that touches would drop what the hand holds, onto the screen.
    #[error(
        "The {} hand holds the {}. Put it down first, on the screen Grasp, then go on.",
        .0.hand, .0.object.to_lowercase()
    )]
    FullHand(Held),
}

/// What a hand holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Held {
    /// Name of the hand.
    pub hand: &'static str,
    /// What.
    pub object: String,
}

/// Why a command is not done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// Nothing can be touched now.
    #[error(transparent)]
    Trouble(#[from] Trouble),
    /// It speaks of a run.
    #[error("No run is open. Plan touches, or open an unfinished run.")]
    NoRun,
    /// One at a time.
    #[error("A run is under way. Finish or close it first.")]
    RunUnderWay,
    /// It would be lost.
    #[error("The last change is not on disk yet. Close when it is written.")]
    NotOnDisk,
    /// The plan is not there yet.
    #[error("The plan is still being made. Wait until it is there.")]
    StillPlanning,
    /// There is no plan.
    #[error("Nothing is planned yet. Plan touches first.")]
    NothingPlanned,
    /// The plan is empty.
    #[error("The arm reaches none of the targets. Choose another area and plan again.")]
    NothingInReach,
    /// Nothing was trained.
    #[error(
        "There is no model {} to correct targets with. Train it in step Models first, or correct with none.",
        .0.name()
    )]
    NoModel(Method),
    /// Nothing was measured.
    #[error("No measured place of the screen waits. Touch its corners first.")]
    NoPlacement,
    /// The plan has fewer.
    #[error("The plan has no target {0}.")]
    NoTarget(usize),
    /// It was refused when it was planned.
    #[error("Target {number} cannot be touched: {reason}")]
    CannotBeTouched {
        /// From 1.
        number: usize,
        /// A sentence.
        reason: String,
    },
    /// It is under way.
    #[error("Target {0} is being touched just now.")]
    BeingTouched(usize),
    /// Nothing counts.
    #[error("Target {0} has no touch that counts, so there is none to reject.")]
    NothingToReject(usize),
    /// Nothing was rejected.
    #[error("Target {0} has no rejected touch that could count again.")]
    NothingToRestore(usize),
    /// Everything is done.
    #[error("All touches are done, so there is none to skip.")]
    NothingToSkip,
    /// Nobody reaches under an arm that moves.
    #[error("An arm moves. Wait until it stands, then put the screen on its block.")]
    ArmMoves,
    /// It may be over the screen.
    #[error("It is not known where the arm is that touches. Wait until its joints are heard, then go on.")]
    ArmUnknown,
    /// The screen would meet it.
    #[error(
        "{0}: the hand is over the screen, no higher than the glass would be on its block, or nearly so. Bring it home (Robot) before the screen is raised."
    )]
    HandInScreen(String),
    /// Block and weight.
    #[error("Height and weight must be numbers from zero on.")]
    NotNumbers,
}

/// Why the touches do not tell where the screen lies.
#[derive(Debug, thiserror::Error)]
pub enum Unplaced {
    /// The robot has no such fingertip.
    #[error("{}", sentence(&.0.to_string()))]
    Description(#[from] DescriptionError),
    /// Touches of another robot.
    #[error("The run was made with another arm than this robot's.")]
    OtherArm,
    /// Too few, or they do not fit.
    #[error("{}", sentence(&.0.to_string()))]
    Placement(#[from] PlacementError),
}

/// Why the place of the screen that was accepted is not used.
#[derive(Debug, thiserror::Error)]
pub enum NotRestored {
    /// Its file is no placement of this robot.
    #[error("{} {NOMINAL}", sentence(&.0.to_string()))]
    Placement(#[from] PlacementError),
    /// The file itself.
    #[error("{} {NOMINAL}", sentence(&.0.to_string()))]
    File(#[from] FileError),
}

const NOMINAL: &str = "Until then the described place is used.";

/// Why a run cannot be begun, written or opened.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The robot has no such fingertip.
    #[error("{}", sentence(&.0.to_string()))]
    Description(#[from] DescriptionError),
    /// The tables or the manifest of the session.
    #[error("{}", sentence(&.0.to_string()))]
    Session(#[from] SessionError),
    /// The session's own file.
    #[error("{}", sentence(&.0.to_string()))]
    Format(#[from] FormatError),
    /// A file itself.
    #[error("{}", sentence(&.0.to_string()))]
    File(#[from] FileError),
    /// The system says no.
    #[error("{} cannot be written ({error}). Make room or give the right to write there.", .path.display())]
    Unwritable {
        /// What was tried to write.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// A defect of this program.
    #[error("{} cannot be put into words ({error}). Please report it.", .file.display())]
    Unspeakable {
        /// What was tried to write.
        file: PathBuf,
        /// Why not.
        error: serde_json::Error,
    },
    /// It is not what was written.
    #[error("{} is damaged ({error}).", .file.display())]
    Damaged {
        /// Which.
        file: PathBuf,
        /// What is wrong.
        error: serde_json::Error,
    },
    /// The run cannot go on because one of its files cannot be read.
    #[error("{0} {STILL}")]
    Unread(Box<RunError>),
    /// The run was written by another version.
    #[error("{} was written by another version of this program. {STILL}", .0.display())]
    OtherVersion(PathBuf),
    /// Files of different runs.
    #[error("Plan and touches of {} do not belong together. {STILL}", .0.display())]
    Mixed(PathBuf),
    /// The manifest lacks what is needed.
    #[error(
        "{} does not say which screen was touched with which arm. {STILL}",
        .0.join(names::MANIFEST).display()
    )]
    NoScreen(PathBuf),
    /// The robot is another one.
    #[error(
        "The run was made with another arm than this robot's, so it cannot go on with it. What it has touched can still be learned from in step Models."
    )]
    OtherArm,
}

const STILL: &str = "The run cannot go on, but what it has touched can still be learned from in step Models.";

impl RunError {
    /// For `map_err` of what the system does with a path.
    pub fn unwritable(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |error| Self::Unwritable { path, error }
    }

    /// When the run is opened.
    pub fn unread(error: impl Into<Self>) -> Self {
        Self::Unread(Box::new(error.into()))
    }
}
