//! Why the model in use cannot be read or changed: sentences that say what to do.

use std::path::PathBuf;

use plumbline_effects::RigModelError;
use plumbline_model::files::FileError;
use plumbline_model::touchscreen::PlacementError;
use plumbline_vision::mount::MountFileError;

use crate::eyes::store::StoreError;
use crate::ground::text::sentence;

/// Why the model in use cannot be read or changed.
#[derive(Debug, thiserror::Error)]
pub enum ModelInUseError {
    /// The model itself.
    #[error("{}", sentence(&.0.to_string()))]
    Model(#[from] RigModelError),
    /// The calibration of the eyes.
    #[error("{}", sentence(&.0.to_string()))]
    Eyes(#[from] StoreError),
    /// The mount of the eyes.
    #[error("{}", sentence(&.0.to_string()))]
    Mount(#[from] MountFileError),
    /// The place of the touchscreen.
    #[error("{}", sentence(&.0.to_string()))]
    Screen(#[from] PlacementError),
    /// Its file.
    #[error("{}", sentence(&.0.to_string()))]
    File(#[from] FileError),
    /// It has no place.
    #[error("{} cannot be made ({error}). Check that the disk can be written.", .folder.display())]
    NoFolder {
        /// Where it belongs.
        folder: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// Frames of other sessions.
    #[error("The finding is not of these sessions. Search the gap again.")]
    OtherSessions,
    /// By place in the list.
    #[error("The finding has no such effect. Choose one of its list.")]
    NoSuchEffect,
    /// The finding says so.
    #[error("{title} cannot be added: {why}.")]
    NotAddable {
        /// Which.
        title: String,
        /// Why.
        why: String,
    },
}
