//! Commands of the lab's own data sets: images of the eyes with boxes.

use std::path::PathBuf;

use plumbline_model::{ClassIndex, PixelBox};
use serde::{Deserialize, Serialize};

/// Opening and filling data sets, drawing boxes, export and import.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LabelsCommand {
    /// Opens a data set.
    Open {
        /// Its folder, or its `data.yaml`.
        path: PathBuf,
    },
    /// Makes a data set without images and opens it.
    Create {
        /// Its folder, which must be empty or not exist.
        folder: PathBuf,
        /// Names of its classes; their order is the meaning of every class number.
        names: Vec<String>,
    },
    /// Closes the data set. Refused while something is not on disk.
    Close,
    /// Adds the newest pair of the source, both eyes.
    Capture,
    /// Shows an image of the data set.
    Choose {
        /// Its name.
        image: String,
    },
    /// Shows an image before or after the present one.
    Step(i64),
    /// Changes a box of an image.
    Edit {
        /// Name of the image that was shown when this was asked for.
        image: String,
        /// What is changed.
        edit: BoxEdit,
    },
    /// Takes back the last change of the shown image.
    Undo,
    /// Does again what was taken back.
    Redo,
    /// Takes over the boxes of the image before (of the same eye).
    CopyPrevious,
    /// Lets the present detector propose boxes for the shown image.
    Propose,
    /// Takes over all proposed boxes.
    AcceptProposals,
    /// Takes over one proposed box, corrected or as it is.
    AcceptProposal {
        /// Its place in the list of proposals.
        index: usize,
        /// What it really is.
        class: Option<ClassIndex>,
        /// Where it really is.
        area: Option<PixelBox>,
    },
    /// Forgets one proposed box.
    DiscardProposal {
        /// Its place in the list of proposals.
        index: usize,
    },
    /// Forgets what is proposed.
    DiscardProposals,
    /// Says that nothing of the classes is on the shown image: labeled, without a box.
    NothingHere,
    /// Marks the shown image to be looked at again, or not.
    ToCheck(bool),
    /// Tries again to write what could not be written.
    SaveAgain,
    /// Writes a data set to train with, split by scene.
    Export {
        /// Its folder, which must be empty or not exist.
        folder: PathBuf,
        /// Share of the scenes that is trained on, percent.
        train_percent: u8,
        /// Same seed, same split.
        seed: u64,
    },
    /// Looks what reading another data set into this one would do; nothing is written.
    Import {
        /// Its `data.yaml`, or its folder.
        path: PathBuf,
    },
    /// Does what was shown of an import.
    AcceptImport,
    /// Forgets an import.
    DiscardImport,
}

/// A change of the boxes of one image.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BoxEdit {
    /// A new box.
    Add {
        /// What it is.
        class: ClassIndex,
        /// Where; the part on the image is kept.
        area: PixelBox,
    },
    /// A box gets other edges.
    Place {
        /// Its place in the list.
        index: usize,
        /// Where; the part on the image is kept.
        area: PixelBox,
    },
    /// A box gets another class.
    Class {
        /// Its place in the list.
        index: usize,
        /// What it is.
        class: ClassIndex,
    },
    /// A box goes.
    Delete {
        /// Its place in the list.
        index: usize,
    },
}
