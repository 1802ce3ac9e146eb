//! Commands of tying the arms to the eyes.

use serde::{Deserialize, Serialize};

/// Tying the arms to the eyes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HandEyeCommand {
    /// Looks at body, screen, table and hands. The head and both arms move; nothing is touched.
    Look,
    /// Ends the look; the arm holds.
    End,
    /// Puts the proposal into the model in use.
    Accept,
    /// Forgets the proposal.
    Discard,
}
