//! A detector on a whole set: boxes, times, scores.

use std::path::PathBuf;
use std::time::Duration;

use image::RgbImage;
use plumbline_model::{Cancelled, ClassIndex, ClassNames, Detection, JobContext, files};

use super::look::LookedAt;
use super::{
    ConfusionMatrix, ConfusionOptions, IntervalOptions, Intervals, IouThresholds, ScoreIntervals,
    ScoredImage, Scores, Summary, average_precision,
};
use crate::detect::{DetectError, DetectSettings, DetectTiming, Detector, Part};
use crate::yolo_set::{LabeledImage, YoloSet};

/// Something that finds things on images.
pub trait Detect {
    /// What it is called in tables.
    fn name(&self) -> String;
    /// Meaning of its class numbers.
    fn names(&self) -> &ClassNames;
    /// As [`Detector::detect`].
    fn detect(
        &mut self,
        image: &RgbImage,
        settings: &DetectSettings,
        found: &mut Vec<Detection>,
    ) -> Result<DetectTiming, DetectError>;

    /// The same on a part of an image, as [`Detector::detect_in`]; what has no parts looks at all of it.
    ///
    /// # Errors
    /// As [`Detector::detect_in`].
    fn detect_in(
        &mut self,
        image: &RgbImage,
        part: Part,
        settings: &DetectSettings,
        found: &mut Vec<Detection>,
    ) -> Result<DetectTiming, DetectError> {
        let _ = part;
        self.detect(image, settings, found)
    }
}

impl Detect for Detector {
    fn name(&self) -> String {
        self.info().name.clone()
    }

    fn names(&self) -> &ClassNames {
        &self.info().names
    }

    fn detect(
        &mut self,
        image: &RgbImage,
        settings: &DetectSettings,
        found: &mut Vec<Detection>,
    ) -> Result<DetectTiming, DetectError> {
        Self::detect(self, image, settings, found)
    }

    fn detect_in(
        &mut self,
        image: &RgbImage,
        part: Part,
        settings: &DetectSettings,
        found: &mut Vec<Detection>,
    ) -> Result<DetectTiming, DetectError> {
        Self::detect_in(self, image, part, settings, found)
    }
}

/// How models are judged.
#[derive(Clone, Debug, PartialEq)]
pub struct EvaluateOptions {
    /// Boxes that are asked for.
    pub settings: DetectSettings,
    /// Overlaps at which a box counts as right.
    pub iou: IouThresholds,
    /// Boxes of the matrix, and of precision and recall.
    pub confusion: ConfusionOptions,
    /// How far scores can be trusted.
    pub interval: IntervalOptions,
    /// What of the images is looked at, and what of them counts.
    pub looked_at: LookedAt,
}

impl Default for EvaluateOptions {
    /// As everybody does it: nearly every box (confidence 0.001), suppression at 0.7, at most 300.
    fn default() -> Self {
        Self {
            settings: DetectSettings::for_scores(),
            iou: IouThresholds::coco(),
            confusion: ConfusionOptions::default(),
            interval: IntervalOptions::default(),
            looked_at: LookedAt::default(),
        }
    }
}

/// How the names of a model and of a set fit together. Classes are compared by name whatever
/// their numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct NameAgreement {
    /// Classes that both have, under different numbers: reading numbers instead of names would
    /// have taken one for the other.
    pub renumbered: Vec<String>,
    /// Classes of the set that the model does not know: all their things count as missed.
    pub unknown_to_model: Vec<String>,
    /// Classes of the model that the set does not have: their boxes are not looked at.
    pub unknown_to_set: Vec<String>,
}

impl NameAgreement {
    /// Compares two lists of classes.
    pub fn new(model: &ClassNames, set: &ClassNames) -> Self {
        let lacking = |of: &ClassNames, other: &ClassNames| -> Vec<String> {
            of.iter()
                .filter(|(_, name)| other.index_of(name).is_none())
                .map(|(_, name)| name.to_owned())
                .collect()
        };
        let renumbered =
            set.iter().filter(|(class, name)| model.index_of(name).is_some_and(|other| other != *class));
        Self {
            renumbered: renumbered.map(|(_, name)| name.to_owned()).collect(),
            unknown_to_model: lacking(set, model),
            unknown_to_set: lacking(model, set),
        }
    }

    /// Whether both have the same classes in the same order.
    pub fn is_same(&self) -> bool {
        *self == Self::default()
    }

