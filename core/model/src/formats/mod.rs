//! Calibration files: this program's own and those of ROS, Kalibr and mrcal.
//!
//! All numbers are written with every digit, so that a file read back is the same calibration.
//! OpenCV FileStorage needs OpenCV and is read and written by the vision package, with the same
//! errors and checks.

pub mod depth;
mod document;
mod error;
pub mod kalibr;
pub mod lens;
pub mod mrcal;
pub mod native;
pub(crate) mod node;
mod rectification;
pub mod ros;
#[cfg(test)]
pub(crate) mod testing;
pub(crate) mod text_file;
mod yaml;

use std::path::{Path, PathBuf};

pub use error::{FormatError, Place};
pub use rectification::Rectification;

use crate::calibration::StereoCalibration;
use crate::camera::ModelKind;
use document::Document;

/// What a length in a file of another program is measured in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LengthUnit {
    /// Meters, as the formats prescribe.
    Meters,
    /// Millimeters, as many OpenCV scripts use.
    Millimeters,
    /// Sides of the calibration board's squares.
    Squares {
        /// Side of one square, meters.
        side_m: f64,
    },
}

impl LengthUnit {
    /// How many meters one unit is.
    pub fn meters(self) -> f64 {
        match self {
            Self::Meters => 1.0,
            Self::Millimeters => 1e-3,
            Self::Squares { side_m } => side_m,
        }
    }
}

/// What the reader of a foreign file cannot know from the file. Files of this program need none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Unit of lengths in the file. `None`: meters, refused when that puts the eyes more than
    /// [`lens::LARGEST_PLAUSIBLE_BASELINE_M`] apart.
    pub length_unit: Option<LengthUnit>,
    /// Image size (width, height) in pixels, for OpenCV files that do not hold it.
    pub image_size_px: Option<(u32, u32)>,
    /// Lens model, for OpenCV files that do not name it. `None`: four coefficients are a
    /// fisheye's, any other number a pinhole's.
    pub model: Option<ModelKind>,
}

/// A kind of calibration file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CalibrationFormat {
    /// This program's own, with all its evidence; one file.
    Native,
    /// ROS camera_info; two files, left and right.
    RosCameraInfo,
    /// Kalibr camchain; one file.
    KalibrCamchain,
    /// OpenCV FileStorage; one file, or several that complete each other.
    OpenCvStorage,
}

impl CalibrationFormat {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Native, Self::RosCameraInfo, Self::KalibrCamchain, Self::OpenCvStorage];

    /// Name on screen and in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Native => "Plumbline calibration",
            Self::RosCameraInfo => "ROS camera_info",
            Self::KalibrCamchain => "Kalibr camchain",
            Self::OpenCvStorage => "OpenCV FileStorage",
        }
    }
}

/// Reads a calibration of any format of this package, recognized by its content; for ROS give
/// the left file, then the right one, or the folder that holds `left.yaml` and `right.yaml`.
pub fn read_any(files: &[PathBuf]) -> Result<StereoCalibration, FormatError> {
    read_with(files, &ReadOptions::default())
}

/// [`read_any`], with what the file does not say.
pub fn read_with(files: &[PathBuf], options: &ReadOptions) -> Result<StereoCalibration, FormatError> {
    let files = expand(files)?;
    let documents: Vec<Document> = files.iter().map(|file| Document::open(file)).collect::<Result<_, _>>()?;
    let formats: Vec<CalibrationFormat> = documents.iter().map(format_of).collect::<Result<_, _>>()?;
    match (&formats[..], &documents[..]) {
        ([CalibrationFormat::Native], [file]) => native::from_document(file),
        ([CalibrationFormat::KalibrCamchain], [file]) => {
            kalibr::read(file, options).map(StereoCalibration::bare)
        }
        ([CalibrationFormat::RosCameraInfo, CalibrationFormat::RosCameraInfo], [left, right]) => {
            ros::read(left, right, options).map(StereoCalibration::bare)
        }
        _ => Err(wrong_count(&formats)),
    }
}

/// The files that stand for a folder; other paths as they are.
fn expand(files: &[PathBuf]) -> Result<Vec<PathBuf>, FormatError> {
    let [folder] = files else { return Ok(files.to_vec()) };
    if !folder.is_dir() {
        return Ok(files.to_vec());
    }
    ["yaml", "yml"]
        .map(|extension| ["left", "right"].map(|eye| folder.join(eye).with_extension(extension)))
        .into_iter()
        .find(|pair| pair.iter().all(|file| file.is_file()))
        .map(Vec::from)
        .ok_or_else(|| FormatError::Folder { file: folder.clone() })
}

fn wrong_count(formats: &[CalibrationFormat]) -> FormatError {
    let reason = match formats {
        [] => "no calibration file was given: give one, for example rig-cameras.yaml".to_owned(),
        [CalibrationFormat::RosCameraInfo] => {
            "a ROS camera_info file describes one eye: give the left eye's file and the right eye's file, in this order".to_owned()
        }
        _ => {
            let names: Vec<&str> = formats.iter().map(|format| format.name()).collect();
            format!(
                "these {} files do not make one calibration ({}): give one Plumbline, Kalibr or OpenCV file, or two ROS files",
                formats.len(),
                names.join(", ")
            )
        }
    };
    FormatError::FileCount { reason }
}

/// What a file holds, by its content.
fn format_of(document: &Document) -> Result<CalibrationFormat, FormatError> {
    let keys = document.keys();
    if native::recognizes(&keys) {
        Ok(CalibrationFormat::Native)
    } else if kalibr::recognizes(&keys) {
        Ok(CalibrationFormat::KalibrCamchain)
    } else if ros::recognizes(&keys) {
        Ok(CalibrationFormat::RosCameraInfo)
    } else {
        let mut names = keys.iter().take(8).copied().collect::<Vec<_>>().join(", ");
        if keys.len() > 8 {
            names.push_str(", …");
        }
        Err(FormatError::Unrecognized { file: document.file().to_path_buf(), keys: names })
    }
}

/// Reads a text file whole; an empty file, a picture or other binary data is an error that says so.
pub fn read_text(file: &Path) -> Result<String, FormatError> {
    text_file::read(file)
}

/// Whether this is the text of an OpenCV FileStorage (YAML, XML or JSON), which [`read_any`]
/// cannot read.
pub fn is_opencv_storage(text: &str) -> bool {
    let start = text.trim_start();
    // OpenCV's YAML says so with a colon that no YAML standard knows.
    start.starts_with("%YAML:")
        || start.starts_with("<?xml")
        || text.contains("opencv-matrix")
        || text.contains("<opencv_storage>")
}
