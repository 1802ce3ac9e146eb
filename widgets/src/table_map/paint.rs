//! Drawing of the table map.

use egui::{
    Align2, Color32, FontId, Mesh, Painter, Rect, Response, Shape, Stroke, StrokeKind, TextStyle, Ui,
    epaint::{EllipseShape, PathShape},
    pos2, vec2,
};

use super::{Outline, Place, ScalarField, TableMark, TableScene, TableTransform, contour};
use crate::axis;
use crate::colormap::ColorScale;
use crate::overlay;
use crate::theme::{self, Tokens, space};

/// Half width and half depth of the torso, meters; a sign, not a measurement.
const TORSO_M: [f64; 2] = [0.11, 0.05];

pub(super) fn map(
    ui: &Ui,
    rect: Rect,
    transform: TableTransform,
    scene: &TableScene,
    field: Option<(&ScalarField, ColorScale)>,
) {
    let tokens = theme::tokens(ui);
    let font = theme::font(ui, &TextStyle::Small);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, tokens.backdrop);
    let map = Map { painter: &painter, transform, tokens, font };
    if let Some((field, scale)) = field {
        map.cells(field, scale);
    }
    map.grid(rect);
    if let Some((field, scale)) = field {
        map.contours(field, scale);
    }
    map.torso();
    for outline in &scene.outlines {
        map.outline(outline);
    }
    for mark in &scene.marks {
        map.mark(mark, scene.vector_scale, field.is_some());
    }
}

/// The focus ring and the words under the pointer.
pub(super) fn frame(ui: &Ui, rect: Rect, response: &Response, readout: Option<&str>) {
    let tokens = theme::tokens(ui);
    if response.has_focus() {
        let ring = Stroke::new(1.5, tokens.accent);
        ui.painter().rect_stroke(rect, 0.0, ring, StrokeKind::Inside);
    }
    if let Some(text) = readout {
        let font = theme::font(ui, &TextStyle::Small);
        let galley = ui.painter().layout_no_wrap(text.to_owned(), font, tokens.text_strong);
        let at = rect.left_top() + vec2(space::S, space::S);
        let chip = Rect::from_min_size(at, galley.size() + vec2(12.0, 6.0));
        ui.painter().rect_filled(chip, 4.0, tokens.panel);
        ui.painter().galley(at + vec2(6.0, 3.0), galley, tokens.text_strong);
    }
}

struct Map<'a> {
    painter: &'a Painter,
    transform: TableTransform,
    tokens: &'static Tokens,
    font: FontId,
}

