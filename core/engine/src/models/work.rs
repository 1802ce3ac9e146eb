//! What takes time: reading sessions, training, reading and writing models and tables.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_correction::{CorrectionModel, Method, TouchData};
use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;
use plumbline_model::{JobContext, counted};

use super::error::ModelError;
use super::files;
use super::learn::{Trained, learn, options};
use super::losses::Losses;
use super::map::model_map;
use super::screen::{self, Corners};
use super::sessions::{self, touch_data};
use super::store::{History, Store};
use super::tables::Tables;
use super::tables::work::{TableFigures, TablesResult, TablesWork};
use super::view::{ModelMap, TouchSession};
use crate::ground;
use crate::ground::LongWork;
use crate::ground::jobs::JobError;

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum ModelsWork {
    /// Reads what was accepted before.
    Restore {
        /// Where the world's files are.
        folder: PathBuf,
        /// The robot that they must be of.
        rig: Arc<Rig>,
    },
    /// Looks which sessions with touches there are.
    List {
        /// Folder of the sessions.
        folder: PathBuf,
    },
    /// Reads a session.
    Read {
        /// Its folder.
        session: PathBuf,
        /// The robot that it must be of.
        rig: Arc<Rig>,
    },
    /// Trains and compares.
    Train {
        /// Folder of the session.
        session: PathBuf,
        /// The robot, its screen where it was measured to lie.
        rig: Arc<Rig>,
        /// Which become proposals.
        methods: Vec<Method>,
        /// Same seed, same models.
        seed: u64,
        /// As published.
        published_recipe: bool,
        /// Where loss curves grow.
        losses: Losses,
    },
    /// Makes a model the one in use.
    Accept {
        /// Where models are kept.
        store: Store,
        /// What was in use so far.
        history: History,
        /// The model; `None`: none.
        model: Option<(Arc<CorrectionModel>, Corners)>,
        /// When it was accepted.
        accepted: jiff::Timestamp,
    },
    /// Goes back to what was in use before.
    Undo {
        /// Where models are kept.
        store: Store,
        /// What was in use so far.
        history: History,
        /// The robot.
        rig: Arc<Rig>,
    },
    /// Reads a model file.
    Import {
        /// Which.
        file: PathBuf,
        /// The robot that it must be of.
        rig: Arc<Rig>,
    },
    /// Writes a model file.
    Export {
        /// The model.
        model: Arc<CorrectionModel>,
        /// As ONNX rather than as JSON.
        onnx: bool,
        /// Where to.
        file: PathBuf,
    },
    /// Part of editing tables.
    Tables(TablesWork),
}

/// What came out.
#[derive(Clone, Debug)]
pub enum ModelsResult {
    /// What was accepted before.
    Restored(Box<Restored>),
    /// Sessions with touches, newest first.
    Listed(Vec<TouchSession>),
    /// What a session has; an error is why nothing can be learned from it.
    Read {
        /// Its folder.
        session: PathBuf,
        /// Its touches.
        data: Result<Arc<TouchData>, Arc<ModelError>>,
    },
    /// Proposals.
    Trained(Box<Trained>),
    /// In use from now on.
    InUse {
        /// What was in use until now and now.
        history: History,
        /// The model; `None`: none.
        model: Option<Arc<CorrectionModel>>,
        /// Its map, where it was not drawn yet.
        map: Option<Arc<ModelMap>>,
    },
    /// A proposal.
    Imported {
        /// The model.
        model: Arc<CorrectionModel>,
        /// Its map.
        map: Arc<ModelMap>,
    },
    /// Written there.
    Exported(PathBuf),
    /// Part of editing tables.
    Tables(TablesResult),
}

/// What was accepted before.
#[derive(Clone, Debug)]
pub struct Restored {
    /// What was in use; `None` when that cannot be told.
    pub history: Option<History>,
    /// The model in use and its map.
    pub model: Option<(Arc<CorrectionModel>, Arc<ModelMap>)>,
    /// Sessions with touches.
    pub sessions: Vec<TouchSession>,
    /// The tables.
    pub tables: Tables,
    /// How good they are.
    pub figures: TableFigures,
    /// What could not be read, a sentence each.
    pub problems: Vec<String>,
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, ModelsWork>;

impl LongWork for ModelsWork {
    type Result = ModelsResult;

    fn title(&self) -> String {
        match self {
            Self::Restore { .. } => "Read the models in use".to_owned(),
            Self::List { .. } => "Look for sessions with touches".to_owned(),
            Self::Read { session, .. } => format!("Read the touches of {}", name_of(session)),
            Self::Train { methods, .. } => format!("Train {}", names(methods)),
            Self::Accept { model: Some((model, _)), .. } => format!("Use {}", model.method().name()),
            Self::Accept { model: None, .. } => "Use no model".to_owned(),
            Self::Undo { .. } => "Go back to the model before".to_owned(),
            Self::Import { file, .. } => format!("Read the model {}", name_of(file)),
            Self::Export { model, .. } => format!("Write {}", model.method().name()),
            Self::Tables(work) => work.title(),
        }
    }

    fn is_quiet(&self) -> bool {
        match self {
            Self::Restore { .. } | Self::List { .. } | Self::Read { .. } => true,
            Self::Tables(work) => work.is_quiet(),
            _ => false,
        }
    }

