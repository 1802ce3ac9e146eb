//! What can go wrong before the program runs, each with what to do about it.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Why the image did not start.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Nothing that could be unpacked follows the runtime.
    #[error(
        "{} carries no whole image: {why}. It was probably not copied or downloaded to its end; get it again",
        image.display()
    )]
    NoImage {
        /// The file that was started.
        image: PathBuf,
        /// What is missing.
        why: String,
    },
    /// The bytes are not those that were packed.
    #[error("{} is damaged: {why}. Copy or download it again", image.display())]
    Damaged {
        /// The file that was started.
        image: PathBuf,
        /// What does not fit.
        why: String,
    },
    /// An entry of the image would be written somewhere else than into the folder.
    #[error(
        "the image holds {}, {why}, so nothing of it was unpacked. It is no image of Plumbline's; \
         get one from where you got the program",
        entry.display()
    )]
    Leaves {
        /// The entry as the image names it.
        entry: PathBuf,
        /// Where it would lead.
        why: &'static str,
    },
    /// The disk is full, or would be.
    #[error(
        "unpacking needs {needed_mb} MB in {}, where {free_mb} MB are free. Make room there, or {elsewhere}",
        folder.display()
    )]
    NoRoom {
        /// Where it would be unpacked.
        folder: PathBuf,
        /// Megabytes that the image takes when it is unpacked.
        needed_mb: u64,
        /// Megabytes that are free.
        free_mb: u64,
        /// How to have it unpacked to another place.
        elsewhere: &'static str,
    },
    /// The disk became full on the way.
    #[error("the disk is full: {} could not be written to its end. Make room there, or {elsewhere}", path.display())]
    Full {
        /// What was being written.
        path: PathBuf,
        /// How to have it unpacked to another place.
        elsewhere: &'static str,
    },
    /// Nothing can be written where the image is to be unpacked.
    #[error(
        "{} cannot be written ({source}). Make that possible, or {elsewhere}", path.display()
    )]
    CannotWrite {
        /// What was to be written.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
        /// How to have it unpacked to another place.
        elsewhere: &'static str,
    },
    /// The environment names no folder for caches.
    #[error(
        "neither XDG_CACHE_HOME nor HOME names a folder to unpack into. Set one of them, or start with \
         --appimage-extract-and-run, which unpacks into the folder for temporary files"
    )]
    NoCacheFolder,
    /// Files are missing from what was unpacked, and somebody runs it.
    #[error(
        "{} is no longer whole and is still in use. Close every window of Plumbline, then start it again; \
         it will be unpacked anew", folder.display()
    )]
    BrokenInUse {
        /// What was unpacked.
        folder: PathBuf,
    },
    /// What was unpacked cannot be run.
    #[error(
        "{} cannot be started ({source}). Where the disk of that folder allows no programs, {elsewhere}",
        path.display()
    )]
    CannotStart {
        /// What was to be started.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
        /// How to have it unpacked to another place.
        elsewhere: &'static str,
    },
    /// The kernel did not say which file runs.
    #[error("the file that was started cannot be told ({0}). It takes /proc; mount it, then start again")]
    NoSelf(std::io::Error),
    /// No entry has a name of this pattern.
    #[error("nothing in the image is called {0}; --appimage-extract without a pattern unpacks everything")]
    NothingMatches(String),
    /// The pattern cannot be read.
    #[error("{pattern} is no pattern ({why}). Use * and ? and [a-z], as in 'share/doc/*'")]
    Pattern {
        /// As it was given.
        pattern: String,
        /// What is wrong about it.
        why: String,
    },
    /// An option of the runtime that this one has not.
    #[error("there is no option {0} here; --appimage-help names those that there are")]
    NoSuchOption(String),
}

impl Error {
    /// Something could not be written.
    pub fn writing(path: &Path, source: std::io::Error, elsewhere: &'static str) -> Self {
        let path = path.to_owned();
        match source.kind() {
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
                Self::Full { path, elsewhere }
            }
            _ => Self::CannotWrite { path, source, elsewhere },
        }
    }
}
