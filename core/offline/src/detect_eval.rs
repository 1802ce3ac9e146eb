//! `plumbline detect-eval`: how good detectors are on a labeled set.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use plumbline_model::robot::Rig;
use plumbline_model::{Eye, JobContext, PixelBox, files};
use plumbline_vision::detect::{Detector, DetectorOptions, Part, Region, shipped_detector};
use plumbline_vision::detect_score::{
    EvaluateError, EvaluateOptions, Interval, Intervals, ModelEvaluation, PartOfJob, evaluate, matrix_csv,
    scores_csv,
};
use plumbline_vision::yolo_set::{Split, YoloSet, YoloSurvey};
use serde::Serialize;

use super::OfflineError;

/// What to judge, and by what.
#[derive(Clone, Debug)]
pub struct DetectEvalArgs {
    /// ONNX files; empty takes the detector that comes with the program.
    pub models: Vec<PathBuf>,
    /// The set.
    pub data: PathBuf,
    /// Part of the set.
    pub split: Split,
    /// Where the scores are written as a table.
    pub csv: Option<PathBuf>,
    /// Folder that receives what is taken for what, a table per model.
    pub matrices: Option<PathBuf>,
    /// What computes.
    pub options: DetectorOptions,
    /// How models are judged.
    pub judging: EvaluateOptions,
}

/// How good they are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DetectEvalReport {
    /// The set.
    pub data: PathBuf,
    /// Part of it.
    pub split: Split,
    /// Its classes in order.
    pub classes: Vec<String>,
    /// Images in that part.
    pub images: usize,
    /// Scenes in it.
    pub scenes: usize,
    /// Images with nothing on them.
    pub backgrounds: usize,
    /// What of the images the network was given: `lit` (all but what is black to the edge), `all` or
    /// `part`.
    pub looked_at: &'static str,
    /// Where things count, x, y, width, height in px; null: everywhere.
    pub counted_in_px: Option<[u32; 4]>,
    /// Labeled boxes per class.
    pub boxes: BTreeMap<String, usize>,
    /// What is wrong with the set; it is left out.
    pub problems: Vec<String>,
    /// One per model, in the order given.
    pub models: Vec<ModelReport>,
    /// Models that could not be judged.
    pub failed: Vec<FailedModel>,
    /// What was noticed.
    pub notes: Vec<String>,
}

/// How good one is. A score that there is none of, because the class is nowhere in the set, is
/// null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelReport {
    /// What it is called.
    pub model: String,
    /// Its file.
    pub file: PathBuf,
    /// Who made it, as far as it says.
    pub made_by: Option<String>,
    /// Size, head, precision, in words.
    pub summary: String,
    /// Mean over overlaps 0.50–0.95 and over the classes.
    pub map50_95: Option<f64>,
    /// Where it would mostly lie on other scenes.
    pub map50_95_interval: Option<Interval>,
    /// Mean over the classes, at an overlap of 0.5.
    pub map50: Option<f64>,
    /// Where it would mostly lie on other scenes.
    pub map50_interval: Option<Interval>,
    /// mAP50–95 of each class.
    pub per_class: BTreeMap<String, Option<f64>>,
    /// mAP50 of each class.
    pub per_class_map50: BTreeMap<String, Option<f64>>,
    /// More of each class, in the order of the set.
    pub classes: Vec<ClassReport>,
    /// Whole time of an image without reading its file, median.
    pub milliseconds_median: f64,
    /// Its part before the network.
    pub milliseconds_before: f64,
    /// The network alone.
    pub milliseconds_network: f64,
    /// Its part after the network.
    pub milliseconds_after: f64,
    /// How its names fit those of the set; null if they are the same.
    pub names: Option<String>,
    /// What its scores are worth where it proposed labels of the set itself; null where it did not.
    pub judged_by_itself: Option<String>,
    /// Images that could not be used, and those on which it failed.
    pub skipped: Vec<String>,
}

/// How good a model is at one class.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClassReport {
    /// Its name.
    pub class: String,
    /// Labeled boxes of it.
    pub things: usize,
    /// Images with one.
    pub images: usize,
    /// mAP50–95.
    pub map50_95: Option<f64>,
    /// mAP50.
    pub map50: Option<f64>,
    /// Where they would mostly lie on other scenes.
    pub intervals: Intervals,
    /// Part of the boxes that are right, from the confidence of the matrix on.
    pub precision: Option<f64>,
    /// Part of the things that are found, likewise.
    pub recall: Option<f64>,
    /// Confidence with the greatest F1.
    pub best_confidence: Option<f64>,
    /// That F1.
    pub best_f1: Option<f64>,
}

