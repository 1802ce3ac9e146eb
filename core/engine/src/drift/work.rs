//! What takes long: a session of what was watched, and what was watched told with another model.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use jiff::Timestamp;
use plumbline_drift::{GridCorrection, Judged, Monitor, Sample, judge, log_of};
use plumbline_effects::RobotModel;
use plumbline_model::JobContext;
use plumbline_model::robot::{Posture, Rig};
use plumbline_model::session::{
    LocalizationRow, LocalizationTable, Manifest, RigReference, Session, StereoImages, names,
};

use super::Unjudged;
use crate::ground::jobs::JobError;
use crate::ground::sessions::{folders, free_folder, rig_of, title_of};
use crate::ground::text::sentence;
use crate::ground::{self, LongWork, software};
use crate::robot::RobotControl;

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
    /// Makes or replaces the session of an evaluation.
    KeepGrid {
        /// Where sessions are kept.
        sessions: PathBuf,
        /// Its folder; `None`: it has none yet.
        folder: Option<PathBuf>,
        /// Everything that was measured.
        rows: Arc<[LocalizationRow]>,
        /// With which eyes.
        rig: Arc<Rig>,
        /// When it began.
        began: Timestamp,
    },
    /// Looks which evaluations there are.
    ListGrids {
        /// Where sessions are kept.
        sessions: Vec<PathBuf>,
    },
    /// Judges an evaluation.
    JudgeGrid {
        /// Its folder.
        session: PathBuf,
        /// Corrected how.
        correction: GridCorrection,
        /// The model in use.
        model: Arc<RobotModel>,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum DriftResult {
    /// A session, in this folder.
    Logged(PathBuf),
    /// What was seen, with another model; `None`: it cannot be told as the head stands.
    Retold(Option<Box<Monitor>>),
    /// An evaluation is on disk, in this folder.
    GridKept(PathBuf),
    /// Evaluations, newest first.
    Grids(Vec<PathBuf>),
    /// How far off places are, or why that cannot be told, a sentence.
    GridJudged(Result<Arc<Judged>, Unjudged>),
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, DriftWork, RobotControl>;

impl LongWork for DriftWork {
    type Result = DriftResult;

    fn title(&self) -> String {
        match self {
            Self::WriteLog { .. } => "Make a session of what was watched".to_owned(),
            Self::Retell { .. } => "Tell what was watched with the new model".to_owned(),
            Self::KeepGrid { .. } => "Keep what the evaluation measured".to_owned(),
            Self::ListGrids { .. } => "Look which evaluations there are".to_owned(),
            Self::JudgeGrid { .. } => "Judge an evaluation".to_owned(),
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
                let folder = new_folder(&sessions, "drift", at)?;
                write(&folder, manifest(rig, at, "watch-drift", WATCHED), table)?;
                Ok(DriftResult::Logged(folder))
            }
            Self::Retell { samples, model, posture, knows_when } => {
                let monitor = Monitor::retold(&samples, &model, &posture, knows_when);
                Ok(DriftResult::Retold(monitor.map(Box::new)))
            }
            Self::KeepGrid { sessions, folder, rows, rig, began } => {
                let folder = match folder {
                    Some(folder) => folder,
                    None => new_folder(&sessions, GRID, began)?,
                };
                let head = [rig.eyes.pan, rig.eyes.tilt];
                let head = head.map(|joint| rig.description.joints()[joint.0].name.clone()).to_vec();
                let table = LocalizationTable::from_rows(head, &rows);
                write(&folder, manifest(&rig, began, "evaluate-grid", EVALUATED), table)?;
                Ok(DriftResult::GridKept(folder))
            }
            Self::ListGrids { sessions } => Ok(DriftResult::Grids(grids(&sessions)?)),
            Self::JudgeGrid { session, correction, model } => {
                Ok(DriftResult::GridJudged(judged(&session, correction, &model)))
            }
        }
    }
}

/// What the names of folders of evaluations end with.
const GRID: &str = "grid";
const WATCHED: &str = "Three places on the table, put where the turns of the eyes put them that were seen by following \
    corners; at the first look they come out where they are.";
const EVALUATED: &str = "A thing at known places of the table, found by the detector in both eyes. Estimates are those \
    of the rig with its calibration and without any effect.";

/// A folder of its own for a session.
fn new_folder(sessions: &Path, what: &str, at: Timestamp) -> Result<PathBuf, JobError> {
    let name = format!("{}_{what}", at.strftime("%Y-%m-%dT%H-%M-%S"));
    free_folder(sessions, &name).map_err(|error| JobError::failed(format!("{}: {error}", sessions.display())))
}

fn write(folder: &Path, manifest: Manifest, table: LocalizationTable) -> Result<(), JobError> {
    let session = Session {
        manifest,
        touches: None,
        localizations: Some(table),
        poses: None,
        stereo: StereoImages::default(),
        log: None,
    };
    session.write(folder).map_err(JobError::failed)
}

/// Evaluations in folders of sessions, newest first.
fn grids(sessions: &[PathBuf]) -> Result<Vec<PathBuf>, JobError> {
    let mut found = Vec::new();
    for sessions in sessions {
        let all = folders(sessions).map_err(JobError::failed)?.into_iter();
        let is_grid = |folder: &PathBuf| {
            let name = title_of(folder);
            name.contains(&format!("_{GRID}")) && folder.join(names::LOCALIZATIONS).is_file()
        };
        found.extend(all.filter(is_grid));
    }
    found.sort_by_key(|folder| std::cmp::Reverse(title_of(folder)));
    Ok(found)
}

fn judged(folder: &Path, correction: GridCorrection, model: &RobotModel) -> Result<Arc<Judged>, Unjudged> {
    let title = title_of(folder);
    let unread = |said: String| Unjudged::Unread { said: sentence(&said) };
    let session = Session::read(folder).map_err(|error| unread(error.to_string()))?;
    let rig = rig_of(&session, folder).map_err(|error| unread(error.to_string()))?;
    if rig.name != model.rig().name {
        return Err(Unjudged::OtherRobot { session: title, rig: rig.name.clone() });
    }
    let Some(table) = session.localizations.as_ref() else { return Err(Unjudged::NoTable(title)) };
    judge(table, model, correction).map(Arc::new).map_err(|why| Unjudged::Places { session: title, why })
}

fn manifest(rig: &Rig, started: Timestamp, purpose: &str, notes: &str) -> Manifest {
    let mut extra = toml::Table::new();
    extra.insert("software".to_owned(), software().into());
    extra.insert("purpose".to_owned(), purpose.into());
    let mut manifest = Manifest {
        rig: RigReference::Named(rig.name.clone()),
        started,
        operator: String::new(),
        notes: notes.to_owned(),
        touchscreen: None,
        chain: None,
        extra,
    };
    // A search elsewhere knows neither calibration nor mount.
    manifest.set_calibrated_at(&rig.eyes.calibrated_at);
    manifest
}

impl DriftResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Logged(folder) => format!("What was watched is the session {}.", title_of(folder)),
            Self::GridKept(folder) => format!("What was measured is in the session {}.", title_of(folder)),
            Self::Grids(grids) => format!("{} evaluations.", grids.len()),
            Self::GridJudged(Ok(judged)) => {
                format!("{:.1} mm off on average.", 1e3 * judged.errors.mean_m)
            }
            Self::GridJudged(Err(why)) => why.to_string(),
            Self::Retold(Some(_)) => "What was watched is told with the new model.".to_owned(),
            Self::Retold(None) => {
                "What was watched cannot be told with the new model as the head stands: watching begins anew."
                    .to_owned()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::{CalibratedAt, default_rig};

    use super::*;

    #[test]
    fn a_session_keeps_how_warm_the_eyes_were_when_they_were_calibrated() {
        let mut rig = Rig::clone(&default_rig());
        rig.eyes.calibrated_at = CalibratedAt { cameras_s: Some(720.0), mount_s: None };
        let kept = manifest(&rig, Timestamp::UNIX_EPOCH, "watch-drift", WATCHED);
        assert_eq!(kept.calibrated_at(), rig.eyes.calibrated_at);
    }
}
