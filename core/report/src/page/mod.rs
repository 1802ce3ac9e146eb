//! Lays out the page: what stands where, and how much of it fits.

mod bars;
mod effects;
mod figures;
mod map;
mod notes;
mod scatter;
#[cfg(test)]
mod tests;
mod verdict;

use plumbline_gap::{Finding, Verdict};

use crate::ReportContext;
use crate::drawing::{Drawing, Stroke, Style, ink};

/// A4 portrait.
pub const WIDTH: f64 = 595.28;
pub const HEIGHT: f64 = 841.89;
/// Border on all sides.
pub const MARGIN: f64 = 40.0;
/// Between two columns.
const GUTTER: f64 = 24.0;
/// Between two parts.
const GAP: f64 = 15.0;
/// Least and largest heights of the figures.
const MAPS: [f64; 2] = [104.0, 232.0];
/// Largest height of maps without other figures below.
const ALONE: f64 = 320.0;
const SCATTER: [f64; 2] = [74.0, 118.0];

/// A rectangle of the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Area {
    pub fn right(&self) -> f64 {
        self.x + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.y + self.height
    }

    /// Columns of a width by shares.
    fn columns<const N: usize>(&self, shares: [f64; N]) -> [Self; N] {
        let whole: f64 = shares.iter().sum();
        let free = self.width - GUTTER * (N as f64 - 1.0);
        let mut x = self.x;
        shares.map(|share| {
            let column = Self { x, width: free * share / whole, ..*self };
            x += column.width + GUTTER;
            column
        })
    }

    /// Without a heading of this height.
    fn below(&self, height: f64) -> Self {
        Self { y: self.y + height, height: self.height - height, ..*self }
    }
}

/// How much of the words is printed. The more effects, the less of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Detail {
    /// Lines of an effect's name, and of its values.
    pub name: usize,
    /// Lines of what an effect means.
    pub meaning: usize,
    /// Lines of what can be done about it.
    pub remedy: usize,
    /// Lines of its other names, and of how to tell them apart.
    pub others: usize,
    /// Lines of each note.
    pub note: usize,
}

const DETAILS: [Detail; 4] = [
    Detail { name: 2, meaning: 3, remedy: 3, others: 2, note: 8 },
    Detail { name: 2, meaning: 2, remedy: 2, others: 2, note: 6 },
    Detail { name: 1, meaning: 1, remedy: 1, others: 1, note: 5 },
    Detail { name: 1, meaning: 1, remedy: 1, others: 1, note: 4 },
];

/// Draws the page.
pub fn draw(finding: &Finding, context: &ReportContext) -> Drawing {
    let mut drawing = Drawing::new(WIDTH, HEIGHT);
    drawing.rect(0.0, 0.0, WIDTH, HEIGHT, ink::PAPER);
    let width = WIDTH - 2.0 * MARGIN;
    let top = verdict::draw(&mut drawing, finding, context) + 4.0;
    let bottom = verdict::footer(&mut drawing, finding) - 10.0;

    let summary = Area { x: MARGIN, y: top, width, height: 98.0 };
    let with_scatter = MAPS[0] + SCATTER[0] + GAP;
    let room = |detail: &Detail| {
        bottom
            - summary.bottom()
            - GAP
            - effects::height(finding, width, *detail)
            - notes::height(finding, width, *detail)
            - 2.0 * GAP
    };
    // Where room is scarce the maps stay: they say most.
    let last = DETAILS[DETAILS.len() - 1];
    let has_scatter =
        finding.verdict != Verdict::NoGap && scatter::is_possible(finding) && room(&last) >= with_scatter;
    let least = if has_scatter { with_scatter } else { MAPS[0] };
    let detail = DETAILS.into_iter().find(|detail| room(detail) >= least).unwrap_or(last);

    figures::summary(&mut drawing, summary, finding, context);
    let figures_height = room(&detail).max(0.0);
    let mut y = summary.bottom() + GAP;
    let scatter_height =
        if has_scatter { (0.36 * figures_height).clamp(SCATTER[0], SCATTER[1]) } else { 0.0 };
    let taken = if has_scatter { scatter_height + GAP } else { 0.0 };
    let maps = Area {
        x: MARGIN,
        y,
        width,
        height: (figures_height - taken).min(if has_scatter { MAPS[1] } else { ALONE }),
    };
    y = figures::maps(&mut drawing, maps, finding, context) + GAP;
    if has_scatter {
        scatter::draw(&mut drawing, Area { x: MARGIN, y, width, height: scatter_height }, finding);
        y += scatter_height + GAP;
    }
    y = effects::draw(&mut drawing, Area { x: MARGIN, y, width, height: 0.0 }, finding, detail);
    notes::draw(&mut drawing, Area { x: MARGIN, y, width, height: bottom - y }, finding, detail);
    drawing
}

/// A heading; what follows starts [`HEADING`] further down.
fn heading(drawing: &mut Drawing, area: Area, title: &str) {
    drawing.text([area.x, area.y + 8.0], title, Style::HEADING);
}

/// Height of a heading.
const HEADING: f64 = 17.0;

/// A line across an area.
fn rule(drawing: &mut Drawing, x: f64, y: f64, width: f64) {
    drawing.line(vec![[x, y], [x + width, y]], Stroke::new(ink::LINE, 0.6));
}

/// "1 effect", "2 effects".
fn count(number: usize, one: &str, several: &str) -> String {
    if number == 1 { format!("1 {one}") } else { format!("{number} {several}") }
}
