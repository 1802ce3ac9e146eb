//! Writing so that a crash, a kill or a full disk leaves the old file or the new one.

use std::fs::{self, File, Permissions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::error::{FileError, Kind};
use super::presence::dangling;
use super::sweep;

/// Writes a file in one step.
///
/// # Errors
/// When the target is no file that can be replaced, or the system refuses; then what was there is
/// there unchanged.
pub fn write(file: &Path, bytes: impl AsRef<[u8]>) -> Result<(), FileError> {
    let replacement = Replacement::of(file)?;
    replacement.fill(bytes)?;
    replacement.commit()
}

/// [`write`], for what is written piece by piece.
///
/// # Errors
/// As [`write`], and when `fill` says so.
pub fn write_with(
    file: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let replacement = Replacement::of(file)?;
    let filled = File::create_new(replacement.temporary()).and_then(|created| {
        let mut out = BufWriter::new(created);
        fill(&mut out)?;
        out.flush()
    });
    filled.map_err(FileError::unwritable(file))?;
    replacement.commit()
}

/// Makes a folder and those above it, if they are not there.
///
/// # Errors
/// When the system refuses, for example because a file of that name is there.
pub fn make_folder(folder: &Path) -> Result<(), FileError> {
    fs::create_dir_all(folder).map_err(FileError::unwritable(folder))
}

/// Makes a folder where its parent exists already; `false`: it was there. Of several that ask at once, one is told `true`.
///
/// # Errors
/// [`FileError::Unwritable`].
pub fn make_new_folder(folder: &Path) -> Result<bool, FileError> {
    match fs::create_dir(folder) {
        Err(why) if why.kind() == ErrorKind::AlreadyExists => Ok(false),
        made => made.map(|()| true).map_err(FileError::unwritable(folder)),
    }
}

/// A file written under a temporary name beside its place, and moved there when all is well.
///
/// Dropped without [`Self::commit`], it is removed and the place is as it was.
#[derive(Debug)]
pub struct Replacement {
    /// As it was asked for, for messages.
    asked: PathBuf,
    /// Where it goes: through links, so that a link stays one.
    target: PathBuf,
    temporary: PathBuf,
    /// Of the file that is replaced.
    permissions: Option<Permissions>,
    committed: bool,
}

impl Replacement {
    /// Chooses a temporary name in the folder of `target`, with the same extension.
    ///
    /// # Errors
    /// When the target is a folder, pipe, socket or device, a link to nothing, or write-protected.
    pub fn of(target: &Path) -> Result<Self, FileError> {
        let asked = target.to_path_buf();
        let (target, permissions) = place(target)?;
        let temporary = sweep::temporary(&target);
        if let Some(folder) = temporary.parent() {
            sweep::once(folder);
        }
        Ok(Self { asked, target, temporary, permissions, committed: false })
    }

    /// Where to write.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Writes the contents to the temporary name.
    ///
    /// # Errors
    /// When the system refuses.
    pub fn fill(&self, bytes: impl AsRef<[u8]>) -> Result<(), FileError> {
        File::create(&self.temporary)
            .and_then(|mut file| file.write_all(bytes.as_ref()))
            .map_err(|source| self.refused(source))
    }

    /// Moves the file to its place, after it is on the disk.
    ///
    /// # Errors
    /// When the system refuses; [`FileError::Unconfirmed`] is the only one after which the new file
    /// is in its place.
    pub fn commit(mut self) -> Result<(), FileError> {
        self.settle().map_err(|source| self.refused(source))?;
        self.committed = true;
        // Two names of one file stay both when one is moved to the other.
        let _ = fs::remove_file(&self.temporary);
        confirm_folder(&self.target)
            .map_err(|source| FileError::Unconfirmed { file: self.asked.clone(), source })
    }

    fn settle(&self) -> io::Result<()> {
        // A full disk may show only here.
        writable(&self.temporary)?.sync_all()?;
        if let Some(permissions) = &self.permissions {
            fs::set_permissions(&self.temporary, permissions.clone())?;
        }
        fs::rename(&self.temporary, &self.target)
    }

    fn refused(&self, source: io::Error) -> FileError {
        FileError::Unwritable { file: self.asked.clone(), source }
    }
}

impl Drop for Replacement {
    fn drop(&mut self) {
        if !self.committed {
            // It may never have been created; there is nothing else to do about it here.
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

/// Whether a file of this name can be written, as far as can be told before it is.
pub(super) fn check_place(target: &Path) -> Result<(), FileError> {
    let (place, _) = place(target)?;
    let folder = place.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match fs::metadata(folder) {
        Err(source) => Err(FileError::Unwritable { file: target.to_path_buf(), source }),
        Ok(_) => Ok(()),
    }
}

/// Where a file of this name is written, and the permissions of the one that is there.
fn place(target: &Path) -> Result<(PathBuf, Option<Permissions>), FileError> {
    if target.file_name().is_none() {
        return Err(FileError::NotReplaced { file: target.to_path_buf(), kind: Kind::Folder });
    }
    let about = match fs::metadata(target) {
        Ok(about) => about,
        Err(error) if error.kind() == ErrorKind::NotFound => {
            return match dangling(target) {
                Some(to) => Err(FileError::DanglingTarget { file: target.to_path_buf(), to }),
                None => Ok((target.to_path_buf(), None)),
            };
        }
        Err(source) => return Err(FileError::Unwritable { file: target.to_path_buf(), source }),
    };
    if let Some(kind) = Kind::of(&about) {
        return Err(FileError::NotReplaced { file: target.to_path_buf(), kind });
    }
    if about.permissions().readonly() {
        return Err(FileError::Protected { file: target.to_path_buf() });
    }
    let is_link = fs::symlink_metadata(target).is_ok_and(|about| about.file_type().is_symlink());
    let place = if is_link {
        fs::canonicalize(target).map_err(FileError::unwritable(target))?
    } else {
        target.to_path_buf()
    };
    Ok((place, Some(about.permissions())))
}

/// For `sync_all`, which some systems only do for who may write.
fn writable(file: &Path) -> io::Result<File> {
    if cfg!(unix) { File::open(file) } else { fs::OpenOptions::new().write(true).open(file) }
}

/// Puts the new name on the disk, too.
fn confirm_folder(file: &Path) -> io::Result<()> {
    if !cfg!(unix) {
        return Ok(());
    }
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match File::open(folder).and_then(|folder| folder.sync_all()) {
        // Some network file systems know no such thing, and a folder may be closed to readers.
        Err(error) if is_beyond_asking(&error) => Ok(()),
        done => done,
    }
}

fn is_beyond_asking(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported | ErrorKind::PermissionDenied)
}
