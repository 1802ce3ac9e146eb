//! Commands about the program's own threads.

use serde::{Deserialize, Serialize};

use crate::watched::WatchedThread;

/// What is done about a thread that failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum WatchCommand {
    /// Starts it again. The robot's is then not connected, and nothing moves.
    StartAgain(WatchedThread),
}
