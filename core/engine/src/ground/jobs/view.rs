//! What is told and shown of a job.

use std::time::Duration;

use serde::{Deserialize, Serialize};

/// Number of a job, unique while the program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct JobId(pub u64);

/// Long work that is running.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum JobCommand {
    /// Asks a job to stop; what was there before stays.
    Cancel(JobId),
    /// Takes a job that has ended out of the list.
    Dismiss(JobId),
}

/// A job, running or ended.
#[derive(Clone, Debug, PartialEq)]
pub struct JobView {
    /// Its number, for [`crate::command::JobCommand`].
    pub id: JobId,
    /// What it does, for people: "Solve 30 pairs".
    pub title: String,
    /// How far it is or how it ended.
    pub state: JobState,
    /// Time since it started, or that it took.
    pub elapsed: Duration,
    /// Nobody asked for it: it is not what the operator waits for, and not what *Cancel* means.
    pub by_itself: bool,
}

/// How far a job is or how it ended. Every way to end looks different.
#[derive(Clone, Debug, PartialEq)]
pub enum JobState {
    /// At work.
    Running {
        /// 0 to 1.
        fraction: f64,
        /// What it is doing just now.
        doing: String,
        /// Estimated from the time that the fraction took; `None` too early to say.
        remaining: Option<Duration>,
        /// Was asked to stop and will at its next checkpoint.
        cancelling: bool,
    },
    /// Ended with a result.
    Done {
        /// The result in a sentence.
        summary: String,
    },
    /// Stopped on request; nothing was changed.
    Cancelled,
    /// Could not be done.
    Failed {
        /// What is wrong and what to do.
        reason: String,
    },
    /// A defect of this program; nothing was changed.
    Panicked {
        /// What the program said when it stopped.
        message: String,
    },
}

impl JobState {
    /// Whether it has not ended.
    pub fn is_running(&self) -> bool {
        matches!(self, Self::Running { .. })
    }

    /// Whether it ended with what is to be read.
    pub fn has_failed(&self) -> bool {
        matches!(self, Self::Failed { .. } | Self::Panicked { .. })
    }
}
