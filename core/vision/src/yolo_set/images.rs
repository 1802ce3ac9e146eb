//! Which files are the images of a part, and where the labels of an image are.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

use plumbline_model::files::{self, Size};

use super::YoloSetError;
use super::problem::{LabelProblem, RowProblem};

/// Whether a file is an image that can be read, by its name.
pub fn is_image_name(path: &Path) -> bool {
    has_extension(path, &["png", "jpg", "jpeg"])
}

/// Images that other programs take but that are not read here.
fn is_other_image_name(path: &Path) -> bool {
    has_extension(path, &["bmp", "tif", "tiff", "webp", "dng", "mpo", "heic", "avif", "gif"])
}

fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    let extension = path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase);
    extension.is_some_and(|extension| extensions.contains(&extension.as_str()))
}

/// The label file of an image: the last folder called `images` is called `labels` for it, the
/// extension is `txt`. Without such a folder it lies beside the image.
pub fn label_file_of(image: &Path) -> PathBuf {
    let parts: Vec<Component<'_>> = image.components().collect();
    let folders = parts.len().saturating_sub(1);
    let last = parts[..folders].iter().rposition(|part| part.as_os_str() == "images");
    let swapped = parts
        .iter()
        .enumerate()
        .map(|(index, part)| if Some(index) == last { OsStr::new("labels") } else { part.as_os_str() });
    swapped.collect::<PathBuf>().with_extension("txt")
}

/// Images of a place: of a folder and the folders in it, or of a list. Sorted by path.
pub(super) fn images_of(
    place: &Path,
    root: &Path,
    problems: &mut Vec<LabelProblem>,
) -> Result<BTreeSet<PathBuf>, YoloSetError> {
    let mut images = BTreeSet::new();
    if place.is_dir() {
        of_folder(place, &mut images, problems)?;
    } else {
        of_list(place, root, &mut images, problems)?;
    }
    Ok(images)
}

fn of_folder(
    folder: &Path,
    images: &mut BTreeSet<PathBuf>,
    problems: &mut Vec<LabelProblem>,
) -> Result<(), YoloSetError> {
    for entry in std::fs::read_dir(folder).map_err(YoloSetError::io(folder))? {
        let entry = entry.map_err(YoloSetError::io(folder))?;
        let path = entry.path();
        // Hidden files are leftovers of copying; links to folders could lead in circles.
        if entry.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if entry.file_type().map_err(YoloSetError::io(&path))?.is_dir() {
            of_folder(&path, images, problems)?;
        } else {
            take(path, images, problems);
        }
    }
    Ok(())
}

fn of_list(
    list: &Path,
    root: &Path,
    images: &mut BTreeSet<PathBuf>,
    problems: &mut Vec<LabelProblem>,
) -> Result<(), YoloSetError> {
    let text = files::read_text(list, Size::TEXT)?;
    let beside = list.parent().unwrap_or(Path::new(""));
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() {
            continue;
        }
        let written = line.strip_prefix("./").unwrap_or(line);
        let place = [beside.join(written), root.join(written)].into_iter().find(|path| path.is_file());
        match place {
            Some(path) => take(path, images, problems),
            None => problems.push(LabelProblem {
                file: list.to_owned(),
                line: Some(index + 1),
                what: RowProblem::NoImage,
            }),
        }
    }
    Ok(())
}

fn take(path: PathBuf, images: &mut BTreeSet<PathBuf>, problems: &mut Vec<LabelProblem>) {
    if is_image_name(&path) {
        images.insert(path);
    } else if is_other_image_name(&path) {
        let reason = "another format".to_owned();
        problems.push(LabelProblem { file: path, line: None, what: RowProblem::BadImage { reason } });
    }
}
