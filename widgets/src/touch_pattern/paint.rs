//! Drawing of the pattern.

use egui::{Align2, Painter, Pos2, Rect, Response, Stroke, StrokeKind, TextStyle, Ui, pos2, vec2};

use super::{PatternArea, PatternTransform, TouchMark, TouchMarkState, TouchPattern};
use crate::arrow_key::ArrowKey;
use crate::format;
use crate::overlay;
use crate::theme::{self, Tokens, space};

/// Arrows may reach so far beyond the glass: fingers slip off.
/// Narrower drawings leave out where the robot sits, pt.
const WITH_ROBOT: f32 = 210.0;
/// Wide enough for that and for how long errors are drawn …
const WITH_BOTH: f32 = 320.0;
/// … and for the size with that alone.
const WITH_SCALE: f32 = 200.0;
const REACH: f32 = 12.0;
/// Room below for a line of words.
pub(super) const BELOW: f32 = 20.0;

pub(super) fn pattern(
    ui: &Ui,
    transform: PatternTransform,
    pattern: &TouchPattern<'_>,
    area: Option<PatternArea>,
    hovered: Option<usize>,
) {
    let tokens = theme::tokens(ui);
    let painter = ui.painter();
    painter.rect_filled(transform.rect, 3.0, tokens.backdrop);
    painter.rect_stroke(transform.rect, 3.0, Stroke::new(1.0, tokens.text_weak), StrokeKind::Inside);
    if let Some(area) = area {
        self::area(painter, transform, area, pattern.editable, tokens);
    }
    let drawing = painter.with_clip_rect(transform.rect.expand(REACH).intersect(ui.clip_rect()));
    // What was touched lies above what is to come.
    let mut marks: Vec<&TouchMark> = pattern.marks.iter().collect();
    marks.sort_by_key(|mark| order(mark.state));
    for mark in marks {
        self::mark(&drawing, transform, mark, pattern.error_scale, tokens);
    }
    for number in [pattern.selected, hovered].into_iter().flatten() {
        if let Some(mark) = pattern.marks.iter().find(|mark| mark.number == number) {
            let at = transform.to_drawing(mark.target_px);
            let color = if pattern.selected == Some(number) { tokens.text_strong } else { tokens.text_weak };
            drawing.circle_stroke(at, 7.5, Stroke::new(1.5, color));
        }
    }
    below(ui, transform, pattern, hovered, tokens);
}

/// The focus ring.
pub(super) fn focus(ui: &Ui, rect: Rect, response: &Response) {
    if response.has_focus() {
        let ring = Stroke::new(1.5, theme::tokens(ui).accent);
        ui.painter().rect_stroke(rect, 3.0, ring, StrokeKind::Outside);
    }
}

fn order(state: TouchMarkState) -> u8 {
    match state {
        TouchMarkState::Unreachable => 0,
        TouchMarkState::Planned => 1,
        TouchMarkState::Skipped | TouchMarkState::Rejected | TouchMarkState::Missed => 2,
        TouchMarkState::Touched => 3,
        TouchMarkState::Next => 4,
    }
}

fn area(painter: &Painter, transform: PatternTransform, area: PatternArea, editable: bool, tokens: &Tokens) {
    let first = transform.to_drawing([area.u_px[0], area.v_px[0]]);
    let last = transform.to_drawing([area.u_px[1], area.v_px[1]]);
    let rect = Rect::from_two_pos(first, last);
    painter.rect_filled(rect, 0.0, tokens.text_strong.gamma_multiply(0.05));
    let color = if editable { tokens.text } else { tokens.text_weak.gamma_multiply(0.6) };
    painter.rect_stroke(rect, 0.0, Stroke::new(1.0, color), StrokeKind::Middle);
    if editable {
        for corner in [rect.left_top(), rect.right_top(), rect.left_bottom(), rect.right_bottom()] {
            painter.rect_filled(Rect::from_center_size(corner, vec2(6.0, 6.0)), 1.0, color);
        }
    }
}

