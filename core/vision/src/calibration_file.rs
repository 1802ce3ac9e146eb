//! Calibration files of every known format, behind one pair of functions.

use std::path::PathBuf;

use plumbline_model::StereoCalibration;
use plumbline_model::formats::{
    self, CalibrationFormat, FormatError, ReadOptions, is_opencv_storage, kalibr, native, read_text, ros,
};

use crate::opencv_storage;

/// Reads a calibration; the format is recognized by the content. Give the left ROS file before
/// the right one.
pub fn load(files: &[PathBuf]) -> Result<StereoCalibration, FormatError> {
    load_with(files, &ReadOptions::default())
}

/// [`load`], with what a file of another program does not say: its unit of length, its image
/// size, its lens model.
pub fn load_with(files: &[PathBuf], options: &ReadOptions) -> Result<StereoCalibration, FormatError> {
    let opencv = match files.first() {
        Some(first) if !first.is_dir() => is_opencv_storage(&read_text(first)?),
        _ => false,
    };
    if opencv {
        opencv_storage::read(files, options).map(StereoCalibration::bare)
    } else {
        formats::read_with(files, options)
    }
}

/// Writes a calibration. ROS takes two files, left and right; every other format one. Only the
/// native format keeps residuals, uncertainties and evidence.
pub fn save(
    calibration: &StereoCalibration,
    files: &[PathBuf],
    format: CalibrationFormat,
) -> Result<(), FormatError> {
    let cameras = &calibration.cameras;
    match (format, files) {
        (CalibrationFormat::Native, [file]) => native::write(calibration, file),
        (CalibrationFormat::KalibrCamchain, [file]) => kalibr::write(cameras, file),
        (CalibrationFormat::OpenCvStorage, [file]) => opencv_storage::write(cameras, file),
        (CalibrationFormat::RosCameraInfo, [left, right]) => ros::write(cameras, left, right),
        _ => {
            let expected = match format {
                CalibrationFormat::RosCameraInfo => "two files, the left eye's and the right eye's",
                _ => "one file",
            };
            Err(FormatError::FileCount {
                reason: format!("{} is written to {expected}, not {}", format.name(), files.len()),
            })
        }
    }
}
