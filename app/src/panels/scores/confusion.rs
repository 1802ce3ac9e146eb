//! What was taken for what; a click on a cell opens its images.

use egui::{Color32, Rect, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use plumbline_engine::view::{ModelScores, ScoreTable};
use plumbline_engine::{ConfusionCell, ScoresCommand};
use plumbline_widgets::theme;

use super::parts::{chosen, judged};
use crate::panels::PanelContext;

/// Room for the names at the left, and above.
const NAMES: [f32; 2] = [92.0, 74.0];
const LEAST_CELL: f32 = 22.0;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let what = "After evaluating, each cell counts what was taken for what; a click shows the images.";
    let Some(table) = judged(ui, cx, what) else { return };
    let Some((model, scores)) = chosen(cx, &table) else {
        ui.label(theme::weak(ui, "This detector could not be judged; choose another row of the table."));
        return;
    };
    ui.horizontal(|ui| {
        let from = scores.confusion_confidence;
        ui.add(egui::Label::new(theme::weak(ui, format!("{model}, confidence from {from:.2}"))).truncate());
        ui.checkbox(&mut cx.state.scores.shares, "Shares")
            .on_hover_text("Share of the row in place of counts");
    });
    egui::ScrollArea::both().auto_shrink(false).show(ui, |ui| matrix(ui, cx, &table, scores));
}

fn matrix(ui: &mut Ui, cx: &mut PanelContext<'_>, table: &ScoreTable, scores: &ModelScores) {
    let n = table.names.len() + 1;
    let room = ui.available_size() - vec2(NAMES[0] + 8.0, NAMES[1] + 8.0);
    let side = (room.x / n as f32).min(room.y / n as f32).clamp(LEAST_CELL, 64.0);
    let wide = (room.x / n as f32).clamp(side, 64.0);
    let size = vec2(NAMES[0] + wide * n as f32, NAMES[1] + side * n as f32);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let origin = rect.min + vec2(NAMES[0], NAMES[1]);
    let name = |i: usize| table.names.get(plumbline_model::ClassIndex(i)).unwrap_or("background").to_owned();
    let open = cx.view.scores.cell.as_ref().filter(|cell| cell.model == cx.state.scores.model);
    let open = open.map(|cell| cell.cell);
    let shares = cx.state.scores.shares;
    names(ui, rect, origin, (wide, side), n, &name);
    for row in 0..n {
        let sum: usize = scores.confusion[row].iter().sum();
        for column in 0..n {
            let count = scores.confusion[row][column];
            let of = |i: usize| (i + 1 < n).then_some(i);
            let cell = ConfusionCell { truth: of(row), found: of(column) };
            let at = origin + vec2(wide * column as f32, side * row as f32);
            let square = Rect::from_min_size(at, vec2(wide, side)).shrink(1.0);
            let share = if sum > 0 { count as f32 / sum as f32 } else { 0.0 };
            let text = match (count, shares) {
                (0, _) => String::new(),
                (_, true) => format!("{:.0} %", 100.0 * share),
                (_, false) => count.to_string(),
            };
            let what = match (row + 1 < n, column + 1 < n) {
                (true, true) if row == column => format!("{} found", name(row)),
                (true, true) => format!("{} taken for {}", name(row), name(column)),
                (true, false) => format!("{} missed", name(row)),
                (false, true) => format!("{} found where nothing is", name(column)),
                (false, false) => "nothing".to_owned(),
            };
            let label = format!("{what}: {count}");
            if one(ui, square, &label, &text, share, row == column, open == Some(cell), count > 0) {
                cx.outbox.send(ScoresCommand::OpenCell { model: cx.state.scores.model, cell });
            }
        }
    }
}

fn names(
    ui: &Ui,
    rect: Rect,
    origin: egui::Pos2,
    (wide, side): (f32, f32),
    n: usize,
    name: &dyn Fn(usize) -> String,
) {
    let tokens = theme::tokens(ui);
    let small = egui::TextStyle::Small.resolve(ui.style());
    let painter = ui.painter();
    painter.text(
        rect.left_top(),
        egui::Align2::LEFT_TOP,
        "it is ↓   found as →",
        small.clone(),
        tokens.text_weak,
    );
    for i in 0..n {
        let y = origin.y + side * (i as f32 + 0.5);
        let color = if i + 1 < n { tokens.text } else { tokens.text_weak };
        let text = if i + 1 < n { name(i) } else { "nothing there".to_owned() };
        painter.text(pos2(origin.x - 6.0, y), egui::Align2::RIGHT_CENTER, text, small.clone(), color);
        let text = if i + 1 < n { name(i) } else { "missed".to_owned() };
        let galley = painter.layout_no_wrap(text, small.clone(), color);
        // Slanted, so that long names fit over narrow columns.
        let at = pos2(origin.x + wide * (i as f32 + 0.5) - 3.0, origin.y - 6.0);
        let angle = -0.9f32;
        let up = vec2(angle.sin() * galley.size().y, -angle.cos() * galley.size().y);
        let shape = egui::epaint::TextShape::new(at + up, galley, color).with_angle(angle);
        painter.add(shape);
    }
}

#[allow(clippy::too_many_arguments, reason = "one cell in all its states")]
fn one(
    ui: &mut Ui,
    rect: Rect,
    label: &str,
    text: &str,
    share: f32,
    right: bool,
    open: bool,
    filled: bool,
) -> bool {
    let tokens = theme::tokens(ui);
    let sense = if filled { Sense::click() } else { Sense::hover() };
    let response = ui.interact(rect, ui.scope_id().with(label), sense);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, filled, label));
    let base = if right { tokens.accepted } else { tokens.difference };
    let fill = if filled {
        mix(tokens.raised, base, 0.15 + 0.75 * share)
    } else {
        tokens.raised.gamma_multiply(0.5)
    };
    ui.painter().rect_filled(rect, 2.0, fill);
    let small = egui::TextStyle::Small.resolve(ui.style());
    let luma = 0.3 * f32::from(fill.r()) + 0.59 * f32::from(fill.g()) + 0.11 * f32::from(fill.b());
    let ink = if luma > 130.0 { Color32::from_black_alpha(230) } else { Color32::from_white_alpha(235) };
    ui.painter().text(rect.center(), egui::Align2::CENTER_CENTER, text, small, ink);
    if open || filled && (response.hovered() || response.has_focus()) {
        let stroke = Stroke::new(if open { 2.0 } else { 1.0 }, tokens.accent);
        ui.painter().rect_stroke(rect, 2.0, stroke, StrokeKind::Inside);
    }
    response.on_hover_text(label).clicked()
}

fn mix(a: Color32, b: Color32, t: f32) -> Color32 {
    let of = |x: u8, y: u8| (f32::from(x) + (f32::from(y) - f32::from(x)) * t.clamp(0.0, 1.0)) as u8;
    Color32::from_rgb(of(a.r(), b.r()), of(a.g(), b.g()), of(a.b(), b.b()))
}
