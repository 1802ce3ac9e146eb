//! How far grasping has come, for who waits for it.

use std::path::Path;

use plumbline_grasp::{Record, tracks};
use plumbline_model::files::{self, FileError, Size};

use super::keeping::{Keeping, KeepingError};
use super::view::AttemptView;
use super::workflow::GraspWorkflow;

impl GraspWorkflow {
    /// The newest attempt that the operator saw to be good.
    pub fn held_last(&self) -> Option<&AttemptView> {
        self.attempts.iter().find(|attempt| attempt.told == Some(true))
    }

    /// The newest attempt that has ended.
    pub fn newest(&self) -> Option<&AttemptView> {
        self.attempts.first()
    }

    /// Whether nothing is under way.
    pub fn is_idle(&self) -> bool {
        self.running.is_none()
    }
}

/// What is kept of an attempt.
///
/// # Errors
/// When its folder holds no record that can be read.
pub fn read_record(folder: &Path) -> Result<Record, KeepingError> {
    Keeping::of(folder.to_owned()).read()
}

/// The joint tracks that are kept of an attempt; `None`: there are none.
///
/// # Errors
/// When there are some that cannot be read.
pub fn read_tracks(folder: &Path) -> Result<Option<String>, FileError> {
    let file = folder.join(tracks::FILE);
    if files::present(&file)? { files::read_text(&file, Size::TEXT).map(Some) } else { Ok(None) }
}
