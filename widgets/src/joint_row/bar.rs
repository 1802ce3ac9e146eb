//! The bar with limits, present position and goal.

use egui::{
    Align2, Color32, EventFilter, Id, Key, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, TextStyle,
    Ui, WidgetInfo, pos2, vec2,
};

use super::JointRow;
use crate::format;
use crate::theme::{self, Tokens};

const TRACK_HEIGHT: f32 = 6.0;
/// Room for the numbers of the limits, where there is enough of it.
const NUMBER_WIDTH: f32 = 36.0;
const MARKER_RADIUS: f32 = 4.5;
/// Per press of an arrow key.
const KEY_STEP_RAD: f64 = std::f64::consts::PI / 180.0;

/// Left of the track.
pub(super) fn ends(width: f32) -> f32 {
    if width > 190.0 { NUMBER_WIDTH } else { MARKER_RADIUS + 1.0 }
}

/// Draws the bar; an angle where the operator dragged, clicked or pressed a key.
pub(super) fn show(row: &JointRow<'_>, ui: &mut Ui, rect: Rect, base: Id) -> Option<f64> {
    let enabled = row.allowed().is_some() && ui.is_enabled();
    let sense = if enabled { Sense::click_and_drag() } else { Sense::hover() };
    let mut response = ui.interact(rect, base.with("bar"), sense);
    let shown_rad = row.state.proposed_rad.or(row.state.goal_rad).or(row.state.present_rad);
    response.widget_info(|| {
        let label = format!("{} goal", row.name);
        match shown_rad {
            Some(angle_rad) => WidgetInfo::slider(enabled, angle_rad.to_degrees(), label),
            None => WidgetInfo::labeled(egui::Role::Slider, enabled, label),
        }
    });
    let Some(limits) = row.limits() else {
        paint_unknown(ui, rect);
        return None;
    };
    let track = Track { rect: track_rect(rect), limits };
    let proposed = row.allowed().and_then(|[low, high]| {
        let pointer = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked());
        let by_pointer = pointer.map(|pos| track.angle(pos.x));
        let wanted = by_pointer.or_else(|| stepped(ui, &response, shown_rad?));
        // The bar ends where it ends: a hand that drags past it means the end.
        wanted.map(|angle_rad| angle_rad.clamp(low, high))
    });
    if ui.is_rect_visible(rect) {
        paint(row, ui, rect, &track, proposed);
        if response.has_focus() {
            let ring = Stroke::new(1.5, theme::tokens(ui).accent);
            ui.painter().rect_stroke(rect.shrink2(vec2(0.0, 3.0)), 4.0, ring, StrokeKind::Inside);
        }
    }
    if let Some(reduced) = row.reduced {
        response = response.on_hover_text(format!("Hatched: not while {}.", reduced.reason));
    }
    if proposed.is_some() {
        response.mark_changed();
    }
    proposed.filter(|angle_rad| Some(*angle_rad) != row.state.proposed_rad)
}

/// By arrow keys, with keyboard focus.
fn stepped(ui: &Ui, response: &egui::Response, from_rad: f64) -> Option<f64> {
    if !response.has_focus() {
        return None;
    }
    let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let presses = |key| ui.input(|input| input.num_presses(key)) as f64;
    let steps = presses(Key::ArrowRight) - presses(Key::ArrowLeft);
    (steps != 0.0).then_some(from_rad + steps * KEY_STEP_RAD)
}

fn track_rect(rect: Rect) -> Rect {
    let inset = ends(rect.width());
    let y = rect.center().y;
    Rect::from_x_y_ranges(
        rect.left() + inset..=rect.right() - inset,
        y - TRACK_HEIGHT / 2.0..=y + TRACK_HEIGHT / 2.0,
    )
}

struct Track {
    rect: Rect,
    limits: [f64; 2],
}

impl Track {
    fn x(&self, angle_rad: f64) -> f32 {
        let [low, high] = self.limits;
        self.rect.left() + self.rect.width() * ((angle_rad - low) / (high - low)) as f32
    }

    fn angle(&self, x: f32) -> f64 {
        let [low, high] = self.limits;
        low + (high - low) * f64::from((x - self.rect.left()) / self.rect.width().max(1.0))
    }

    fn at(&self, angle_rad: f64) -> Pos2 {
        pos2(self.x(angle_rad), self.rect.center().y)
    }

    fn contains(&self, angle_rad: f64) -> bool {
        (self.limits[0]..=self.limits[1]).contains(&angle_rad)
    }
}

fn paint_unknown(ui: &Ui, rect: Rect) {
    let font = theme::font(ui, &TextStyle::Small);
    let color = theme::tokens(ui).text_weak;
    ui.painter().text(rect.center(), Align2::CENTER_CENTER, "limits unknown", font, color);
}

