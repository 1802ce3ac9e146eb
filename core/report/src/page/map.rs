//! The table seen from above, with an arrow per row: what was measured less what was predicted.

use plumbline_gap::Finding;
use plumbline_gap::finding::Residual;

use super::Area;
use crate::ReportContext;
use crate::drawing::{Anchor, Color, Drawing, Stroke, Style, ink};
use crate::values::{fixed, round_down};

/// At most this many arrows; more would be one dark spot.
const MOST_ARROWS: usize = 260;
/// Height of the line with the scales.
const SCALES: f64 = 17.0;
/// Part of the map's width that a long arrow takes.
const LONG_ARROW: f64 = 0.085;

/// Which of the residuals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    Before,
    After,
}

/// Scale and middle, the same for all maps of a page.
pub struct View {
    /// Middle of what is shown, robot frame, m.
    middle_m: [f64; 2],
    /// Points of the page per meter of the table.
    per_m: f64,
    /// Points of the page per meter of an arrow.
    arrow_per_m: f64,
    screen_m: Option<[[f64; 2]; 4]>,
    /// Height of a map that shows all, its scales included.
    pub height: f64,
}

fn has_place(residual: &&Residual) -> bool {
    residual.at_m.iter().chain(&residual.before_m).chain(&residual.after_m).all(|v| v.is_finite())
}

fn level(vector: &[f64; 3]) -> f64 {
    vector[0].hypot(vector[1])
}

impl View {
    /// Fits all rows into an area; `None` without any.
    pub fn of(finding: &Finding, context: &ReportContext, area: Area) -> Option<Self> {
        let rows: Vec<&Residual> = finding.comparison.residuals.iter().filter(has_place).collect();
        let screen_m = context.screen_m.filter(|corners| corners.iter().flatten().all(|v| v.is_finite()));
        let corners = screen_m.iter().flatten().map(|[x, y]| [*x, *y]);
        let places = rows.iter().map(|row| [row.at_m[0], row.at_m[1]]).chain(corners);
        let mut range = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for place in places {
            for (range, value) in range.iter_mut().zip(place) {
                *range = [range[0].min(value), range[1].max(value)];
            }
        }
        if rows.is_empty() {
            return None;
        }
        // A single place still needs a table around it.
        let span = range.map(|[low, high]| (high - low).max(0.05));
        let margin = 2.0 * (LONG_ARROW * area.width);
        let per_m = ((area.width - margin) / span[1]).min((area.height - SCALES - margin) / span[0]);
        let per_m = per_m.max(1.0);
        let mut lengths: Vec<f64> = rows
            .iter()
            .filter(|row| !row.outlier)
            .map(|row| level(&row.before_m).max(level(&row.after_m)))
            .collect();
        lengths.sort_by(f64::total_cmp);
        let long = lengths.get(lengths.len() * 19 / 20).or(lengths.last()).copied().unwrap_or(0.0);
        let arrow_per_m = if long > 0.0 { LONG_ARROW * area.width / long } else { per_m };
        let middle_m = range.map(|[low, high]| 0.5 * (low + high));
        let height = (span[0] * per_m + margin + SCALES).min(area.height);
        Some(Self { middle_m, per_m, arrow_per_m, screen_m, height })
    }

    /// Away from the robot is up, the robot's left is left.
    fn at(&self, area: Area, place: [f64; 2]) -> [f64; 2] {
        let middle = [area.x + 0.5 * area.width, area.y + 0.5 * (area.height - SCALES)];
        [
            middle[0] - (place[1] - self.middle_m[1]) * self.per_m,
            middle[1] - (place[0] - self.middle_m[0]) * self.per_m,
        ]
    }