/// A model that could not be judged.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FailedModel {
    /// Its file.
    pub model: PathBuf,
    /// Why.
    pub reason: String,
}

/// The part of an image of the robot's eyes in which the workspace is seen by one of them or the other,
/// with the head at home; `None` where a head at home looks elsewhere.
pub fn workspace_part() -> Option<Region> {
    let rig = Rig::built_in("nico").ok()?;
    let (cameras, workspace) = (&rig.eyes.cameras, rig.workspace(&rig.home()));
    let [left, right] = Eye::BOTH.map(|eye| Region::of_workspace(cameras, &workspace, eye));
    let right = right?;
    let [x0, y0] = [right.x_px, right.y_px].map(|first| first as f32);
    let (x1, y1) = (x0 + right.width_px as f32, y0 + right.height_px as f32);
    Some(left?.with(&PixelBox::new(x0, y0, x1, y1), 0.0, cameras.camera(Eye::Left).size_px()))
}

/// Judges models on a set, one after the other.
pub fn detect_eval(
    args: &DetectEvalArgs,
    context: &dyn JobContext,
) -> Result<DetectEvalReport, OfflineError> {
    let models = match args.models.as_slice() {
        [] => vec![shipped_detector().ok_or(OfflineError::NoDetector)?.file],
        files => files.to_vec(),
    };
    // The folder of the set, not only its description: its images and labels are what is judged by.
    let set = args.data.parent().filter(|_| !args.data.is_dir());
    let set = set.filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let set = if args.data.is_dir() { args.data.as_path() } else { set };
    let mut inputs = vec![args.data.as_path(), set];
    inputs.extend(models.iter().map(PathBuf::as_path));
    if let Some(file) = &args.csv {
        files::output(file, &inputs)?;
    }
    let survey = YoloSet::survey(&args.data, &[args.split], context)?;
    let mut report = about(args, &survey);
    let mut judged: Vec<ModelEvaluation> = Vec::new();
    for (part, file) in models.iter().enumerate() {
        let part = PartOfJob { whole: context, part, parts: models.len() };
        match one(file, args, &survey.set, &part) {
            Ok((model, evaluation)) => {
                report.models.push(model);
                judged.push(evaluation);
            }
            Err(
                error @ (OfflineError::Cancelled(_) | OfflineError::Evaluate(EvaluateError::Cancelled(_))),
            ) => {
                return Err(error);
            }
            Err(error) if models.len() == 1 => return Err(error),
            Err(error) => report.failed.push(FailedModel { model: file.clone(), reason: error.to_string() }),
        }
    }
    if let (true, Some(first)) = (judged.is_empty(), report.failed.first()) {
        let (models, example) = (models.len(), first.reason.clone());
        return Err(OfflineError::NoModelJudged { models, example });
    }
    if let Some(file) = &args.csv {
        files::write(file, scores_csv(&judged))?;
    }
    if let Some(folder) = &args.matrices {
        files::make_folder(folder)?;
        for model in &judged {
            let file = folder.join(format!("{}.csv", model.model.trim_end_matches(".onnx")));
            files::output(&file, &inputs)?;
            files::write(&file, matrix_csv(&model.matrix, &model.class_names))?;
        }
    }
    Ok(report)
}

fn one(
    file: &Path,
    args: &DetectEvalArgs,
    set: &YoloSet,
    context: &dyn JobContext,
) -> Result<(ModelReport, ModelEvaluation), OfflineError> {
    let mut detector = Detector::open(file, &args.options)?;
    let evaluation = evaluate(&mut detector, set, &args.judging, context)?;
    let info = detector.info();
    let told = [info.disagreement.clone(), info.provider_note.clone(), evaluation.agreement.sentence()];
    let told: Vec<String> = told.into_iter().flatten().collect();
    let report = ModelReport {
        file: file.to_owned(),
        made_by: info.made_by.clone(),
        summary: info.summary(),
        names: (!told.is_empty()).then(|| told.join("; ")),
        ..model_report(&evaluation)
    };
    Ok((report, evaluation))
}

