//! The experiment with grasps, for the window.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use plumbline_report::experiment::Experiment as Page;

use super::plan::{Experiment, Trial};

/// The experiment with grasps.
#[derive(Clone, Debug, Default)]
pub struct TrialsView {
    /// The one that is shown; `None`: none.
    pub shown: Option<Arc<ShownTrials>>,
    /// What is done just now.
    pub phase: TrialsPhase,
    /// Earlier ones, newest first.
    pub earlier: Arc<[EarlierTrials]>,
    /// Time left at the pace so far.
    pub remaining: Option<Duration>,
}

/// An experiment with what came of it so far.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownTrials {
    /// Its folder.
    pub folder: PathBuf,
    /// What it is.
    pub experiment: Experiment,
    /// Attempts that were made.
    pub made: usize,
    /// Of all.
    pub all: usize,
    /// What came of them, as it stands on the page.
    pub page: Page,
}

/// An earlier experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct EarlierTrials {
    /// Its folder.
    pub folder: PathBuf,
    /// Its name for people.
    pub name: String,
    /// Attempts that were made.
    pub made: usize,
    /// Of all.
    pub all: usize,
}

/// What is done just now.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum TrialsPhase {
    /// Nothing; an experiment that is shown can go on.
    #[default]
    Idle,
    /// It goes on by itself.
    Running {
        /// Which.
        trial: Trial,
        /// What is done of it.
        doing: TrialStage,
        /// Whether it holds after that.
        pausing: bool,
    },
    /// A person has to lay the thing down.
    Asks {
        /// Which.
        trial: Trial,
        /// Where, robot frame, m.
        at_m: [f64; 2],
    },
    /// A person has to say whether it is held.
    WaitsForWord {
        /// Which.
        trial: Trial,
    },
    /// It cannot go on by itself: why, and what to do.
    Paused {
        /// A sentence.
        why: String,
    },
}

/// A part of an attempt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialStage {
    /// The thing is laid down and comes to rest.
    Laying,
    /// The robot grasps.
    Grasping,
    /// It is looked whether it was lifted.
    Judging,
    /// The hand opens, the arm goes home.
    Clearing,
}
