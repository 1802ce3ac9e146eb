//! The few signs of the program, drawn as shapes. States differ by shape, not by color alone,
//! and no sign stands without a word.

use std::f32::consts::TAU;

use egui::{
    Align2, Color32, FontFamily, FontId, Painter, Pos2, Shape, Stroke, epaint::PathShape, pos2, vec2,
};

/// A sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Glyph {
    /// Open circle: not done, off, unknown.
    Ring,
    /// Filled circle: good.
    Disc,
    /// Check mark: done, accepted.
    Check,
    /// Circle filled clockwise by a fraction of 0..=1: under way.
    Progress(f32),
    /// Triangle with an exclamation mark: look here.
    Warning,
    /// Clock: old, overtaken by a change.
    Clock,
    /// Diagonal cross: failed.
    Cross,
    /// Octagon: danger.
    Octagon,
    /// i in a circle: information.
    Info,
}

/// Draws a sign of `size` points around `center`.
pub fn paint(painter: &Painter, center: Pos2, size: f32, glyph: Glyph, color: Color32) {
    let r = size / 2.0;
    let width = (size / 8.0).max(1.25);
    let stroke = Stroke::new(width, color);
    let at = |x: f32, y: f32| pos2(center.x + x * r, center.y + y * r);
    match glyph {
        Glyph::Ring => {
            painter.circle_stroke(center, r - width / 2.0, stroke);
        }
        Glyph::Disc => {
            painter.circle_filled(center, r, color);
        }
        Glyph::Check => {
            painter.line(
                vec![at(-0.8, 0.05), at(-0.25, 0.65), at(0.85, -0.65)],
                Stroke::new(width * 1.3, color),
            );
        }
        Glyph::Progress(fraction) => {
            painter.circle_stroke(center, r - width / 2.0, stroke);
            painter.add(pie(center, r - width * 1.6, fraction, color));
        }
        Glyph::Warning => {
            painter.add(PathShape::convex_polygon(
                vec![at(0.0, -1.0), at(1.1, 0.9), at(-1.1, 0.9)],
                color,
                Stroke::NONE,
            ));
            mark_inside(painter, at(0.0, 0.3), size * 0.75, "!", color);
        }
        Glyph::Clock => {
            painter.circle_stroke(center, r - width / 2.0, stroke);
            painter.line(vec![at(0.0, -0.5), at(0.0, 0.05), at(0.4, 0.3)], Stroke::new(width, color));
        }
        Glyph::Cross => {
            for sign in [-1.0, 1.0] {
                let arm = vec2(0.7 * r, 0.7 * r * sign);
                painter.line_segment([center - arm, center + arm], Stroke::new(width * 1.3, color));
            }
        }
        Glyph::Octagon => {
            let corners =
                (0..8).map(|i| center + egui::Vec2::angled((i as f32 + 0.5) * TAU / 8.0) * r * 1.05);
            painter.add(PathShape::convex_polygon(corners.collect(), color, Stroke::NONE));
            mark_inside(painter, center, size * 0.75, "!", color);
        }
        Glyph::Info => {
            painter.circle_stroke(center, r - width / 2.0, stroke);
            painter.circle_filled(at(0.0, -0.45), width * 0.7, color);
            painter.line_segment([at(0.0, -0.1), at(0.0, 0.55)], stroke);
        }
    }
}

fn mark_inside(painter: &Painter, at: Pos2, size: f32, text: &str, back: Color32) {
    let font = FontId::new(size, FontFamily::Proportional);
    painter.text(at, Align2::CENTER_CENTER, text, font, crate::theme::readable_on(back));
}

/// A pie from twelve o'clock, clockwise. Drawn as a fan: a pie of more than half is not convex.
fn pie(center: Pos2, radius: f32, fraction: f32, color: Color32) -> Shape {
    const SLICES: usize = 32;
    let filled = (fraction.clamp(0.0, 1.0) * SLICES as f32).round() as usize;
    let rim = |i: usize| center + egui::Vec2::angled(i as f32 / SLICES as f32 * TAU - TAU / 4.0) * radius;
    let mut mesh = egui::Mesh::default();
    mesh.colored_vertex(center, color);
    for i in 0..=filled {
        mesh.colored_vertex(rim(i), color);
        if i > 0 {
            mesh.add_triangle(0, i as u32, i as u32 + 1);
        }
    }
    Shape::mesh(mesh)
}