/// What a set holds and what is wrong with it.
fn about(args: &DetectEvalArgs, survey: &YoloSurvey) -> DetectEvalReport {
    let YoloSurvey { set, problems, .. } = survey;
    let scenes: std::collections::BTreeSet<&str> =
        set.images.iter().map(|image| image.scene.as_str()).collect();
    let boxes = set.names.iter().zip(set.boxes_per_class());
    let counted = |count: usize, what: &str| (count > 0).then(|| format!("{count} {what}"));
    let notes = [
        counted(survey.without_labels, "images have no label file and count as images with nothing on them"),
        counted(survey.polygons, "rows are outlines, of which the boxes around them are taken"),
        counted(survey.repeated_rows, "rows are there twice and count once"),
        counted(survey.in_several_splits, "images are in several parts of the set"),
        counted(problems.len(), "rows or images of the set are wrong and left out"),
    ];
    DetectEvalReport {
        data: args.data.clone(),
        split: args.split,
        classes: set.names.iter().map(|(_, name)| name.to_owned()).collect(),
        images: set.images.len(),
        scenes: scenes.len(),
        backgrounds: set.images.iter().filter(|image| image.boxes.is_empty()).count(),
        looked_at: match args.judging.looked_at.part {
            Part::Lit => "lit",
            Part::Whole => "all",
            Part::Region(_) => "part",
        },
        counted_in_px: args
            .judging
            .looked_at
            .within
            .map(|Region { x_px, y_px, width_px, height_px }| [x_px, y_px, width_px, height_px]),
        boxes: boxes.map(|((_, name), count)| (name.to_owned(), count)).collect(),
        problems: problems.iter().map(ToString::to_string).collect(),
        models: Vec::new(),
        failed: Vec::new(),
        notes: notes.into_iter().flatten().collect(),
    }
}

fn model_report(evaluation: &ModelEvaluation) -> ModelReport {
    let classes: Vec<ClassReport> = evaluation
        .scores
        .per_class
        .iter()
        .zip(&evaluation.per_class_intervals)
        .map(|(scores, intervals)| {
            let at = evaluation.scores.at_confidence(scores.class, evaluation.confidence);
            let best = evaluation.scores.best_confidence(scores.class);
            ClassReport {
                class: evaluation.class_names.get(scores.class).unwrap_or_default().to_owned(),
                things: scores.things,
                images: scores.images,
                map50_95: scores.summary.ap,
                map50: scores.summary.ap50,
                intervals: *intervals,
                precision: at.and_then(|point| point.precision()),
                recall: at.and_then(|point| point.recall()),
                best_confidence: best.map(|point| point.confidence),
                best_f1: best.and_then(|point| point.f1()),
            }
        })
        .collect();
    let skipped = evaluation.skipped.iter().map(|skipped| {
        let counts = if skipped.counts { " (counts as nothing found)" } else { " (left out)" };
        format!("{}: {}{counts}", skipped.path.display(), skipped.reason)
    });
    ModelReport {
        model: evaluation.model.clone(),
        file: PathBuf::new(),
        made_by: None,
        summary: String::new(),
        map50_95: evaluation.scores.overall.ap,
        map50_95_interval: evaluation.intervals.ap,
        map50: evaluation.scores.overall.ap50,
        map50_interval: evaluation.intervals.ap50,
        per_class: classes.iter().map(|class| (class.class.clone(), class.map50_95)).collect(),
        per_class_map50: classes.iter().map(|class| (class.class.clone(), class.map50)).collect(),
        classes,
        milliseconds_median: evaluation.timing.total_s * 1e3,
        milliseconds_before: evaluation.timing.before_s * 1e3,
        milliseconds_network: evaluation.timing.network_s * 1e3,
        milliseconds_after: evaluation.timing.after_s * 1e3,
        names: None,
        judged_by_itself: evaluation.judged_by_itself(),
        skipped: skipped.collect(),
    }
}

#[cfg(test)]
mod tests {
    use plumbline_model::{ClassIndex, Unattended};
    use plumbline_vision::detect_score::LookedAt;
    use plumbline_vision::yolo_set::{LabeledBox, LabeledImage, WriteOptions};

    use super::*;

