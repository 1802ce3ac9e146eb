//! Folders of recorded sessions: what they are called, and of which robot they are.

use std::path::{Path, PathBuf};

use plumbline_model::Session;
use plumbline_model::robot::{Rig, RigError};
use plumbline_model::session::RigReference;

/// A folder of sessions cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{} cannot be read ({error}). Check that you may read it.", .folder.display())]
pub struct Unread {
    folder: PathBuf,
    error: std::io::Error,
}

/// What lies in a folder of sessions; nothing where nothing was ever recorded.
///
/// # Errors
/// When there is a folder that cannot be read.
pub fn folders(folder: &Path) -> Result<Vec<PathBuf>, Unread> {
    match std::fs::read_dir(folder) {
        Ok(listing) => Ok(listing.flatten().map(|entry| entry.path()).collect()),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(Unread { folder: folder.to_owned(), error }),
    }
}

/// Whether a session was touched to be learned from: not only its corners to place the screen, and
/// not through a model to check that.
pub fn is_for_training(folder: &Path) -> bool {
    !is_of_corners(folder) && !is_check(folder)
}

/// Whether a session was touched to check what had been learned.
pub fn is_check(folder: &Path) -> bool {
    named(folder).contains("_check")
}

/// Whether only the corners of the screen were touched, to place it.
pub fn is_of_corners(folder: &Path) -> bool {
    named(folder).contains("_corners")
}

fn named(folder: &Path) -> std::borrow::Cow<'_, str> {
    folder.file_name().unwrap_or_default().to_string_lossy()
}

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

/// Makes a folder of this name among sessions, with a number behind it where the name is taken.
///
/// # Errors
/// What the system says.
pub fn free_folder(sessions: &Path, name: &str) -> std::io::Result<PathBuf> {
    std::fs::create_dir_all(sessions)?;
    for count in 1.. {
        let name = if count == 1 { name.to_owned() } else { format!("{name}-{count}") };
        let folder = sessions.join(name);
        match std::fs::create_dir(&folder) {
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
            other => return other.map(|()| folder),
        }
    }
    Err(std::io::ErrorKind::AlreadyExists.into())
}
