//! All points, the one that the others miss by most first.

use std::collections::HashMap;

use egui::{Align2, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};
use plumbline_widgets::steady;
use plumbline_widgets::theme::{self, Role};

use super::panel::quantity;
use super::points::label;
use super::rows::PointRow;
use crate::panels::PanelContext;

const ROW_HEIGHT: f32 = 20.0;
const HEIGHT: f32 = 150.0;

pub(super) fn show(ui: &mut Ui, cx: &mut PanelContext<'_>, rows: &[PointRow]) {
    ui.label(theme::strong(ui, "Worst first"));
    if rows.is_empty() {
        ui.label(theme::small(ui, "No points."));
        return;
    }
    let mut sorted: Vec<&PointRow> = rows.iter().collect();
    let magnitude = |row: &PointRow| row.error.map_or(-1.0, f64::abs);
    sorted.sort_by(|a, b| magnitude(b).total_cmp(&magnitude(a)));
    let list = ui.scope_id().with(("worst first", cx.state.models.tables.table));
    let order = steady::in_order(ui, list, sorted.iter().map(|row| row.index).collect(), ());
    let by_index: HashMap<_, _> = rows.iter().map(|row| (row.index, row)).collect();
    let sorted: Vec<&PointRow> = order.iter().filter_map(|index| by_index.get(index).copied()).collect();
    let area =
        ScrollArea::vertical().id_salt("points by error").max_height(HEIGHT).auto_shrink([false, true]);
    let shown = area.show_rows(ui, ROW_HEIGHT, sorted.len(), |ui, visible| {
        ui.spacing_mut().item_spacing.y = 0.0;
        for row in &sorted[visible] {
            show_row(ui, cx, row);
        }
    });
    steady::keep(ui, list, order, shown.inner_rect);
}

fn show_row(ui: &mut Ui, cx: &mut PanelContext<'_>, row: &PointRow) {
    let panel = &mut cx.state.models.tables;
    let chosen = panel.chosen == Some(row.index);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW_HEIGHT), Sense::click());
    let words = format!("Row of {}", label(row, panel.table).replace("Point", "point"));
    response.widget_info(|| WidgetInfo::selected(egui::Role::Button, true, chosen, &words));
    let tokens = theme::tokens(ui);
    if chosen || response.hovered() {
        let fill = if chosen { tokens.selected } else { tokens.raised };
        ui.painter().rect_filled(rect, 3.0, fill);
    }
    if response.has_focus() {
        let ring = egui::Stroke::new(1.5, tokens.accent);
        ui.painter().rect_stroke(rect, 3.0, ring, egui::StrokeKind::Inside);
    }
    let quantity = quantity(panel.table);
    let text = |x: f32, anchor: Align2, text: String, color| {
        let font = TextStyle::Body.resolve(ui.style());
        ui.painter().text(pos2(x, rect.center().y), anchor, text, font, color);
    };
    let middle = rect.left() + 0.55 * rect.width();
    text(rect.left() + 4.0, Align2::LEFT_CENTER, format!("{}", row.index + 1), tokens.text_weak);
    text(middle, Align2::RIGHT_CENTER, quantity.text(row.value), tokens.text);
    let error = quantity.text_or_none(row.error);
    text(rect.right() - 8.0, Align2::RIGHT_CENTER, error, Role::Difference.color(tokens));
    if response.clicked() {
        panel.chosen = Some(row.index);
        panel.draft = None;
    }
}