impl Map<'_> {
    /// Lines every 100 mm with their numbers at the edges.
    fn grid(&self, rect: Rect) {
        let near = self.transform.to_table(rect.right_bottom());
        let far = self.transform.to_table(rect.left_top());
        let stroke = Stroke::new(1.0, self.tokens.text_weak.gamma_multiply(0.18));
        let weak = self.tokens.text_weak;
        for x in axis::ticks(near[0] * 1e3, far[0] * 1e3, 9) {
            let y = self.transform.to_screen([x * 1e-3, 0.0]).y;
            self.painter.hline(rect.x_range(), y, stroke);
            if y - rect.top() > 16.0 && rect.bottom() - y > 16.0 {
                let at = pos2(rect.right() - space::XS, y - 1.0);
                self.word(at, Align2::RIGHT_BOTTOM, &crate::format::fixed(x, 0), weak);
            }
        }
        for y in axis::ticks(near[1] * 1e3, far[1] * 1e3, 11) {
            let x = self.transform.to_screen([0.0, y * 1e-3]).x;
            self.painter.vline(x, rect.y_range(), stroke);
            if x - rect.left() > 16.0 && rect.right() - x > 40.0 {
                let at = pos2(x, rect.bottom() - 2.0);
                self.word(at, Align2::CENTER_BOTTOM, &crate::format::fixed(y, 0), weak);
            }
        }
        let corner = rect.right_top() + vec2(-space::XS, 2.0);
        self.word(corner, Align2::RIGHT_TOP, "x ↑, y ←, mm", weak);
    }

    /// Smooth colors: one quad per cell with a color per corner; cells with a missing node stay
    /// empty.
    fn cells(&self, field: &ScalarField, scale: ColorScale) {
        let [rows, columns] = field.nodes();
        let mut mesh = Mesh::default();
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                let corners = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)];
                let colors = corners.map(|(r, c)| field.node(r, c).and_then(|v| scale.color(v as f32)));
                if colors.iter().all(Option::is_some) {
                    let first = mesh.vertices.len() as u32;
                    for ((r, c), color) in corners.into_iter().zip(colors.into_iter().flatten()) {
                        let at = self.transform.to_screen(field.node_m(r as f64, c as f64));
                        mesh.colored_vertex(at, color);
                    }
                    mesh.add_triangle(first, first + 1, first + 2);
                    mesh.add_triangle(first, first + 2, first + 3);
                }
            }
        }
        self.painter.add(mesh);
    }

    fn contours(&self, field: &ScalarField, scale: ColorScale) {
        let Some(extent) = field.extent() else { return };
        let quantity = field.quantity();
        let [low, high] = extent.map(|v| quantity.on_screen(v));
        let levels = axis::ticks(low, high, 6);
        let per_unit = quantity.on_screen(1.0);
        let mut words: Vec<Rect> = Vec::new();
        for (level, text) in levels.iter().zip(axis::labels(&levels)) {
            let value = level / per_unit;
            let back = scale.color(value as f32).unwrap_or(self.tokens.backdrop);
            let ink = theme::readable_on(back);
            let segments = contour::segments(field, value);
            for [a, b] in &segments {
                let ends = [self.transform.to_screen(*a), self.transform.to_screen(*b)];
                self.painter.line_segment(ends, Stroke::new(1.0, ink.gamma_multiply(0.55)));
            }
            let place = segments.iter().map(|[a, _]| self.transform.to_screen(*a)).find(|at| {
                let room = Rect::from_center_size(*at, vec2(44.0, 20.0));
                self.painter.clip_rect().shrink(12.0).contains_rect(room)
                    && !words.iter().any(|word| word.intersects(room))
            });
            if let Some(at) = place {
                words.push(Rect::from_center_size(at, vec2(44.0, 20.0)));
                let galley = self.painter.layout_no_wrap(text, self.font.clone(), ink);
                let chip = Rect::from_center_size(at, galley.size() + vec2(6.0, 0.0));
                self.painter.rect_filled(chip, 3.0, back);
                self.painter.galley(chip.min + vec2(3.0, 0.0), galley, ink);
            }
        }
    }

    fn torso(&self) {
        let center = self.transform.to_screen([0.0, 0.0]);
        let half = self.transform.vector([TORSO_M[1], TORSO_M[0]]).abs();
        let ellipse = EllipseShape {
            center,
            radius: half,
            fill: self.tokens.raised,
            stroke: Stroke::new(1.0, self.tokens.text_weak),
            angle: 0.0,
        };
        self.painter.add(ellipse);
        self.word(center, Align2::CENTER_CENTER, "torso", self.tokens.text_weak);
    }

    fn outline(&self, outline: &Outline) {
        let mut points: Vec<_> = outline.corners_m.iter().map(|c| self.transform.to_screen(*c)).collect();
        let Some(first) = points.first().copied() else { return };
        let (color, width, dashed) = match outline.place {
            Place::Patch => (self.tokens.text, 1.0, false),
            Place::Touchscreen => (self.tokens.text_strong, 1.5, false),
            Place::Training => (self.tokens.accepted, 1.5, true),
            Place::Reach => (self.tokens.text_weak, 1.0, true),
            Place::View => (self.tokens.text_weak, 1.0, false),
        };
        if outline.place == Place::Touchscreen {
            let fill = self.tokens.text_strong.gamma_multiply(0.05);
            self.painter.add(PathShape::convex_polygon(points.clone(), fill, Stroke::NONE));
        }
        points.push(first);
        let stroke = Stroke::new(width, color);
        if dashed {
            self.painter.extend(Shape::dashed_line(&points, stroke, 6.0, 4.0));
        } else {
            self.painter.line(points.clone(), stroke);
        }
        let corner = points.iter().copied().reduce(|a, b| if b.x + b.y < a.x + a.y { b } else { a });
        if let Some(corner) = corner.filter(|_| !outline.name.is_empty()) {
            self.word(corner + vec2(3.0, 1.0), Align2::LEFT_TOP, &outline.name, color);
        }
    }

    fn mark(&self, mark: &TableMark, vector_scale: f64, on_field: bool) {
        let tokens = if on_field { &theme::ON_IMAGE } else { self.tokens };
        let rim = if on_field { theme::RIM } else { Color32::TRANSPARENT };
        let at = self.transform.to_screen(mark.at_m);
        let color = mark.ink.color(tokens);
        if let Some(vector) = mark.vector_m {
            let vector = self.transform.vector(vector) * vector_scale as f32;
            overlay::arrow(self.painter, at, vector, Stroke::new(1.5, color), Some(rim));
        }
        let radius = if mark.vector_m.is_some() { 2.0 } else { 3.5 };
        self.painter.circle(at, radius, color, Stroke::new(1.0, rim));
        if !mark.text.is_empty() {
            self.word(at + vec2(6.0, 0.0), Align2::LEFT_CENTER, &mark.text, color);
        }
    }

    fn word(&self, at: egui::Pos2, anchor: Align2, text: &str, color: Color32) {
        self.painter.text(at, anchor, text, self.font.clone(), color);
    }
}
