//! Commands of calibrating how the eyes sit in the head.

use serde::{Deserialize, Serialize};

/// Calibrating how the eyes sit in the head, in the order of work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MountCommand {
    /// Plans head poses from which the board, where it lies now, is well seen.
    Plan,
    /// Turns the head to all planned poses and takes a view at each. Moves the head only.
    Tour,
    /// Takes a view where the head stands.
    Capture,
    /// Removes a view.
    Delete {
        /// Its name.
        view: String,
    },
    /// Removes the views that were taken while the eyes were colder than in the others.
    DeleteColder,
    /// Removes all views.
    DeleteAll,
    /// Brings back the views that were deleted last, as long as no mount was accepted since.
    Undo,
    /// Solves; gives a proposal.
    Solve,
    /// Makes the proposal the mount in use.
    Accept,
    /// Forgets the proposal.
    Discard,
    /// Puts a mount that was in use earlier in use again.
    UseEarlier {
        /// Its id on the timeline.
        id: String,
    },
    /// Goes back to the nominal mount.
    UseNominal,
}
