//! Commands of the experiment with grasps.

use std::path::PathBuf;

use plumbline_grasp::Method;
use serde::{Deserialize, Serialize};

/// The experiment with grasps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrialsCommand {
    /// Begins an experiment in a folder of its own. The arm moves.
    Begin {
        /// Methods to compare.
        methods: Vec<Method>,
        /// Attempts per position and method.
        attempts: usize,
        /// x and y, robot frame, m; `None`: the 22 published positions.
        positions_m: Option<Vec<[f64; 2]>>,
        /// Class of the object.
        object: String,
        /// Of all that is drawn by chance.
        seed: u64,
    },
    /// Shows an earlier one. Moves nothing.
    Open {
        /// Its folder.
        folder: PathBuf,
    },
    /// Goes on with the attempt that is next. The arm moves.
    GoOn,
    /// Holds after the attempt that is under way.
    Pause,
    /// The thing lies where it was asked for. The arm moves.
    Placed,
    /// Shows none any more; what was made stays.
    Close,
    /// Writes what came of it so far.
    Export {
        /// Where to.
        file: PathBuf,
        /// As what.
        format: TrialsFormat,
    },
}

/// What an experiment is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrialsFormat {
    /// One line per attempt.
    Csv,
    /// The page, for a browser.
    Html,
    /// The page, for printing.
    Pdf,
}
