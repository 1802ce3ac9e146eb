//! Where stereo pairs come from.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// A source of stereo pairs, as the operator names it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SourceSpec {
    /// Two folders; same file names are one pair.
    Folders {
        /// Left eye.
        left: PathBuf,
        /// Right eye.
        right: PathBuf,
    },
    /// One folder of pairs.
    Folder(PathBuf),
    /// Two video files of equal length.
    Videos {
        /// Left eye.
        left: PathBuf,
        /// Right eye.
        right: PathBuf,
    },
    /// Two cameras by number.
    Cameras {
        /// Left eye.
        left: u32,
        /// Right eye.
        right: u32,
    },
}
