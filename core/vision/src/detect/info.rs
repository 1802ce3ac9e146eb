//! What is known of a detector before it sees an image.

use std::fmt;
use std::path::PathBuf;

use plumbline_model::detection::ClassNames;
use serde::{Deserialize, Serialize};

use super::Provider;

/// What is known of an opened detector.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DetectorInfo {
    /// Name of its file, or what it was called when it came from memory.
    pub name: String,
    /// Its file, if it came from one.
    pub file: Option<PathBuf>,
    /// Meaning of its class numbers: what is used.
    pub names: ClassNames,
    /// Where `names` come from.
    pub names_from: NamesFrom,
    /// Names that the file itself carries, if it does.
    pub names_in_file: Option<ClassNames>,
    /// Names of the `data.yaml` beside the file, if there is a readable one.
    pub names_beside: Option<ClassNames>,
    /// Where the two differ, in words for the operator; must be shown. Also says if there are
    /// no names at all, or if what lies beside the file cannot be read.
    pub disagreement: Option<String>,
    /// Size of the images that the network itself sees.
    pub input: InputSize,
    /// Type of the numbers that go in and come out.
    pub precision: Precision,
    /// Form of the output.
    pub head: Head,
    /// What computes it.
    pub provider_used: Provider,
    /// Why that is not what was asked for.
    pub provider_note: Option<String>,
    /// Who made the file and with which version, as far as it says.
    pub made_by: Option<String>,
    /// ONNX Runtime that runs it.
    pub runtime: String,
}

impl DetectorInfo {
    /// One line for lists and reports.
    pub fn summary(&self) -> String {
        let Self { name, input, precision, head, provider_used, .. } = self;
        let classes = self.names.len();
        format!("{name}: {classes} classes, {input}, {precision}, {head}, on {provider_used}")
    }
}

/// Where names of classes come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NamesFrom {
    /// The metadata of the ONNX file.
    File,
    /// The `data.yaml` beside it.
    DataYaml,
    /// Nowhere: classes are numbered.
    Nowhere,
}

impl fmt::Display for NamesFrom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::File => "the file itself",
            Self::DataYaml => "the data.yaml beside the file",
            Self::Nowhere => "nowhere: the classes are only numbered",
        })
    }
}

/// Size of the images that a network sees, (width, height) in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum InputSize {
    /// Always this one.
    Fixed {
        /// Width, px.
        width_px: u32,
        /// Height, px.
        height_px: u32,
    },
    /// Any; an image is scaled to fit into this one and then padded to whole strides only.
    Dynamic {
        /// Width, px.
        width_px: u32,
        /// Height, px.
        height_px: u32,
        /// Sides must be multiples of it, px.
        stride_px: u32,
    },
}

impl fmt::Display for InputSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed { width_px, height_px } => write!(f, "{width_px}x{height_px} px"),
            Self::Dynamic { width_px, height_px, .. } => {
                write!(f, "any size up to {width_px}x{height_px} px")
            }
        }
    }
}

/// Type of the numbers of a network's input and output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Precision {
    /// Single precision.
    Float32,
    /// Half precision.
    Float16,
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Float32 => "float32",
            Self::Float16 => "float16",
        })
    }
}

/// Form of a network's output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Head {
    /// 1×(4+classes)×N: N boxes (middle and size) with a confidence per class; the same thing
    /// is seen by several of them.
    Raw,
    /// The same, 1×N×(4+classes).
    RawTransposed,
    /// 1×N×6: boxes by their edges, confidence, class; every thing once.
    EndToEnd,
}

impl fmt::Display for Head {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Raw => "raw head",
            Self::RawTransposed => "raw head, transposed",
            Self::EndToEnd => "end-to-end head",
        })
    }
}

/// What a network was trained for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Task {
    /// Outlines of things.
    Segment,
    /// Joints of bodies.
    Pose,
    /// One name for a whole image.
    Classify,
    /// Turned boxes.
    Oriented,
    /// A distance for every pixel.
    Depth,
    /// Something else, as the file calls it.
    Other(String),
}

impl Task {
    /// From the name in the metadata; `None` for detection.
    pub(super) fn from_metadata(task: &str) -> Option<Self> {
        Some(match task.trim() {
            "detect" | "" => return None,
            "segment" => Self::Segment,
            "pose" => Self::Pose,
            "classify" => Self::Classify,
            "obb" => Self::Oriented,
            "depth" => Self::Depth,
            other => Self::Other(other.to_owned()),
        })
    }
}

impl fmt::Display for Task {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Segment => f.write_str("segmentation"),
            Self::Pose => f.write_str("poses"),
            Self::Classify => f.write_str("classification of whole images"),
            Self::Oriented => f.write_str("oriented boxes"),
            Self::Depth => f.write_str("depth"),
            Self::Other(task) => write!(f, "\"{task}\""),
        }
    }
}
