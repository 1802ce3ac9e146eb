//! Horizontal bars with a name and a value.

use super::Area;
use crate::drawing::{Anchor, Color, Drawing, Stroke, Style, ink};
use crate::font;

/// One bar.
pub struct Bar {
    pub name: String,
    pub value: f64,
    pub label: String,
    pub color: Color,
}

/// Draws bars below each other, with a dashed line at `mark` through all. Returns the lower end.
pub fn draw(
    drawing: &mut Drawing,
    area: Area,
    bars: &[Bar],
    names: f64,
    pitch: f64,
    mark: Option<f64>,
) -> f64 {
    let style = Style::BODY;
    let labels = bars
        .iter()
        .map(|bar| font::width(&bar.label, style.size, font::Weight::SemiBold))
        .fold(0.0, f64::max);
    let left = area.x + names;
    let track = (area.width - names - labels - 8.0).max(10.0);
    let largest = bars.iter().map(|bar| bar.value).filter(|v| v.is_finite()).fold(0.0, f64::max);
    let length =
        |value: f64| if largest > 0.0 && value.is_finite() { track * value.max(0.0) / largest } else { 0.0 };
    let thick = pitch - 5.0;
    let mut y = area.y;
    for bar in bars {
        let base = y + 0.5 * thick + 2.8;
        drawing.text([area.x, base], font::fit(&bar.name, names - 6.0, style.size, style.weight), style);
        drawing.rect(left, y, track, thick, ink::TRACK);
        drawing.rect(left, y, length(bar.value).max(0.8), thick, bar.color);
        drawing.anchored([area.right(), base], &bar.label, style.bold().color(ink::STRONG), Anchor::End);
        y += pitch;
    }
    if let Some(mark) = mark.filter(|mark| mark.is_finite()) {
        let x = left + length(mark);
        let stroke = Stroke::new(ink::STRONG, 0.7).dashed(2.0, 1.6);
        drawing.line(vec![[x, area.y - 2.0], [x, y - 5.0 + 2.0]], stroke);
    }
    y
}
