//! What takes time: judging, reading the images of a cell, writing the table.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_model::{JobContext, counted};

use plumbline_vision::detect_score::{ModelEvaluation, scores_csv};

use super::cells;
use super::command::{ConfusionCell, SetPart};
use super::evaluation::{self, Evaluation, name_of};
use super::view::OpenedCell;
use crate::detect::command::Provider;
use crate::ground;
use crate::ground::LongWork;
use crate::ground::jobs::JobError;
use crate::labels::write_text;

/// Work of this workflow.
#[derive(Clone, Debug)]
pub enum ScoresWork {
    /// Judges detectors.
    Evaluate {
        /// Their files.
        models: Vec<PathBuf>,
        /// The data set.
        set: PathBuf,
        /// Which part of it.
        part: SetPart,
        /// What computes the networks.
        provider: Provider,
    },
    /// Reads the images of a cell.
    OpenCell {
        /// What came out.
        evaluation: Arc<Evaluation>,
        /// Place of the model in the table.
        model: usize,
        /// The cell.
        cell: ConfusionCell,
    },
    /// Writes the table.
    ExportCsv {
        /// What came out.
        evaluation: Arc<Evaluation>,
        /// Where to.
        file: PathBuf,
    },
}

/// What came out.
#[derive(Clone, Debug)]
pub enum ScoresResult {
    /// A table.
    Evaluated(Arc<Evaluation>),
    /// The images of a cell.
    Opened(Arc<OpenedCell>),
    /// Written there.
    Written(PathBuf),
}

/// What the handlers of this room may reach besides their own workflow.
pub type Context<'a> = ground::Context<'a, ScoresWork>;

impl LongWork for ScoresWork {
    type Result = ScoresResult;

    fn title(&self) -> String {
        match self {
            Self::Evaluate { models, .. } => match models.as_slice() {
                [model] => format!("Judge {}", name_of(model)),
                more => format!("Judge {} detectors", more.len()),
            },
            Self::OpenCell { .. } => "Read the images of the cell".to_owned(),
            Self::ExportCsv { file, .. } => format!("Write {}", short(file)),
        }
    }

    fn is_quiet(&self) -> bool {
        matches!(self, Self::OpenCell { .. })
    }

    fn run(self, context: &dyn JobContext) -> Result<ScoresResult, JobError> {
        match self {
            Self::Evaluate { models, set, part, provider } => {
                evaluation::judge(&models, &set, part, provider, context)
                    .map(Arc::new)
                    .map(ScoresResult::Evaluated)
            }
            Self::OpenCell { evaluation, model, cell } => {
                cells::open(&evaluation, model, cell, context).map(Arc::new).map(ScoresResult::Opened)
            }
            Self::ExportCsv { evaluation, file } => {
                let judged: Vec<ModelEvaluation> = evaluation.models.iter().flatten().cloned().collect();
                write_text(&file, &scores_csv(&judged))?;
                Ok(ScoresResult::Written(file))
            }
        }
    }
}

impl ScoresResult {
    /// The result in a sentence.
    pub fn summary(&self) -> String {
        match self {
            Self::Evaluated(evaluation) => {
                let table = &evaluation.table;
                let judged = table.rows.iter().filter(|row| row.scores.is_ok()).count();
                let failed = table.rows.len() - judged;
                let failed =
                    if failed > 0 { format!("; {failed} could not be judged") } else { String::new() };
                format!(
                    "Judged {judged} of {} detectors on {}{failed}.",
                    table.rows.len(),
                    counted(table.images, "image")
                )
            }
            Self::Opened(cell) => format!("In the cell: {}.", counted(cell.of, "image")),
            Self::Written(file) => format!("The scores are in {}.", file.display()),
        }
    }
}

fn short(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
