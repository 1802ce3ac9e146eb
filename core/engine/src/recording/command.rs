//! Commands of recording.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// Recording what works live.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RecordingCommand {
    /// Begins a session with a recording.
    Start,
    /// Ends it.
    Stop,
    /// Writes a recording as a LeRobot data set.
    ExportLerobot {
        /// The recording, in its session.
        file: PathBuf,
        /// Where to: a folder that is empty or new.
        folder: PathBuf,
        /// What was being done, a sentence.
        task: String,
    },
}
