//! The smaller cells of a row.

use std::time::Duration;

use egui::{Align2, Id, Rect, Response, Sense, Stroke, TextStyle, Ui, WidgetInfo, pos2, vec2};

use super::layout::Columns;
use super::{Freshness, HIGH_LOAD, HOT_C, JointHistory, JointRow, ROW_HEIGHT, WARM_C};
use crate::format;
use crate::glyph::{self, Glyph};
use crate::lamp::Health;
use crate::theme::{self, space};

const ARROW: f32 = 3.5;

/// The name in plain words, and the id behind it where there is room. `true` when pressed.
pub(super) fn name(row: &JointRow<'_>, ui: &mut Ui, rect: Rect, base: Id) -> bool {
    let response = ui.interact(rect, base.with("name"), Sense::click());
    response.widget_info(|| {
        WidgetInfo::selected(egui::Role::DisclosureTriangle, ui.is_enabled(), row.expanded, row.name)
    });
    theme::paint_hover(ui, &response, rect);
    let tokens = theme::tokens(ui);
    let painter = ui.painter_at(rect);
    let center = pos2(rect.left() + 7.0, rect.center().y);
    let corners = if row.expanded {
        [vec2(-ARROW, -ARROW / 2.0), vec2(ARROW, -ARROW / 2.0), vec2(0.0, ARROW)]
    } else {
        [vec2(-ARROW / 2.0, -ARROW), vec2(ARROW, 0.0), vec2(-ARROW / 2.0, ARROW)]
    };
    let triangle = corners.map(|corner| center + corner).to_vec();
    painter.add(egui::Shape::convex_polygon(triangle, tokens.text_weak, Stroke::NONE));
    let body = theme::font(ui, &TextStyle::Body);
    let color = if row.no_answer().is_some() { tokens.text_weak } else { tokens.text };
    let at = pos2(rect.left() + space::M, rect.center().y);
    let mut job = egui::text::LayoutJob::simple_singleline(row.name.to_owned(), body, color);
    job.wrap = egui::text::TextWrapping::truncate_at_width(rect.right() - at.x);
    let galley = painter.layout_job(job);
    let name = Align2::LEFT_CENTER.anchor_size(at, galley.size());
    painter.galley(name.min, galley, color);
    let small = theme::font(ui, &TextStyle::Small);
    let id = painter.layout_no_wrap(row.id.to_owned(), small, tokens.text_weak);
    if name.right() + space::S + id.size().x < rect.right() {
        let at = pos2(rect.right() - id.size().x, rect.center().y - id.size().y / 2.0);
        painter.galley(at, id, tokens.text_weak);
    }
    let clicked = response.clicked();
    response.on_hover_text(format!("{} ({})", row.name, row.id));
    clicked
}

/// "34.2°", and how old it is instead where it is.
pub(super) fn present(row: &JointRow<'_>, ui: &Ui, rect: Rect) {
    let tokens = theme::tokens(ui);
    let at = pos2(rect.right(), rect.center().y);
    let angle = row.state.present_rad.map_or_else(|| format::NONE.to_owned(), format::joint_degrees);
    match row.freshness {
        Freshness::Stale(age) => {
            let up = vec2(0.0, -5.5);
            let small = theme::font(ui, &TextStyle::Small);
            ui.painter().text(at + up, Align2::RIGHT_CENTER, angle, small.clone(), tokens.text_weak);
            ui.painter().text(at - up, Align2::RIGHT_CENTER, old(age), small, tokens.warning);
        }
        Freshness::Live | Freshness::NoAnswer { .. } => {
            let body = theme::font(ui, &TextStyle::Body);
            let color = if row.is_beyond_limits() { tokens.warning } else { tokens.text_strong };
            ui.painter().text(at, Align2::RIGHT_CENTER, angle, body, color);
        }
    }
}

fn old(age: Option<Duration>) -> String {
    let Some(age) = age else { return "not read".to_owned() };
    if age.as_secs() < 1 { format!("{} ms old", age.as_millis()) } else { format!("{} s old", age.as_secs()) }
}

/// In place of bar, position and goal.
pub(super) fn no_answer(ui: &Ui, rect: Rect, sentence: &str) {
    let tokens = theme::tokens(ui);
    let painter = ui.painter_at(rect);
    let center = pos2(rect.left() + 12.0, rect.center().y);
    glyph::paint(&painter, center, 11.0, Glyph::Warning, tokens.warning);
    let body = theme::font(ui, &TextStyle::Body);
    let text = painter.text(center + vec2(12.0, 0.0), Align2::LEFT_CENTER, sentence, body, tokens.warning);
    let ends = [pos2(text.right() + space::S, rect.center().y), rect.right_center()];
    if ends[0].x < ends[1].x {
        painter.extend(egui::Shape::dashed_line(&ends, Stroke::new(1.0, tokens.line), 4.0, 4.0));
    }
    ui.interact(rect, ui.scope_id().with(("no answer", sentence)), Sense::hover())
        .widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, sentence));
}

