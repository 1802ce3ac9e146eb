//! Why an evaluation cannot be judged: sentences.

use plumbline_drift::NotJudged;

/// Why an evaluation cannot be judged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unjudged {
    /// Its files cannot be read; what their reader said.
    #[error("{said}")]
    Unread {
        /// A sentence.
        said: String,
    },
    /// It is of another robot.
    #[error("{session} was made with another robot ({rig}): choose one of this robot.")]
    OtherRobot {
        /// Its name.
        session: String,
        /// The robot's.
        rig: String,
    },
    /// There are no places in it.
    #[error("{0} has no localizations.csv: choose an evaluation.")]
    NoTable(String),
    /// Its places cannot be judged so.
    #[error("{session}: {why}.")]
    Places {
        /// Its name.
        session: String,
        /// Why not.
        why: NotJudged,
    },
    /// Judging itself has ended; what was said of that.
    #[error("{said}")]
    Ended {
        /// A sentence.
        said: String,
    },
}
