//! `plumbline detect-eval`: how good detectors are on a labeled set.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use plumbline_offline::detector::{self, DetectorOptions, Region};
use plumbline_offline::scores::{ConfusionOptions, EvaluateOptions, Interval, LookedAt};
use plumbline_offline::{self as offline, ClassReport, DetectEvalArgs, DetectEvalReport, ModelReport};

use super::common::listed;
use super::output::{Output, say};

/// Arguments of `detect-eval`.
#[derive(Debug, Args)]
pub struct DetectEval {
    /// Detectors, ONNX files as ultralytics exports them; else the one that comes with the program.
    #[arg(long, value_name = "FILE.onnx", num_args = 1..)]
    model: Vec<PathBuf>,
    /// The data.yaml of a labeled set in the YOLO layout.
    #[arg(long, value_name = "data.yaml")]
    data: PathBuf,
    /// Part of the set that is judged by.
    #[arg(long, value_enum, default_value_t)]
    split: Part,
    /// Where the scores are written as a table: a row per model and class.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Folder that receives, as a table per model, what is taken for what.
    #[arg(long, value_name = "DIR")]
    matrices: Option<PathBuf>,
    /// Confidence of precision, recall and of what is taken for what; average precision has none.
    #[arg(long, value_name = "PART", default_value_t = 0.25)]
    confidence: f64,
    /// What of every image the detector is given.
    #[arg(long, value_enum, default_value_t)]
    look: Look,
    /// Only what lies in this part of every image counts; things that reach over its edge are neither missed
    /// nor found. X,Y,WIDTH,HEIGHT in pixels, or `workspace`: where the robot's eyes see the workspace with
    /// the head at home.
    #[arg(long, value_name = "X,Y,WIDTH,HEIGHT|workspace", required_if_eq("look", "part"), value_parser = part)]
    part: Option<Region>,
    /// Threads on the processor; else one per core.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// What of an image is looked at.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Look {
    /// All but what is black to the edge, as it is around the disc of a fisheye lens.
    #[default]
    Lit,
    /// All of it.
    All,
    /// Only the part that counts.
    Part,
}

/// A part of an image as it is typed.
fn part(text: &str) -> Result<Region, String> {
    if text == "workspace" {
        return offline::workspace_part()
            .ok_or_else(|| "the head at home does not see the workspace".to_owned());
    }
    let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x_px, y_px, width_px, height_px]) if width_px > 0 && height_px > 0 => {
            Ok(Region { x_px, y_px, width_px, height_px })
        }
        _ => Err("give four whole numbers, x,y,width,height in pixels with a width and a height above 0, \
                  or workspace"
            .to_owned()),
    }
}

/// Part of a set.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
enum Part {
    /// What detectors learn from.
    Train,
    /// What they are chosen by.
    #[default]
    Val,
    /// What they are judged by in the end.
    Test,
}

impl From<Part> for offline::Split {
    fn from(part: Part) -> Self {
        match part {
            Part::Train => Self::Train,
            Part::Val => Self::Val,
            Part::Test => Self::Test,
        }
    }
}

/// Judges the detectors.
pub fn run(arguments: DetectEval, output: &Output) -> anyhow::Result<()> {
    let confusion = ConfusionOptions { confidence: arguments.confidence, ..ConfusionOptions::default() };
    let threads = arguments.threads.map(usize::from);
    let looked_at = LookedAt {
        part: match (arguments.look, arguments.part) {
            (Look::All, _) => detector::Part::Whole,
            (Look::Part, Some(region)) => detector::Part::Region(region),
            (Look::Lit | Look::Part, _) => detector::Part::Lit,
        },
        within: arguments.part,
    };
    let args = DetectEvalArgs {
        models: arguments.model,
        data: arguments.data,
        split: arguments.split.into(),
        csv: arguments.csv,
        matrices: arguments.matrices,
        options: DetectorOptions { threads, ..DetectorOptions::default() },
        judging: EvaluateOptions { confusion, looked_at, ..EvaluateOptions::default() },
    };
    let report = offline::detect_eval(&args, output)?;
    report.notes.iter().for_each(|note| say(note));
    output.result(&report, text)
}

fn text(report: &DetectEvalReport) -> String {
    let mut text = format!(
        "{}, {}: {} images of {} scenes, {} of them with nothing on them\n\n",
        report.data.display(),
        report.split,
        report.images,
        report.scenes,
        report.backgrounds,
    );
    if let Some([x, y, width, height]) = report.counted_in_px {
        text += &format!(
            "only what lies in {width}x{height} px from ({x}, {y}) counts; looked at: {}\n\n",
            report.looked_at
        );
    }
    text += &table(report);
    for model in &report.models {
        text += &details(model);
    }
    text += &listed(
        "\nnot judged:",
        report.failed.iter().map(|failed| format!("{}: {}", failed.model.display(), failed.reason)),
    );
    text += &listed("\nwrong in the set, left out:", report.problems.iter().take(10).cloned());
    text
}

/// A line per model: mAP50–95 of what the robot grasps and of its hands, and over all.
fn table(report: &DetectEvalReport) -> String {
    let hands = ["Tomato", "LeftHand", "RightHand"];
    let columns: Vec<&str> =
        hands.into_iter().filter(|name| report.classes.iter().any(|class| class == name)).collect();
    let width = report.models.iter().map(|model| model.model.chars().count()).max().unwrap_or(0).max(5);
    let mut text = format!("{:width$}", "model");
    columns.iter().for_each(|column| text += &format!("  {column:>9}"));
    text += "        all            95 %   mAP50            95 %   before  network  after ms\n";
    for model in &report.models {
        text += &format!("{:width$}", model.model);
        for column in &columns {
            text += &format!("  {:>9}", score(model.per_class.get(*column).copied().flatten()));
        }
        text += &format!(
            "  {:>9}  {:>14}  {:>6}  {:>14}  {:>7.1}  {:>7.1}  {:>8.1}\n",
            score(model.map50_95),
            between(model.map50_95_interval),
            score(model.map50),
            between(model.map50_interval),
            model.milliseconds_before,
            model.milliseconds_network,
            model.milliseconds_after,
        );
    }
    text
}

fn details(model: &ModelReport) -> String {
    let mut text = format!("\n{}\n", model.summary);
    if let Some(made_by) = &model.made_by {
        text += &format!("  made by {made_by}\n");
    }
    if let Some(names) = &model.names {
        text += &format!("  names: {names}\n");
    }
    if let Some(own) = &model.judged_by_itself {
        text += &format!("  {own}\n");
    }
    text += "  class         boxes  mAP50-95            95 %   mAP50            95 %  precision  recall  best at\n";
    model.classes.iter().for_each(|class| text += &line(class));
    text + &listed("  images with trouble:", model.skipped.iter().map(|skipped| format!("  {skipped}")))
}

fn line(class: &ClassReport) -> String {
    format!(
        "  {:12}  {:>5}  {:>8}  {:>14}  {:>6}  {:>14}  {:>9}  {:>6}  {:>7}\n",
        class.class,
        class.things,
        score(class.map50_95),
        between(class.intervals.ap),
        score(class.map50),
        between(class.intervals.ap50),
        score(class.precision),
        score(class.recall),
        class.best_confidence.map_or("-".to_owned(), |confidence| format!("{confidence:.2}")),
    )
}

fn score(score: Option<f64>) -> String {
    score.map_or("-".to_owned(), |score| format!("{score:.3}"))
}

fn between(interval: Option<Interval>) -> String {
    interval.map_or("-".to_owned(), |Interval { low, high }| format!("{low:.3}-{high:.3}"))
}
