//! The folder that an image is unpacked into once, and who is using it.
//!
//! For every image there are, in the folder of Plumbline's caches: `ID`, what was unpacked; `ID.part`,
//! what is being unpacked or removed; `ID.lock`, which whoever runs from `ID` holds together with others,
//! and whoever makes or removes it holds alone. The kernel lets go of a lock when its holders end,
//! however they end, so nothing that was left behind by a kill is ever waited for.

use std::fs::{DirBuilder, File, FileTimes, OpenOptions, TryLockError};
use std::os::unix::fs::{DirBuilderExt, MetadataExt};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use crate::contents::Contents;
use crate::error::Error;
use crate::image::{ID_DIGITS, Image, is_id};

/// The variable that names the place of all caches.
const VARIABLE: &str = "XDG_CACHE_HOME";
/// How to have an image unpacked to another place.
pub const ELSEWHERE: &str =
    "set XDG_CACHE_HOME to a folder on another disk, or start with --appimage-extract-and-run";

/// What was unpacked, kept from being removed for as long as the lock is held.
#[derive(Debug)]
pub struct Held {
    /// Where it lies.
    pub folder: PathBuf,
    /// To be handed to the program that runs from there.
    pub lock: File,
}

/// Plumbline's folder among the caches of the user.
///
/// # Errors
/// [`Error::NoCacheFolder`] when the environment names none.
pub fn folder() -> Result<PathBuf, Error> {
    let absolute = |name| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let caches = absolute(VARIABLE).or_else(|| Some(absolute("HOME")?.join(".cache")));
    Ok(caches.ok_or(Error::NoCacheFolder)?.join("plumbline"))
}

/// Unpacks the image, unless that was done before, and keeps it.
///
/// # Errors
/// When the image is damaged or nothing can be written there.
pub fn hold(caches: &Path, image: &Image, contents: &Contents) -> Result<Held, Error> {
    let cannot = |source| Error::writing(caches, source, ELSEWHERE);
    DirBuilder::new().recursive(true).mode(0o700).create(caches).map_err(cannot)?;
    let place = Place::new(caches, image.id());
    // Who waited for another start looks again; a folder that is never whole ends it.
    for tries in 0..MOST_TRIES {
        let lock = place.lock(|file| file.lock_shared().map(|()| true)).map_err(cannot)?;
        if let Some(lock) = lock.filter(|_| place.whole.is_dir() && contents.are_in(&place.whole)) {
            return Ok(Held { folder: place.whole, lock });
        }
        match place.lock(try_alone).map_err(cannot)? {
            Some(_alone) if place.whole.is_dir() && contents.are_in(&place.whole) => {}
            Some(_alone) => make(&place, image, contents)?,
            // Others who only look hold it for no time.
            None if place.whole.exists() && tries >= TRIES_WHILE_OTHERS_LOOK => {
                return Err(Error::BrokenInUse { folder: place.whole });
            }
            None => {
                if tries == 0 && place.part.exists() {
                    eprintln!("plumbline: another start is unpacking the same image; waiting for it");
                }
                std::thread::sleep(BETWEEN_TRIES);
            }
        }
    }
    Err(cannot(std::io::Error::other("what was unpacked does not stay there")))
}

const MOST_TRIES: usize = 50;
const TRIES_WHILE_OTHERS_LOOK: usize = 10;
const BETWEEN_TRIES: Duration = Duration::from_millis(20);

/// Unpacks under another name and renames; the caller holds the lock alone.
fn make(place: &Place, image: &Image, contents: &Contents) -> Result<(), Error> {
    let cannot = |source| Error::writing(&place.part, source, ELSEWHERE);
    image.verify()?;
    // Left by a start that was killed, or no longer whole.
    remove_folder(&place.part).map_err(cannot)?;
    discard(place).map_err(cannot)?;
    let folder = place.whole.parent().unwrap_or(&place.whole);
    crate::room_for(contents.bytes(), folder, ELSEWHERE)?;
    eprintln!(
        "plumbline: unpacking into {}, once: {} MB",
        place.whole.display(),
        contents.bytes().div_ceil(1_000_000)
    );
    let unpacked = fill(place, contents);
    if unpacked.is_err() {
        // What is half there would only take the room that may be missing; what says why comes first.
        let _ = std::fs::remove_dir_all(&place.part);
    }
    unpacked
}