fn mark(painter: &Painter, transform: PatternTransform, mark: &TouchMark, scale: f64, tokens: &Tokens) {
    let at = transform.to_drawing(mark.target_px);
    match mark.state {
        TouchMarkState::Planned => {
            painter.circle_stroke(at, 3.5, Stroke::new(1.2, tokens.predicted));
        }
        TouchMarkState::Next => {
            painter.circle_filled(at, 3.0, tokens.text_strong);
            painter.circle_stroke(at, 7.0, Stroke::new(1.5, tokens.text_strong));
        }
        TouchMarkState::Touched => {
            painter.circle_filled(at, 2.0, tokens.measured);
            arrow(painter, transform, at, mark, scale, Stroke::new(1.5, tokens.difference));
        }
        TouchMarkState::Rejected => {
            cross(painter, at, Stroke::new(1.5, tokens.noise_floor));
            arrow(painter, transform, at, mark, scale, Stroke::new(1.0, tokens.noise_floor));
        }
        TouchMarkState::Missed => cross(painter, at, Stroke::new(1.8, tokens.warning)),
        TouchMarkState::Skipped => {
            painter.line_segment(
                [at - vec2(3.5, 0.0), at + vec2(3.5, 0.0)],
                Stroke::new(1.5, tokens.noise_floor),
            );
        }
        TouchMarkState::Unreachable => {
            painter.circle_stroke(at, 2.5, Stroke::new(1.0, tokens.noise_floor));
        }
    }
}

fn arrow(
    painter: &Painter,
    transform: PatternTransform,
    at: Pos2,
    mark: &TouchMark,
    scale: f64,
    stroke: Stroke,
) {
    if let Some(error_px) = mark.error_px {
        let vector = transform.vector(error_px.map(|along| along * scale));
        overlay::arrow(painter, at, vector, stroke, None);
    }
}

fn cross(painter: &Painter, at: Pos2, stroke: Stroke) {
    for along in [vec2(3.0, 3.0), vec2(3.0, -3.0)] {
        painter.line_segment([at - along, at + along], stroke);
    }
}

/// What lies under the pointer, else the size of the screen; where the robot sits; how much
/// errors are magnified.
fn below(
    ui: &Ui,
    transform: PatternTransform,
    pattern: &TouchPattern<'_>,
    hovered: Option<usize>,
    tokens: &Tokens,
) {
    let font = theme::font(ui, &TextStyle::Small);
    let rect = transform.rect;
    let word = |x: f32, anchor: Align2, text: String, color| {
        ui.painter().text(pos2(x, rect.bottom() + space::XS), anchor, text, font.clone(), color)
    };
    let under = hovered.and_then(|number| pattern.marks.iter().find(|mark| mark.number == number));
    match under {
        Some(mark) => {
            word(rect.left(), Align2::LEFT_TOP, capitalized(&mark.text()), tokens.text_strong);
        }
        None => {
            let [width, height] = pattern.size_px;
            let size = format!("{width}×{height} px");
            // How long an error is drawn goes before where the robot sits.
            let has_errors = pattern.marks.iter().any(|mark| mark.error_px.is_some());
            let below = rect.width() > if has_errors { WITH_BOTH } else { WITH_ROBOT };
            let text = if below { format!("{size}, the robot sits below") } else { size };
            word(rect.left(), Align2::LEFT_TOP, text, tokens.text_weak);
            if has_errors && rect.width() > WITH_SCALE {
                scale(ui, transform, pattern, tokens);
            }
        }
    }
}

/// How long an error of a round length is drawn; where lengths are not known, how many times as long as it is.
fn scale(ui: &Ui, transform: PatternTransform, pattern: &TouchPattern<'_>, tokens: &Tokens) {
    let font = theme::font(ui, &TextStyle::Small);
    let corner = transform.rect.right_bottom() + vec2(0.0, space::XS);
    let points_per_px = f64::from(transform.vector([1.0, 0.0]).x) * pattern.error_scale;
    let per_mm = pattern.pixel_width_m.map(|width_m| points_per_px / (1e3 * width_m));
    match per_mm.and_then(|points_per_mm| ArrowKey::of(points_per_mm, "mm", 48.0)) {
        Some(key) => {
            let size = key.size(ui.painter(), &font);
            let room = Align2::RIGHT_TOP.anchor_size(corner - vec2(0.0, 2.0), size);
            key.paint(ui.painter(), room, &font, egui::Color32::TRANSPARENT, tokens.difference);
        }
        None => {
            let text = format!("errors ×{}", format::significant(pattern.error_scale, 1));
            ui.painter().text(corner, Align2::RIGHT_TOP, text, font, tokens.difference);
        }
    }
}

fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
