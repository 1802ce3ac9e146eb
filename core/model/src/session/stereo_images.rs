//! `stereo/left` and `stereo/right`: images, paired by their file names.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::error::SessionError;
use crate::files::{self, FileError, is_hidden};
use crate::pixel::Eye;

/// Images of the same moment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StereoImagePair {
    /// The file name that both share.
    pub name: String,
    /// Path of the left image.
    pub left: PathBuf,
    /// Path of the right image.
    pub right: PathBuf,
}

/// An image whose partner is missing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnpairedImage {
    /// Eye that it is of.
    pub eye: Eye,
    /// Its path.
    pub file: PathBuf,
}

/// The images of a session, sorted by name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StereoImages {
    /// Complete pairs.
    pub pairs: Vec<StereoImagePair>,
    /// Images without a partner; to be reported, not used.
    pub unpaired: Vec<UnpairedImage>,
}

impl StereoImages {
    /// Lists the PNG and JPEG files in `left` and `right` of a folder, which may be absent.
    pub fn list(folder: &Path) -> Result<Self, SessionError> {
        let [mut left, mut right] = [BTreeMap::new(), BTreeMap::new()];
        for (eye, images) in Eye::BOTH.into_iter().zip([&mut left, &mut right]) {
            *images = list_eye(&folder.join(eye.to_string()))?;
        }
        let names: BTreeSet<String> = left.keys().chain(right.keys()).cloned().collect();
        let mut images = Self::default();
        for name in names {
            match (left.remove(&name), right.remove(&name)) {
                (Some(left), Some(right)) => images.pairs.push(StereoImagePair { name, left, right }),
                (Some(file), None) => images.unpaired.push(UnpairedImage { eye: Eye::Left, file }),
                (None, Some(file)) => images.unpaired.push(UnpairedImage { eye: Eye::Right, file }),
                (None, None) => {}
            }
        }
        Ok(images)
    }

    /// Whether there is no image at all.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty() && self.unpaired.is_empty()
    }
}

fn list_eye(folder: &Path) -> Result<BTreeMap<String, PathBuf>, SessionError> {
    if !files::present(folder)? {
        return Ok(BTreeMap::new());
    }
    let unreadable = |source| FileError::Unreadable { file: folder.to_path_buf(), source };
    let mut images = BTreeMap::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let file = entry.map_err(unreadable)?.path();
        if is_hidden(&file) {
            continue;
        }
        let extension = file.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        if matches!(extension.as_deref(), Some("png" | "jpg" | "jpeg"))
            && let Some(name) = file.file_name()
        {
            images.insert(name.to_string_lossy().into_owned(), file);
        }
    }
    Ok(images)
}