    /// What there is to know, for the operator; `None` if both are the same.
    pub fn sentence(&self) -> Option<String> {
        let listed = |what: &str, names: &[String]| {
            (!names.is_empty()).then(|| format!("{what}: {}", names.join(", ")))
        };
        let told: Vec<String> = [
            listed("other numbers in the model than in the set, so matched by name", &self.renumbered),
            listed("not known to the model, so all of them count as missed", &self.unknown_to_model),
            listed("known only to the model, so not looked at", &self.unknown_to_set),
        ]
        .into_iter()
        .flatten()
        .collect();
        (!told.is_empty()).then(|| told.join("; "))
    }
}

/// Where the time of an image goes, median over the images; the first one, run once before, warms
/// the model up.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct MedianTiming {
    /// Letterbox and conversion of the pixels.
    pub before_s: f64,
    /// The network alone.
    pub network_s: f64,
    /// Reading the head, suppression.
    pub after_s: f64,
    /// All of it.
    pub total_s: f64,
}

/// An image that is not in the scores, or on which the model failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SkippedImage {
    /// The image.
    pub path: PathBuf,
    /// Why.
    pub reason: String,
    /// Whether it counts, with nothing found, because the model is to blame.
    pub counts: bool,
}

/// Classes that published tables take as one.
const HANDS: [&str; 2] = ["LeftHand", "RightHand"];

/// A model, judged.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelEvaluation {
    /// What the model is called.
    pub model: String,
    /// Classes of the set; all numbers are of this list.
    pub class_names: ClassNames,
    /// How the model's own names fit.
    pub agreement: NameAgreement,
    /// The images that were scored, in order; entries of the matrix count in them.
    pub images: Vec<LabeledImage>,
    /// What was found on each of them, the surest first.
    pub found: Vec<Vec<Detection>>,
    /// Images with trouble.
    pub skipped: Vec<SkippedImage>,
    /// The scores.
    pub scores: Scores,
    /// How far the scores over all classes can be trusted.
    pub intervals: Intervals,
    /// How far those of each class can.
    pub per_class_intervals: Vec<Intervals>,
    /// Mean of both hands, as published tables have it; `None` if the set has no hands.
    pub hands: Option<(Summary, Intervals)>,
    /// What is taken for what.
    pub matrix: ConfusionMatrix,
    /// Confidence of the matrix, and of precision and recall.
    pub confidence: f64,
    /// Where the time goes.
    pub timing: MedianTiming,
}

/// Why a model could not be judged.
#[derive(Debug, thiserror::Error)]
pub enum EvaluateError {
    /// Stopped on request.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// No image could be used.
    #[error(
        "none of the {images} images can be used{example}: choose another part of the set, or restore them"
    )]
    NoImages {
        /// How many there are.
        images: usize,
        /// What is wrong with the first.
        example: String,
    },
    /// The model failed on every image.
    #[error("{model} failed on all {images} images ({reason}): export it again, or choose another one")]
    FailsAlways {
        /// The model.
        model: String,
        /// How many there are.
        images: usize,
        /// What it said first.
        reason: String,
    },
    /// The model and the set have no class in common.
    #[error(
        "{model} knows the classes {theirs}, the set has {ours}: not one name is the same, so nothing can be compared. Give a model that was trained for these classes, or put the data.yaml of its training beside it"
    )]
    NoCommonClass {
        /// The model.
        model: String,
        /// Its classes.
        theirs: ClassNames,
        /// Those of the set.
        ours: ClassNames,
    },
}

/// Runs a model on every image of a set and scores it.
pub fn evaluate(
    detector: &mut dyn Detect,
    set: &YoloSet,
    options: &EvaluateOptions,
    context: &dyn JobContext,
) -> Result<ModelEvaluation, EvaluateError> {
    let model = detector.name();
    let to_set: Vec<Option<ClassIndex>> =
        detector.names().iter().map(|(_, name)| set.names.index_of(name)).collect();
    if to_set.iter().all(Option::is_none) {
        let theirs = detector.names().clone();
        return Err(EvaluateError::NoCommonClass { model, theirs, ours: set.names.clone() });
    }
    let agreement = NameAgreement::new(detector.names(), &set.names);
    let ran = run(detector, set, &to_set, options, context)?;
    context.report(1.0, &format!("{model}: scoring"));
    let scored: Vec<ScoredImage> = ran
        .images
        .iter()
        .zip(&ran.found)
        .map(|(image, found)| options.looked_at.scored(image, found))
        .collect();
    let scores = average_precision(&scored, set.names.len(), &options.iou);
    context.checkpoint()?;
    let scenes: Vec<&str> = ran.images.iter().map(|image| image.scene.as_str()).collect();
    let hands: Vec<usize> = HANDS.iter().filter_map(|name| Some(set.names.index_of(name)?.0)).collect();
    let ScoreIntervals { overall: intervals, per_class: per_class_intervals, groups } =
        scores.intervals(&scenes, std::slice::from_ref(&hands), &options.interval);
    let of_hands = hands.iter().map(|class| &scores.per_class[*class].summary);
    let seen: Vec<&Summary> = of_hands.filter(|summary| summary.ap.is_some()).collect();
    let hands = (!seen.is_empty()).then(|| Summary::mean(seen)).zip(groups.into_iter().next());
    Ok(ModelEvaluation {
        model,
        class_names: set.names.clone(),
        agreement,
        scores,
        intervals,
        per_class_intervals,
        hands,
        matrix: ConfusionMatrix::new(&scored, set.names.len(), &options.confusion),
        confidence: options.confusion.confidence,
        timing: medians(&ran.times),
        images: ran.images,
        found: ran.found,
        skipped: ran.skipped,
    })
}

