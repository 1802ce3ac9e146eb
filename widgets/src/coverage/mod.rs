//! Where boards were seen so far, and where they are still missing.

mod grid;
mod histogram;

pub use grid::CoverageGrid;
pub use histogram::Histogram;

use egui::{Align2, Color32, Rect, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};
use plumbline_model::Eye;

use crate::axis;
use crate::colormap::Colormap;
use crate::format::{self, Quantity};
use crate::theme::{self, space};

/// Corners needed in a cell before more of them add little.
const ENOUGH: u32 = 12;

/// What was collected: corners over both images, distances and tilts of the boards.
#[derive(Clone, Debug, PartialEq)]
pub struct Coverage {
    /// Corners over the left image.
    pub left: CoverageGrid,
    /// Corners over the right image.
    pub right: CoverageGrid,
    /// Distances of the boards from the eyes, meters.
    pub distance_m: Histogram,
    /// Angles between the boards and the image plane, radians.
    pub tilt_rad: Histogram,
}

impl Coverage {
    /// Nothing collected yet, for images of this size. Boards are wanted from 0.15 to 0.65 m,
    /// tilted by 0 to 50°.
    pub fn new(size_px: [u32; 2]) -> Self {
        Self {
            left: CoverageGrid::new(size_px),
            right: CoverageGrid::new(size_px),
            distance_m: Histogram::new([0.15, 0.65], 5),
            tilt_rad: Histogram::new([0.0, 50f64.to_radians()], 5),
        }
    }

    /// The grid of one eye.
    pub fn grid(&self, eye: Eye) -> &CoverageGrid {
        match eye {
            Eye::Left => &self.left,
            Eye::Right => &self.right,
        }
    }

    /// One grid to add to.
    pub fn grid_mut(&mut self, eye: Eye) -> &mut CoverageGrid {
        match eye {
            Eye::Left => &mut self.left,
            Eye::Right => &mut self.right,
        }
    }

    /// Covered part of both images, 0..=1.
    pub fn fraction(&self) -> f64 {
        (self.left.fraction() + self.right.fraction()) / 2.0
    }

    /// What to do next, in one sentence.
    pub fn advice(&self) -> String {
        let mut missing = Vec::new();
        for eye in Eye::BOTH {
            // The emptiest: the map shows the others.
            if let Some(region) = self.grid(eye).missing_regions().first() {
                missing.push(format!("{region} of the {eye} image"));
            }
        }
        if let Some(range) = self.distance_m.emptiest() {
            missing.push(format!("boards {} away", range_text(range, Quantity::Length)));
        }
        if let Some(range) = self.tilt_rad.emptiest() {
            missing.push(format!("boards tilted by {}", range_text(range, Quantity::Angle)));
        }
        if missing.is_empty() {
            return "Everything was shown: more pairs make it only slightly better.".to_owned();
        }
        let shown = missing.len().min(3);
        format!("Would make it better: {}.", missing[..shown].join("; "))
    }
}

fn range_text([low, high]: [f64; 2], quantity: Quantity) -> String {
    let number = |si| format::fixed(quantity.on_screen(si), 0);
    let gap = if quantity == Quantity::Angle { "" } else { " " };
    format!("{} to {}{gap}{}", number(low), number(high), quantity.unit())
}

/// Room for the advice, the titles and the histograms beside the maps, pt.
const BESIDE_MAPS: f32 = 212.0;
/// Narrower maps show nothing any more, pt.
const LEAST_MAP: f32 = 72.0;

/// Draws the advice, both images' coverage and the two histograms, all within `height` (pt) where that is possible.
pub fn coverage_view(ui: &mut Ui, coverage: &Coverage, height: f32) {
    // First, for below the pictures it is out of sight in a low window.
    ui.label(coverage.advice());
    ui.add_space(space::XS);
    let column = ((ui.available_width() - space::M) / 2.0).max(96.0);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::M;
        for eye in Eye::BOTH {
            ui.vertical(|ui| {
                ui.set_width(column);
                let [w, h] = coverage.grid(eye).size_px().map(|n| n.max(1) as f32);
                let fitting = (height - BESIDE_MAPS) * w / h;
                heat_map(ui, coverage.grid(eye), eye, (column, column.min(fitting.max(LEAST_MAP))));
            });
        }
    });
    ui.add_space(space::S);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = space::M;
        let width = vec2(column, 84.0);
        histogram(ui, "Distance", &coverage.distance_m, Quantity::Length, width);
        histogram(ui, "Tilt", &coverage.tilt_rad, Quantity::Angle, width);
    });
}

/// Least room of a number below a histogram.
const TICK_WIDTH: f32 = 30.0;
/// A map that is this wide has room for words over it.
const WORDY: f32 = 140.0;

