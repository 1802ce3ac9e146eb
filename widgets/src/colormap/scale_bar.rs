//! The scale that says which color stands for which value.

use egui::{Align2, Mesh, Pos2, Rect, Response, Sense, Stroke, TextStyle, Ui, Vec2, WidgetInfo, pos2, vec2};

use super::ColorScale;
use crate::axis;
use crate::format::Quantity;
use crate::theme;

const THICKNESS: f32 = 10.0;
const STEPS: usize = 64;

/// Which way the scale grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Orientation {
    /// To the right.
    Horizontal,
    /// Upward.
    Vertical,
}

/// A strip of colors with round numbers in the unit of its quantity. Its ends are pointed:
/// values beyond them have the color of the end.
pub struct ScaleBar<'a> {
    label: &'a str,
    scale: ColorScale,
    quantity: Quantity,
    orientation: Orientation,
    marker: Option<f32>,
    is_short: bool,
}

impl<'a> ScaleBar<'a> {
    /// A scale for values in SI, shown in the unit of `quantity`.
    pub fn new(label: &'a str, scale: ColorScale, quantity: Quantity, orientation: Orientation) -> Self {
        Self { label, scale, quantity, orientation, marker: None, is_short: false }
    }

    /// Marks a value, such as the one under the pointer.
    pub fn marker(mut self, value: Option<f32>) -> Self {
        self.marker = value;
        self
    }

    /// Its title is the unit alone, where there is one: for where room is short and words beside it say of what.
    pub fn short(mut self, is_short: bool) -> Self {
        self.is_short = is_short;
        self
    }

    /// Width of a vertical scale: that of its title, or of its numbers.
    pub fn width(&self, ui: &Ui) -> f32 {
        let font = theme::font(ui, &TextStyle::Small);
        let title = ui.painter().layout_no_wrap(self.title(), font, theme::tokens(ui).text_weak);
        title.size().x.max(56.0)
    }

    fn title(&self) -> String {
        let unit = self.quantity.unit();
        match (unit.is_empty(), self.is_short) {
            (true, _) => self.label.to_owned(),
            (false, true) => unit.to_owned(),
            (false, false) => format!("{}, {unit}", self.label),
        }
    }

    /// Draws it along the available width or height.
    pub fn show(self, ui: &mut Ui) -> Response {
        let size = match self.orientation {
            Orientation::Horizontal => vec2(ui.available_width(), THICKNESS + 34.0),
            Orientation::Vertical => vec2(self.width(ui), ui.available_height()),
        };
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let [low, high] = self.scale.range.map(|v| self.quantity.text(f64::from(v)));
        let label = format!("{}: {low} to {high}", self.label);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &label));
        if ui.is_rect_visible(rect) {
            self.paint(ui, rect);
        }
        response
    }

    fn paint(&self, ui: &Ui, rect: Rect) {
        let tokens = theme::tokens(ui);
        let font = theme::font(ui, &TextStyle::Small);
        let painter = ui.painter();
        let (strip, title_at, title_anchor) = match self.orientation {
            Orientation::Horizontal => {
                let top = rect.top() + 16.0;
                let strip = Rect::from_min_max(
                    pos2(rect.left() + THICKNESS, top),
                    pos2(rect.right() - THICKNESS, top + THICKNESS),
                );
                (strip, rect.left_top(), Align2::LEFT_TOP)
            }
            Orientation::Vertical => {
                let strip = Rect::from_min_max(
                    rect.min + vec2(0.0, 20.0 + THICKNESS),
                    pos2(rect.left() + THICKNESS, rect.bottom() - THICKNESS),
                );
                (strip, rect.left_top(), Align2::LEFT_TOP)
            }
        };
        painter.text(title_at, title_anchor, self.title(), font.clone(), tokens.text_weak);
        painter.add(self.colors(strip));
        let [low, high] = self.scale.range.map(|v| self.quantity.on_screen(f64::from(v)));
        let room = if self.orientation == Orientation::Horizontal {
            strip.width() / 44.0
        } else {
            strip.height() / 28.0
        };
        let ticks = axis::ticks(low, high, (room as usize).clamp(2, 9));
        for (tick, text) in ticks.iter().zip(axis::labels(&ticks)) {
            let at = self.along(strip, (tick - low) / (high - low));
            let (at, anchor) = self.beside(strip, at);
            painter.text(at, anchor, text, font.clone(), tokens.text_weak);
        }
        if let Some(value) = self.marker.filter(|value| value.is_finite()) {
            let span = f64::from(self.scale.range[1] - self.scale.range[0]);
            let part = (f64::from(value - self.scale.range[0]) / span).clamp(0.0, 1.0);
            let at = self.along(strip, part);
            let reach = self.across() * (THICKNESS / 2.0 + 3.0);
            painter.line_segment([at - reach, at + reach], Stroke::new(2.0, tokens.text_strong));
        }
    }

    /// Unit vector across the strip.
    fn across(&self) -> Vec2 {
        if self.orientation == Orientation::Horizontal { vec2(0.0, 1.0) } else { vec2(1.0, 0.0) }
    }

    /// Middle of the strip at a fraction of the range.
    fn along(&self, strip: Rect, part: f64) -> Pos2 {
        match self.orientation {
            Orientation::Horizontal => pos2(strip.left() + strip.width() * part as f32, strip.center().y),
            Orientation::Vertical => pos2(strip.center().x, strip.bottom() - strip.height() * part as f32),
        }
    }

    fn beside(&self, strip: Rect, at: Pos2) -> (Pos2, Align2) {
        match self.orientation {
            Orientation::Horizontal => (pos2(at.x, strip.bottom() + 3.0), Align2::CENTER_TOP),
            Orientation::Vertical => (pos2(strip.right() + 6.0, at.y), Align2::LEFT_CENTER),
        }
    }

    /// The strip with a pointed cap at each end.
    fn colors(&self, strip: Rect) -> Mesh {
        let mut mesh = Mesh::default();
        let half = self.across() * (THICKNESS / 2.0);
        let color_at = |part: f64| {
            let part = if self.scale.reversed { 1.0 - part } else { part };
            self.scale.map.table()[(part * 255.0).round() as usize]
        };
        for i in 0..=STEPS {
            let part = i as f64 / STEPS as f64;
            let at = self.along(strip, part);
            mesh.colored_vertex(at - half, color_at(part));
            mesh.colored_vertex(at + half, color_at(part));
            if i > 0 {
                let k = 2 * i as u32;
                mesh.add_triangle(k - 2, k - 1, k);
                mesh.add_triangle(k - 1, k + 1, k);
            }
        }
        for (part, sign) in [(0.0, -1.0), (1.0, 1.0)] {
            let at = self.along(strip, part);
            let outward = (self.along(strip, 1.0) - self.along(strip, 0.0)).normalized() * sign;
            let first = mesh.vertices.len() as u32;
            for corner in [at - half, at + half, at + outward * (THICKNESS * 0.7)] {
                mesh.colored_vertex(corner, color_at(part));
            }
            mesh.add_triangle(first, first + 1, first + 2);
        }
        mesh
    }
}