#[derive(Default)]
struct Ran {
    images: Vec<LabeledImage>,
    found: Vec<Vec<Detection>>,
    times: Vec<DetectTiming>,
    skipped: Vec<SkippedImage>,
}

fn run(
    detector: &mut dyn Detect,
    set: &YoloSet,
    to_set: &[Option<ClassIndex>],
    options: &EvaluateOptions,
    context: &dyn JobContext,
) -> Result<Ran, EvaluateError> {
    let (model, count) = (detector.name(), set.images.len());
    let mut ran = Ran::default();
    let (mut found, part) = (Vec::new(), options.looked_at.part);
    for (index, labeled) in set.images.iter().enumerate() {
        context.checkpoint()?;
        context.report(index as f64 / count as f64, &format!("{model}: image {} of {count}", index + 1));
        let image = match open(labeled) {
            Ok(image) => image,
            Err(reason) => {
                ran.skipped.push(SkippedImage { path: labeled.path.clone(), reason, counts: false });
                continue;
            }
        };
        if ran.times.is_empty() {
            // What fails here fails below too, and is told there.
            let _ = detector.detect_in(&image, part, &options.settings, &mut found);
        }
        match detector.detect_in(&image, part, &options.settings, &mut found) {
            Ok(timing) => ran.times.push(timing),
            Err(error) => {
                found.clear();
                let (path, reason) = (labeled.path.clone(), error.to_string());
                ran.skipped.push(SkippedImage { path, reason, counts: true });
            }
        }
        let known = found.iter().filter_map(|found| {
            let class = to_set.get(found.class.0).copied().flatten()?;
            Some(Detection { class, ..*found })
        });
        ran.found.push(known.collect());
        ran.images.push(labeled.clone());
    }
    let first = ran.skipped.first();
    if ran.images.is_empty() {
        let example = first.map(|image| format!(" ({}: {})", image.path.display(), image.reason));
        return Err(EvaluateError::NoImages { images: count, example: example.unwrap_or_default() });
    }
    match first {
        Some(first) if ran.times.is_empty() => {
            Err(EvaluateError::FailsAlways { model, images: count, reason: first.reason.clone() })
        }
        _ => Ok(ran),
    }
}

/// The image, if it still is the one that was labeled.
fn open(labeled: &LabeledImage) -> Result<RgbImage, String> {
    let image = files::read_image(&labeled.path).map_err(|error| error.to_string())?.into_rgb8();
    if image.dimensions() == labeled.size_px {
        return Ok(image);
    }
    let ((w, h), (was_w, was_h)) = (image.dimensions(), labeled.size_px);
    Err(format!("it is {w}x{h} px but was {was_w}x{was_h} px when its labels were read"))
}

fn medians(times: &[DetectTiming]) -> MedianTiming {
    let median = |part: fn(&DetectTiming) -> Duration| {
        let mut seconds: Vec<f64> = times.iter().map(|timing| part(timing).as_secs_f64()).collect();
        seconds.sort_by(f64::total_cmp);
        let (below, above) = (seconds.get((seconds.len() - 1) / 2), seconds.get(seconds.len() / 2));
        below.zip(above).map_or(0.0, |(below, above)| 0.5 * (below + above))
    };
    MedianTiming {
        before_s: median(|timing| timing.before),
        network_s: median(|timing| timing.network),
        after_s: median(|timing| timing.after),
        total_s: median(|timing| timing.total()),
    }
}

/// A part of a longer job, for one model of several.
pub struct PartOfJob<'a> {
    /// The whole job.
    pub whole: &'a dyn JobContext,
    /// Number of this part.
    pub part: usize,
    /// How many parts there are.
    pub parts: usize,
}

impl JobContext for PartOfJob<'_> {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        self.whole.checkpoint()
    }

    fn report(&self, fraction: f64, doing: &str) {
        self.whole.report((self.part as f64 + fraction) / self.parts as f64, doing);
    }
}
