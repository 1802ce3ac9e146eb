//! Drawing of marks.

use egui::{
    Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, TextStyle, Vec2, epaint::PathShape,
    vec2,
};

use super::{Mark, PointShape};
use crate::theme::{ON_IMAGE, RIM, Tokens, size};
use crate::view_state::ImageTransform;

pub(super) fn marks(marks: &[Mark], painter: &Painter, transform: &ImageTransform, taken: &[Rect]) {
    let pen = Pen { painter, transform, tokens: &ON_IMAGE, taken };
    for mark in marks {
        pen.mark(mark);
    }
}

struct Pen<'a> {
    painter: &'a Painter,
    transform: &'a ImageTransform,
    tokens: &'static Tokens,
    taken: &'a [Rect],
}

impl Pen<'_> {
    fn mark(&self, mark: &Mark) {
        match mark {
            Mark::Point { at_px, shape, radius_pt, ink } => {
                self.point(self.transform.to_screen(*at_px), *shape, *radius_pt, ink.color(self.tokens));
            }
            Mark::Line { points_px, closed, dashed, width_pt, ink } => {
                self.line(points_px, *closed, *dashed, Stroke::new(*width_pt, ink.color(self.tokens)));
            }
            Mark::Area { points_px, opacity, ink } => {
                let color = ink.color(self.tokens).gamma_multiply(*opacity);
                let points = self.screen(points_px);
                self.painter.add(PathShape::convex_polygon(points, color, Stroke::NONE));
            }
            Mark::Arrow { from_px, vector_px, scale, ink } => {
                let tip_px = [0, 1].map(|i| from_px[i] + vector_px[i] * scale);
                let foot = self.transform.to_screen(*from_px);
                arrow(
                    self.painter,
                    foot,
                    self.transform.to_screen(tip_px) - foot,
                    Stroke::new(1.5, ink.color(self.tokens)),
                    Some(RIM),
                );
            }
            Mark::Text { at_px, text, anchor, ink } => {
                self.text(self.transform.to_screen(*at_px), text, *anchor, ink.color(self.tokens));
            }
            Mark::Boxes(boxes) => super::boxes::paint(boxes, self.painter, self.transform, self.taken),
            Mark::Cells { origin_px, cell_px, columns, colors } => {
                self.cells(*origin_px, *cell_px, *columns, colors);
            }
        }
    }

    fn screen(&self, points_px: &[[f64; 2]]) -> Vec<Pos2> {
        points_px.iter().map(|p| self.transform.to_screen(*p)).collect()
    }

    fn point(&self, at: Pos2, shape: PointShape, radius: f32, color: Color32) {
        let painter = self.painter;
        match shape {
            PointShape::Dot => {
                painter.circle(at, radius, color, Stroke::new(1.0, RIM));
            }
            PointShape::Ring => {
                painter.circle_stroke(at, radius, Stroke::new(3.0, RIM));
                painter.circle_stroke(at, radius, Stroke::new(1.5, color));
            }
            PointShape::Plus | PointShape::Cross => {
                let arm =
                    if shape == PointShape::Plus { vec2(radius, 0.0) } else { vec2(radius, radius) * 0.8 };
                for stroke in [Stroke::new(3.5, RIM), Stroke::new(1.5, color)] {
                    painter.line_segment([at - arm, at + arm], stroke);
                    painter.line_segment([at - arm.rot90(), at + arm.rot90()], stroke);
                }
            }
        }
    }

    fn line(&self, points_px: &[[f64; 2]], closed: bool, dashed: bool, stroke: Stroke) {
        let mut points = self.screen(points_px);
        if closed && let Some(first) = points.first().copied() {
            points.push(first);
        }
        let rim = Stroke::new(stroke.width + 1.5, RIM);
        if dashed {
            self.painter.extend(Shape::dashed_line(&points, rim, 7.0, 5.0));
            self.painter.extend(Shape::dashed_line(&points, stroke, 7.0, 5.0));
        } else {
            self.painter.line(points.clone(), rim);
            self.painter.line(points, stroke);
        }
    }

    fn text(&self, at: Pos2, text: &str, anchor: Align2, color: Color32) {
        let font = self.painter.ctx().global_style().text_styles.get(&TextStyle::Small).cloned();
        let font = font.unwrap_or_else(|| FontId::proportional(size::SMALL));
        let galley = self.painter.layout_no_wrap(text.to_owned(), font, color);
        let rect = anchor.anchor_size(at, galley.size() + vec2(8.0, 2.0));
        self.painter.rect_filled(rect, 3.0, RIM);
        self.painter.galley(rect.min + vec2(4.0, 1.0), galley, color);
    }

    fn cells(&self, origin_px: [f64; 2], cell_px: [f64; 2], columns: usize, colors: &[Option<Color32>]) {
        let columns = columns.max(1);
        let corner = |column: usize, row: usize| {
            self.transform.to_screen([
                origin_px[0] + column as f64 * cell_px[0],
                origin_px[1] + row as f64 * cell_px[1],
            ])
        };
        let mut mesh = Mesh::default();
        for (i, color) in colors.iter().enumerate() {
            if let Some(color) = color {
                let (column, row) = (i % columns, i / columns);
                let rect = Rect::from_min_max(corner(column, row), corner(column + 1, row + 1));
                mesh.add_colored_rect(rect, *color);
            }
        }
        self.painter.add(mesh);
    }
}

/// An arrow with a head of constant size; nothing for vectors shorter than a point.
pub(crate) fn arrow(painter: &Painter, foot: Pos2, vector: Vec2, stroke: Stroke, rim: Option<Color32>) {
    let length = vector.length();
    if !(length.is_finite() && length >= 1.0) {
        return;
    }
    let tip = foot + vector;
    let head = (3.5 * stroke.width).min(0.5 * length);
    let along = vector / length * head;
    let across = along.rot90() * 0.5;
    let rim = rim.map(|color| Stroke::new(stroke.width + 2.0, color));
    for stroke in rim.into_iter().chain([stroke]) {
        painter.line_segment([foot, tip], stroke);
        painter.line(vec![tip - along + across, tip, tip - along - across], stroke);
    }
}
