//! Judging detectors on a labeled data set.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_model::ClassNames;
pub use plumbline_vision::detect::DetectError;
use plumbline_vision::detect_score::EvaluateError;

use super::command::{ConfusionCell, SetPart};
use crate::ground::jobs::JobId;
use crate::ground::text::sentence;
use crate::labels::Pixels;
use crate::labels::view::{LabelBox, ProposedBox};

/// Scores of detectors.
#[derive(Clone, Debug, Default)]
pub struct ScoresView {
    /// Detectors that can be judged.
    pub models: Arc<[ScoredModelFile]>,
    /// The data set.
    pub set: Option<PathBuf>,
    /// Which part of it.
    pub part: SetPart,
    /// The evaluation that is under way.
    pub evaluating: Option<JobId>,
    /// Why the last one gave nothing; a sentence.
    pub failed: Option<String>,
    /// What came out.
    pub table: Option<Arc<ScoreTable>>,
    /// The images behind a cell of a confusion matrix.
    pub cell: Option<Arc<OpenedCell>>,
    /// The image that is shown large, by its place in the cell.
    pub picture: Option<usize>,
}

/// A detector in the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScoredModelFile {
    /// Its file.
    pub file: PathBuf,
    /// Whether it is judged in the next evaluation.
    pub chosen: bool,
    /// Whether it came with the program.
    pub shipped: bool,
}

/// The table.
#[derive(Clone, Debug)]
pub struct ScoreTable {
    /// The data set.
    pub set: PathBuf,
    /// Its classes.
    pub names: ClassNames,
    /// Images that were judged on.
    pub images: usize,
    /// Boxes per class.
    pub instances: Vec<usize>,
    /// Images that could not be read and were left out, a sentence each.
    pub left_out: Vec<String>,
    /// One row per model.
    pub rows: Vec<ScoreRow>,
}

/// A model in the table.
#[derive(Clone, Debug)]
pub struct ScoreRow {
    /// Its file name.
    pub model: String,
    /// Its scores, or why there are none.
    pub scores: Result<ModelScores, Arc<NotJudged>>,
}

/// Why a detector has no scores: a sentence.
#[derive(Debug, thiserror::Error)]
pub enum NotJudged {
    /// It cannot be opened.
    #[error("{}", sentence(&.0.to_string()))]
    Detector(#[from] DetectError),
    /// It cannot be judged on this data set.
    #[error("{}", sentence(&.0.to_string()))]
    Evaluate(#[from] EvaluateError),
}

/// Scores of one model.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelScores {
    /// All classes.
    pub all: Score,
    /// Tomato, where the set has it.
    pub tomato: Option<Score>,
    /// Both hands, where the set has them.
    pub hands: Option<Score>,
    /// Per class of the set; `None` without boxes of it.
    pub classes: Vec<Option<Score>>,
    /// Median time per image before, in and after the network, ms.
    pub times_ms: [f64; 3],
    /// Classes of the set that the model does not know.
    pub unknown_to_model: Vec<String>,
    /// Classes of the model that the set does not have; what it finds of them is left out.
    pub unknown_to_set: Vec<String>,
    /// Whether the class numbers of model and set differ, so that they were matched by name.
    pub other_order: bool,
    /// What the scores are worth where labels of the set are boxes that the model proposed itself, a sentence.
    pub judged_by_itself: Option<String>,
    /// Boxes per cell: row by truth, column by what was found; background last.
    pub confusion: Vec<Vec<usize>>,
    /// Confidence from which boxes count in the matrix.
    pub confusion_confidence: f32,
}

/// Mean average precision with its 95 % interval over images.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Score {
    /// mAP50–95.
    pub map50_95: f64,
    /// Its interval.
    pub map50_95_interval: Option<[f64; 2]>,
    /// mAP50.
    pub map50: f64,
    /// Its interval.
    pub map50_interval: Option<[f64; 2]>,
}

/// The images behind a cell.
#[derive(Clone, Debug)]
pub struct OpenedCell {
    /// Place of the model in the table.
    pub model: usize,
    /// The cell.
    pub cell: ConfusionCell,
    /// Images, as many as are shown.
    pub pictures: Vec<CellPicture>,
    /// How many there are in all.
    pub of: usize,
}

/// An image of a cell.
#[derive(Clone, Debug)]
pub struct CellPicture {
    /// Its name.
    pub name: String,
    /// Its pixels, or why they cannot be read.
    pub pixels: Pixels,
    /// What is there, by the labels.
    pub truth: Vec<LabelBox>,
    /// What was found, in classes of the set.
    pub found: Vec<ProposedBox>,
    /// Boxes that fell into the cell, by place in `truth` and in `found`.
    pub in_cell: Vec<(Option<usize>, Option<usize>)>,
}
