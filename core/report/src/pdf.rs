//! A page as PDF.

use std::collections::HashMap;

use krilla::Document;
use krilla::color::rgb;
use krilla::geom::{Path, PathBuilder, Point, Size, Transform};
use krilla::image::Image;
use krilla::metadata::Metadata;
use krilla::num::NormalizedF32;
use krilla::page::PageSettings;
use krilla::paint::{Fill, FillRule, Stroke, StrokeDash};
use krilla::surface::Surface;
use krilla::text::{Font, TextDirection};

use crate::drawing::{self, Color, Drawing, Mark, Picture};
use crate::font::{self, Weight};
use crate::{About, ReportError};

/// Distance of the control points of a quarter of a circle, per radius.
const QUARTER: f64 = 0.552_284_75;

/// A picture on a page: its pixels, and where it lies: left, top, width, height.
pub struct Placed<'a> {
    pub picture: &'a Picture,
    pub rect: [f64; 4],
}

/// The page as a file.
pub fn of(drawing: &Drawing, about: &About) -> Result<Vec<u8>, ReportError> {
    of_pages(std::slice::from_ref(drawing), None, about)
}

/// Pages as a file; a picture lies on the first one, over what is drawn there.
pub fn of_pages(
    pages: &[Drawing],
    mut placed: Option<Placed<'_>>,
    about: &About,
) -> Result<Vec<u8>, ReportError> {
    let refused = |reason: &str| ReportError::Pdf { reason: reason.to_owned() };
    let mut document = Document::new();
    document.set_metadata(
        Metadata::new()
            .title(font::printable(&about.title))
            .description(font::printable(&about.sentence))
            .creator(format!("Plumbline {}", font::printable(&about.version)))
            .language("en".to_owned()),
    );
    let mut fonts = HashMap::new();
    for weight in [Weight::Regular, Weight::SemiBold] {
        let font = Font::new(weight.data().into(), 0).ok_or_else(|| refused("a font cannot be read"))?;
        fonts.insert(weight, font);
    }
    for drawing in pages {
        let settings = PageSettings::from_wh(drawing.width as f32, drawing.height as f32)
            .ok_or_else(|| refused("the page has no size"))?;
        let mut page = document.start_page_with(settings);
        let mut surface = page.surface();
        for mark in &drawing.marks {
            draw(&mut surface, mark, &fonts);
        }
        if let Some(placed) = placed.take() {
            lay(&mut surface, &placed).ok_or_else(|| refused("the picture is incomplete"))?;
        }
        surface.finish();
        page.finish();
    }
    document.finish().map_err(|error| refused(&format!("{error:?}")))
}

/// `None`: the pixels are not as many as the picture's size says, or it has no place.
fn lay(surface: &mut Surface<'_>, Placed { picture, rect }: &Placed<'_>) -> Option<()> {
    let [left, top, width, height] = rect.map(|length| length as f32);
    let bytes = 4 * picture.size_px[0] as usize * picture.size_px[1] as usize;
    let size = Size::from_wh(width, height).filter(|_| bytes > 0 && picture.rgba.len() == bytes)?;
    surface.push_transform(&Transform::from_translate(left, top));
    let [columns, rows] = picture.size_px;
    surface.draw_image(Image::from_rgba8(picture.rgba.clone(), columns, rows), size);
    surface.pop();
    Some(())
}

fn draw(surface: &mut Surface<'_>, mark: &Mark, fonts: &HashMap<Weight, Font>) {
    match mark {
        Mark::Path { points, closed, fill, stroke } => {
            let Some(path) = polyline(points, *closed) else { return };
            surface.set_fill(fill.map(|(color, opacity)| fill_of(color, opacity)));
            surface.set_stroke(stroke.as_ref().map(stroke_of));
            surface.draw_path(&path);
        }
        Mark::Circle { center, radius, fill, opacity } => {
            let Some(path) = circle(*center, *radius) else { return };
            surface.set_fill(Some(fill_of(*fill, *opacity)));
            surface.set_stroke(None);
            surface.draw_path(&path);
        }
        Mark::Text(text) => {
            let Some(font) = fonts.get(&text.weight).filter(|_| !text.text.is_empty()) else { return };
            surface.set_fill(Some(fill_of(text.color, 1.0)));
            surface.set_stroke(None);
            let start = Point::from_xy(text.left() as f32, text.at[1] as f32);
            surface.draw_text(start, font.clone(), text.size as f32, &text.text, false, TextDirection::Auto);
        }
    }
}

fn polyline(points: &[[f64; 2]], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (i, [x, y]) in points.iter().enumerate() {
        if !(x.is_finite() && y.is_finite()) {
            return None;
        }
        match i {
            0 => builder.move_to(*x as f32, *y as f32),
            _ => builder.line_to(*x as f32, *y as f32),
        }
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

fn circle([x, y]: [f64; 2], radius: f64) -> Option<Path> {
    if !(x.is_finite() && y.is_finite() && radius.is_finite()) {
        return None;
    }
    let mut builder = PathBuilder::new();
    let at = |across: f64, down: f64| ((x + across * radius) as f32, (y + down * radius) as f32);
    let (x0, y0) = at(1.0, 0.0);
    builder.move_to(x0, y0);
    let turns = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];
    for quarter in 0..4 {
        let (from, to) = (turns[quarter], turns[(quarter + 1) % 4]);
        let (x1, y1) = at(from.0 + QUARTER * to.0, from.1 + QUARTER * to.1);
        let (x2, y2) = at(to.0 + QUARTER * from.0, to.1 + QUARTER * from.1);
        let (x3, y3) = at(to.0, to.1);
        builder.cubic_to(x1, y1, x2, y2, x3, y3);
    }
    builder.close();
    builder.finish()
}

fn fill_of(color: Color, opacity: f64) -> Fill {
    Fill { paint: paint(color).into(), opacity: share(opacity), rule: FillRule::NonZero }
}

fn stroke_of(stroke: &drawing::Stroke) -> Stroke {
    Stroke {
        paint: paint(stroke.color).into(),
        width: stroke.width as f32,
        opacity: share(stroke.opacity),
        dash: stroke.dash.map(|[dash, gap]| StrokeDash { array: vec![dash as f32, gap as f32], offset: 0.0 }),
        ..Stroke::default()
    }
}

fn paint(Color(r, g, b): Color) -> rgb::Color {
    rgb::Color::new(r, g, b)
}

fn share(value: f64) -> NormalizedF32 {
    NormalizedF32::new(value as f32).unwrap_or(NormalizedF32::ONE)
}
