//! Marks on top of an image, in image pixels, as plain data.

use egui::{
    Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, TextStyle, Vec2, epaint::PathShape,
    pos2, vec2,
};

use crate::image_view::ImageTransform;
use crate::theme::{ON_IMAGE, RIM, Role, Tokens, size};

/// The color of a mark: a meaning, or a color of its own (from a color map).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ink {
    /// By meaning.
    Role(Role),
    /// A color that carries a value.
    Color(Color32),
}

impl From<Role> for Ink {
    fn from(role: Role) -> Self {
        Self::Role(role)
    }
}
impl From<Color32> for Ink {
    fn from(color: Color32) -> Self {
        Self::Color(color)
    }
}

impl Ink {
    pub(crate) fn color(self, tokens: &Tokens) -> Color32 {
        match self {
            Self::Role(role) => role.color(tokens),
            Self::Color(color) => color,
        }
    }
}

/// Shape of a mark at one position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointShape {
    /// Filled circle.
    Dot,
    /// Open circle.
    Ring,
    /// Upright cross.
    Plus,
    /// Diagonal cross.
    Cross,
}

/// One mark. Positions in image pixels, (0, 0) at the center of the top-left pixel; radii and
/// widths in points on the screen, so that marks keep their size under zoom.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// A position.
    Point {
        /// Where.
        at_px: [f64; 2],
        /// How it is drawn.
        shape: PointShape,
        /// Radius in points.
        radius_pt: f32,
        /// Color.
        ink: Ink,
    },
    /// A line through points.
    Line {
        /// Where; two or more.
        points_px: Vec<[f64; 2]>,
        /// Back to the first point.
        closed: bool,
        /// Dashes instead of a full line.
        dashed: bool,
        /// Width in points.
        width_pt: f32,
        /// Color.
        ink: Ink,
    },
    /// A filled convex polygon.
    Area {
        /// Corners in order.
        points_px: Vec<[f64; 2]>,
        /// 0 transparent, 1 opaque.
        opacity: f32,
        /// Color.
        ink: Ink,
    },
    /// A vector at a position, drawn `scale` times its length.
    Arrow {
        /// Foot.
        from_px: [f64; 2],
        /// Vector in pixels.
        vector_px: [f64; 2],
        /// Magnification.
        scale: f64,
        /// Color.
        ink: Ink,
    },
    /// A word at a position.
    Text {
        /// Where.
        at_px: [f64; 2],
        /// What.
        text: String,
        /// Which side of the text is at the position.
        anchor: Align2,
        /// Color.
        ink: Ink,
    },
    /// A grid of colored cells, row by row from the top left.
    Cells {
        /// Top-left corner of the first cell (that of the first pixel is (-0.5, -0.5)).
        origin_px: [f64; 2],
        /// Width and height of a cell.
        cell_px: [f64; 2],
        /// Cells per row.
        columns: usize,
        /// Colors, transparency included; `None` draws nothing.
        colors: Vec<Option<Color32>>,
    },
}

/// Marks in drawing order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// First is lowest.
    pub marks: Vec<Mark>,
}

impl Overlay {
    /// Nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a filled circle.
    pub fn dot(&mut self, at_px: [f64; 2], ink: impl Into<Ink>) -> &mut Self {
        self.point(at_px, PointShape::Dot, 3.0, ink)
    }

    /// Adds an open circle.
    pub fn ring(&mut self, at_px: [f64; 2], ink: impl Into<Ink>) -> &mut Self {
        self.point(at_px, PointShape::Ring, 4.0, ink)
    }

    /// Adds an upright cross.
    pub fn plus(&mut self, at_px: [f64; 2], ink: impl Into<Ink>) -> &mut Self {
        self.point(at_px, PointShape::Plus, 6.0, ink)
    }

    /// Adds a diagonal cross.
    pub fn cross(&mut self, at_px: [f64; 2], ink: impl Into<Ink>) -> &mut Self {
        self.point(at_px, PointShape::Cross, 5.0, ink)
    }

    /// Adds a position mark.
    pub fn point(
        &mut self,
        at_px: [f64; 2],
        shape: PointShape,
        radius_pt: f32,
        ink: impl Into<Ink>,
    ) -> &mut Self {
        self.push(Mark::Point { at_px, shape, radius_pt, ink: ink.into() })
    }

    /// Adds a straight line.
    pub fn line(&mut self, from_px: [f64; 2], to_px: [f64; 2], ink: impl Into<Ink>) -> &mut Self {
        self.polyline(vec![from_px, to_px], ink)
    }

    /// Adds a line through points.
    pub fn polyline(&mut self, points_px: Vec<[f64; 2]>, ink: impl Into<Ink>) -> &mut Self {
        self.push(Mark::Line { points_px, closed: false, dashed: false, width_pt: 1.5, ink: ink.into() })
    }

    /// Adds a closed outline.
    pub fn outline(&mut self, points_px: Vec<[f64; 2]>, ink: impl Into<Ink>) -> &mut Self {
        self.push(Mark::Line { points_px, closed: true, dashed: false, width_pt: 1.5, ink: ink.into() })
    }

    /// Adds an arrow that shows a vector `scale` times its length.
    pub fn arrow(
        &mut self,
        from_px: [f64; 2],
        vector_px: [f64; 2],
        scale: f64,
        ink: impl Into<Ink>,
    ) -> &mut Self {
        self.push(Mark::Arrow { from_px, vector_px, scale, ink: ink.into() })
    }

    /// Adds a word above a position.
    pub fn text(&mut self, at_px: [f64; 2], text: impl Into<String>, ink: impl Into<Ink>) -> &mut Self {
        self.push(Mark::Text { at_px, text: text.into(), anchor: Align2::CENTER_BOTTOM, ink: ink.into() })
    }

    /// Adds any mark.
    pub fn push(&mut self, mark: Mark) -> &mut Self {
        self.marks.push(mark);
        self
    }

    /// Adds all marks of another overlay on top.
    pub fn append(&mut self, other: Self) -> &mut Self {
        self.marks.extend(other.marks);
        self
    }

    /// Draws the marks with the colors for images.
    pub fn paint(&self, painter: &Painter, transform: &ImageTransform) {
        let ink = Pen { painter, transform, tokens: &ON_IMAGE };
        for mark in &self.marks {
            ink.mark(mark);
        }
    }
}

struct Pen<'a> {
    painter: &'a Painter,
    transform: &'a ImageTransform,
    tokens: &'static Tokens,
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

/// The smallest rectangle around points, in pixels; `None` without points.
pub fn bounds_px(points_px: &[[f64; 2]]) -> Option<Rect> {
    let first = points_px.first()?;
    let start = Rect::from_pos(pos2(first[0] as f32, first[1] as f32));
    Some(points_px.iter().fold(start, |mut rect, p| {
        rect.extend_with(pos2(p[0] as f32, p[1] as f32));
        rect
    }))
}
