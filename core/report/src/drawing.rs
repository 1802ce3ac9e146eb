//! A page as a list of marks, written by `svg` and `pdf` alike. Coordinates are points from the
//! top left corner, x to the right, y down.

use crate::font::{self, Weight};

/// A color, 0–255.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color(pub u8, pub u8, pub u8);

/// Colors by meaning: those of the window's light theme, on white paper.
pub mod ink {
    use super::Color;

    pub const STRONG: Color = Color(0x0B, 0x0F, 0x13);
    pub const TEXT: Color = Color(0x27, 0x2E, 0x35);
    pub const WEAK: Color = Color(0x5A, 0x64, 0x6E);
    pub const LINE: Color = Color(0xCF, 0xD5, 0xDB);
    pub const GRID: Color = Color(0xE6, 0xE9, 0xED);
    pub const TRACK: Color = Color(0xF1, 0xF3, 0xF5);
    pub const PAPER: Color = Color(0xFF, 0xFF, 0xFF);
    /// What the present model leaves.
    pub const BEFORE: Color = Color(0xC6, 0x7D, 0x26);
    /// What is left with the effects found.
    pub const AFTER: Color = Color(0x39, 0x73, 0xBA);
    pub const FLOOR: Color = Color(0x81, 0x8B, 0x92);
    pub const ACCEPTED: Color = Color(0x08, 0x5F, 0x42);
    pub const WARNING: Color = Color(0x96, 0x64, 0x00);
    pub const UNKNOWN: Color = Color(0x89, 0x09, 0x88);
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    pub color: Color,
    pub width: f64,
    pub opacity: f64,
    /// Lengths of dash and gap.
    pub dash: Option<[f64; 2]>,
}

impl Stroke {
    pub fn new(color: Color, width: f64) -> Self {
        Self { color, width, opacity: 1.0, dash: None }
    }

    pub fn dashed(self, dash: f64, gap: f64) -> Self {
        Self { dash: Some([dash, gap]), ..self }
    }

    pub fn opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

/// Which point of a text its position is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Anchor on the base line.
    pub at: [f64; 2],
    pub text: String,
    pub size: f64,
    pub weight: Weight,
    pub color: Color,
    pub anchor: Anchor,
}

impl Text {
    /// Left end of its base line.
    pub fn left(&self) -> f64 {
        let width = self.width();
        match self.anchor {
            Anchor::Start => self.at[0],
            Anchor::Middle => self.at[0] - 0.5 * width,
            Anchor::End => self.at[0] - width,
        }
    }

    pub fn width(&self) -> f64 {
        font::width(&self.text, self.size, self.weight)
    }
}

/// One mark.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// Straight lines.
    Path { points: Vec<[f64; 2]>, closed: bool, fill: Option<(Color, f64)>, stroke: Option<Stroke> },
    /// A full circle.
    Circle { center: [f64; 2], radius: f64, fill: Color, opacity: f64 },
    /// Text.
    Text(Text),
}

/// Pixels.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Picture {
    /// Columns and rows.
    pub size_px: [u32; 2],
    /// Four bytes per pixel, row by row from the top left.
    pub rgba: Vec<u8>,
}

/// A page.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub width: f64,
    pub height: f64,
    pub marks: Vec<Mark>,
}

impl Drawing {
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, marks: vec![] }
    }

    pub fn rect(&mut self, x: f64, y: f64, width: f64, height: f64, fill: Color) {
        let points = vec![[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
        self.marks.push(Mark::Path { points, closed: true, fill: Some((fill, 1.0)), stroke: None });
    }

    pub fn polygon(&mut self, points: Vec<[f64; 2]>, fill: Color, opacity: f64) {
        self.marks.push(Mark::Path { points, closed: true, fill: Some((fill, opacity)), stroke: None });
    }

    pub fn line(&mut self, points: Vec<[f64; 2]>, stroke: Stroke) {
        self.marks.push(Mark::Path { points, closed: false, fill: None, stroke: Some(stroke) });
    }

    pub fn circle(&mut self, center: [f64; 2], radius: f64, fill: Color, opacity: f64) {
        self.marks.push(Mark::Circle { center, radius, fill, opacity });
    }

    pub fn text(&mut self, at: [f64; 2], text: impl AsRef<str>, style: Style) {
        self.anchored(at, text, style, Anchor::Start);
    }

    pub fn anchored(&mut self, at: [f64; 2], text: impl AsRef<str>, style: Style, anchor: Anchor) {
        let text = font::printable(text.as_ref());
        let Style { size, weight, color } = style;
        self.marks.push(Mark::Text(Text { at, text, size, weight, color, anchor }));
    }

    /// Wrapped text from a first base line down, at most `most` lines (the last one then ends with
    /// an ellipsis). Returns the base line after the last line.
    pub fn paragraph(&mut self, at: [f64; 2], width: f64, text: &str, style: Style, most: usize) -> f64 {
        let mut y = at[1];
        for line in font::wrap(text, width, style.size, style.weight, most) {
            self.text([at[0], y], line, style);
            y += style.leading();
        }
        y
    }
}

/// Size, weight, and color of text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    pub size: f64,
    pub weight: Weight,
    pub color: Color,
}

impl Style {
    pub const TITLE: Self = Self { size: 19.0, weight: Weight::SemiBold, color: ink::STRONG };
    pub const LEAD: Self = Self { size: 10.5, weight: Weight::Regular, color: ink::TEXT };
    pub const HEADING: Self = Self { size: 9.5, weight: Weight::SemiBold, color: ink::STRONG };
    pub const BODY: Self = Self { size: 8.0, weight: Weight::Regular, color: ink::TEXT };
    pub const SMALL: Self = Self { size: 6.8, weight: Weight::Regular, color: ink::WEAK };

    pub fn bold(self) -> Self {
        Self { weight: Weight::SemiBold, ..self }
    }

    pub fn color(self, color: Color) -> Self {
        Self { color, ..self }
    }

    pub fn size(self, size: f64) -> Self {
        Self { size, ..self }
    }

    /// Distance of base lines.
    pub fn leading(self) -> f64 {
        1.36 * self.size
    }

    /// Number of lines that a text takes.
    pub fn lines(self, text: &str, width: f64, most: usize) -> usize {
        font::wrap(text, width, self.size, self.weight, most).len()
    }
}
