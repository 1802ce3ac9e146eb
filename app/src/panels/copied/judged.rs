//! Tables of commissioning, of judged detectors and of data sets.

use plumbline_engine::View;
use plumbline_engine::view::{CommissionState, LabelState, Score};
use plumbline_model::ClassIndex;

use super::{Table, number};
use crate::operator::guidance::{commission_name, done_in_words};
use crate::panels::PanelState;

pub fn commission(view: &View) -> Table {
    let rows = view.commission.steps.iter().map(|step| {
        let (state, at, came) = match &step.state {
            CommissionState::Done(done) => {
                let at = done.at.map_or_else(String::new, |at| at.to_string());
                ("done".to_owned(), at, done_in_words(&done.figure))
            }
            CommissionState::Now => ("now".to_owned(), String::new(), String::new()),
            CommissionState::Waits(for_step) => {
                (format!("waits for step {}", for_step.number()), String::new(), String::new())
            }
        };
        vec![step.step.number().to_string(), commission_name(step.step).to_owned(), state, at, came]
    });
    Table::new(&["step", "name", "state", "at", "came_of_it"], rows)
}

fn score(score: Option<&Score>) -> [String; 6] {
    let value = |of: &dyn Fn(&Score) -> Option<f64>| number(score.and_then(of), 1.0, 4);
    [
        value(&|s| Some(s.map50_95)),
        value(&|s| Some(s.map50_95_interval?[0])),
        value(&|s| Some(s.map50_95_interval?[1])),
        value(&|s| Some(s.map50)),
        value(&|s| Some(s.map50_interval?[0])),
        value(&|s| Some(s.map50_interval?[1])),
    ]
}

/// Every detector on everything and on each class.
pub fn scores(view: &View) -> Table {
    let headings = [
        "detector",
        "class",
        "boxes",
        "map50_95",
        "map50_95_low_95",
        "map50_95_high_95",
        "map50",
        "map50_low_95",
        "map50_high_95",
        "network_ms",
        "why_not_judged",
    ];
    let mut rows = vec![];
    if let Some(table) = &view.scores.table {
        let mut add = |head: [String; 3], of: Option<&Score>, ms: String, why: String| {
            rows.push(head.into_iter().chain(score(of)).chain([ms, why]).collect());
        };
        for row in &table.rows {
            let head = |class: &str, boxes: usize| [row.model.clone(), class.to_owned(), boxes.to_string()];
            let all: usize = table.instances.iter().sum();
            match &row.scores {
                Err(why) => add(head("all", all), None, String::new(), why.to_string()),
                Ok(scores) => {
                    let ms = number(Some(scores.times_ms[1]), 1.0, 2);
                    add(head("all", all), Some(&scores.all), ms, String::new());
                    for (i, of) in scores.classes.iter().enumerate() {
                        let name = table.names.get(ClassIndex(i)).unwrap_or("");
                        let boxes = table.instances.get(i).copied().unwrap_or(0);
                        add(head(name, boxes), of.as_ref(), String::new(), String::new());
                    }
                }
            }
        }
    }
    Table::new(&headings, rows)
}

/// What was taken for what by the detector that is shown.
pub fn confusion(view: &View, state: &PanelState) -> Table {
    let shown = view.scores.table.as_ref().and_then(|table| {
        let row = table.rows.get(state.scores.model)?;
        Some((table, &row.model, row.scores.as_ref().ok()?))
    });
    let Some((table, model, scores)) = shown else { return Table::default() };
    let name = |i: usize| table.names.get(ClassIndex(i)).unwrap_or("background").to_owned();
    let counts = scores.confusion.iter().enumerate();
    let cells =
        counts.flat_map(|(truth, row)| row.iter().enumerate().map(move |(found, n)| (truth, found, n)));
    let rows = cells.map(|(truth, found, n)| vec![model.clone(), name(truth), name(found), n.to_string()]);
    Table::new(&["detector", "labeled", "found_as", "count"], rows)
}

/// The images of the data set.
pub fn images(view: &View) -> Table {
    let rows = view.labels.images.iter().map(|image| {
        let state = match image.state {
            LabelState::Unlabeled => "not labeled",
            LabelState::Labeled => "labeled",
            LabelState::ToCheck => "to check",
        };
        vec![
            image.name.clone(),
            state.to_owned(),
            image.boxes.to_string(),
            image.problems.to_string(),
            image.unusable.clone().unwrap_or_default(),
        ]
    });
    Table::new(&["image", "state", "boxes", "problems", "why_unusable"], rows)
}

/// What is wrong in it.
pub fn problems(view: &View) -> Table {
    let rows = view.labels.problems.iter().map(|problem| {
        let label = problem.index.map_or_else(String::new, |index| (index + 1).to_string());
        vec![problem.image.clone(), label, problem.text.clone()]
    });
    Table::new(&["image", "box", "problem"], rows)
}
