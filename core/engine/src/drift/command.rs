//! Commands of watching drift.

use std::path::PathBuf;

pub use plumbline_drift::GridCorrection;
use serde::{Deserialize, Serialize};

/// Watching drift.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DriftCommand {
    /// Begins to watch; what was watched before is forgotten.
    Start,
    /// Stops; what was seen stays to be looked at.
    Stop,
    /// Makes a session of what was watched, and looks for the gap in it.
    Explain,
    /// The 9 by 4 evaluation.
    Grid(GridCommand),
}

/// The 9 by 4 evaluation: a thing is laid at one place after the other and looked at.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GridCommand {
    /// Begins, in a session of its own. On the twin the thing is laid by itself, and all others are put away.
    Begin {
        /// Class of the thing.
        object: String,
    },
    /// The thing lies where it was asked for.
    Placed,
    /// Leaves the place out.
    LeaveOut,
    /// Ends; what was measured stays.
    End,
    /// Shows a session with a correction in one of the two figures.
    Show {
        /// In the left or the right figure.
        side: GridSide,
        /// Its folder.
        session: PathBuf,
        /// Corrected how.
        correction: GridCorrection,
    },
}

/// One of two figures side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GridSide {
    /// The left one.
    Left,
    /// The right one.
    Right,
}

impl GridSide {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::Left, Self::Right];
}
