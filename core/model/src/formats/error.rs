//! What can be wrong with a calibration file, and what to do about it.

use std::fmt;
use std::path::PathBuf;

use crate::files::FileError;
use crate::plausible::Implausible;

/// Where in a file something is: the file, the key and, where it is known, the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub file: PathBuf,
    /// Line, counted from 1; `None` where the reader does not know it.
    pub line: Option<usize>,
    /// Path of the key, as in `cameras.left.fx_px`; empty for the file as a whole.
    pub key: String,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        if !self.key.is_empty() {
            write!(f, ", key \"{}\"", self.key)?;
        }
        Ok(())
    }
}

/// Why a calibration (or the manifest of a session) could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FormatError {
    /// The file itself cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Nothing in it.
    #[error("{} is empty: it was probably cut off while it was copied or saved; copy or write it again", file.display())]
    Empty {
        /// The file.
        file: PathBuf,
    },
    /// An image was given.
    #[error("{} is a {kind} picture, not a calibration: give the calibration file, for example rig-cameras.yaml", file.display())]
    Picture {
        /// The file.
        file: PathBuf,
        /// Kind of picture, as in "PNG".
        kind: &'static str,
    },
    /// Neither text nor a known picture.
    #[error(
        "{} is not a text file: give a calibration file (YAML, XML or JSON in UTF-8), for example rig-cameras.yaml",
        file.display()
    )]
    NotText {
        /// The file.
        file: PathBuf,
    },
    /// A folder was given where no calibration is found inside it.
    #[error(
        "{} is a folder without a calibration that is known by its name: give the file itself, or a folder that holds left.yaml and right.yaml",
        file.display()
    )]
    Folder {
        /// The folder.
        file: PathBuf,
    },
    /// Text that does not parse.
    #[error(
        "{place} does not parse as {language} ({reason}): it may be cut off or damaged by hand; correct that line or write the file again"
    )]
    Syntax {
        /// Where the parser stopped.
        place: Place,
        /// "YAML", "TOML", "OpenCV storage".
        language: &'static str,
        /// What the parser said.
        reason: String,
    },
    /// Text that parses and holds something else.
    #[error(
        "{} holds no calibration in a known format (its keys: {keys}): known are this program's own file, ROS camera_info, Kalibr camchain and OpenCV FileStorage",
        file.display()
    )]
    Unrecognized {
        /// The file.
        file: PathBuf,
        /// Top-level keys that were found.
        keys: String,
    },
    /// A number of files that does not fit the format.
    #[error("{reason}")]
    FileCount {
        /// What was given and what to give.
        reason: String,
    },
    /// A key is missing.
    #[error("{place} is missing{}: add it, or write the file again with the program that made it", alternatives(.or))]
    Missing {
        /// Where it should be.
        place: Place,
        /// Other names under which it would have been accepted.
        or: Vec<String>,
    },
    /// A value of another type.
    #[error("{place} should be {expected}, but is {found}: correct it or write the file again")]
    WrongType {
        /// Where.
        place: Place,
        /// What belongs there.
        expected: String,
        /// What is there.
        found: String,
    },
    /// A number that is not finite.
    #[error(
        "{place} is {found}, which is no usable number: the program that wrote the file failed; calibrate again or use an older file"
    )]
    NotFinite {
        /// Where.
        place: Place,
        /// As it stands in the file.
        found: String,
    },
    /// A list or matrix of another size.
    #[error(
        "{place} should have {expected}, but has {found}: write the file again with the program that made it"
    )]
    WrongSize {
        /// Where.
        place: Place,
        /// Size that belongs there.
        expected: String,
        /// Size that is there.
        found: String,
    },
    /// A value that cannot be.
    #[error("{place} should be {expected}, but is {found}: correct it or write the file again")]
    OutOfRange {
        /// Where.
        place: Place,
        /// What would be accepted.
        expected: String,
        /// What is there.
        found: String,
    },
    /// A number that cannot be what it is said to be.
    #[error("{place}: {what}. Correct it, or write the file again")]
    Implausible {
        /// Where.
        place: Place,
        /// What cannot be, and why.
        what: Box<Implausible>,
    },
    /// Cameras that do not see what they saw when the file was written.
    #[error(
        "{place}: these cameras no longer answer as they did when the file was written ({} off), so a number in it was changed or damaged: use a copy of the file as it was, or calibrate again", pixels(*.off_px)
    )]
    OtherAnswers {
        /// The answer that was kept.
        place: Place,
        /// How far off the answer is now, px; infinite where there is none.
        off_px: f64,
    },
    /// Evidence that is not what it was when the file was written.
    #[error(
        "{place}: the {what} in this file are not those that it was written with, so a number was changed or damaged: use a copy of the file as it was, or calibrate again"
    )]
    ChangedSince {
        /// Where the sum was kept.
        place: Place,
        /// What was changed, in the plural or as a whole.
        what: &'static str,
    },
    /// A lens or distortion model that this program does not have.
    #[error(
        "{place} names the model \"{found}\", which is not supported: supported are {supported}; calibrate with one of them"
    )]
    UnsupportedModel {
        /// Where.
        place: Place,
        /// Name in the file.
        found: String,
        /// Names that are understood.
        supported: &'static str,
    },
    /// A 3×3 matrix that should be a rotation.
    #[error(
        "{place} is not a rotation matrix (its columns miss being orthonormal and right-handed by {deviation:.1e}): the file is damaged or in another convention; write it again"
    )]
    NotARotation {
        /// Where.
        place: Place,
        /// Largest deviation of RᵀR from the identity, or 2 for a reflection.
        deviation: f64,
    },
    /// The two eyes are in the wrong order.
    #[error("{place}: {reason}")]
    EyesSwapped {
        /// Where it shows.
        place: Place,
        /// How it shows and what to do.
        reason: String,
    },
    /// Both eyes in one place.
    #[error(
        "{place}: the two eyes are {baseline_m} m apart, so no depth can be measured: check that the file holds a stereo calibration and not the same eye twice"
    )]
    NoBaseline {
        /// Where.
        place: Place,
        /// Distance between the optical centers.
        baseline_m: f64,
    },
    /// A baseline that shows a unit other than the meter.
    #[error(
        "{place}: the two eyes would be {baseline_m} m apart, so the file is probably in millimeters or in squares of the board: read it again and give its unit of length (meters, if it really is that far)"
    )]
    ImplausibleBaseline {
        /// Where.
        place: Place,
        /// Distance between the optical centers, taken as meters.
        baseline_m: f64,
    },
    /// What is to be written does not fit into the format.
    #[error(
        "{format} files have no place for {what}, and leaving it out would change the calibration: {instead}"
    )]
    CannotCarry {
        /// Name of the format.
        format: &'static str,
        /// What does not fit.
        what: String,
        /// What to do.
        instead: &'static str,
    },
}

fn pixels(off_px: f64) -> String {
    if off_px.is_finite() { format!("{off_px:.3} px") } else { "out of sight".to_owned() }
}

fn alternatives(names: &[String]) -> String {
    if names.is_empty() { String::new() } else { format!(" (also accepted: {})", names.join(", ")) }
}
