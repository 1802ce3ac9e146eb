//! Commands of recording.

use serde::{Deserialize, Serialize};

/// Recording what works live.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RecordingCommand {
    /// Begins a session with a recording.
    Start,
    /// Ends it.
    Stop,
}
