//! What takes long: a session of what was watched, and what was watched told with another model.

use std::path::PathBuf;
use std::sync::Arc;

use jiff::Timestamp;
use plumbline_drift::{Monitor, Sample, log_of};
use plumbline_effects::RobotModel;
use plumbline_model::JobContext;
use plumbline_model::robot::Posture;
use plumbline_model::session::{Manifest, RigReference, Session, StereoImages};

use crate::ground::jobs::JobError;
use crate::ground::sessions::{free_folder, title_of};
use crate::ground::text::sentence;
use crate::ground::{self, LongWork, software};

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum DriftWork {
    /// Makes a session of what was watched.
    WriteLog {
        /// Where sessions are kept.
        sessions: PathBuf,
        /// What was seen.
        samples: Arc<[Sample]>,
        /// The robot with what was calibrated.
        model: Arc<RobotModel>,
        /// How it stands.
        posture: Posture,
        /// When it was asked for.
        at: Timestamp,
    },
    /// Tells what was seen as it is with another model.
    Retell {
        /// What was seen.
        samples: Arc<[Sample]>,
        /// The model.
        model: Arc<RobotModel>,
        /// How the robot stands.
        posture: Posture,
        /// Whether times count from switching on.
        knows_when: bool,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum DriftResult {
    /// A session, in this folder.
    Logged(PathBuf),
    /// What was seen, with another model; `None`: it cannot be told as the head stands.
    Retold(Option<Box<Monitor>>),
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, DriftWork>;

impl LongWork for DriftWork {
    type Result = DriftResult;

    fn title(&self) -> String {
        match self {
            Self::WriteLog { .. } => "Make a session of what was watched".to_owned(),
            Self::Retell { .. } => "Tell what was watched with the new model".to_owned(),
        }
    }

    fn is_quiet(&self) -> bool {
        true
    }

    fn run(self, context: &dyn JobContext) -> Result<DriftResult, JobError> {
        context.checkpoint()?;
        match self {
            Self::WriteLog { sessions, samples, model, posture, at } => {
                let rig = model.rig();
                let table = log_of(rig, &posture, &samples)
                    .map_err(|error| JobError::Failed(sentence(&error.to_string())))?;
                let session = Session {
                    manifest: manifest(&rig.name, at),
                    touches: None,
                    localizations: Some(table),
                    poses: None,
                    stereo: StereoImages::default(),
                    log: None,
                };
                let name = format!("{}_drift", at.strftime("%Y-%m-%dT%H-%M-%S"));
                let folder = free_folder(&sessions, &name)
                    .map_err(|error| JobError::failed(format!("{}: {error}", sessions.display())))?;
                session.write(&folder).map_err(JobError::failed)?;
                Ok(DriftResult::Logged(folder))
            }
            Self::Retell { samples, model, posture, knows_when } => {
                let monitor = Monitor::retold(&samples, &model, &posture, knows_when);
                Ok(DriftResult::Retold(monitor.map(Box::new)))
            }
        }
    }
}

fn manifest(rig: &str, started: Timestamp) -> Manifest {
    let mut extra = toml::Table::new();
    extra.insert("software".to_owned(), software().into());
    extra.insert("purpose".to_owned(), "watch-drift".into());
    let notes = "Three places on the table, put where the turns of the eyes put them that were seen by following \
                 corners; at the first look they come out where they are.";
    Manifest {
        rig: RigReference::Named(rig.to_owned()),
        started,
        operator: String::new(),
        notes: notes.to_owned(),
        touchscreen: None,
        chain: None,
        extra,
    }
}

impl DriftResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Logged(folder) => format!("What was watched is the session {}.", title_of(folder)),
            Self::Retold(Some(_)) => "What was watched is told with the new model.".to_owned(),
            Self::Retold(None) => {
                "What was watched cannot be told with the new model as the head stands: watching begins anew."
                    .to_owned()
            }
        }
    }
}