/// Signed around the middle.
pub(super) fn load(row: &JointRow<'_>, ui: &Ui, rect: Rect, base: Id) {
    let response = ui.interact(rect, base.with("load"), Sense::hover());
    let value = row.state.load.filter(|load| load.is_finite() && row.no_answer().is_none());
    let percent = |load: f64| format!("{} %", format::fixed(100.0 * load, 0));
    let label = format!("{} load {}", row.name, value.map_or_else(|| format::NONE.to_owned(), percent));
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &label));
    let tokens = theme::tokens(ui);
    let track = Rect::from_center_size(rect.center(), vec2(rect.width(), 6.0));
    ui.painter().rect_filled(track, 2.0, tokens.raised);
    if let Some(load) = value {
        let middle = track.center().x;
        let end = middle + track.width() / 2.0 * load.clamp(-1.0, 1.0) as f32;
        let part = Rect::from_x_y_ranges(middle.min(end)..=middle.max(end), track.y_range());
        let color = if load.abs() >= HIGH_LOAD { tokens.warning } else { tokens.measured };
        ui.painter().rect_filled(part, 1.0, color.gamma_multiply(if row.is_old() { 0.45 } else { 1.0 }));
    }
    ui.painter().vline(track.center().x, track.y_range().expand(2.0), Stroke::new(1.0, tokens.text_weak));
    hover(response, &label, row.history, |ui, history| {
        super::load_line(history, vec2(220.0, 40.0)).show(ui);
    });
}

/// How warm it is, with a lamp.
pub(super) fn temperature(row: &JointRow<'_>, ui: &Ui, rect: Rect, base: Id) {
    let response = ui.interact(rect, base.with("temperature"), Sense::hover());
    let value = row.state.temperature_c.filter(|c| c.is_finite() && row.no_answer().is_none());
    let health = match value {
        Some(c) if c >= HOT_C => Health::Danger,
        Some(c) if c >= WARM_C => Health::Warning,
        Some(_) => Health::Good,
        None => Health::Off,
    };
    // Servos tell whole degrees.
    let text = value.map_or_else(|| format::NONE.to_owned(), |c| format!("{} °C", format::fixed(c, 0)));
    let label = format!("{} servo {text}, {}", row.name, health.word());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &label));
    let tokens = theme::tokens(ui);
    let (sign, mut color) = health.sign(tokens);
    let mut ink = if health == Health::Danger { tokens.text_strong } else { tokens.text };
    if row.is_old() || value.is_none() {
        (color, ink) = (color.gamma_multiply(0.6), tokens.text_weak);
    }
    glyph::paint(ui.painter(), pos2(rect.left() + 6.0, rect.center().y), 9.0, sign, color);
    let body = theme::font(ui, &TextStyle::Body);
    ui.painter().text(pos2(rect.left() + 16.0, rect.center().y), Align2::LEFT_CENTER, text, body, ink);
    hover(response, &label, row.history, |ui, history| {
        super::temperature_line(history, vec2(220.0, 40.0)).show(ui);
    });
}

fn hover(
    response: Response,
    label: &str,
    history: Option<&JointHistory>,
    line: impl FnOnce(&mut Ui, &JointHistory),
) {
    response.on_hover_ui(|ui| match history {
        Some(history) => line(ui, history),
        None => {
            ui.label(label);
        }
    });
}

/// "held" or "free". The wish, when pressed.
pub(super) fn torque(row: &JointRow<'_>, ui: &Ui, rect: Rect, base: Id) -> Option<bool> {
    let known = row.state.torque_on.filter(|_| row.no_answer().is_none());
    let enabled = known.is_some() && ui.is_enabled();
    let sense = if enabled { Sense::click() } else { Sense::hover() };
    let rect = rect.shrink2(vec2(0.0, 3.0));
    let response = ui.interact(rect, base.with("torque"), sense);
    let word = match known {
        Some(true) => "held",
        Some(false) => "free",
        None => format::NONE,
    };
    response.widget_info(|| {
        let label = format!("{} torque", row.name);
        let mut info = WidgetInfo::selected(egui::Role::Switch, enabled, known == Some(true), label);
        info.current_text_value = Some(word.to_owned());
        info
    });
    let tokens = theme::tokens(ui);
    let painter = ui.painter();
    match known {
        Some(true) => {
            painter.rect_filled(rect, 4.0, tokens.raised);
        }
        // Free is the state that falls: it looks open.
        Some(false) => {
            let outline = Stroke::new(1.0, tokens.text_weak);
            painter.rect_stroke(rect, 4.0, outline, egui::StrokeKind::Inside);
        }
        None => {}
    }
    theme::paint_hover(ui, &response, rect);
    let color = if known == Some(true) { tokens.text } else { tokens.text_weak };
    let small = theme::font(ui, &TextStyle::Small);
    painter.text(rect.center(), Align2::CENTER_CENTER, word, small, color);
    let pressed = response.clicked();
    response.on_hover_text(match known {
        Some(true) => "The servo holds its place. Press to let it go; the arm may fall.",
        Some(false) => "The servo can be turned by hand. Press to hold it where it is.",
        None => "Not known: the servo does not answer.",
    });
    known.filter(|_| pressed).map(|on| !on)
}

/// Why a typed goal was refused, below the row.
pub(super) fn refusal(ui: &mut Ui, columns: &Columns, reason: &str) {
    let (rect, response) = ui.allocate_exact_size(vec2(columns.width(), ROW_HEIGHT - 6.0), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, reason));
    let tokens = theme::tokens(ui);
    let small = theme::font(ui, &TextStyle::Small);
    let galley = ui.painter().layout_no_wrap(reason.to_owned(), small, tokens.warning);
    // Ends below the number that it is about; a long one starts with the row.
    let left = (columns.goal.right() - galley.size().x).max(rect.left() + space::M + 16.0);
    let y = rect.center().y - 3.0;
    glyph::paint(ui.painter(), pos2(left - 11.0, y), 10.0, Glyph::Warning, tokens.warning);
    ui.painter().galley(pos2(left, y - galley.size().y / 2.0), galley, tokens.warning);
}
