//! Reading whole files of bounded size.

use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{ErrorKind, Read};
use std::path::Path;

use super::error::{FileError, Kind};
use super::presence::dangling;
use super::size::Size;

/// Reads a file.
///
/// # Errors
/// When it is not there or is no ordinary file, is larger than `largest`, or cannot be read.
pub fn read(file: &Path, largest: Size) -> Result<Vec<u8>, FileError> {
    let opened = open(file, largest)?;
    // Files such as those of /proc tell the size 0, and any file may grow while it is read.
    let mut bytes = Vec::new();
    opened.take(largest.0.saturating_add(1)).read_to_end(&mut bytes).map_err(FileError::unreadable(file))?;
    if bytes.len() as u64 > largest.0 {
        return Err(FileError::TooLarge { file: file.to_path_buf(), size: None, largest });
    }
    Ok(bytes)
}

/// Reads a text in UTF-8, without the byte-order mark that some editors write.
///
/// # Errors
/// As [`read`], and when it is no text.
pub fn read_text(file: &Path, largest: Size) -> Result<String, FileError> {
    let text = String::from_utf8(read(file, largest)?)
        .map_err(|_| FileError::NotText { file: file.to_path_buf() })?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Opens a file for those who read piece by piece; never waits.
///
/// # Errors
/// As [`check`].
pub fn open(file: &Path, largest: Size) -> Result<File, FileError> {
    // Looked at before it is opened: opening a device can do something already.
    check(file, largest)?;
    let mut how = OpenOptions::new();
    how.read(true);
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt;
        // Should it have become a pipe since, opening does not wait for a writer.
        how.custom_flags(rustix::fs::OFlags::NONBLOCK.bits().cast_signed());
    }
    let opened = how.open(file).map_err(FileError::unreadable(file))?;
    usable(file, &opened.metadata().map_err(FileError::unreadable(file))?, largest)?;
    Ok(opened)
}

/// Checks a file that a library opens by its name.
///
/// # Errors
/// When it is not there, is a dangling link or no ordinary file, or is larger than `largest`.
pub fn check(file: &Path, largest: Size) -> Result<(), FileError> {
    let about = fs::metadata(file).map_err(|source| match dangling(file) {
        Some(to) if source.kind() == ErrorKind::NotFound => {
            FileError::Dangling { file: file.to_path_buf(), to }
        }
        _ => FileError::Unreadable { file: file.to_path_buf(), source },
    })?;
    usable(file, &about, largest)
}

fn usable(file: &Path, about: &Metadata, largest: Size) -> Result<(), FileError> {
    if let Some(kind) = Kind::of(about) {
        return Err(FileError::NotAFile { file: file.to_path_buf(), kind });
    }
    let size = Size(about.len());
    if size > largest {
        return Err(FileError::TooLarge { file: file.to_path_buf(), size: Some(size), largest });
    }
    Ok(())
}
