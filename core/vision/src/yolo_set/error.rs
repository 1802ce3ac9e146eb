//! Why a set cannot be read or written.

use std::path::{Path, PathBuf};

use plumbline_model::{Cancelled, ClassNames};

use super::Split;
use super::problem::LabelProblem;

/// Why a set cannot be read or written, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum YoloSetError {
    /// Stopped on request.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A row or an image is wrong.
    #[error(transparent)]
    Problem(#[from] LabelProblem),
    /// A file itself cannot be read or written.
    #[error(transparent)]
    File(#[from] plumbline_model::files::FileError),
    /// A file or folder cannot be read or written.
    #[error("{}: {source}. Check the path, the permissions and the free space", .file.display())]
    Io {
        /// The file or folder.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Not a `data.yaml`.
    #[error(
        "{} cannot be used ({reason}): give the data.yaml of a YOLO set, with names and at least one of train, val and test", .file.display()
    )]
    DataYaml {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// `nc` and the names disagree.
    #[error(
        "{} says nc: {nc} but names {named} classes ({names}): which numbers mean what is unclear, so correct one of them", .file.display()
    )]
    ClassCount {
        /// The file.
        file: PathBuf,
        /// The number that `nc` gives.
        nc: usize,
        /// How many names there are.
        named: usize,
        /// The names.
        names: ClassNames,
    },
    /// The part is not in the set.
    #[error(
        "{} has no {split} part, only {there}: choose one of these, or add \"{split}: <folder of images>\" to it", .file.display()
    )]
    NoSuchSplit {
        /// The file.
        file: PathBuf,
        /// What was asked for.
        split: Split,
        /// The parts that are there.
        there: String,
    },
    /// The folder or list that `data.yaml` names is not there.
    #[error(
        "{} says {key}: {written}, but {} is not there: correct the path (it is taken relative to \"path\", or to data.yaml itself) or bring the images", .file.display(), .looked_at.display()
    )]
    NoImages {
        /// The `data.yaml`.
        file: PathBuf,
        /// The key.
        key: &'static str,
        /// What the file says.
        written: String,
        /// Where that is.
        looked_at: PathBuf,
    },
    /// Nothing to write or to split.
    #[error("there are no images: capture or import some first")]
    Empty,
    /// All images are one scene.
    #[error(
        "all {images} images are of one scene, and a detector must not be judged on what it has learned: capture another scene (move the things, wait longer than {join_within_s} s)"
    )]
    OneScene {
        /// Images without a part.
        images: usize,
        /// Up to which time difference images count as one scene.
        join_within_s: f64,
    },
    /// Options of a split that make no sense.
    #[error("a part of {0} for validation cannot be cut off: give a number between 0 and 1, usually 0.2")]
    Fraction(f64),
    /// The set in the folder has other classes.
    #[error(
        "{} holds a set with the classes {there}; these images have {ours}. A number would mean two things, so nothing was written: choose an empty folder, or import by name", .folder.display()
    )]
    OtherNames {
        /// The folder.
        folder: PathBuf,
        /// Its classes in their order.
        there: ClassNames,
        /// The classes of the images in their order.
        ours: ClassNames,
    },
    /// Images without a part.
    #[error("{0} images belong neither to train nor to val: split the set first")]
    NotSplit(usize),
    /// Two images with one name.
    #[error(
        "{} is there already with other content (or comes twice): rename one of the images, a set has one image per name", .0.display()
    )]
    NameTaken(PathBuf),
    /// A part is a list of images, which is somebody's own.
    #[error(
        "{} lists the images of its {split} part in a text file, which is not written to: choose an empty folder, or give the part a folder", .file.display()
    )]
    ListOfImages {
        /// The `data.yaml`.
        file: PathBuf,
        /// The part.
        split: Split,
    },
    /// The folder holds something else.
    #[error(
        "{} is not empty and holds no data.yaml: choose an empty folder or one with a YOLO set, so that nothing is mixed up", .0.display()
    )]
    NotASet(PathBuf),
    /// A name that no `data.yaml` can hold, or an empty or repeated one.
    #[error(
        "the class name \"{0}\" is empty, there twice, or cannot be written: give every class its own name"
    )]
    ClassName(String),
    /// A box whose class has no name.
    #[error("a box on {} has class {class}, but only {known} classes are named: give the set its names", .image.display())]
    UnnamedClass {
        /// The image.
        image: PathBuf,
        /// The number.
        class: usize,
        /// How many names there are.
        known: usize,
    },
    /// Classes that the target list does not have.
    #[error("the classes {0} are not known here: say for each of them which class it is, or leave it out")]
    UnknownClasses(String),
}

impl YoloSetError {
    /// For `map_err` of file operations.
    pub(super) fn io(file: &Path) -> impl FnOnce(std::io::Error) -> Self {
        let file = file.to_owned();
        move |source| Self::Io { file, source }
    }
}
