//! Writes a calibration in the formats of other programs.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_model::StereoCalibration;
use plumbline_model::files;
use plumbline_model::formats::{CalibrationFormat, mrcal};
use plumbline_vision::calibration_file;

use crate::eyes::command::ExportFormat;
use crate::ground::jobs::JobError;
use crate::ground::text::sentence;

/// Write a calibration to a file.
#[derive(Clone, Debug)]
pub struct Export {
    /// Which.
    pub calibration: Arc<StereoCalibration>,
    /// How.
    pub format: ExportFormat,
    /// Where to; see [`right_file`] for ROS.
    pub file: PathBuf,
}

impl Export {
    /// Writes it; gives the files written.
    pub fn run(self) -> Result<Vec<PathBuf>, JobError> {
        let (targets, format) = match self.format {
            ExportFormat::Plumbline => (vec![self.file], CalibrationFormat::Native),
            ExportFormat::OpenCv => (vec![self.file], CalibrationFormat::OpenCvStorage),
            ExportFormat::Kalibr => (vec![self.file], CalibrationFormat::KalibrCamchain),
            ExportFormat::RosCameraInfo => {
                let right = right_file(&self.file);
                (vec![self.file, right], CalibrationFormat::RosCameraInfo)
            }
            ExportFormat::MrcalCorners => {
                let evidence = self.calibration.evidence.as_ref().ok_or_else(|| {
                    JobError::failed(
                        "This calibration carries no corners, because it was read from another program's file. Solve collected pairs to write corners.",
                    )
                })?;
                files::export(&self.file).map_err(|error| JobError::failed(sentence(&error.to_string())))?;
                mrcal::write_corners(evidence, &self.file).map_err(JobError::failed)?;
                return Ok(vec![self.file]);
            }
        };
        for file in &targets {
            files::export(file).map_err(|error| JobError::failed(sentence(&error.to_string())))?;
        }
        calibration_file::save(&self.calibration, &targets, format).map_err(JobError::failed)?;
        Ok(targets)
    }
}

/// The right eye's file beside the left eye's: `left` in its name becomes `right`; where the
/// name does not say left, `_right` is added.
pub fn right_file(left: &Path) -> PathBuf {
    let name = left.file_name().unwrap_or_default().to_string_lossy();
    if let Some(at) = name.rfind("left") {
        return left.with_file_name(format!("{}right{}", &name[..at], &name[at + "left".len()..]));
    }
    let stem = left.file_stem().unwrap_or_default().to_string_lossy();
    match left.extension() {
        Some(extension) => left.with_file_name(format!("{stem}_right.{}", extension.to_string_lossy())),
        None => left.with_file_name(format!("{stem}_right")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_right_file_is_named_after_the_left_one() {
        for (left, right) in [
            ("a/left.yaml", "a/right.yaml"),
            ("a/nico_left_eye.yaml", "a/nico_right_eye.yaml"),
            ("left/eyes.yaml", "left/eyes_right.yaml"),
            ("eyes", "eyes_right"),
        ] {
            assert_eq!(right_file(Path::new(left)), Path::new(right));
        }
    }
}
