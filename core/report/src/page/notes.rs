//! What stays unexplained, and what to measure next.

use plumbline_gap::{Finding, Verdict};

use super::{Area, Detail, HEADING, heading, rule};
use crate::drawing::{Drawing, Style, ink};
use crate::font;
use crate::values::{p_value, percent, share};

const PAD: f64 = 8.0;

/// A paragraph, and whether it is the note's first statement.
type Paragraphs = Vec<(String, bool)>;

/// Height of both notes beside each other.
pub fn height(finding: &Finding, width: f64, detail: Detail) -> f64 {
    let column = Area { x: 0.0, y: 0.0, width, height: 0.0 }.columns([1.0, 1.0])[0];
    let lines = |paragraphs: &Paragraphs| wrapped(paragraphs, column.width, detail).len();
    let most = lines(&unexplained(finding)).max(lines(&next(finding)));
    PAD + HEADING + 3.0 + Style::BODY.leading() * most as f64
}

pub fn draw(drawing: &mut Drawing, area: Area, finding: &Finding, detail: Detail) {
    rule(drawing, area.x, area.y, area.width);
    let columns = area.below(PAD).columns([1.0, 1.0]);
    let notes = [("What stays unexplained", unexplained(finding)), ("Next experiment", next(finding))];
    for (column, (title, paragraphs)) in columns.into_iter().zip(notes) {
        heading(drawing, column, title);
        let mut y = column.y + HEADING + 8.0;
        for (line, first) in wrapped(&paragraphs, column.width, detail) {
            let style = if first { Style::BODY.bold().color(ink::STRONG) } else { Style::BODY };
            drawing.text([column.x, y], line, style);
            y += style.leading();
        }
    }
}

fn wrapped(paragraphs: &Paragraphs, width: f64, detail: Detail) -> Vec<(String, bool)> {
    let mut lines = vec![];
    for (text, first) in paragraphs {
        let left = detail.note.saturating_sub(lines.len());
        if left == 0 {
            break;
        }
        let style = if *first { Style::BODY.bold() } else { Style::BODY };
        let wrapped = font::wrap(text, width, style.size, style.weight, left);
        lines.extend(wrapped.into_iter().map(|line| (line, *first)));
    }
    lines
}

fn unexplained(finding: &Finding) -> Paragraphs {
    let rest = &finding.unexplained;
    if finding.verdict == Verdict::NoGap {
        let said = if finding.is_all_clear() {
            "Nothing above the noise of these rows."
        } else {
            "All of it: nothing in the library explains it, and nothing tells how much of it is noise."
        };
        return vec![(said.to_owned(), true)];
    }
    let mut paragraphs = vec![];
    let p = p_value(rest.p_value).replace(' ', "\u{a0}");
    paragraphs.push((
        if !finding.comparison.is_noise_known() {
            format!("{} of the gap is left; how much of that is noise is not known.", share(rest.share))
        } else if rest.p_value.is_finite() && rest.p_value < 0.01 {
            format!("{} of the gap is left, more than noise leaves ({p}).", share(rest.share))
        } else {
            format!("{} of the gap is left; noise alone may leave that much ({p}).", share(rest.share))
        },
        true,
    ));
    if rest.probability.is_finite() && rest.probability > 0.05 {
        paragraphs.push((
            format!(
                "Something that is not in the library is at work with a probability of {}.",
                percent(rest.probability)
            ),
            false,
        ));
    }
    for dependence in rest.depends_on.iter().take(3) {
        let formula = dependence.formula.as_ref().map_or(String::new(), |formula| format!(": {formula}"));
        paragraphs.push((
            format!(
                "The {} depends on the {} ({} of what is left){formula}.",
                dependence.of,
                dependence.on,
                share(dependence.share)
            ),
            false,
        ));
    }
    if rest.depends_on.is_empty() {
        paragraphs.push(("It was found to depend on nothing that was logged.".to_owned(), false));
    }
    paragraphs
}

fn next(finding: &Finding) -> Paragraphs {
    let Some(next) = &finding.next else {
        let text = match finding.verdict {
            Verdict::NoGap if !finding.is_all_clear() => {
                "Measure one pose a few times, and search again: the spread tells the noise."
            }
            Verdict::NoGap => "None is needed. Measure again after anything was changed or bumped.",
            Verdict::NotInLibrary => "No experiment of the menu would tell more about it.",
            _ => "None is needed: no names are left to tell apart.",
        };
        return vec![(text.to_owned(), true)];
    };
    let mut what = next.what.clone();
    if let Some(first) = what.get(..1) {
        let upper = first.to_uppercase();
        what.replace_range(..1, &upper);
    }
    let mut paragraphs = vec![(format!("{}.", what.trim_end_matches('.')), true)];
    if !next.why.is_empty() {
        paragraphs.push((format!("{}.", next.why.trim_end_matches('.')), false));
    }
    paragraphs.push((
        format!(
            "{} measurements, about {} minutes; after it the right name is expected to have a probability of {}.",
            next.count,
            next.minutes.ceil(),
            percent(next.expected_probability)
        ),
        false,
    ));
    let others: Vec<String> = next
        .others
        .iter()
        .take(2)
        .map(|(what, p, minutes)| format!("{what} ({}, {} min)", percent(*p), minutes.ceil()))
        .collect();
    if !others.is_empty() {
        paragraphs.push((format!("Else: {}.", others.join("; ")), false));
    }
    paragraphs
}
