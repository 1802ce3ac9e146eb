//! The target on the touchscreen itself, and the ring where it was touched. Drawn large and
//! bright on black: it is looked at by people who stand beside the robot.

use egui::{Color32, Painter, Pos2, Stroke, vec2};

use crate::theme::ON_IMAGE;

/// How a target looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TargetLook {
    /// It is touched now.
    Now,
    /// It comes next, and nothing moves yet.
    Waits,
    /// It was touched.
    Done,
}

/// A cross and a ring around a place; what was done is a dot. `unit` is the size of the smallest
/// ring, in points.
pub fn paint_target(painter: &Painter, at: Pos2, unit: f32, look: TargetLook) {
    let color = match look {
        TargetLook::Now => ON_IMAGE.text_strong,
        TargetLook::Waits => ON_IMAGE.text_weak.gamma_multiply(0.6),
        TargetLook::Done => {
            painter.circle_filled(at, unit * 0.18, ON_IMAGE.text_weak.gamma_multiply(0.55));
            return;
        }
    };
    let stroke = Stroke::new((unit * 0.1).max(1.0), color);
    painter.circle_stroke(at, unit, stroke);
    if look == TargetLook::Now {
        painter.circle_stroke(at, unit * 2.2, Stroke::new(stroke.width, color.gamma_multiply(0.45)));
    }
    // Open in the middle, so that the place itself is seen.
    for along in [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)] {
        painter.line_segment([at + along * unit * 0.35, at + along * unit * 1.6], stroke);
    }
    painter.circle_filled(at, (unit * 0.09).max(1.0), color);
}

/// Where the glass was felt; full while the contact lasts.
pub fn paint_felt(painter: &Painter, at: Pos2, unit: f32, is_down: bool) {
    let color: Color32 = ON_IMAGE.measured;
    painter.circle_stroke(at, unit * 0.7, Stroke::new((unit * 0.14).max(1.5), color));
    if is_down {
        painter.circle_filled(at, unit * 0.45, color.gamma_multiply(0.5));
    }
}
