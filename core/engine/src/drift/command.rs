//! Commands of watching drift.

use serde::{Deserialize, Serialize};

/// Watching drift.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DriftCommand {
    /// Begins to watch; what was watched before is forgotten.
    Start,
    /// Stops; what was seen stays to be looked at.
    Stop,
    /// Makes a session of what was watched, and looks for the gap in it.
    Explain,
}