    fn run(self, context: &dyn JobContext) -> Result<ModelsResult, JobError> {
        context.checkpoint()?;
        match self {
            Self::Restore { folder, rig } => Ok(ModelsResult::Restored(Box::new(restore(&folder, &rig)))),
            Self::List { folder } => {
                Ok(ModelsResult::Listed(sessions::list(&folder).map_err(JobError::failed)?))
            }
            Self::Read { session, rig } => {
                let data = touch_data(&session, &rig).map(Arc::new).map_err(Arc::new);
                Ok(ModelsResult::Read { session, data })
            }
            Self::Train { session, rig, methods, seed, published_recipe, losses } => {
                let options = options(&session, &rig, seed, published_recipe);
                let trained = learn(&session, &rig, &methods, &options, &losses, context)?;
                Ok(ModelsResult::Trained(Box::new(trained)))
            }
            Self::Accept { store, history, model, accepted } => {
                let kept = model.as_ref().map(|(model, screen_m)| (model.as_ref(), *screen_m));
                let history = store.accept(&history, kept, accepted).map_err(JobError::failed)?;
                Ok(ModelsResult::InUse { history, model: model.map(|(model, _)| model), map: None })
            }
            Self::Undo { store, history, rig } => {
                let (history, model) = store.undo(&history).map_err(JobError::failed)?;
                let screen = screen_in_use(Some(&history), &rig);
                let map = model.as_ref().map(|model| Arc::new(model_map(model, &screen, false)));
                Ok(ModelsResult::InUse { history, model, map })
            }
            Self::Import { file, rig } => {
                let model = files::read(&file, &rig).map_err(JobError::failed)?;
                let map = Arc::new(model_map(&model, &rig.touchscreen, true));
                Ok(ModelsResult::Imported { model: Arc::new(model), map })
            }
            Self::Export { model, onnx, file } => {
                plumbline_model::files::export(&file)
                    .map_err(|error| JobError::failed(crate::ground::text::sentence(&error.to_string())))?;
                let written =
                    if onnx { files::write_onnx(&model, &file) } else { files::write(&model, &file) };
                written.map_err(JobError::failed)?;
                Ok(ModelsResult::Exported(file))
            }
            Self::Tables(work) => work.run(context).map(ModelsResult::Tables),
        }
    }
}

impl ModelsResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Restored(_) => "The models in use were read.".to_owned(),
            Self::Listed(sessions) => format!("{} with touches.", counted(sessions.len(), "session")),
            Self::Read { data: Ok(data), .. } => format!("{} to learn from.", counted(data.len(), "touch")),
            Self::Read { data: Err(reason), .. } => reason.to_string(),
            Self::Trained(trained) => trained_summary(trained),
            Self::InUse { model: Some(model), .. } => format!("{} is in use.", model.method().name()),
            Self::InUse { model: None, .. } => "No model is in use: targets are sent as they are.".to_owned(),
            Self::Imported { model, .. } => {
                format!("{} was read and waits to be accepted.", model.method().name())
            }
            Self::Exported(file) => format!("The model was written to {}.", file.display()),
            Self::Tables(result) => result.summary(),
        }
    }
}

fn trained_summary(trained: &Trained) -> String {
    let of = |method: &CorrectionModel| {
        let name = method.method().name();
        match trained.comparison.of(method.method()) {
            Some(held_out) => format!("{name} {:.1} mm", held_out.errors.mean_2d_m * 1e3),
            None => name.to_owned(),
        }
    };
    let models: Vec<String> = trained.models.iter().map(|model| of(model)).collect();
    let touches = counted(trained.data.len(), "touch");
    format!("Trained on {touches}; mean error on held-out ones: {}.", models.join(", "))
}

/// Everything that can be read is; what cannot is told.
fn restore(folder: &Path, rig: &Rig) -> Restored {
    let mut problems = Vec::new();
    let store = Store::new(folder.join("models"));
    let (history, model) = match store.read(&rig.name) {
        Ok((history, model)) => (Some(history), model),
        Err(problem) => {
            problems.push(problem.to_string());
            (None, None)
        }
    };
    let sessions = sessions::list(&folder.join("sessions")).unwrap_or_else(|problem| {
        problems.push(problem.to_string());
        Vec::new()
    });
    let (tables, table_problems) = super::tables::work::restore(&folder.join("tables"));
    problems.extend(table_problems);
    let figures = super::tables::work::figures(&tables, rig);
    let model = model.map(|model| {
        let map = Arc::new(model_map(&model, &screen_in_use(history.as_ref(), rig), false));
        (model, map)
    });
    Restored { history, model, sessions, tables, figures, problems }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn names(methods: &[Method]) -> String {
    methods.iter().map(|method| method.name()).collect::<Vec<_>>().join(", ")
}

/// Where the screen lies, as it is kept with a model.
/// The screen where it was taken to lie when the model in use was made: that is what its map shows, whatever is known
/// of the screen by now, or not yet.
fn screen_in_use(history: Option<&History>, rig: &Rig) -> Touchscreen {
    let kept = history.and_then(History::in_use);
    kept.and_then(|kept| screen::lying(&rig.touchscreen, &kept.screen_m))
        .unwrap_or_else(|| rig.touchscreen.clone())
}

pub(super) fn screen_of(rig: &Rig) -> Corners {
    screen::corners(&rig.touchscreen)
}
