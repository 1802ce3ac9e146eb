//! Drawing of the table map.

use egui::{
    Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Response, Shape, Stroke, StrokeKind, TextStyle, Ui,
    epaint::{EllipseShape, PathShape},
    pos2, vec2,
};

use super::{BeforeAfter, Outline, Place, ScalarField, TableMark, TableScene, TableTransform, contour};
use crate::arrow_key::ArrowKey;
use crate::axis;
use crate::colormap::ColorScale;
use crate::format;
use crate::overlay;
use crate::theme::{self, Tokens, space};

/// Room for the numbers left and below, and for the axis names above.
pub(super) const AXES: egui::Vec2 = vec2(34.0, 36.0);
/// The part of it that is left and above.
pub(super) const TOP_LEFT: egui::Vec2 = vec2(34.0, 18.0);

/// On a narrower map names would cover what lies beside them, pt: they are left to the words around it.
pub(super) const NAMED_FROM: f32 = 220.0;
/// Where the names of the axes have less room, the unit alone is said, pt.
const NAMES_WIDTH: f32 = 150.0;

/// What a number below the map needs with the room beside it, pt.
const NUMBER_WIDTH: f32 = 32.0;

/// Half width and half depth of the torso, meters; a sign, not a measurement.
const TORSO_M: [f64; 2] = [0.11, 0.05];

/// Draws everything but the points, which come last.
pub(super) fn map(
    ui: &Ui,
    rect: Rect,
    transform: TableTransform,
    scene: &TableScene,
    field: Option<(&ScalarField, ColorScale)>,
) -> Map {
    let tokens = theme::tokens(ui);
    let font = theme::font(ui, &TextStyle::Small);
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, tokens.backdrop);
    let map = Map { painter, transform, tokens, font };
    if let Some((field, scale)) = field {
        map.cells(field, scale);
    }
    if let Some(border) = &scene.border {
        map.hatch(rect, border);
    }
    map.grid(ui.painter(), rect);
    map.torso();
    let mut names: Vec<Rect> =
        scene.outlines.iter().filter_map(|outline| map.outline(outline, field.is_some())).collect();
    names.extend(scene.border.as_ref().and_then(|border| map.border(border)));
    let key = map.place_for_key(scene, rect, &names);
    names.extend(key.as_ref().map(|(_, room)| *room));
    if let Some((field, scale)) = field {
        map.contours(field, scale, names.clone());
    }
    for error in &scene.before_after {
        map.before_after(error, scene.vector_scale, field.is_some());
    }
    for mark in &scene.marks {
        map.mark(mark, scene.vector_scale, field.is_some(), &mut names);
    }
    if let Some((key, room)) = key {
        let (fill, ink) = match field {
            Some(_) => (theme::RIM, theme::ON_IMAGE.text_strong),
            None => (tokens.backdrop, tokens.text_strong),
        };
        key.paint(&map.painter, room, &map.font, fill, ink);
    }
    map
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
        // Long words get a second line rather than leaving the map.
        let width = rect.width() - 2.0 * space::XS - 12.0;
        let galley = ui.painter().layout(text.to_owned(), font, tokens.text_strong, width);
        let corner = rect.left_bottom() + vec2(space::XS, -space::XS);
        let chip = Align2::LEFT_BOTTOM.anchor_size(corner, galley.size() + vec2(12.0, 6.0));
        ui.painter().rect_filled(chip, 4.0, tokens.panel);
        ui.painter().galley(chip.min + vec2(6.0, 3.0), galley, tokens.text_strong);
    }
}

pub(super) struct Map {
    pub(super) painter: Painter,
    pub(super) transform: TableTransform,
    pub(super) tokens: &'static Tokens,
    font: FontId,
}

/// Whether a straight line from one point to another goes through a part of the map.
fn is_crossed(part: Rect, from: Pos2, to: Pos2) -> bool {
    // Shares of the way at which it is between two opposite edges (Liang and Barsky 1984).
    let between = |start: f32, way: f32, low: f32, high: f32| {
        if way == 0.0 {
            return if (low..=high).contains(&start) { (0.0, 1.0) } else { (1.0, 0.0) };
        }
        let ends = [(low - start) / way, (high - start) / way];
        (ends[0].min(ends[1]), ends[0].max(ends[1]))
    };
    let (in_x, out_x) = between(from.x, to.x - from.x, part.left(), part.right());
    let (in_y, out_y) = between(from.y, to.y - from.y, part.top(), part.bottom());
    in_x.max(in_y).max(0.0) <= out_x.min(out_y).min(1.0)
}

