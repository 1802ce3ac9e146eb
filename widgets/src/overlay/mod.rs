//! Marks on top of an image, in image pixels, as plain data.

pub(crate) mod boxes;
mod paint;

pub use boxes::{Emphasis, LabeledBox};
pub(crate) use paint::arrow;

use egui::{Align2, Color32, Painter, Rect, pos2};

use crate::theme::{Role, Tokens};
use crate::view_state::ImageTransform;

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
    /// Boxes around things; their words never lie on each other.
    Boxes(Vec<LabeledBox>),
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

    /// How many times as long as what they stand for the arrows are; `None`: there are none.
    pub fn arrow_scale(&self) -> Option<f64> {
        self.marks.iter().find_map(|mark| match mark {
            Mark::Arrow { scale, .. } => Some(*scale),
            _ => None,
        })
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

    /// Draws the marks with the colors for images. Words of boxes keep off what else stands on the picture.
    pub fn paint_beside(&self, painter: &Painter, transform: &ImageTransform, taken: &[Rect]) {
        paint::marks(&self.marks, painter, transform, taken);
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
