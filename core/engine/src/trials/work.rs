//! What takes long in an experiment: its files.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_model::JobContext;
use plumbline_model::files;
use plumbline_model::robot::Rig;
use plumbline_report::experiment::{experiment_html, experiment_pdf};

use super::command::TrialsFormat;
use super::error::TrialsError;
use super::judged::{Attempt, Judged};
use super::plan::{Experiment, Trial};
use super::store;
use super::summary::{csv, summary};
use super::view::{EarlierTrials, ShownTrials};
use crate::grasp::{read_record, read_tracks};
use crate::ground::jobs::JobError;
use crate::ground::{self, LongWork};
use crate::robot::RobotControl;

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum TrialsWork {
    /// Looks which experiments there are.
    List {
        /// Where they are kept.
        experiments: PathBuf,
    },
    /// Makes a folder for one.
    Begin {
        /// The folder.
        folder: PathBuf,
        /// What it is.
        experiment: Box<Experiment>,
        /// For the map.
        rig: Arc<Rig>,
    },
    /// Reads an earlier one.
    Open {
        /// The folder.
        folder: PathBuf,
        /// For the map.
        rig: Arc<Rig>,
    },
    /// Keeps an attempt.
    Keep {
        /// The folder of the experiment.
        folder: PathBuf,
        /// What it is.
        experiment: Box<Experiment>,
        /// Which attempt.
        trial: Trial,
        /// Where the thing was put, m.
        placed_m: [f64; 2],
        /// The folder of the grasp.
        grasp: PathBuf,
        /// Whether it was lifted.
        lifted: bool,
        /// For the map.
        rig: Arc<Rig>,
    },
    /// Writes what came of it.
    Export {
        /// The folder of the experiment.
        folder: PathBuf,
        /// Where to.
        file: PathBuf,
        /// As what.
        format: TrialsFormat,
        /// For the map.
        rig: Arc<Rig>,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum TrialsResult {
    /// Which there are, newest first, and what is wrong with others.
    Listed(Vec<EarlierTrials>, Vec<String>),
    /// One that was begun or opened, and the attempts that are still to be made.
    Opened(Arc<ShownTrials>, Vec<Trial>),
    /// An attempt is on disk.
    Kept(Arc<ShownTrials>, Vec<Trial>),
    /// A file was written.
    Written(PathBuf),
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, TrialsWork, RobotControl>;

impl LongWork for TrialsWork {
    type Result = TrialsResult;

    fn title(&self) -> String {
        match self {
            Self::List { .. } => "Look for experiments".to_owned(),
            Self::Begin { .. } => "Begin an experiment".to_owned(),
            Self::Open { .. } => "Open an experiment".to_owned(),
            Self::Keep { .. } => "Keep an attempt".to_owned(),
            Self::Export { .. } => "Write an experiment".to_owned(),
        }
    }

    fn is_quiet(&self) -> bool {
        !matches!(self, Self::Export { .. })
    }

    fn run(self, _: &dyn JobContext) -> Result<TrialsResult, JobError> {
        match self {
            Self::List { experiments } => Ok(list(&experiments)),
            Self::Begin { folder, experiment, rig } => {
                store::begin(&folder, &experiment).map_err(JobError::told)?;
                let (shown, open) = shown(folder, &rig).map_err(JobError::told)?;
                Ok(TrialsResult::Opened(shown, open))
            }
            Self::Open { folder, rig } => {
                let (shown, open) = shown(folder, &rig).map_err(JobError::told)?;
                Ok(TrialsResult::Opened(shown, open))
            }
            Self::Keep { folder, experiment, trial, placed_m, grasp, lifted, rig } => {
                let record = read_record(&grasp).map_err(JobError::told)?;
                let judged = Judged::by_eye(&record, lifted);
                let attempt = Attempt { trial, placed_m, record, judged };
                if let Some(tracks) = read_tracks(&grasp).map_err(JobError::told)? {
                    files::write(&store::tracks_of(&folder, &trial), tracks).map_err(JobError::told)?;
                }
                store::keep(&folder, &attempt).map_err(JobError::told)?;
                store::conclude(&folder, &experiment, &rig).map_err(JobError::told)?;
                let (shown, open) = shown(folder, &rig).map_err(JobError::told)?;
                Ok(TrialsResult::Kept(shown, open))
            }
            Self::Export { folder, file, format, rig } => {
                export(&folder, &file, format, &rig).map_err(JobError::told)?;
                Ok(TrialsResult::Written(file))
            }
        }
    }
}

/// What came of an experiment so far, and what is still to be made.
fn shown(folder: PathBuf, rig: &Rig) -> Result<(Arc<ShownTrials>, Vec<Trial>), TrialsError> {
    let experiment = store::read_experiment(&folder)?;
    let attempts = store::attempts(&folder, &experiment)?;
    let summary = summary(&experiment, &attempts);
    let page = super::page::page(&experiment, &summary, rig);
    let made = |trial: &Trial| attempts.iter().any(|attempt| attempt.trial == *trial);
    let open: Vec<Trial> = experiment.trials().filter(|trial| !made(trial)).collect();
    let all = experiment.trials().count();
    let shown = ShownTrials { made: all - open.len(), all, experiment, page, folder };
    Ok((Arc::new(shown), open))
}

fn list(experiments: &Path) -> TrialsResult {
    let (mut found, mut problems) = (vec![], vec![]);
    for entry in std::fs::read_dir(experiments).into_iter().flatten().flatten() {
        let folder = entry.path();
        if files::is_hidden(&folder) || !folder.is_dir() {
            continue;
        }
        let counted = store::read_experiment(&folder).map(|experiment| {
            let made = experiment.trials().filter(|trial| store::is_made(&folder, trial)).count();
            (made, experiment.trials().count())
        });
        let name = entry.file_name().to_string_lossy().into_owned();
        match counted {
            Ok((made, all)) => found.push(EarlierTrials { folder, name, made, all }),
            Err(why) => problems.push(why.to_string()),
        }
    }
    found.sort_by(|a, b| b.name.cmp(&a.name));
    TrialsResult::Listed(found, problems)
}

fn export(folder: &Path, file: &Path, format: TrialsFormat, rig: &Rig) -> Result<(), TrialsError> {
    let experiment = store::read_experiment(folder)?;
    let attempts = store::attempts(folder, &experiment)?;
    let page = || super::page::page(&experiment, &summary(&experiment, &attempts), rig);
    files::export(file)?;
    match format {
        TrialsFormat::Csv => files::write(file, csv(&experiment, &attempts))?,
        TrialsFormat::Html => files::write(file, experiment_html(&page()))?,
        TrialsFormat::Pdf => files::write(file, experiment_pdf(&page())?)?,
    }
    Ok(())
}

impl TrialsResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Listed(found, _) => format!("{} experiments.", found.len()),
            Self::Opened(shown, _) | Self::Kept(shown, _) => {
                format!("{} of {} attempts are made.", shown.made, shown.all)
            }
            Self::Written(file) => format!("Written: {}.", file.display()),
        }
    }
}
