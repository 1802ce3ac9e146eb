//! This program's own calibration file, `rig-cameras.yaml`: the cameras, how well they are known,
//! how every pair fits, and all the evidence needed to solve again.
//!
//! YAML for people and scripts; meters, radians, pixels. Every number has the fewest digits that
//! give it back bit for bit.

mod read;
mod self_test;
mod write;

use std::path::Path;

use super::document::Document;
use super::error::FormatError;
use super::text_file;
use crate::calibration::StereoCalibration;

/// First value of the file: what it is.
const FORMAT: &str = "plumbline-stereo-calibration";
/// Raised when an older program could no longer read the file correctly.
const VERSION: usize = 1;
/// Last key of the file. Numbers cut short are still numbers; only this tells a whole file.
const COMPLETE: &str = "complete";

/// Writes the calibration under a temporary name in the same folder and renames it, after
/// checking that it reads back as the same calibration. When anything fails, a file that was
/// there before is unchanged.
pub fn write(calibration: &StereoCalibration, file: &Path) -> Result<(), FormatError> {
    let text = write::render(calibration);
    let back = read::calibration(&Document::parse(file, &text)?)?;
    if &back != calibration {
        return Err(FormatError::CannotCarry {
            format: "calibration",
            what: "every detail of this calibration".to_owned(),
            instead: "this is a defect of the program; export the calibration in another format and report it",
        });
    }
    text_file::write(file, &text)
}

/// Reads a calibration, bit for bit as it was written.
pub fn read(file: &Path) -> Result<StereoCalibration, FormatError> {
    read::calibration(&Document::open(file)?)
}

/// Whether the keys are those of this file.
pub(crate) fn recognizes(keys: &[&str]) -> bool {
    keys.contains(&"format") && keys.contains(&"cameras")
}

pub(crate) use read::calibration as from_document;