    pub fn draw(&self, drawing: &mut Drawing, area: Area, finding: &Finding, which: Which) {
        let field = Area { height: area.height - SCALES, ..area };
        drawing.rect(field.x, field.y, field.width, field.height, ink::TRACK);
        if let Some(corners) = &self.screen_m {
            let outline = corners.iter().map(|corner| clamped(self.at(area, *corner), field)).collect();
            drawing.polygon(outline, ink::PAPER, 1.0);
        }
        drawing.text([field.x + 5.0, field.y + 10.0], "↑ away from the robot", Style::SMALL);
        let rows: Vec<&Residual> = finding.comparison.residuals.iter().filter(has_place).collect();
        let every = rows.len().div_ceil(MOST_ARROWS).max(1);
        let color = match which {
            Which::Before => ink::BEFORE,
            Which::After => ink::AFTER,
        };
        for row in rows.iter().step_by(every) {
            let from = self.at(area, [row.at_m[0], row.at_m[1]]);
            if row.outlier {
                cross(drawing, from);
                continue;
            }
            let vector = match which {
                Which::Before => row.before_m,
                Which::After => row.after_m,
            };
            let to = [from[0] - vector[1] * self.arrow_per_m, from[1] - vector[0] * self.arrow_per_m];
            arrow(drawing, from, clamped(to, field), color);
        }
        self.scales(drawing, area, every, rows.iter().any(|row| row.outlier));
    }

    fn scales(&self, drawing: &mut Drawing, area: Area, every: usize, has_outliers: bool) {
        let y = area.bottom() - 5.0;
        let style = Style::SMALL;
        let mut x = area.x;
        let mut bar = |drawing: &mut Drawing, per_m: f64, color: Color, what: &str| {
            let length_m = round_down(0.17 * area.width / per_m);
            let length = length_m * per_m;
            for ends in [
                [[x, y - 2.0], [x + length, y - 2.0]],
                [[x, y - 4.5], [x, y + 0.5]],
                [[x + length, y - 4.5], [x + length, y + 0.5]],
            ] {
                drawing.line(ends.to_vec(), Stroke::new(color, 0.8));
            }
            let mm = 1e3 * length_m;
            let label = format!("{} mm {what}", fixed(mm, usize::from(mm < 1.0) + usize::from(mm < 0.1)));
            drawing.text([x + length + 4.0, y], &label, style);
            x += length + 4.0 + crate::font::width(&label, style.size, style.weight) + 12.0;
        };
        bar(drawing, self.per_m, ink::WEAK, "of table");
        bar(drawing, self.arrow_per_m, ink::STRONG, "of error");
        let mut notes = vec![];
        if every > 1 {
            notes.push(format!("1 of {every} rows drawn"));
        }
        if has_outliers {
            notes.push("× outlier".to_owned());
        }
        drawing.anchored([area.right() - 5.0, area.y + 10.0], notes.join(", "), style, Anchor::End);
    }
}

fn clamped([x, y]: [f64; 2], area: Area) -> [f64; 2] {
    [x.clamp(area.x, area.right()), y.clamp(area.y, area.bottom())]
}

fn cross(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    let d = 1.8;
    for sign in [1.0, -1.0] {
        drawing.line(vec![[x - d, y - sign * d], [x + d, y + sign * d]], Stroke::new(ink::WEAK, 0.7));
    }
}

fn arrow(drawing: &mut Drawing, from: [f64; 2], to: [f64; 2], color: Color) {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = dx.hypot(dy);
    drawing.circle(from, 0.9, color, 0.55);
    if length < 0.8 {
        return;
    }
    let (along, across) = ([dx / length, dy / length], [-dy / length, dx / length]);
    let head = length.min(3.6);
    let neck = [to[0] - along[0] * head, to[1] - along[1] * head];
    drawing.line(vec![from, neck], Stroke::new(color, 0.75).opacity(0.9));
    let half = 0.36 * head;
    let side = |sign: f64| [neck[0] + sign * half * across[0], neck[1] + sign * half * across[1]];
    drawing.polygon(vec![to, side(1.0), side(-1.0)], color, 0.95);
}
