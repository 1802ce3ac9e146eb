//! The lab's own data sets: which images there are, the one that is shown with its boxes, what is
//! proposed, what could not be written.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use image::RgbImage;
use plumbline_model::{ClassIndex, ClassNames, PixelBox};

use super::images::Unreadable;
use crate::ground::jobs::JobId;

/// Labeling.
#[derive(Clone, Debug, Default)]
pub struct LabelsView {
    /// The open data set.
    pub set: Option<Arc<LabelSetView>>,
    /// A data set is being opened, made, imported or exported.
    pub working: Option<JobId>,
    /// Why the last data set could not be opened or made; a sentence.
    pub failed: Option<String>,
    /// Images in their order: scenes by time, left eye first.
    pub images: Arc<[LabelImage]>,
    /// Images by their state.
    pub counts: LabelCounts,
    /// Small pictures by name, as far as they are read.
    pub thumbnails: Arc<BTreeMap<String, Arc<RgbImage>>>,
    /// The image that is shown.
    pub shown: Option<ShownLabels>,
    /// What should be looked at, over the whole set.
    pub problems: Arc<[LabelProblem]>,
    /// Why something is not on disk yet, a sentence; nothing is lost while the program runs.
    pub unsaved: Option<String>,
    /// The detector that would propose.
    pub detector: Option<String>,
    /// An import that waits for being accepted.
    pub import: Option<Arc<ImportView>>,
    /// The data set that was open last.
    pub recent: Option<PathBuf>,
}

/// A data set.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelSetView {
    /// Its folder.
    pub folder: PathBuf,
    /// Its classes in order.
    pub names: ClassNames,
}

/// How many images are in which state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LabelCounts {
    /// With a label file.
    pub labeled: usize,
    /// Without one.
    pub unlabeled: usize,
    /// Marked to be looked at again.
    pub to_check: usize,
    /// Boxes in all.
    pub boxes: usize,
}

/// An image in the list.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelImage {
    /// Its name: the file without folder and extension, `left_1767628247.140322`.
    pub name: String,
    /// How far it is.
    pub state: LabelState,
    /// How many boxes it has.
    pub boxes: usize,
    /// Why it or its label file cannot be used.
    pub unusable: Option<String>,
    /// How many problems its boxes have.
    pub problems: usize,
}

/// How far an image is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LabelState {
    /// It has no label file.
    #[default]
    Unlabeled,
    /// It has one.
    Labeled,
    /// It is marked to be looked at again.
    ToCheck,
}

/// A box with its class.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelBox {
    /// What.
    pub class: ClassIndex,
    /// Where, on the raw image.
    pub area: PixelBox,
}

/// A box that a detector proposes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProposedBox {
    /// What and where.
    pub label: LabelBox,
    /// How sure the detector is, 0–1.
    pub confidence: f32,
}

/// The image that is shown.
#[derive(Clone, Debug)]
pub struct ShownLabels {
    /// Its name.
    pub name: String,
    /// Its place in the list.
    pub index: usize,
    /// Its pixels, as soon as they are read.
    pub pixels: Option<Result<Arc<RgbImage>, NotShown>>,
    /// Its boxes.
    pub boxes: Arc<[LabelBox]>,
    /// Counts up with every change of the boxes.
    pub revision: u64,
    /// What is proposed.
    pub proposals: Arc<[ProposedBox]>,
    /// The detector is at work.
    pub proposing: bool,
    /// Why its boxes cannot be changed; a sentence.
    pub locked: Option<String>,
    /// Whether there is something to take back.
    pub can_undo: bool,
    /// Whether there is something to do again.
    pub can_redo: bool,
    /// Whether there are boxes before that could be copied.
    pub can_copy: bool,
    /// What should be looked at.
    pub problems: Arc<[LabelProblem]>,
}

/// Why an image cannot be shown: a sentence.
#[derive(Clone, Debug, thiserror::Error)]
pub enum NotShown {
    /// What was found when the data set was opened.
    #[error("{0}")]
    Unusable(String),
    /// Its file was there then.
    #[error(transparent)]
    Unreadable(#[from] Arc<Unreadable>),
}

/// Something wrong with a box.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelProblem {
    /// Name of the image.
    pub image: String,
    /// Place of the box in its list.
    pub index: Option<usize>,
    /// What is wrong, a sentence.
    pub text: String,
}

/// What an import would do.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportView {
    /// The other data set.
    pub from: PathBuf,
    /// Its classes in its order, with their place in this one; `None`: their boxes
    /// are left out.
    pub classes: Vec<(String, Option<ClassIndex>)>,
    /// Whether a class number means something else there, so that numbers are changed.
    pub renumbered: bool,
    /// Images that come.
    pub images: usize,
    /// Boxes that come.
    pub boxes: usize,
    /// Images that are there already by name, and stay as they are.
    pub skipped: Vec<String>,
    /// What cannot be read and is left out, a sentence each.
    pub problems: Vec<String>,
}
