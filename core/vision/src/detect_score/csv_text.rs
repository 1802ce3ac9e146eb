//! Scores and matrices as text with commas, for spreadsheets. An empty cell: there is no such
//! number.

use plumbline_model::{ClassIndex, ClassNames};

use super::interval::{Interval, Intervals};
use super::{Cell, ConfusionMatrix, ModelEvaluation, OperatingPoint, Summary};

const SCORES_HEADER: &str = "model,class,things,images,map50_95,map50_95_low,map50_95_high,map50,map50_low,map50_high,\
                             map75,confidence,precision,recall,best_confidence,best_f1,before_ms,network_ms,after_ms";

/// One row per model and class, and one for all classes together (`all`).
pub fn scores_csv(models: &[ModelEvaluation]) -> String {
    let mut text = format!("{SCORES_HEADER}\n");
    for model in models {
        let timing = &model.timing;
        let ms =
            [timing.before_s, timing.network_s, timing.after_s].map(|seconds| number(Some(seconds * 1e3), 3));
        for class in &model.scores.per_class {
            let name = model.class_names.get(class.class).unwrap_or_default();
            let counts = [class.things, class.images];
            let intervals = model.per_class_intervals.get(class.class.0).copied().unwrap_or_default();
            let points = Points {
                at: model.scores.at_confidence(class.class, model.confidence),
                best: model.scores.best_confidence(class.class),
            };
            text += &row(&model.model, name, counts, &class.summary, &intervals, &points, &ms);
        }
        let things = model.scores.per_class.iter().map(|class| class.things).sum();
        let counts = [things, model.images.len()];
        let points = Points::default();
        text += &row(&model.model, "all", counts, &model.scores.overall, &model.intervals, &points, &ms);
    }
    text
}

#[derive(Default)]
struct Points {
    at: Option<OperatingPoint>,
    best: Option<OperatingPoint>,
}

fn row(
    model: &str,
    class: &str,
    [things, images]: [usize; 2],
    summary: &Summary,
    intervals: &Intervals,
    points: &Points,
    ms: &[String; 3],
) -> String {
    let between = |interval: Option<Interval>| {
        [interval.map(|interval| interval.low), interval.map(|interval| interval.high)]
            .map(|end| number(end, 4))
    };
    let [ap_low, ap_high] = between(intervals.ap);
    let [ap50_low, ap50_high] = between(intervals.ap50);
    let cells = [
        quoted(model),
        quoted(class),
        things.to_string(),
        images.to_string(),
        number(summary.ap, 6),
        ap_low,
        ap_high,
        number(summary.ap50, 6),
        ap50_low,
        ap50_high,
        number(summary.ap75, 6),
        number(points.at.map(|point| point.confidence), 4),
        number(points.at.and_then(|point| point.precision()), 4),
        number(points.at.and_then(|point| point.recall()), 4),
        number(points.best.map(|point| point.confidence), 4),
        number(points.best.and_then(|point| point.f1()), 4),
        ms[0].clone(),
        ms[1].clone(),
        ms[2].clone(),
    ];
    cells.join(",") + "\n"
}

/// A row per class that is there, then `nothing there`; a column per class that it is taken for,
/// then `missed`.
pub fn matrix_csv(matrix: &ConfusionMatrix, names: &ClassNames) -> String {
    let name = |class: Option<ClassIndex>, none: &str| match class {
        Some(class) => quoted(names.get(class).unwrap_or_default()),
        None => none.to_owned(),
    };
    let columns: Vec<String> = matrix.lines().map(|found| name(found, "missed")).collect();
    let mut text = format!("there / taken for,{}\n", columns.join(","));
    for truth in matrix.lines() {
        let counts = matrix.lines().map(|found| match (truth, found) {
            // What is not there and was not found cannot be counted.
            (None, None) => String::new(),
            _ => matrix.count(Cell { truth, found }).to_string(),
        });
        text += &format!("{},{}\n", name(truth, "nothing there"), counts.collect::<Vec<_>>().join(","));
    }
    text
}

fn number(value: Option<f64>, digits: usize) -> String {
    value.map(|value| format!("{value:.digits$}")).unwrap_or_default()
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}
