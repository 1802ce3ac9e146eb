//! An output is never one of the inputs.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::FileError;
use crate::session_names as names;

/// Files by which a folder is a session or a set of images, wherever in it they lie.
const OWN_NAMES: [&str; 8] = [
    names::MANIFEST,
    names::TOUCHES,
    names::LOCALIZATIONS,
    names::POSES,
    names::LOG,
    "data.yaml",
    "scenes.csv",
    "rig.toml",
];
/// Folders whose contents are measurements.
const OWN_FOLDERS: [&str; 6] = [names::STEREO, "left", "right", "images", "labels", "masks"];
/// Kinds of files that the program's verbs read from a folder, and none writes there as a result.
const OWN_KINDS: [&str; 12] =
    ["png", "jpg", "jpeg", "bmp", "tif", "tiff", "webp", "mp4", "avi", "mkv", "urdf", "xml"];

/// Checks, before any work is done, that a result does not replace what it is computed from: the
/// target is none of the inputs under any name (links, hard links, `..`), and no file by which a
/// folder among the inputs is what it is (its tables, manifest, descriptions, images). Nor may it be
/// what [`super::write`] does not replace.
///
/// # Errors
/// [`FileError::IsInput`] when it would; else as [`super::write`], as far as can be told now.
pub fn output(target: &Path, inputs: &[&Path]) -> Result<(), FileError> {
    let place = resolved(target);
    for input in inputs {
        let clash =
            if input.is_dir() { is_own(&place, target, input) } else { is_same(&place, target, input) };
        if clash {
            return Err(FileError::IsInput { output: target.to_path_buf(), input: input.to_path_buf() });
        }
    }
    // What cannot be written at the end is better said before hours of work.
    super::write::check_place(target)
}

/// Checks that something exported does not replace a table or the description of a session or set:
/// whoever exports chooses the name by hand.
///
/// # Errors
/// [`FileError::OfSession`] when it would; else as [`output`].
pub fn export(target: &Path) -> Result<(), FileError> {
    let place = resolved(target);
    let is_own =
        place.file_name().is_some_and(|name| OWN_NAMES.contains(&&*name.to_string_lossy().to_lowercase()));
    let folder = place.parent().unwrap_or(Path::new("."));
    if is_own && [names::MANIFEST, "data.yaml"].iter().any(|name| folder.join(name).exists()) {
        return Err(FileError::OfSession { file: target.to_path_buf() });
    }
    super::write::check_place(target)
}

/// The path without links and `..`, also of a file that is not there yet.
fn resolved(path: &Path) -> PathBuf {
    if let Ok(whole) = fs::canonicalize(path) {
        return whole;
    }
    // A link to what is not there yet leads to where the file would be made.
    if let Ok(to) = fs::read_link(path) {
        let to = path.parent().unwrap_or(Path::new("")).join(to);
        if to != path {
            let folder = to.parent().map(folder_of).and_then(|folder| fs::canonicalize(folder).ok());
            if let (Some(folder), Some(name)) = (folder, to.file_name()) {
                return folder.join(name);
            }
        }
    }
    match (path.parent().map(|parent| fs::canonicalize(folder_of(parent))), path.file_name()) {
        (Some(Ok(folder)), Some(name)) => folder.join(name),
        _ => std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()),
    }
}

fn folder_of(folder: &Path) -> &Path {
    if folder.as_os_str().is_empty() { Path::new(".") } else { folder }
}

fn is_same(place: &Path, target: &Path, input: &Path) -> bool {
    resolved(input) == place || is_one_file(target, input)
}

/// Whether two names are of one file on the disk.
#[cfg(unix)]
fn is_one_file(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (fs::metadata(a), fs::metadata(b)) {
        (Ok(a), Ok(b)) => (a.dev(), a.ino()) == (b.dev(), b.ino()),
        _ => false,
    }
}

#[cfg(not(unix))]
fn is_one_file(_: &Path, _: &Path) -> bool {
    false
}

/// Whether the target is one of the files by which a folder is what it is.
fn is_own(place: &Path, target: &Path, folder: &Path) -> bool {
    // Tables that are links or hard links to the target, wherever it lies.
    if OWN_NAMES.iter().any(|name| is_same(place, target, &folder.join(name))) {
        return true;
    }
    let Ok(inside) = place.strip_prefix(resolved(folder)) else { return false };
    let name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().to_lowercase());
    let in_own_folder = inside.parent().is_some_and(|above| {
        above.ancestors().any(|at| name(at).is_some_and(|at| OWN_FOLDERS.contains(&&*at)))
    });
    let kind = inside.extension().map(|kind| kind.to_string_lossy().to_lowercase());
    let of_own_kind = kind.is_some_and(|kind| OWN_KINDS.contains(&&*kind));
    name(inside).is_some_and(|name| OWN_NAMES.contains(&&*name))
        || in_own_folder
        || (of_own_kind && place.exists())
}