impl Map {
    /// Round lines with their numbers left of and below the map.
    fn grid(&self, outside: &Painter, rect: Rect) {
        let near = self.transform.to_table(rect.right_bottom());
        let far = self.transform.to_table(rect.left_top());
        let weak = self.tokens.text_weak;
        let stroke = Stroke::new(1.0, weak.gamma_multiply(0.2));
        let word = |at, anchor, text: String| outside.text(at, anchor, text, self.font.clone(), weak);
        let most = |length: f32, each: f32| ((length / each) as usize).clamp(2, 11);
        for x in axis::ticks(near[0] * 1e3, far[0] * 1e3, most(rect.height(), 26.0)) {
            let y = self.transform.to_screen([x * 1e-3, 0.0]).y;
            self.painter.hline(rect.x_range(), y, stroke);
            word(pos2(rect.left() - 6.0, y), Align2::RIGHT_CENTER, format::fixed(x, 0));
        }
        // So many ticks may lie closer than their share of the width by one of them.
        for y in axis::ticks(near[1] * 1e3, far[1] * 1e3, most(rect.width() - NUMBER_WIDTH, NUMBER_WIDTH)) {
            let x = self.transform.to_screen([0.0, y * 1e-3]).x;
            self.painter.vline(x, rect.y_range(), stroke);
            if rect.right() - x < 14.0 {
                continue; // its number would run into what stands beside the map
            }
            word(pos2(x, rect.bottom() + 3.0), Align2::CENTER_TOP, format::fixed(y, 0));
        }
        let names = pos2(rect.left(), rect.top() - 3.0);
        let long = "x ↑ forward, y ← left, mm";
        let text = if rect.width() < NAMES_WIDTH { "mm" } else { long };
        word(names, Align2::LEFT_BOTTOM, text.to_owned());
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

    /// Lines with their values; `taken` is where words stand already.
    fn contours(&self, field: &ScalarField, scale: ColorScale, mut taken: Vec<Rect>) {
        let Some(extent) = field.extent() else { return };
        let quantity = field.quantity();
        let [low, high] = extent.map(|v| quantity.on_screen(v));
        let levels = axis::ticks(low, high, 6);
        for (level, text) in levels.iter().zip(axis::labels(&levels)) {
            let value = level / quantity.on_screen(1.0);
            let back = scale.color(value as f32).unwrap_or(self.tokens.backdrop);
            let ink = theme::readable_on(back);
            let mut lines: Vec<Vec<Pos2>> = contour::lines(field, value)
                .into_iter()
                .map(|line| line.into_iter().map(|at_m| self.transform.to_screen(at_m)).collect())
                .collect();
            lines.sort_by_key(|line| std::cmp::Reverse(line.len()));
            for line in &lines {
                self.painter.line(line.clone(), Stroke::new(1.0, ink.gamma_multiply(0.6)));
            }
            let galley = self.painter.layout_no_wrap(text, self.font.clone(), ink);
            let size = galley.size() + vec2(6.0, 0.0);
            // A value is written once, on its longest line.
            if let Some(chip) = lines.first().and_then(|line| self.room_on(line, size, &taken)) {
                taken.push(chip);
                self.painter.rect_filled(chip, 3.0, back);
                self.painter.galley(chip.min + vec2(3.0, 0.0), galley, ink);
            }
        }
    }

    /// A place for a word on a line, as near to its middle as the other words allow.
    fn room_on(&self, line: &[Pos2], size: egui::Vec2, taken: &[Rect]) -> Option<Rect> {
        let inside = self.painter.clip_rect().shrink(4.0);
        [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8]
            .into_iter()
            .filter_map(|part| line.get((line.len() as f32 * part) as usize))
            .map(|at| Rect::from_center_size(*at, size))
            .find(|chip| {
                inside.contains_rect(*chip) && !taken.iter().any(|word| word.expand(4.0).intersects(*chip))
            })
    }

    /// The scale of the arrows, in the corner with the fewest of them where no name stands; `None`: there are no arrows,
    /// or no room.
    fn place_for_key(&self, scene: &TableScene, rect: Rect, names: &[Rect]) -> Option<(ArrowKey, Rect)> {
        let both = |error: &BeforeAfter| error.before_m.is_some() || error.after_m.is_some();
        let has_arrows =
            scene.marks.iter().any(|mark| mark.vector_m.is_some()) || scene.before_after.iter().any(both);
        if !has_arrows {
            return None;
        }
        let points_per_mm = self.transform.points_per_m * scene.vector_scale * 1e-3;
        let key = ArrowKey::of(points_per_mm, "mm", 0.2 * rect.width())?;
        let size = key.size(&self.painter, &self.font);
        let inside = rect.shrink(space::XS);
        let torso = Rect::from_center_size(self.transform.to_screen([0.0, 0.0]), vec2(60.0, 24.0));
        let corners = [Align2::RIGHT_TOP, Align2::RIGHT_BOTTOM, Align2::LEFT_BOTTOM, Align2::LEFT_TOP];
        let rooms = corners.map(|corner| corner.align_size_within_rect(size, inside));
        let is_free = |room: &Rect| {
            let taken = names.iter().chain([&torso]).any(|taken| taken.expand(2.0).intersects(*room));
            inside.expand(0.5).contains_rect(*room) && !taken
        };
        // Of corners that are as empty the first one.
        let room = rooms.into_iter().filter(is_free).min_by_key(|room| self.arrows_in(scene, *room))?;
        Some((key, room))
    }

    /// How many arrows go through a part of the map.
    fn arrows_in(&self, scene: &TableScene, part: Rect) -> usize {
        let ends = |at_m: [f64; 2], vector_m: Option<[f64; 2]>| {
            let from = self.transform.to_screen(at_m);
            let along = vector_m.map(|vector_m| self.transform.vector(vector_m) * scene.vector_scale as f32);
            along.is_some_and(|along| is_crossed(part, from, from + along))
        };
        let marks = scene.marks.iter().filter(|mark| ends(mark.at_m, mark.vector_m)).count();
        let errors = scene.before_after.iter();
        marks
            + errors
                .filter(|error| ends(error.at_m, error.before_m) || ends(error.at_m, error.after_m))
                .count()
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

    /// Returns where its name stands.
    fn outline(&self, outline: &Outline, on_field: bool) -> Option<Rect> {
        let mut points: Vec<_> = outline.corners_m.iter().map(|c| self.transform.to_screen(*c)).collect();
        let first = points.first().copied()?;
        let (color, width, dashed) = match outline.place {
            Place::Patch => (self.tokens.text, 1.0, false),
            Place::Touchscreen => (self.tokens.text_strong, 1.5, false),
            Place::Training => (self.tokens.accepted, 1.5, true),
            Place::Reach => (self.tokens.text_weak, 1.0, true),
            Place::View => (self.tokens.text_weak, 1.0, false),
        };
        if outline.place == Place::Touchscreen {
            let fill = self.tokens.text_strong.gamma_multiply(0.06);
            self.painter.add(PathShape::convex_polygon(points.clone(), fill, Stroke::NONE));
        }
        points.push(first);
        let stroke = Stroke::new(width, color);
        if dashed {
            self.painter.extend(Shape::dashed_line(&points, stroke, 6.0, 4.0));
        } else {
            self.painter.line(points.clone(), stroke);
        }
        if self.painter.clip_rect().width() < NAMED_FROM {
            return None;
        }
        let corner = points.iter().copied().reduce(|a, b| if b.x + b.y < a.x + a.y { b } else { a });
        let at = corner.filter(|_| !outline.name.is_empty())? + vec2(5.0, 4.0);
        Some(if on_field {
            self.chip(at, &outline.name)
        } else {
            self.word(at, Align2::LEFT_TOP, &outline.name, color)
        })
    }

    /// `taken` is where words stand already: a name that finds no room is left to the pointer.
    fn mark(&self, mark: &TableMark, vector_scale: f64, on_field: bool, taken: &mut Vec<Rect>) {
        let tokens = if on_field { &theme::ON_IMAGE } else { self.tokens };
        let rim = if on_field { theme::RIM } else { Color32::TRANSPARENT };
        let at = self.transform.to_screen(mark.at_m);
        let color = mark.ink.color(tokens);
        if let Some(vector) = mark.vector_m {
            let vector = self.transform.vector(vector) * vector_scale as f32;
            overlay::arrow(&self.painter, at, vector, Stroke::new(1.5, color), Some(rim));
        }
        let radius = if mark.vector_m.is_some() { 1.5 } else { 3.5 };
        self.painter.circle(at, radius, color, Stroke::new(1.0, rim));
        if !mark.text.is_empty() {
            let galley = self.painter.layout_no_wrap(mark.text.clone(), self.font.clone(), color);
            if let Some(room) = self.room_beside(at, galley.size(), taken) {
                taken.push(room);
                self.painter.galley(room.min, galley, color);
            }
        }
    }

    /// A place for a name: right, left, above or below what it names.
    fn room_beside(&self, at: Pos2, size: egui::Vec2, taken: &[Rect]) -> Option<Rect> {
        let inside = self.painter.clip_rect();
        let sides = [
            (Align2::LEFT_CENTER, vec2(6.0, 0.0)),
            (Align2::RIGHT_CENTER, vec2(-6.0, 0.0)),
            (Align2::CENTER_BOTTOM, vec2(0.0, -5.0)),
            (Align2::CENTER_TOP, vec2(0.0, 5.0)),
        ];
        let rooms = sides.map(|(anchor, beside)| anchor.anchor_size(at + beside, size));
        rooms.into_iter().find(|room| {
            inside.contains_rect(*room) && !taken.iter().any(|word| word.shrink(1.0).intersects(*room))
        })
    }

    /// As it was below, as it is above.
    fn before_after(&self, error: &BeforeAfter, vector_scale: f64, on_field: bool) {
        let tokens = if on_field { &theme::ON_IMAGE } else { self.tokens };
        let rim = if on_field { theme::RIM } else { Color32::TRANSPARENT };
        let at = self.transform.to_screen(error.at_m);
        for (vector_m, role) in [(error.before_m, BeforeAfter::BEFORE), (error.after_m, BeforeAfter::AFTER)] {
            let Some(vector_m) = vector_m else { continue };
            let vector = self.transform.vector(vector_m) * vector_scale as f32;
            overlay::arrow(&self.painter, at, vector, Stroke::new(1.5, role.color(tokens)), Some(rim));
        }
        self.painter.circle(at, 1.5, tokens.text, Stroke::new(1.0, rim));
    }

    pub(super) fn width_of(&self, text: &str) -> f32 {
        self.painter.layout_no_wrap(text.to_owned(), self.font.clone(), Color32::WHITE).size().x
    }

    /// A word that can be read on every color.
    pub(super) fn chip(&self, at: Pos2, text: &str) -> Rect {
        let ink = theme::ON_IMAGE.text_strong;
        let galley = self.painter.layout_no_wrap(text.to_owned(), self.font.clone(), ink);
        let rect = Rect::from_min_size(at, galley.size() + vec2(8.0, 2.0));
        self.painter.rect_filled(rect, 3.0, theme::RIM);
        self.painter.galley(rect.min + vec2(4.0, 1.0), galley, ink);
        rect
    }

    fn word(&self, at: Pos2, anchor: Align2, text: &str, color: Color32) -> Rect {
        self.painter.text(at, anchor, text, self.font.clone(), color)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrow_crosses_what_it_ends_in_and_what_it_only_goes_through() {
        let part = Rect::from_min_max(pos2(10.0, 10.0), pos2(20.0, 14.0));
        let crosses = |from: [f32; 2], to: [f32; 2]| is_crossed(part, from.into(), to.into());
        assert!(crosses([0.0, 12.0], [11.0, 12.0]) && crosses([15.0, 11.0], [15.0, 40.0]));
        assert!(crosses([15.0, 0.0], [16.0, 40.0]) && crosses([12.0, 12.0], [12.0, 12.0]));
        assert!(!crosses([15.0, 0.0], [15.0, 9.0]) && !crosses([0.0, 0.0], [9.0, 40.0]));
        assert!(!crosses([5.0, 5.0], [5.0, 5.0]));
    }
}
