//! Commands of commissioning.

use serde::{Deserialize, Serialize};

/// Commissioning. None of them moves anything.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CommissionCommand {
    /// Begins, or goes on with what was begun before.
    Start {
        /// Whether every step is done once more, and minutes, touches and views are counted from zero.
        anew: bool,
    },
    /// Leads no more. What was done stays done and counted.
    Leave,
}
