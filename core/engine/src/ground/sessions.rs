//! Folders of recorded sessions: what they are called, and of which robot they are.

use std::path::Path;

use plumbline_model::Session;
use plumbline_model::robot::{Rig, RigError};
use plumbline_model::session::RigReference;

/// The rig that a session names; a rig file lies in the session's folder. It may be that of a robot
/// that was only measured ([`Rig::read_measured`]).
///
/// # Errors
/// When the rig cannot be read.
pub fn rig_of(session: &Session, folder: &Path) -> Result<Rig, RigError> {
    match &session.manifest.rig {
        RigReference::Named(name) => Rig::built_in(name),
        RigReference::File(file) => Rig::read_measured(&folder.join(file)),
    }
}

/// Name of a session for people: that of its folder.
pub fn title_of(folder: &Path) -> String {
    let full = folder.canonicalize();
    let folder = full.as_deref().unwrap_or(folder);
    folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy().into_owned()
}
