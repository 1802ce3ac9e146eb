//! Tables of the gap between model and measurement.

use plumbline_engine::View;

use super::{Table, meters, mm, number};
use crate::operator::snapshot::gap::{Finding, ShownUnit, Unit};
use crate::operator::words::gap::kind;

/// A table of the finding that is shown; an empty one where there is none.
fn of(view: &View, headings: &[&str], rows: impl Fn(&Finding) -> Vec<Vec<String>>) -> Table {
    Table::new(headings, view.gap.finding().map(rows).unwrap_or_default())
}

fn plain(value: f64) -> String {
    number(Some(value), 1.0, 4)
}

/// What the gap consists of.
pub fn compared(view: &View) -> Table {
    of(view, &["measurement", "coordinate", "unit", "rms", "noise", "share"], |finding| {
        let kinds = finding.comparison.kinds.iter();
        let rows = kinds.flat_map(|of| of.coordinates.iter().map(move |coordinate| (of.what, coordinate)));
        rows.map(|(what, coordinate)| {
            let (unit, factor) = match coordinate.unit {
                Unit::Meter => ("mm", 1e3),
                Unit::Radian => ("deg", 1f64.to_degrees()),
                Unit::Pixel => ("px", 1.0),
            };
            let value = |value: f64| number(Some(value), factor, 4);
            vec![
                kind(what).to_owned(),
                coordinate.name.clone(),
                unit.to_owned(),
                value(coordinate.rms),
                value(coordinate.floor),
                plain(coordinate.share),
            ]
        })
        .collect()
    })
}

/// What was named, one row per parameter; values in SI, as the model has them.
pub fn named(view: &View) -> Table {
    let headings =
        ["effect", "probability", "parameter", "value", "low_95", "high_95", "in_words", "not_addable"];
    of(view, &headings, |finding| {
        let effects = finding.effects.iter();
        let rows = effects.flat_map(|effect| effect.parameters.iter().map(move |found| (effect, found)));
        rows.map(|(effect, found)| {
            vec![
                effect.title.clone(),
                plain(effect.probability),
                found.name.clone(),
                found.value.to_string(),
                found.low.to_string(),
                found.high.to_string(),
                found.text.clone().unwrap_or_default(),
                effect.not_addable.clone().unwrap_or_default(),
            ]
        })
        .collect()
    })
}

/// What the data say about every effect of the library.
pub fn candidates(view: &View) -> Table {
    of(view, &["effect", "probability", "score_sigmas"], |finding| {
        let rows = finding.candidates.iter().map(|candidate| {
            vec![candidate.title.clone(), plain(candidate.probability), plain(candidate.score_sigmas)]
        });
        rows.collect()
    })
}

/// What is left of every row.
pub fn residuals(view: &View) -> Table {
    let headings = [
        "session",
        "measurement",
        "row",
        "set",
        "x_m",
        "y_m",
        "z_m",
        "before_x_mm",
        "before_y_mm",
        "before_z_mm",
        "after_x_mm",
        "after_y_mm",
        "after_z_mm",
        "counts",
    ];
    of(view, &headings, |finding| {
        let rows = finding.comparison.residuals.iter().map(|row| {
            let session = finding.sessions.get(row.session).cloned().unwrap_or_default();
            let mut cells = vec![session, kind(row.what).to_owned(), row.row.to_string(), row.set.clone()];
            cells.extend(row.at_m.iter().map(|&at_m| meters(at_m)));
            cells.extend(row.before_m.iter().chain(&row.after_m).map(|&error_m| mm(Some(error_m))));
            cells.push(if row.outlier { "no" } else { "yes" }.to_owned());
            cells
        });
        rows.collect()
    })
}

/// Before and after on rows that were not used.
pub fn shown(view: &View) -> Table {
    of(view, &["on", "rows", "unit", "before", "after", "noise"], |finding| {
        let shown = &finding.shown;
        let (unit, factor) = match shown.unit {
            ShownUnit::Meter => ("mm", 1e3),
            ShownUnit::Pixel => ("px", 1.0),
        };
        let row = |on: &str, rows: usize, [before, after, floor]: [f64; 3]| {
            let value = |value: f64| number(Some(value), factor, 4);
            vec![on.to_owned(), rows.to_string(), unit.to_owned(), value(before), value(after), value(floor)]
        };
        let held_out = format!("held-out {}", shown.blocks);
        let mut rows = vec![row(&held_out, shown.rows, [shown.before, shown.after, shown.floor])];
        rows.extend(
            shown
                .unseen
                .iter()
                .map(|unseen| row(&unseen.what, unseen.rows, [unseen.before, unseen.after, unseen.floor])),
        );
        rows
    })
}

/// What to measure next, and what else would help.
pub fn next(view: &View) -> Table {
    of(view, &["experiment", "why", "minutes", "expected_probability"], |finding| {
        let mut rows = vec![];
        if let Some(next) = &finding.next {
            rows.push(vec![
                next.what.clone(),
                next.why.clone(),
                plain(next.minutes),
                plain(next.expected_probability),
            ]);
            rows.extend(next.others.iter().map(|(what, minutes, probability)| {
                vec![what.clone(), String::new(), plain(*minutes), plain(*probability)]
            }));
        }
        rows
    })
}

/// Findings and models so far.
pub fn history(view: &View) -> Table {
    let headings = ["at", "what", "before", "after", "noise", "unit", "taken_back"];
    let cells = |errors: Option<[f64; 3]>, in_pixels: bool| {
        let (unit, factor) = if in_pixels { ("px", 1.0) } else { ("mm", 1e3) };
        let value = |i: usize| number(errors.map(|errors| errors[i]), factor, 4);
        [value(0), value(1), value(2), unit.to_owned()]
    };
    let row = |at: jiff::Timestamp, what: String, errors, in_pixels, undone: bool| {
        let mut row = vec![at.to_string(), what];
        row.extend(cells(errors, in_pixels));
        row.push(if undone { "yes" } else { "no" }.to_owned());
        row
    };
    let steps = view.gap.model.history.iter();
    let steps = steps.map(|step| row(step.at, step.title.clone(), step.errors, step.in_pixels, step.undone));
    let findings = view.gap.findings.iter().map(|found| {
        let what = format!("finding: {}", found.named.join(", "));
        row(found.made, what, Some(found.errors), found.in_pixels, false)
    });
    Table::new(&headings, steps.chain(findings))
}
