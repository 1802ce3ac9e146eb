//! What takes time: looking for sessions, the search, reading and writing findings and models.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_effects::RigModel;
use plumbline_gap::{Options, Verdict};
use plumbline_model::robot::Rig;
use plumbline_model::{JobContext, Session, counted, files};
use plumbline_report::ReportContext;

use super::search::{SearchError, measured, search};
use super::sessions::{self, are_as, at_home, stamps};
use super::store::{KeptFinding, KeptSession, Named, Store};
use super::view::GapSession;
use super::{at_tip, model};
use crate::ground::LongWork;
use crate::ground::jobs::JobError;
use crate::ground::notice::NoticeLevel;
use crate::ground::sessions::title_of;
use crate::ground::text::sentence;
use crate::{ground, rig_models};

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum GapWork {
    /// Reads what was found and accepted before.
    Restore {
        /// Where the world's files are.
        folder: PathBuf,
        /// The robot that they must be of.
        rig: Arc<Rig>,
    },
    /// Looks which sessions there are, and whether those of the findings changed.
    List {
        /// Folder of the sessions.
        folder: PathBuf,
        /// Sessions elsewhere that were chosen.
        others: Vec<PathBuf>,
        /// Sessions of findings.
        watched: Vec<KeptSession>,
    },
    /// Looks for the gap.
    Find {
        /// Folders of the sessions.
        sessions: Vec<PathBuf>,
        /// The robot that they must be of.
        rig: Arc<Rig>,
        /// The model to compare with.
        model: Arc<RigModel>,
        /// Seed and limits.
        options: Options,
        /// Where findings are kept.
        store: Store,
        /// When it was asked for.
        at: jiff::Timestamp,
    },
    /// Deletes a finding.
    Delete {
        /// Where findings are kept.
        store: Store,
        /// Which.
        id: String,
    },
    /// Adds effects of a finding to the model in use.
    Add {
        /// The finding.
        finding: Arc<Named>,
        /// Which effects, by place.
        effects: Vec<usize>,
        /// Whether the finding was made with the robot's description alone, so that it replaces what
        /// is in the model.
        replaces: bool,
        /// The model in use.
        model: Arc<RigModel>,
        /// The robot.
        rig: Arc<Rig>,
        /// Where the world's files are.
        folder: PathBuf,
        /// When it was asked for.
        at: jiff::Timestamp,
    },
    /// Puts a model in use.
    Use {
        /// Where the world's files are.
        folder: PathBuf,
        /// The robot.
        rig: Arc<Rig>,
        /// The model.
        model: Arc<RigModel>,
        /// What this does, for people.
        title: String,
    },
    /// Writes a page about a finding.
    Report {
        /// The finding.
        finding: Arc<Named>,
        /// What stands beside it.
        context: Box<ReportContext>,
        /// Where to.
        file: PathBuf,
        /// As PDF rather than as HTML.
        pdf: bool,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum GapResult {
    /// What was there before.
    Restored(Box<Restored>),
    /// Sessions, newest first, and which watched ones have changed.
    Listed {
        /// Sessions.
        sessions: Vec<GapSession>,
        /// Folders of sessions that are not any more as they were compared.
        changed: Vec<PathBuf>,
    },
    /// A finding.
    Found(Arc<Named>),
    /// A finding is gone.
    Deleted(String),
    /// A model is in use, and how far each of its effects moves what it is about, see [`at_tip::moved_m`].
    InUse(Arc<RigModel>, Vec<Option<f64>>),
    /// The arm is no better off with small shares of all usual effects: the model stays. Id of the finding.
    NotSized(String),
    /// Written there.
    Written(PathBuf),
}

/// What was there before.
#[derive(Clone, Debug)]
pub struct Restored {
    /// Sessions, newest first.
    pub sessions: Vec<GapSession>,
    /// Findings, newest first.
    pub findings: Vec<Arc<Named>>,
    /// Folders of sessions that are not any more as they were compared.
    pub changed: Vec<PathBuf>,
    /// The model in use; `None` when that cannot be told.
    pub model: Option<Arc<RigModel>>,
    /// How far each of its effects moves what it is about.
    pub moved_m: Vec<Option<f64>>,
    /// What could not be read, a sentence each.
    pub problems: Vec<String>,
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, GapWork>;

impl LongWork for GapWork {
    type Result = GapResult;

    fn title(&self) -> String {
        match self {
            Self::Restore { .. } => "Read what was found before".to_owned(),
            Self::List { .. } => "Look for sessions".to_owned(),
            Self::Find { sessions, .. } => match sessions.as_slice() {
                [one] => format!("Find what is missing: {}", title_of(one)),
                several => format!("Find what is missing: {} sessions", several.len()),
            },
            Self::Delete { .. } => "Delete a finding".to_owned(),
            Self::Add { effects, .. } if effects.is_empty() => "Correct the arm without a name".to_owned(),
            Self::Add { effects, .. } if effects.len() == 1 => "Add an effect to the model".to_owned(),
            Self::Add { effects, .. } => format!("Add {} to the model", counted(effects.len(), "effect")),
            Self::Use { title, .. } => title.clone(),
            Self::Report { file, .. } => format!("Write {}", title_of(file)),
        }
    }

    fn is_quiet(&self) -> bool {
        matches!(self, Self::Restore { .. } | Self::List { .. } | Self::Delete { .. })
    }

    fn run(self, context: &dyn JobContext) -> Result<GapResult, JobError> {
        context.checkpoint()?;
        match self {
            Self::Restore { folder, rig } => Ok(GapResult::Restored(Box::new(restore(&folder, &rig)))),
            Self::List { folder, others, watched } => {
                let mut sessions = sessions::list(&folder).map_err(JobError::failed)?;
                let elsewhere =
                    others.into_iter().filter(|other| !sessions.iter().any(|s| s.folder == *other));
                let elsewhere: Vec<GapSession> = elsewhere.map(sessions::listed).collect();
                sessions.extend(elsewhere);
                Ok(GapResult::Listed { sessions, changed: changed(&watched) })
            }
            Self::Find { sessions, rig, model, options, store, at } => {
                let kept: Vec<KeptSession> = sessions
                    .iter()
                    .map(|folder| KeptSession { folder: folder.clone(), tables: stamps(folder) })
                    .collect();
                context.report(0.0, "reading the sessions");
                let measurements = measured(&sessions, &rig).map_err(failed)?;
                let finding =
                    search(&measurements, &model.for_eyes_of(&rig), &options, context).map_err(failed)?;
                let about = (model::name(&model), model::parts(&model));
                let named =
                    store.keep(KeptFinding::new(finding, kept, about, at)).map_err(JobError::failed)?;
                Ok(GapResult::Found(Arc::new(named)))
            }
            Self::Delete { store, id } => {
                store.delete(&id).map_err(JobError::failed)?;
                Ok(GapResult::Deleted(id))
            }
            Self::Add { finding, effects, replaces, model, rig, folder, at } => {
                let sessions = sessions_of(&finding)?;
                let named = &finding.kept.finding;
                // Names that come in addition leave what is in the model as it is.
                let whole = if replaces {
                    whole(&finding, &sessions, &effects, (&model, &rig), at, context)?
                } else {
                    None
                };
                let next = match whole {
                    Some(next) => next,
                    None if effects.is_empty() => return Ok(GapResult::NotSized(finding.id.clone())),
                    None => rig_models::with(&model, &rig, (named, &sessions), &effects, replaces, at)
                        .map_err(JobError::failed)?,
                };
                rig_models::save(&folder, &next, &rig).map_err(JobError::failed)?;
                let moved_m = at_tip::moved_m(&next, &rig);
                Ok(GapResult::InUse(Arc::new(next), moved_m))
            }
            Self::Use { folder, rig, model, .. } => {
                rig_models::save(&folder, &model, &rig).map_err(JobError::failed)?;
                let moved_m = at_tip::moved_m(&model, &rig);
                Ok(GapResult::InUse(model, moved_m))
            }
            Self::Report { finding, context, file, pdf } => {
                write_report(&finding, &context, &file, pdf)?;
                Ok(GapResult::Written(file))
            }
        }
    }
}

/// What was not done, in a sentence; what was cancelled stays so.
fn failed(error: SearchError) -> JobError {
    match error {
        SearchError::Gap(plumbline_gap::GapError::Cancelled(cancelled)) => cancelled.into(),
        other => JobError::Failed(sentence(&other.to_string())),
    }
}

/// Names that leave what noise alone leaves at least so often need no small shares beside them.
const NOISE_P: f64 = 0.05;

/// The arm with all usual effects beside those that were chosen, where the finding's rows are touches of one
/// session and that errs less.
fn whole(
    finding: &Named,
    sessions: &[Session],
    effects: &[usize],
    (model, rig): (&RigModel, &Rig),
    at: jiff::Timestamp,
    context: &dyn JobContext,
) -> Result<Option<RigModel>, JobError> {
    let found = &finding.kept.finding;
    if !effects.is_empty() && found.verdict == Verdict::Named && found.unexplained.p_value > NOISE_P {
        return Ok(None);
    }
    let folders: Vec<PathBuf> = finding.kept.sessions.iter().map(|session| session.folder.clone()).collect();
    let measurements = measured(&folders, rig).map_err(failed)?;
    let Some(touches) = plumbline_fit::ArmTouches::of(sessions, &measurements) else { return Ok(None) };
    rig_models::whole(model, rig, &touches, found, effects, at, context).map_err(|error| match error {
        rig_models::WholeError::Cancelled(cancelled) => cancelled.into(),
        other => JobError::failed(other),
    })
}

/// The sessions of a finding, as they are on disk.
fn sessions_of(finding: &Named) -> Result<Vec<Session>, JobError> {
    let read = |session: &KeptSession| Session::read(&session.folder).map_err(JobError::told);
    finding.kept.sessions.iter().map(read).collect()
}

fn write_report(
    finding: &Named,
    context: &ReportContext,
    file: &std::path::Path,
    pdf: bool,
) -> Result<(), JobError> {
    let page = if pdf {
        plumbline_report::pdf(&finding.kept.finding, context)
            .map_err(|error| JobError::Failed(sentence(&error.to_string())))?
    } else {
        plumbline_report::html(&finding.kept.finding, context).into_bytes()
    };
    let sessions = finding.kept.sessions.iter().map(|session| session.folder.as_path());
    files::output(file, &sessions.collect::<Vec<_>>())
        .and_then(|()| files::write(file, page))
        .map_err(|error| JobError::Failed(sentence(&error.to_string())))
}

/// Everything that can be read is; what cannot is told.
fn restore(folder: &std::path::Path, rig: &Arc<Rig>) -> Restored {
    let mut problems = Vec::new();
    let sessions = sessions::list(&folder.join("sessions")).unwrap_or_else(|problem| {
        problems.push(problem.to_string());
        Vec::new()
    });
    let (mut findings, unread) = Store::new(folder.join("gap")).read(&rig.name);
    for named in &mut findings {
        let kept = std::mem::take(&mut named.kept.sessions).into_iter();
        named.kept.sessions = kept.map(|session| at_home(session, &folder.join("sessions"))).collect();
    }
    problems.extend(unread);
    let model = match rig_models::load(folder, rig) {
        Ok(model) => Some(Arc::new(model)),
        Err(problem) => {
            problems.push(problem.to_string());
            None
        }
    };
    let watched: Vec<KeptSession> = findings.iter().flat_map(|named| named.kept.sessions.clone()).collect();
    Restored {
        sessions,
        findings: findings.into_iter().map(Arc::new).collect(),
        changed: changed(&watched),
        moved_m: model.as_ref().map_or_else(Vec::new, |model| at_tip::moved_m(model, rig)),
        model,
        problems,
    }
}

/// Folders of sessions whose tables are not any more as they were.
fn changed(watched: &[KeptSession]) -> Vec<PathBuf> {
    watched
        .iter()
        .filter(|session| !are_as(&stamps(&session.folder), &session.tables))
        .map(|session| session.folder.clone())
        .collect()
}

impl GapResult {
    /// Whether it is good news: a search that gives no name is none.
    pub fn level(&self) -> NoticeLevel {
        match self {
            Self::Found(named) if named.kept.finding.is_answered() => NoticeLevel::Success,
            Self::Found(_) => NoticeLevel::Info,
            _ => NoticeLevel::Success,
        }
    }

    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Restored(_) => "What was found before was read.".to_owned(),
            Self::Listed { sessions, .. } => format!("{}.", counted(sessions.len(), "session")),
            Self::Found(named) => named.kept.finding.sentence.clone(),
            Self::Deleted(_) => "The finding was deleted.".to_owned(),
            Self::InUse(model, _) => format!("The model in use is {}.", model::name(model)),
            Self::NotSized(_) => "The model in use stays as it is.".to_owned(),
            Self::Written(file) => format!("The report was written to {}.", file.display()),
        }
    }
}
