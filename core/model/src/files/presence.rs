//! Whether an optional file is there.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use super::error::FileError;

/// Whether there is something of this name. A link to nothing, or a place that cannot be looked
/// at, is an error: what somebody meant to be there must not count as "none".
///
/// # Errors
/// When the path is a dangling link, or the system does not say.
pub fn present(file: &Path) -> Result<bool, FileError> {
    match fs::metadata(file) {
        Ok(_) => Ok(true),
        Err(error) if error.kind() == ErrorKind::NotFound => match dangling(file) {
            Some(to) => Err(FileError::Dangling { file: file.to_path_buf(), to }),
            None => Ok(false),
        },
        Err(source) => Err(FileError::Unreadable { file: file.to_path_buf(), source }),
    }
}

/// What a link names that leads nowhere; `None` if the path is no link.
pub(super) fn dangling(file: &Path) -> Option<std::path::PathBuf> {
    let link = fs::symlink_metadata(file).is_ok_and(|about| about.file_type().is_symlink());
    link.then(|| fs::read_link(file).unwrap_or_default())
}

/// Whether a listing of a folder passes this name over: names that begin with a dot, such as
/// those of files that are just being written.
pub fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}