fn fill(place: &Place, contents: &Contents) -> Result<(), Error> {
    let cannot = |source| Error::writing(&place.part, source, ELSEWHERE);
    DirBuilder::new().mode(0o700).create(&place.part).map_err(cannot)?;
    contents.unpack(&contents.all(), &place.part, ELSEWHERE)?;
    // Later images find out by it which is the older one.
    let times = FileTimes::new().set_modified(contents.made_at());
    File::open(&place.part).and_then(|part| part.set_times(times)).map_err(cannot)?;
    std::fs::rename(&place.part, &place.whole).map_err(cannot)
}

/// Removes what older images were unpacked to, unless it is in use, and what was left half done. What
/// cannot be removed stays: the program runs all the same, and the next start tries again.
pub fn remove_older(caches: &Path, image: &Image, made_at: SystemTime) {
    let entries = std::fs::read_dir(caches).into_iter().flatten().flatten();
    let mut ids: Vec<String> =
        entries.filter_map(|entry| id_of(&entry.file_name().to_string_lossy())).collect();
    ids.sort();
    ids.dedup();
    for id in ids.iter().filter(|id| *id != image.id()) {
        let place = Place::new(caches, id);
        if let Ok(Some(_alone)) = place.lock(try_alone) {
            let _ = remove_if_older(&place, made_at);
        }
    }
}

fn remove_if_older(place: &Place, made_at: SystemTime) -> std::io::Result<()> {
    remove_folder(&place.part)?;
    match place.whole.symlink_metadata() {
        Ok(found) if found.modified()? > made_at => return Ok(()),
        Ok(_) => discard(place)?,
        Err(_) => {}
    }
    std::fs::remove_file(&place.lock)
}

/// Removes what was unpacked; renamed first, so that what a kill leaves is not taken for whole.
fn discard(place: &Place) -> std::io::Result<()> {
    if place.whole.symlink_metadata().is_ok() {
        std::fs::rename(&place.whole, &place.part)?;
        remove_folder(&place.part)?;
    }
    Ok(())
}

fn remove_folder(path: &Path) -> std::io::Result<()> {
    match std::fs::remove_dir_all(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// The id of the image that a file among the caches belongs to; everything else there is somebody else's.
fn id_of(name: &str) -> Option<String> {
    let (id, rest) = name.split_at_checked(ID_DIGITS)?;
    (is_id(id) && ["", ".part", ".lock"].contains(&rest)).then(|| id.to_owned())
}

/// The three names of one image.
struct Place {
    whole: PathBuf,
    part: PathBuf,
    lock: PathBuf,
}

impl Place {
    fn new(caches: &Path, id: &str) -> Self {
        Self {
            whole: caches.join(id),
            part: caches.join(format!("{id}.part")),
            lock: caches.join(format!("{id}.lock")),
        }
    }

    /// The lock, taken in this way; `None` when others hold it. Who removed the image removed the file of
    /// its lock too, and a lock on a file that is no longer there keeps nobody away, so then it is taken anew.
    fn lock(&self, take: impl Fn(&File) -> std::io::Result<bool>) -> std::io::Result<Option<File>> {
        loop {
            let file =
                OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&self.lock)?;
            if !take(&file)? {
                return Ok(None);
            }
            let mine = file.metadata()?;
            match std::fs::metadata(&self.lock) {
                Ok(there) if (there.dev(), there.ino()) == (mine.dev(), mine.ino()) => return Ok(Some(file)),
                Ok(_) => {}
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => {}
                Err(error) => return Err(error),
            }
        }
    }
}

fn try_alone(file: &File) -> std::io::Result<bool> {
    match file.try_lock() {
        Ok(()) => Ok(true),
        Err(TryLockError::WouldBlock) => Ok(false),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_bears_the_name_of_an_image_is_ever_removed() {
        let id = "0123456789abcdef".repeat(2);
        for name in [id.clone(), format!("{id}.part"), format!("{id}.lock")] {
            assert_eq!(id_of(&name).as_deref(), Some(id.as_str()));
        }
        for name in ["thumbnails", &id[1..], &format!("{id}.txt"), &id.to_uppercase(), &"é".repeat(40)] {
            assert_eq!(id_of(name), None, "{name}");
        }
    }

    #[test]
    fn a_lock_whose_file_was_removed_is_taken_anew() {
        let caches = tempfile::tempdir().expect("a folder");
        let place = Place::new(caches.path(), &"a".repeat(ID_DIGITS));
        let first = place.lock(try_alone).expect("a lock").expect("it is free");
        assert!(place.lock(try_alone).expect("a lock").is_none(), "one holds it");
        std::fs::remove_file(&place.lock).expect("removed");
        let second = place.lock(try_alone).expect("a lock").expect("another file");
        drop(first);
        assert!(place.lock(try_alone).expect("a lock").is_none(), "the second still holds it");
        drop(second);
    }
}
