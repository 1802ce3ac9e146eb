//! A recording as a LeRobot data set, as `plumbline lerobot` writes it.

use std::path::{Path, PathBuf};

use plumbline_lerobot::{ExportError, Options, export};
use plumbline_model::JobContext;
use plumbline_vision::calibration_file;

use crate::ground::jobs::JobError;
use crate::ground::text::sentence;

/// The calibration that lies beside a recording.
pub(super) const BESIDE: &str = "rig-cameras.yaml";

/// Which recording, and where to.
#[derive(Clone, Debug)]
pub struct ExportLerobot {
    /// The recording, in its session.
    pub file: PathBuf,
    /// A folder that is empty or new.
    pub folder: PathBuf,
    /// What was being done, a sentence.
    pub task: String,
}

impl ExportLerobot {
    /// The session that it lies in.
    pub fn session(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new(""))
    }

    /// What was written, in sentences. Where nothing comes of it, nothing of it stays.
    pub fn run(&self, context: &dyn JobContext) -> Result<String, JobError> {
        let beside = self.session().join(BESIDE);
        let calibration = if beside.is_file() {
            Some(calibration_file::load(&[beside]).map_err(JobError::told)?)
        } else {
            None
        };
        let cameras = calibration.as_ref().map(|calibration| &calibration.cameras);
        let options = Options { task: &self.task, cameras };
        let exported = export(&self.file, &self.folder, &options, context).map_err(|error| match error {
            ExportError::Cancelled(cancelled) => cancelled.into(),
            other => JobError::Failed(sentence(&other.to_string())),
        })?;
        let written = format!("The recording was written as a data set to {}:", self.folder.display());
        let said = std::iter::once(written).chain(exported.said());
        Ok(said.collect::<Vec<_>>().join(" "))
    }
}