fn paint(row: &JointRow<'_>, ui: &Ui, rect: Rect, track: &Track, proposed: Option<f64>) {
    let tokens = theme::tokens(ui);
    let painter = ui.painter_at(rect.expand(2.0));
    painter.rect_filled(track.rect, 3.0, tokens.raised_hover);
    if track.contains(0.0) {
        painter.vline(track.x(0.0), track.rect.y_range().expand(2.0), Stroke::new(1.0, tokens.text_weak));
    }
    hatch(row, &painter, track, tokens);
    limits(ui, rect, track);
    let old = row.is_old();
    let strength = if old { 0.45 } else { 1.0 };
    let goal =
        proposed.or(row.state.proposed_rad).or(row.state.goal_rad).filter(|goal| track.contains(*goal));
    let present = row.state.present_rad.filter(|present| present.is_finite());
    if let (Some(goal), Some(present)) = (goal, present.filter(|present| track.contains(*present))) {
        let line = Stroke::new(2.0, tokens.predicted.gamma_multiply(0.7 * strength));
        painter.line_segment([track.at(present), track.at(goal)], line);
    }
    // What the servo was told already, while something else is proposed.
    if let Some(sent) = row.state.goal_rad.filter(|sent| Some(*sent) != goal && track.contains(*sent)) {
        let tick = Stroke::new(1.5, tokens.predicted.gamma_multiply(strength));
        painter.vline(track.x(sent), track.rect.y_range().expand(3.0), tick);
    }
    if let Some(present) = present.filter(|present| track.contains(*present)) {
        present_marker(&painter, track.at(present), tokens.measured.gamma_multiply(strength));
    }
    if let Some(goal) = goal {
        goal_marker(&painter, track.at(goal), tokens.predicted, tokens.panel);
    }
    if let Some(present) = present.filter(|present| !track.contains(*present)) {
        beyond(&painter, track, present, tokens);
    }
}

/// Both ends, with their numbers where there is room.
fn limits(ui: &Ui, rect: Rect, track: &Track) {
    let tokens = theme::tokens(ui);
    let [low, high] = track.limits;
    let caps = track.rect.y_range().expand(3.0);
    for x in [track.rect.left(), track.rect.right()] {
        ui.painter().vline(x, caps, Stroke::new(1.5, tokens.text_weak));
    }
    if ends(rect.width()) == NUMBER_WIDTH {
        let font = theme::font(ui, &TextStyle::Small);
        let number = |angle_rad: f64| format::fixed(angle_rad.to_degrees(), 0);
        let y = rect.center().y;
        let at = [pos2(track.rect.left() - 6.0, y), pos2(track.rect.right() + 6.0, y)];
        ui.painter().text(at[0], Align2::RIGHT_CENTER, number(low), font.clone(), tokens.text_weak);
        ui.painter().text(at[1], Align2::LEFT_CENTER, number(high), font, tokens.text_weak);
    }
}

/// What another joint forbids.
fn hatch(row: &JointRow<'_>, painter: &Painter, track: &Track, tokens: &Tokens) {
    if row.reduced.is_none() {
        return;
    }
    let [low, high] = track.limits;
    let parts = match row.allowed() {
        Some([from, to]) => vec![[low, from], [to, high]],
        None => vec![[low, high]],
    };
    for [from, to] in parts {
        let [left, right] = [track.x(from), track.x(to)];
        if right - left < 1.0 {
            continue;
        }
        let part = Rect::from_x_y_ranges(left..=right, track.rect.y_range().expand(2.0));
        painter.rect_filled(part, 0.0, tokens.panel);
        let clipped = painter.with_clip_rect(part.intersect(painter.clip_rect()));
        let stroke = Stroke::new(1.0, tokens.text_weak);
        let mut x = left - part.height();
        while x < right {
            clipped.line_segment([pos2(x, part.bottom()), pos2(x + part.height(), part.top())], stroke);
            x += 5.0;
        }
        painter.rect_stroke(part, 0.0, Stroke::new(1.0, tokens.line), StrokeKind::Inside);
    }
}

/// Filled: where it is.
pub(super) fn present_marker(painter: &Painter, at: Pos2, color: Color32) {
    painter.circle_filled(at, MARKER_RADIUS, color);
}

/// Hollow: where it should be.
pub(super) fn goal_marker(painter: &Painter, at: Pos2, color: Color32, inside: Color32) {
    painter.circle(at, MARKER_RADIUS + 0.5, inside.gamma_multiply(0.4), Stroke::new(2.0, color));
}

/// The joint stands outside of its limits: an arrow at that end.
fn beyond(painter: &Painter, track: &Track, present: f64, tokens: &Tokens) {
    let (x, out) =
        if present < track.limits[0] { (track.rect.left(), -1.0) } else { (track.rect.right(), 1.0) };
    let y = track.rect.center().y;
    let tip = pos2(x + 5.0 * out, y);
    let back = |side: f32| pos2(x - 4.0 * out, y + 6.0 * side);
    let rim = Stroke::new(1.5, tokens.panel);
    painter.add(Shape::convex_polygon(vec![tip, back(1.0), back(-1.0)], tokens.warning, rim));
}
