//! Commands of truth mode.

use serde::{Deserialize, Serialize};

/// Truth mode of the twin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TruthCommand {
    /// Shows measured less true everywhere, or stops that. Off at each start.
    Show(bool),
}
