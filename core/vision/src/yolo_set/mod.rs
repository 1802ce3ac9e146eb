//! Data sets in the YOLO layout: images, one text file of boxes beside each, and a `data.yaml`
//! that names the classes and says where the images are.
//!
//! The number of a class means nothing without the names of its own set, so nothing here takes a
//! number of one list for a number of another: sets are joined by name ([`ClassMapping`]), and a
//! set with other names, or the same in another order, is never appended to.

mod data_yaml;
mod error;
mod images;
mod mapping;
mod problem;
mod read;
mod rows;
mod scene;
mod split;
#[cfg(test)]
mod tests;
mod write;

use std::fmt;
use std::path::{Path, PathBuf};

use plumbline_model::{ClassIndex, ClassNames, JobContext, PixelBox, Unattended};
use serde::{Deserialize, Serialize};

pub use error::YoloSetError;
pub use images::{is_image_name, label_file_of};
pub use mapping::{ClassMapping, ClassTarget, MappingProposal, UnknownClass};
pub use problem::{LabelProblem, RowProblem};
pub use scene::{scene_of, seconds_of};
pub use split::{SplitCounts, SplitOptions};
pub use write::{WriteOptions, WriteReport};

/// Which part of a set an image belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Split {
    /// A detector learns from it.
    Train,
    /// It is chosen between detectors by it.
    Val,
    /// It is judged by it.
    Test,
}

impl Split {
    /// All, in the order of `data.yaml`.
    pub const ALL: [Self; 3] = [Self::Train, Self::Val, Self::Test];

    /// Its key in `data.yaml`, and its folder below `images` and `labels`.
    pub fn key(self) -> &'static str {
        match self {
            Self::Train => "train",
            Self::Val => "val",
            Self::Test => "test",
        }
    }
}

impl fmt::Display for Split {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key())
    }
}

/// A box that somebody says is right.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LabeledBox {
    /// What it is, in the list of its set.
    pub class: ClassIndex,
    /// Where, on the raw image.
    pub area: PixelBox,
}

/// An image and what is on it. No box: nothing of the classes is on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LabeledImage {
    /// The image file.
    pub path: PathBuf,
    /// Width × height of the image.
    pub size_px: (u32, u32),
    /// What was seen: images of one scene (left and right of a pair, a moment later) resemble each
    /// other too much to learn from one and judge by the other. See [`scene_of`].
    pub scene: String,
    /// What is on it.
    pub boxes: Vec<LabeledBox>,
    /// Part of the set; `None`: not chosen yet.
    pub split: Option<Split>,
}

/// A data set in memory; the images themselves stay in their files.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct YoloSet {
    /// The classes; their order is the meaning of every number in the set.
    pub names: ClassNames,
    /// Images in the order of their paths.
    pub images: Vec<LabeledImage>,
}

/// A set that was read, and what was wrong with it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct YoloSurvey {
    /// What could be read.
    pub set: YoloSet,
    /// What could not: rows and images that are left out.
    pub problems: Vec<LabelProblem>,
    /// Images without a label file, taken for images with nothing on them.
    pub without_labels: usize,
    /// Rows that outline a thing by a polygon, of which the box around it was taken.
    pub polygons: usize,
    /// Rows that say the same as another one of their file, taken once.
    pub repeated_rows: usize,
    /// Images that several parts of the set list; they count to the first of train, val, test.
    pub in_several_splits: usize,
}

/// The text of a label file: one row per box.
pub fn label_text(boxes: &[LabeledBox], size_px: (u32, u32)) -> String {
    boxes.iter().map(|labeled| rows::text(labeled, size_px)).collect()
}

impl YoloSet {
    /// Reads one part of the set that a `data.yaml` describes. The first row or image that is
    /// wrong is an error; [`YoloSet::survey`] reads the rest and lists what is wrong.
    pub fn read(data_yaml: &Path, split: Split) -> Result<Self, YoloSetError> {
        Self::strict(Self::survey(data_yaml, &[split], &Unattended)?)
    }

    /// Reads all parts of a set; an image that several parts list counts to the first of them.
    pub fn read_all(data_yaml: &Path) -> Result<Self, YoloSetError> {
        Self::strict(Self::survey(data_yaml, &Split::ALL, &Unattended)?)
    }

    /// Reads parts of a set as far as they can be read. An error is what leaves nothing to read:
    /// no `data.yaml`, no names, no such part.
    pub fn survey(
        data_yaml: &Path,
        splits: &[Split],
        context: &dyn JobContext,
    ) -> Result<YoloSurvey, YoloSetError> {
        read::survey(data_yaml, splits, context)
    }

    /// The class names of a `data.yaml`, without reading an image.
    pub fn read_names(data_yaml: &Path) -> Result<ClassNames, YoloSetError> {
        Ok(data_yaml::DataYaml::read(data_yaml)?.names)
    }

    /// Writes images, labels and `data.yaml` to a folder: a new one, or one with a set of the same
    /// names in the same order, which is added to. See [`WriteOptions`].
    pub fn write(
        &self,
        folder: &Path,
        options: &WriteOptions,
        context: &dyn JobContext,
    ) -> Result<WriteReport, YoloSetError> {
        write::write(self, folder, options, context)
    }

    /// Chooses train or val for the images that have no part yet, whole scenes at a time. The
    /// same images and the same seed give the same parts.
    pub fn split(&mut self, options: &SplitOptions) -> Result<SplitCounts, YoloSetError> {
        split::split(self, options)
    }

    /// The set in the classes of another list. Boxes of classes that are left out are left out.
    pub fn mapped(&self, mapping: &ClassMapping) -> Self {
        let map = |labeled: &LabeledBox| {
            mapping.target(labeled.class).map(|class| LabeledBox { class, area: labeled.area })
        };
        let images = self.images.iter().map(|image| LabeledImage {
            boxes: image.boxes.iter().filter_map(map).collect(),
            ..image.clone()
        });
        Self { names: mapping.to_names().clone(), images: images.collect() }
    }

    /// Boxes per class, in the order of the names.
    pub fn boxes_per_class(&self) -> Vec<usize> {
        let mut counts = vec![0; self.names.len()];
        for labeled in self.images.iter().flat_map(|image| &image.boxes) {
            if let Some(count) = counts.get_mut(labeled.class.0) {
                *count += 1;
            }
        }
        counts
    }

    fn strict(survey: YoloSurvey) -> Result<Self, YoloSetError> {
        match survey.problems.into_iter().next() {
            Some(problem) => Err(YoloSetError::Problem(problem)),
            None => Ok(survey.set),
        }
    }
}
