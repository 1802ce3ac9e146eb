//! Judging detectors one after the other on the same images.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_model::{ClassIndex, JobContext};
use plumbline_vision::detect::{Detector, DetectorOptions};
use plumbline_vision::detect_score::{
    Cell, EvaluateError, EvaluateOptions, Interval, Intervals, ModelEvaluation, PartOfJob, Summary, evaluate,
};
use plumbline_vision::yolo_set::{Split, YoloSet, YoloSurvey};

use super::command::SetPart;
use super::view::{ModelScores, NotJudged, Score, ScoreRow, ScoreTable};
use crate::detect::command::Provider;
use crate::ground::jobs::JobError;
use crate::ground::text::sentence;
use crate::labels::{data_yaml_of, set_failed};

/// What came out: the table, and everything behind it.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// For the window.
    pub table: Arc<ScoreTable>,
    /// Per row, where there are scores.
    pub models: Vec<Option<ModelEvaluation>>,
}

/// Judges detectors. One that cannot be judged says why in its row; the others go on.
///
/// # Errors
/// The data set cannot be used, or the work was cancelled.
pub fn judge(
    models: &[PathBuf],
    set: &Path,
    part: SetPart,
    provider: Provider,
    context: &dyn JobContext,
) -> Result<Evaluation, JobError> {
    let survey = read(set, part, context)?;
    let mut rows = Vec::with_capacity(models.len());
    let mut evaluations = Vec::with_capacity(models.len());
    for (place, file) in models.iter().enumerate() {
        let part = PartOfJob { whole: context, part: place, parts: models.len() };
        let judged = one(file, &survey.set, provider, &part)?;
        let name = name_of(file);
        rows.push(ScoreRow {
            model: name.clone(),
            scores: judged.as_ref().map(scores_of).map_err(Arc::clone),
        });
        evaluations.push(judged.ok().map(|evaluation| ModelEvaluation { model: name, ..evaluation }));
    }
    let mut left_out: Vec<String> =
        survey.problems.iter().map(|problem| sentence(&problem.to_string())).collect();
    if let Some(first) = evaluations.iter().flatten().next() {
        left_out
            .extend(first.skipped.iter().map(|image| format!("{}: {}.", image.path.display(), image.reason)));
    }
    let table = ScoreTable {
        set: set.to_owned(),
        names: survey.set.names.clone(),
        images: survey.set.images.len(),
        instances: survey.set.boxes_per_class(),
        left_out,
        rows,
    };
    Ok(Evaluation { table: Arc::new(table), models: evaluations })
}

fn read(set: &Path, part: SetPart, context: &dyn JobContext) -> Result<YoloSurvey, JobError> {
    let split = match part {
        SetPart::Val => Split::Val,
        SetPart::Train => Split::Train,
        SetPart::Test => Split::Test,
    };
    context.report(0.0, "reading the data set");
    let survey = YoloSet::survey(&data_yaml_of(set), &[split], context).map_err(set_failed)?;
    let boxes: usize = survey.set.images.iter().map(|image| image.boxes.len()).sum();
    if boxes == 0 {
        return Err(JobError::failed(format!(
            "The {split} part of {} has no box to judge by. Choose another part, or label its images first.",
            set.display()
        )));
    }
    Ok(survey)
}

/// One detector; the inner error is told in its row, and the others go on.
fn one(
    file: &Path,
    set: &YoloSet,
    provider: Provider,
    context: &dyn JobContext,
) -> Result<Result<ModelEvaluation, Arc<NotJudged>>, JobError> {
    context.checkpoint()?;
    // The window and what is live behind it go on meanwhile.
    let options = DetectorOptions {
        provider,
        or_processor: true,
        shares_processor: true,
        ..DetectorOptions::default()
    };
    let mut detector = match Detector::open(file, &options) {
        Ok(detector) => detector,
        Err(error) => return Ok(Err(Arc::new(error.into()))),
    };
    match evaluate(&mut detector, set, &EvaluateOptions::default(), context) {
        Ok(evaluation) => Ok(Ok(evaluation)),
        Err(EvaluateError::Cancelled(cancelled)) => Err(cancelled.into()),
        Err(error) => Ok(Err(Arc::new(error.into()))),
    }
}

fn scores_of(evaluation: &ModelEvaluation) -> ModelScores {
    let scores = &evaluation.scores;
    let of = |name: &str| {
        let class = evaluation.class_names.index_of(name)?;
        let summary = &scores.per_class.get(class.0)?.summary;
        score(summary, evaluation.per_class_intervals.get(class.0))
    };
    let timing = &evaluation.timing;
    ModelScores {
        all: score(&scores.overall, Some(&evaluation.intervals)).unwrap_or_default(),
        tomato: of("Tomato"),
        hands: evaluation.hands.as_ref().and_then(|(summary, intervals)| score(summary, Some(intervals))),
        classes: evaluation.class_names.iter().map(|(_, name)| of(name)).collect(),
        times_ms: [timing.before_s, timing.network_s, timing.after_s].map(|seconds| 1e3 * seconds),
        unknown_to_model: evaluation.agreement.unknown_to_model.clone(),
        unknown_to_set: evaluation.agreement.unknown_to_set.clone(),
        other_order: !evaluation.agreement.renumbered.is_empty(),
        judged_by_itself: evaluation.judged_by_itself(),
        confusion: confusion(evaluation),
        confusion_confidence: evaluation.confidence as f32,
    }
}

fn score(summary: &Summary, intervals: Option<&Intervals>) -> Option<Score> {
    let ends = |interval: Option<Interval>| interval.map(|Interval { low, high }| [low, high]);
    Some(Score {
        map50_95: summary.ap?,
        map50_95_interval: intervals.and_then(|intervals| ends(intervals.ap)),
        map50: summary.ap50?,
        map50_interval: intervals.and_then(|intervals| ends(intervals.ap50)),
    })
}

fn confusion(evaluation: &ModelEvaluation) -> Vec<Vec<usize>> {
    let matrix = &evaluation.matrix;
    let row = |truth: Option<ClassIndex>| {
        matrix.lines().map(move |found| matrix.count(Cell { truth, found })).collect()
    };
    matrix.lines().map(row).collect()
}

/// The file name of a model, for people.
pub fn name_of(file: &Path) -> String {
    file.file_stem().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}