/// `column`: width of the title; `width`: that of the map.
fn heat_map(ui: &mut Ui, grid: &CoverageGrid, eye: Eye, (column, width): (f32, f32)) {
    let title = if eye == Eye::Left { "Left eye" } else { "Right eye" };
    let share = format::percent(grid.fraction());
    let title_row = ui.horizontal(|ui| {
        ui.label(theme::small(ui, title));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            // Where there is no room for the word it would run into the title, and beyond the pane.
            let text = if column < WORDY { share.clone() } else { format!("{share} covered") };
            ui.label(theme::small(ui, text));
        });
    });
    title_row.response.widget_info(|| WidgetInfo::labeled(egui::Role::GenericContainer, true, title));
    let [w, h] = grid.size_px().map(|n| n.max(1) as f32);
    let (rect, response) = ui.allocate_exact_size(vec2(width, width * h / w), Sense::hover());
    response.widget_info(|| {
        WidgetInfo::labeled(egui::Role::Image, true, format!("Coverage of the {eye} image: {share}"))
    });
    let [columns, rows] = grid.cells();
    let cell = vec2(rect.width() / columns as f32, rect.height() / rows as f32);
    for row in 0..rows {
        for column in 0..columns {
            let min = rect.min + vec2(column as f32 * cell.x, row as f32 * cell.y);
            let at = Rect::from_min_size(min, cell).shrink(0.5);
            if let Some(color) = cell_color(ui, grid, column, row) {
                ui.painter().rect_filled(at, 0.0, color);
            }
        }
    }
    let pointed = response.hover_pos().map(|pos| {
        let part = (pos - rect.min) / rect.size();
        let at = |part: f32, n: usize| ((part * n as f32) as usize).min(n - 1);
        grid.count(at(part.x, columns), at(part.y, rows))
    });
    if let Some(count) = pointed {
        response.on_hover_text_at_pointer(format::count(count as usize, "corner"));
    }
}

/// Unreachable cells show nothing, empty ones a dim ground, the others more light with more
/// corners.
fn cell_color(ui: &Ui, grid: &CoverageGrid, column: usize, row: usize) -> Option<Color32> {
    if !grid.is_reachable(column, row) {
        return None;
    }
    let count = grid.count(column, row);
    if count == 0 {
        return Some(theme::tokens(ui).raised);
    }
    let part = 0.25 + 0.75 * f64::from(count.min(ENOUGH)) / f64::from(ENOUGH);
    Some(Colormap::Viridis.table()[(part * 255.0) as usize])
}

fn histogram(ui: &mut Ui, title: &str, data: &Histogram, quantity: Quantity, size: egui::Vec2) {
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let counts = data.counts();
    response.widget_info(|| {
        let text = counts.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
        WidgetInfo::labeled(egui::Role::Image, true, format!("{title} histogram: {text}"))
    });
    let tokens = theme::tokens(ui);
    let font = theme::font(ui, &TextStyle::Small);
    let painter = ui.painter();
    let heading = format!("{title}, {}", quantity.unit());
    painter.text(rect.left_top(), Align2::LEFT_TOP, heading, font.clone(), tokens.text_weak);
    let plot = Rect::from_min_max(rect.min + vec2(0.0, 18.0), rect.max - vec2(0.0, 18.0));
    let width = plot.width() / counts.len() as f32;
    let most = counts.iter().copied().max().unwrap_or(0).max(1) as f32;
    for (i, count) in counts.iter().enumerate() {
        let x = plot.left() + i as f32 * width;
        let height = (plot.height() * *count as f32 / most).max(1.0);
        let bar =
            Rect::from_min_max(pos2(x + 1.0, plot.bottom() - height), pos2(x + width - 1.0, plot.bottom()));
        let color = if *count == 0 { tokens.line } else { tokens.measured };
        painter.rect_filled(bar, 0.0, color);
    }
    let [low, high] = data.range().map(|v| quantity.on_screen(v));
    let ticks = axis::ticks(low, high, ((plot.width() / TICK_WIDTH) as usize).clamp(2, 6));
    for (tick, text) in ticks.iter().zip(axis::labels(&ticks)) {
        let x = plot.left() + plot.width() * ((tick - low) / (high - low)) as f32;
        let anchor = if x - rect.left() < 8.0 {
            Align2::LEFT_TOP
        } else if rect.right() - x < 8.0 {
            Align2::RIGHT_TOP
        } else {
            Align2::CENTER_TOP
        };
        painter.text(pos2(x, plot.bottom() + 3.0), anchor, text, font.clone(), tokens.text_weak);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_names_what_is_missing_and_stops_when_nothing_is() {
        let mut coverage = Coverage::new([640, 480]);
        let advice = coverage.advice();
        assert!(advice.contains("left image") && advice.contains("right image"), "{advice}");
        for eye in Eye::BOTH {
            for y in 0..48 {
                for x in 0..64 {
                    coverage.grid_mut(eye).add([f64::from(x) * 10.0 + 5.0, f64::from(y) * 10.0 + 5.0]);
                }
            }
        }
        assert_eq!(coverage.fraction(), 1.0);
        for i in 0..200 {
            coverage.distance_m.add(0.15 + 0.5 * f64::from(i) / 200.0);
        }
        assert_eq!(coverage.advice(), "Would make it better: boards tilted by 0 to 10°.");
        for i in 0..200 {
            coverage.tilt_rad.add(50f64.to_radians() * f64::from(i) / 200.0);
        }
        assert!(coverage.advice().starts_with("Everything was shown"));
    }
}
