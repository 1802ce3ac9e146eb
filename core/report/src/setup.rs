//! The page of a whole setup: what is in use, and how it came to that, the newest first.

use crate::drawing::{Anchor, Drawing, Stroke, Style, ink};
use crate::page::{HEIGHT, MARGIN, WIDTH};
use crate::{About, ReportError, html, pdf};

/// Height of a row.
const ROW: f64 = 13.5;
/// So many lines say what speaks against something in use.
const MOST_LINES: usize = 3;
/// And so many at most what it is.
const MOST_OF_TITLE: usize = 8;
/// Left edges of the columns behind the first one; the last two end there.
const COLUMNS: [f64; 4] = [118.0, 206.0, 496.0, WIDTH - MARGIN];

/// What stands on the page.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Setup {
    /// "Setup of nico".
    pub title: String,
    /// When it was written.
    pub date: String,
    /// What is in use, in the order of work.
    pub in_use: Vec<InUse>,
    /// What was put in use, taken back, found and checked, the newest first.
    pub steps: Vec<Step>,
    /// Name and version of the program.
    pub version: String,
}

/// What is in use of a kind.
#[derive(Clone, Debug, PartialEq)]
pub struct InUse {
    /// "Eyes".
    pub subject: String,
    /// "calibration of 31 pairs".
    pub title: String,
    /// Since when; may be empty.
    pub since: String,
    /// Its error with its unit; may be empty.
    pub error: String,
    /// What was seen since and speaks against it, a sentence; may be empty.
    pub against: String,
}

/// Something on the timeline.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// When.
    pub at: String,
    /// "Eyes".
    pub subject: String,
    /// What it is.
    pub title: String,
    /// The error before, with its unit; may be empty.
    pub before: String,
    /// The error after; may be empty.
    pub after: String,
    /// Whether it changed what is in use.
    pub is_change: bool,
}

/// The page as an HTML file that needs no other file.
pub fn setup_html(setup: &Setup) -> String {
    html::of(&draw(setup), &about(setup))
}

/// The page as a PDF file, with its fonts.
///
/// # Errors
/// When the file cannot be made; HTML always can.
pub fn setup_pdf(setup: &Setup) -> Result<Vec<u8>, ReportError> {
    pdf::of(&draw(setup), &about(setup))
}

fn about(setup: &Setup) -> About {
    let in_use: Vec<String> = setup
        .in_use
        .iter()
        .map(|now| {
            let against = if now.against.is_empty() { String::new() } else { format!(" {}", now.against) };
            format!("{}: {}. {}{against}", now.subject, now.title, now.error)
        })
        .collect();
    About {
        title: format!("{} · {}", setup.title, setup.date),
        sentence: in_use.join(" "),
        version: setup.version.clone(),
    }
}

fn draw(setup: &Setup) -> Drawing {
    let mut drawing = Drawing::new(WIDTH, HEIGHT);
    drawing.rect(0.0, 0.0, WIDTH, HEIGHT, ink::PAPER);
    let mut y = MARGIN + 14.0;
    drawing.text([MARGIN, y], &setup.title, Style::TITLE);
    y += 16.0;
    drawing.text([MARGIN, y], format!("{} · {}", setup.date, setup.version), Style::BODY.color(ink::WEAK));
    y = heading(&mut drawing, y + 26.0, "In use", ["since", "error"]);
    for now in &setup.in_use {
        y += ROW;
        // All of what is in use is told: a model may have many effects.
        y = cells(
            &mut drawing,
            y,
            [&now.subject, "", &now.title, &now.since, &now.error],
            (true, MOST_OF_TITLE),
        );
        if !now.against.is_empty() {
            let (style, width) = (Style::SMALL.color(ink::WARNING), COLUMNS[3] - COLUMNS[0]);
            let first = y + style.leading();
            y = drawing.paragraph([COLUMNS[0], first], width, &now.against, style, MOST_LINES)
                - style.leading();
        }
    }
    y = heading(&mut drawing, y + 30.0, "Timeline, the newest first", ["before", "after"]);
    let room = ((HEIGHT - MARGIN - 16.0 - y) / ROW).floor().max(0.0) as usize;
    let shown = if setup.steps.len() > room { room.saturating_sub(1) } else { setup.steps.len() };
    for step in &setup.steps[..shown] {
        y += ROW;
        cells(
            &mut drawing,
            y,
            [&step.at, &step.subject, &step.title, &step.before, &step.after],
            (step.is_change, 1),
        );
    }
    if shown < setup.steps.len() {
        let left = setup.steps.len() - shown;
        let more = format!("{left} older ones are left out here; the table as CSV has all.");
        drawing.text([MARGIN, y + ROW], more, Style::SMALL);
    }
    let note = "Errors of one kind of result are each on the data that it was judged on. What was only measured is gray.";
    drawing.text([MARGIN, HEIGHT - MARGIN + 6.0], note, Style::SMALL);
    drawing
}

