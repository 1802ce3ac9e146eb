//! What takes long: making the file, and waiting until all of it is written.

use std::path::{Path, PathBuf};

use jiff::Timestamp;
use plumbline_model::files::{self, Size};
use plumbline_model::formats::native;
use plumbline_model::robot::Rig;
use plumbline_model::session::{Manifest, names};
use plumbline_model::{JobContext, StereoCalibration, StereoCameras, counted};
use plumbline_recording::{About, Attached, FILE, RecordingWriter};

use super::export::{BESIDE, ExportLerobot};
use super::recorder::{Recorder, Written};
use crate::ground::jobs::JobError;
use crate::ground::sessions::free_folder;
use crate::ground::{self, LongWork, software};

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum RecordingWork {
    /// Makes a session with a recording.
    Begin {
        /// Where sessions are kept.
        sessions: PathBuf,
        /// When it was asked for.
        started: Timestamp,
        /// Name of the rig.
        rig: String,
        /// Whether it is of the twin.
        of_twin: bool,
        /// The calibration in use.
        cameras: Option<Box<StereoCameras>>,
    },
    /// Waits until everything is written.
    End(Recorder),
    /// Writes a recording as a data set.
    Export(ExportLerobot),
}

/// What came out.
#[derive(Clone, Debug)]
pub enum RecordingResult {
    /// It records.
    Begun(Recorder),
    /// It is on disk.
    Ended(Written),
    /// It was written as a data set: what of it, and where, in sentences.
    Exported(String),
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, RecordingWork>;

impl LongWork for RecordingWork {
    type Result = RecordingResult;

    fn title(&self) -> String {
        match self {
            Self::Begin { .. } => "Begin a recording".to_owned(),
            Self::End(_) => "Finish the recording".to_owned(),
            Self::Export(_) => "Export as LeRobot data set".to_owned(),
        }
    }

    fn is_quiet(&self) -> bool {
        matches!(self, Self::Begin { .. })
    }

    fn run(self, context: &dyn JobContext) -> Result<RecordingResult, JobError> {
        match self {
            Self::Begin { sessions, started, rig, of_twin, cameras } => {
                let name = format!("{}_recording", started.strftime("%Y-%m-%dT%H-%M-%S"));
                let session = free_folder(&sessions, &name)
                    .map_err(|error| JobError::failed(format!("{}: {error}", sessions.display())))?;
                let about = About {
                    software: software(),
                    attached: attached(&session, &rig, cameras.as_deref())?,
                    rig: rig.clone(),
                    of_twin,
                    cameras: cameras.map(|cameras| *cameras),
                };
                manifest(&rig, started).write(&session.join(names::MANIFEST)).map_err(JobError::failed)?;
                let writer = RecordingWriter::create(&session.join(FILE), started, &about);
                let writer = writer.map_err(JobError::failed)?;
                Recorder::start(session, writer).map(RecordingResult::Begun).map_err(JobError::failed)
            }
            Self::Export(export) => export.run(context).map(RecordingResult::Exported),
            Self::End(recorder) => recorder.finish().map(RecordingResult::Ended).map_err(JobError::failed),
        }
    }
}

/// Files that make a recording whole by itself; those of the eyes lie beside it, too.
fn attached(session: &Path, rig: &str, cameras: Option<&StereoCameras>) -> Result<Vec<Attached>, JobError> {
    let file = |name: &str, media_type: &str, bytes: Vec<u8>| Attached {
        name: name.to_owned(),
        media_type: media_type.to_owned(),
        bytes,
    };
    let mut attached = Vec::new();
    if let Some([rig, description]) = Rig::built_in_files(rig) {
        attached.push(file("rig.toml", "application/toml", rig.into()));
        attached.push(file("robot.urdf", "application/xml", description.into()));
    }
    if let Some(cameras) = cameras {
        let beside = session.join(BESIDE);
        native::write(&StereoCalibration::bare(*cameras), &beside).map_err(JobError::failed)?;
        let bytes = files::read(&beside, Size::SHORT).map_err(JobError::failed)?;
        attached.push(file(BESIDE, "application/yaml", bytes));
    }
    Ok(attached)
}

fn manifest(rig: &str, started: Timestamp) -> Manifest {
    let mut extra = toml::Table::new();
    extra.insert("software".to_owned(), software().into());
    Manifest { extra, ..Manifest::of_rig(rig, started) }
}

impl RecordingResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Begun(_) => "It records.".to_owned(),
            Self::Ended(Written { counts, .. }) => format!(
                "Recorded {}, {:.1} MB.",
                counted(usize::try_from(counts.pairs).unwrap_or(usize::MAX), "pair"),
                counts.bytes as f64 * 1e-6
            ),
            Self::Exported(said) => said.clone(),
        }
    }
}
