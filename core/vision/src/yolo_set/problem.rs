//! What can be wrong with one row or one image of a set; the rest of the set is read all the same.

use std::fmt;
use std::path::PathBuf;

/// Something that is left out, and where it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelProblem {
    /// The label file, or the image where the image is at fault.
    pub file: PathBuf,
    /// Line of the label file, from 1.
    pub line: Option<usize>,
    /// What is wrong, and what to do.
    pub what: RowProblem,
}

impl fmt::Display for LabelProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        write!(f, ": {}", self.what)
    }
}

impl std::error::Error for LabelProblem {}

/// What is wrong with a row, a label file or an image.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RowProblem {
    /// Neither a box nor a polygon.
    #[error(
        "{found} numbers: a row is the class and its box (class, middle x, middle y, width, height), or the class and three or more corners of an outline"
    )]
    Fields {
        /// Numbers in the row.
        found: usize,
    },
    /// A row with a confidence, as a detector writes it.
    #[error(
        "six numbers: the last looks like a confidence, as a detector writes it; labels that somebody has checked have five"
    )]
    Confidence,
    /// A field that is no number.
    #[error("\"{text}\" is no number that a label can hold: write the row again")]
    NotANumber {
        /// The field.
        text: String,
    },
    /// A class number that is none.
    #[error("the class \"{text}\" is no whole number from 0 on: write the class's number in data.yaml")]
    NotAClass {
        /// The field.
        text: String,
    },
    /// A class number beyond the names.
    #[error(
        "class {class}, but data.yaml names {known} classes (0 to {last}): add its name at the end of data.yaml or correct the row",
        last = .known.saturating_sub(1)
    )]
    UnknownClass {
        /// The number.
        class: usize,
        /// How many classes are named.
        known: usize,
    },
    /// A coordinate that is not a part of the image's width or height.
    #[error(
        "{text} is outside 0 to 1: coordinates are parts of the image's width and height, not pixels; export the labels again"
    )]
    OffImage {
        /// The field.
        text: String,
    },
    /// A box without extent.
    #[error("the box has no extent: delete the row or draw the box again")]
    NoExtent,
    /// The label file is no text.
    #[error("the file is no text in UTF-8: it may be damaged; write the labels again")]
    NotText,
    /// The label file is there but cannot be read.
    #[error("cannot be read ({reason}): check its permissions and the disk")]
    Unreadable {
        /// What the system says.
        reason: String,
    },
    /// The image is listed but is not there.
    #[error("the image is listed but is not there: restore it or take it off the list")]
    NoImage,
    /// The image cannot be used.
    #[error("is no image that can be read ({reason}): give PNG or JPEG files")]
    BadImage {
        /// What is wrong.
        reason: String,
    },
}