    /// A network that finds the same on every image; see the tests of the detector.
    fn tiny() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../vision/tests/detectors/raw.onnx")
    }

    fn options() -> DetectorOptions {
        DetectorOptions { threads: Some(1), ..DetectorOptions::default() }
    }

    fn args(data: PathBuf, models: Vec<PathBuf>) -> DetectEvalArgs {
        let judging = EvaluateOptions::default();
        DetectEvalArgs {
            models,
            data,
            split: Split::Val,
            csv: None,
            matrices: None,
            options: options(),
            judging,
        }
    }

    /// Five scenes with the thing that the network finds first.
    fn set(folder: &Path) -> PathBuf {
        let names = Detector::open(&tiny(), &options()).expect("a network").info().names.clone();
        let area = PixelBox::new(15.0, 26.0, 25.0, 34.0);
        let image = |index: u32| {
            let path = folder.join(format!("scene{index}.png"));
            image::RgbImage::from_pixel(64, 64, image::Rgb([255, 128, 0])).save(&path).expect("saved");
            let boxes = vec![LabeledBox { class: ClassIndex(0), area }];
            LabeledImage { path, size_px: (64, 64), scene: index.to_string(), boxes, split: Some(Split::Val) }
        };
        let set = YoloSet { names, images: (0..5).map(image).collect() };
        set.write(&folder.join("set"), &WriteOptions::default(), &Unattended).expect("written").data_yaml
    }

    #[test]
    fn what_can_be_judged_is_judged_and_the_rest_is_said() {
        let folder = tempfile::tempdir().expect("a folder");
        let data = set(folder.path());
        let (csv, matrices) = (folder.path().join("scores.csv"), folder.path().join("matrices"));
        let args = DetectEvalArgs {
            csv: Some(csv.clone()),
            matrices: Some(matrices.clone()),
            ..args(data, vec![folder.path().join("gone.onnx"), tiny()])
        };
        let report = detect_eval(&args, &Unattended).expect("one can be judged");
        assert_eq!((report.images, report.scenes, report.models.len()), (5, 5, 1));
        assert!(report.failed[0].reason.contains("gone.onnx"), "{:?}", report.failed);
        let json = serde_json::to_value(&report).expect("JSON");
        let model = &json["models"][0];
        assert_eq!(model["model"], "raw.onnx");
        assert!((model["map50"].as_f64().expect("a score") - 1.0).abs() < 1e-9, "{model}");
        assert!(model["map50_95"].is_number() && model["milliseconds_median"].is_number());
        let first = &report.classes[0];
        assert!(model["per_class"][first].is_number());
        assert!(model["per_class"][&report.classes[1]].is_null(), "nowhere in the set, so no score");
        assert!(std::fs::read_to_string(csv).expect("written").lines().count() > report.classes.len());
        assert!(matrices.join("raw.csv").is_file());
    }

    #[test]
    fn what_lies_outside_the_part_that_counts_is_neither_missed_nor_found() {
        let folder = tempfile::tempdir().expect("a folder");
        let data = set(folder.path());
        let score = |within: Region| {
            let mut args = args(data.clone(), vec![tiny()]);
            args.judging.looked_at = LookedAt { part: Part::Whole, within: Some(within) };
            let report = detect_eval(&args, &Unattended).expect("judged");
            assert_eq!((report.looked_at, report.counted_in_px.map(|px| px[0])), ("all", Some(within.x_px)));
            report.models[0].map50
        };
        let around = Region { x_px: 10, y_px: 20, width_px: 20, height_px: 20 };
        assert!((score(around).expect("it is there") - 1.0).abs() < 1e-9);
        assert_eq!(score(Region { x_px: 40, ..around }), None, "nothing is there");
    }

    #[test]
    fn the_workspace_of_a_head_at_home_is_a_part_of_the_images() {
        let part = workspace_part().expect("it is in view");
        let share = part.share_of((640, 480));
        assert!(share > 0.1 && share < 0.5, "{part:?}");
    }

    #[test]
    fn a_set_or_part_that_is_not_there_is_said() {
        let folder = tempfile::tempdir().expect("a folder");
        let gone = args(folder.path().join("data.yaml"), vec![tiny()]);
        assert!(detect_eval(&gone, &Unattended).expect_err("no set").to_string().contains("data.yaml"));
        let test = DetectEvalArgs { split: Split::Test, ..args(set(folder.path()), vec![tiny()]) };
        let words = detect_eval(&test, &Unattended).expect_err("no test part").to_string();
        assert!(words.contains("has no test part, only train and val"), "{words}");
    }
}
