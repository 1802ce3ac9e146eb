//! The grid between pixels and the values inside them, when deep in.

use egui::{Align2, Color32, FontId, Painter, Stroke, pos2};

use super::{ImageTransform, ValueText};
use crate::texture::Picture;
use crate::theme::{PIXEL_GRID, readable_on};

/// Points per pixel from which the grid is drawn.
const GRID_FROM: f64 = 10.0;
/// Points per pixel from which values are written.
const VALUES_FROM: f64 = 40.0;

pub(super) fn paint(
    painter: &Painter,
    transform: &ImageTransform,
    picture: &Picture,
    value_text: Option<ValueText<'_>>,
) {
    if transform.points_per_px < GRID_FROM {
        return;
    }
    grid(painter, transform);
    if transform.points_per_px >= VALUES_FROM {
        values(painter, transform, picture, value_text);
    }
}

fn grid(painter: &Painter, transform: &ImageTransform) {
    let [columns, rows] = transform.visible(painter.clip_rect());
    let image = transform.image_rect().intersect(painter.clip_rect());
    // Fades in, so that it does not jump at one zoom step.
    let strength = ((transform.points_per_px - GRID_FROM) / 20.0).clamp(0.15, 0.6) as f32;
    let stroke = Stroke::new(1.0, PIXEL_GRID.gamma_multiply(strength));
    let edge = |i: usize| i as f64 - 0.5;
    for column in columns.start..=columns.end {
        painter.vline(transform.to_screen([edge(column), 0.0]).x, image.y_range(), stroke);
    }
    for row in rows.start..=rows.end {
        painter.hline(image.x_range(), transform.to_screen([0.0, edge(row)]).y, stroke);
    }
}

fn values(
    painter: &Painter,
    transform: &ImageTransform,
    picture: &Picture,
    value_text: Option<ValueText<'_>>,
) {
    let [columns, rows] = transform.visible(painter.clip_rect());
    let font = FontId::proportional((transform.points_per_px as f32 / 4.2).clamp(9.5, 14.0));
    for row in rows {
        for column in columns.clone() {
            let color = picture.image()[(column, row)];
            let text = match value_text {
                Some(value_text) => value_text(column, row),
                None => Some(color_text(color, "\n")),
            };
            if let Some(text) = text {
                let at = transform.to_screen([column as f64, row as f64]);
                let galley = painter.layout_no_wrap(text, font.clone(), readable_on(color));
                let at = Align2::CENTER_CENTER.anchor_size(pos2(at.x, at.y), galley.size()).min;
                painter.galley(at, galley, readable_on(color));
            }
        }
    }
}

/// "128" for gray, "120 80 33" for color.
pub(super) fn color_text(color: Color32, separator: &str) -> String {
    let [r, g, b, _] = color.to_array();
    if r == g && g == b { r.to_string() } else { format!("{r}{separator}{g}{separator}{b}") }
}
