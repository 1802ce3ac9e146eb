//! Head and foot of the page.

use plumbline_gap::{Finding, Verdict};

use super::{HEIGHT, MARGIN, WIDTH, count, rule};
use crate::ReportContext;
use crate::drawing::{Anchor, Color, Drawing, Style, ink};
use crate::font;

/// The verdict in a line.
pub fn title(finding: &Finding) -> String {
    let effects = finding.effects.len();
    match finding.verdict {
        Verdict::NoGap if !finding.is_all_clear() => "No name found, and the noise is not known".to_owned(),
        Verdict::NoGap => "Model and measurement agree".to_owned(),
        Verdict::Named => format!("{} found and named", count(effects, "missing effect", "missing effects")),
        Verdict::Class if finding.many.is_some() => "Much is a little off at once".to_owned(),
        Verdict::Class => {
            let open = finding.effects.iter().filter(|effect| effect.class.len() > 1).count();
            format!(
                "{} found, {} still open",
                count(effects, "effect", "effects"),
                match open {
                    _ if effects == 1 => "its name".to_owned(),
                    1 => "one name".to_owned(),
                    open => format!("{open} names"),
                }
            )
        }
        Verdict::NotInLibrary => "A gap that no known effect explains".to_owned(),
    }
}

pub fn color(finding: &Finding) -> Color {
    match finding.verdict {
        Verdict::NoGap if !finding.is_all_clear() => ink::UNKNOWN,
        Verdict::NoGap | Verdict::Named => ink::ACCEPTED,
        Verdict::Class => ink::WARNING,
        Verdict::NotInLibrary => ink::UNKNOWN,
    }
}

/// Draws the head; returns where the rest may start.
pub fn draw(drawing: &mut Drawing, finding: &Finding, context: &ReportContext) -> f64 {
    let width = WIDTH - 2.0 * MARGIN;
    let small = Style::SMALL.size(7.5);
    drawing.text([MARGIN, 44.0], "Gap between model and measurement", small.bold());
    let about: Vec<&str> = [finding.rig.as_str(), context.model.as_str(), context.date.as_str()]
        .into_iter()
        .filter(|part| !part.trim().is_empty())
        .collect();
    let about = font::fit(&about.join("  ·  "), 0.62 * width, small.size, small.weight);
    drawing.anchored([WIDTH - MARGIN, 44.0], about, small, Anchor::End);
    rule(drawing, MARGIN, 51.0, width);
    drawing.rect(MARGIN, 63.5, 5.0, 17.0, color(finding));
    let style = Style::TITLE;
    drawing.text(
        [MARGIN + 13.0, 79.0],
        font::fit(&title(finding), width - 13.0, style.size, style.weight),
        style,
    );
    let mut y = drawing.paragraph([MARGIN, 98.0], width, &finding.sentence, Style::LEAD, 4);
    if !finding.warnings.is_empty() {
        let said: Vec<String> = finding.warnings.iter().map(|warning| sentence(warning)).collect();
        let text = format!("Beside the verdict: {}", said.join(" "));
        y = drawing.paragraph([MARGIN, y - 1.0], width, &text, Style::BODY.color(ink::WARNING), 2);
    }
    y
}

/// A warning as a sentence of its own.
fn sentence(warning: &str) -> String {
    let mut letters = warning.chars();
    let first = letters.next().map_or_else(String::new, |first| first.to_uppercase().collect());
    let end = if warning.ends_with(['.', '!', '?', '…']) { "" } else { "." };
    format!("{first}{}{end}", letters.as_str())
}

/// Draws the foot; returns where it starts.
pub fn footer(drawing: &mut Drawing, finding: &Finding) -> f64 {
    let width = WIDTH - 2.0 * MARGIN;
    let style = Style::SMALL;
    let (data, judged) = (data(finding), judged(finding));
    let lines = style.lines(&data, width, 2) + style.lines(&judged, width, 3);
    let top = HEIGHT - 30.0 - style.leading() * (lines as f64 - 1.0) - 10.0;
    rule(drawing, MARGIN, top, width);
    let y = drawing.paragraph([MARGIN, top + 11.0], width, &data, style, 2);
    drawing.paragraph([MARGIN, y], width, &judged, style, 3);
    top
}

fn data(finding: &Finding) -> String {
    let comparison = &finding.comparison;
    let outliers = comparison.rows.saturating_sub(comparison.rows_kept);
    let mut parts = vec![
        format!("Data: {}", listed(&finding.sessions)),
        format!("{} in {}", count(comparison.rows, "row", "rows"), count(comparison.cells, "cell", "cells")),
    ];
    if outliers > 0 {
        parts.push(format!("{} not used", count(outliers, "outlier", "outliers")));
    }
    if !finding.left_out.is_empty() {
        parts.push(format!("{} could not be read", count(finding.left_out.len(), "row", "rows")));
    }
    parts.push(format!("Plumbline {}, seed {}", finding.version, finding.seed));
    format!("{}.", parts.join("; "))
}

/// The first sessions by name, the others counted.
fn listed(sessions: &[String]) -> String {
    const SHOWN: usize = 3;
    let mut names: Vec<String> = sessions
        .iter()
        .take(SHOWN)
        .map(|name| font::fit(name, 150.0, Style::SMALL.size, Style::SMALL.weight))
        .collect();
    if sessions.len() > SHOWN {
        names.push(format!("{} more sessions", sessions.len() - SHOWN));
    }
    if names.is_empty() { "no session".to_owned() } else { names.join(", ") }
}

fn judged(finding: &Finding) -> String {
    let floor = finding.comparison.floor_from().sentence();
    if finding.shown.rows == 0 {
        return format!("How it was judged: every row was used to compare; none was held out. {floor}");
    }
    format!(
        "How it was judged: {} rows in {}. The error of a row is that of a model which was found and sized without its block; rows were never used to judge themselves. Intervals are 95 %. {floor}",
        finding.shown.rows,
        if finding.shown.blocks.is_empty() { "blocks" } else { finding.shown.blocks.as_str() },
    )
}

#[cfg(test)]
mod tests {
    use plumbline_gap::finding::FloorSource;

    use super::*;
    use crate::sample;

    #[test]
    fn without_a_known_noise_no_page_is_green_or_says_that_anything_agrees() {
        let mut finding = sample::no_gap();
        assert_eq!(
            (title(&finding).as_str(), color(&finding)),
            ("Model and measurement agree", ink::ACCEPTED)
        );
        finding.comparison.floor_from_repeats = false;
        finding.comparison.floor_source = FloorSource::Fitted;
        assert!(!title(&finding).contains("agree"), "{}", title(&finding));
        assert_ne!(color(&finding), ink::ACCEPTED);
        assert!(judged(&finding).contains("the noise is not known"), "{}", judged(&finding));
    }

    #[test]
    fn warnings_are_sentences_of_their_own() {
        assert_eq!(sentence("row 7 lies far off"), "Row 7 lies far off.");
        assert_eq!(sentence("Done."), "Done.");
    }

    #[test]
    fn the_foot_says_what_told_the_noise() {
        let mut finding = sample::no_gap();
        assert!(judged(&finding).contains("spread of repeats"));
        finding.comparison.floor_from_repeats = false;
        for source in [FloorSource::Instrument, FloorSource::Neighbors, FloorSource::Fitted] {
            finding.comparison.floor_source = source;
            let said = judged(&finding);
            assert!(said.contains(source.sentence()), "{said}");
            assert_eq!(said.contains("near neighbors"), source == FloorSource::Neighbors, "{said}");
        }
    }
}