/// A heading with the names of the last two columns, and a line; the base line after it.
fn heading(drawing: &mut Drawing, y: f64, title: &str, last: [&str; 2]) -> f64 {
    drawing.text([MARGIN, y], title, Style::HEADING);
    for (at, name) in COLUMNS[2..].iter().zip(last) {
        drawing.anchored([*at, y], name, Style::SMALL, Anchor::End);
    }
    drawing.line(vec![[MARGIN, y + 4.0], [WIDTH - MARGIN, y + 4.0]], Stroke::new(ink::LINE, 0.6));
    y + 3.0
}

/// The base line of its last line.
fn cells(
    drawing: &mut Drawing,
    y: f64,
    [first, second, title, before, after]: [&str; 5],
    (strong, most): (bool, usize),
) -> f64 {
    let style = if strong { Style::BODY } else { Style::BODY.color(ink::WEAK) };
    drawing.text([MARGIN, y], first, style);
    drawing.text([COLUMNS[0], y], second, style);
    let from = if second.is_empty() { COLUMNS[0] } else { COLUMNS[1] };
    let before_width = crate::font::width(before, style.size, style.weight);
    let width = COLUMNS[2] - before_width - 10.0 - from;
    let below = drawing.paragraph([from, y], width, title, style, most) - style.leading();
    drawing.anchored([COLUMNS[2], y], before, style, Anchor::End);
    drawing.anchored([COLUMNS[3], y], after, style, Anchor::End);
    below.max(y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::Mark;

    fn sample(steps: usize) -> Setup {
        Setup {
            title: "Setup of <nico>".to_owned(),
            date: "2026-11-23 15:00".to_owned(),
            in_use: vec![InUse {
                subject: "Eyes".to_owned(),
                title: "calibration of 31 pairs".to_owned(),
                since: "2026-11-23 14:10".to_owned(),
                error: "0.082 px".to_owned(),
                against: "The calibration of the eyes does not hold any more: places are off by 12 mm near, 19 mm in the middle and 31 mm far. Calibrate the eyes again; the screen Drift says what has turned.".to_owned(),
            }],
            steps: (0..steps)
                .map(|k| Step {
                    at: "2026-11-23 14:10".to_owned(),
                    subject: "Correction model".to_owned(),
                    title: format!(
                        "step {k} of a title that is much longer than the room that there is for it in a row"
                    ),
                    before: "5.88 mm".to_owned(),
                    after: "0.93 mm".to_owned(),
                    is_change: k % 2 == 0,
                })
                .collect(),
            version: "0".to_owned(),
        }
    }

    #[test]
    fn html_and_pdf_hold_what_is_in_use_and_every_step() {
        let page = setup_html(&sample(5));
        assert!(page.contains("Setup of &lt;nico&gt;") && page.contains("calibration of 31 pairs"));
        for k in 0..5 {
            assert!(page.contains(&format!("step {k} ")), "{k}");
        }
        assert!(page.contains("5.88 mm") && page.contains("0.93 mm"));
        assert!(page.contains("does not hold any more"), "what speaks against it stands beside it");
        assert!(setup_pdf(&sample(5)).expect("written").starts_with(b"%PDF"));
    }

    #[test]
    fn a_model_of_many_effects_is_told_to_the_end() {
        let mut setup = sample(0);
        setup.in_use[0].title =
            (1..=8).map(|k| format!("Right joint {k}: zero position off")).collect::<Vec<_>>().join("; ");
        let page = setup_html(&setup);
        assert!(page.contains("joint 8") && !page.contains('…'), "{page}");
    }

    #[test]
    fn what_does_not_fit_is_counted_and_nothing_leaves_the_page_or_meets_its_neighbor() {
        let drawing = draw(&sample(200));
        let texts: Vec<_> = drawing
            .marks
            .iter()
            .filter_map(|mark| if let Mark::Text(text) = mark { Some(text) } else { None })
            .collect();
        let shown = texts.iter().filter(|text| text.text.starts_with("step ")).count();
        let left_out = format!("{} older ones", 200 - shown);
        assert!(texts.iter().any(|text| text.text.starts_with(&left_out)), "{shown} shown");
        for text in &texts {
            let [_, y] = text.at;
            assert!(
                text.left() >= MARGIN - 1e-9 && text.left() + text.width() <= WIDTH - MARGIN + 1e-9,
                "{text:?}"
            );
            assert!(y > MARGIN && y < HEIGHT - MARGIN + 8.0);
            let on_row =
                texts.iter().filter(|other| (other.at[1] - y).abs() < 1e-9 && other.left() > text.left());
            for other in on_row {
                assert!(text.left() + text.width() <= other.left() + 1e-9, "{text:?} covers {other:?}");
            }
        }
    }
}
