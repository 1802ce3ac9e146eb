//! The chosen point in numbers.

use egui::{DragValue, Grid, Ui};
use plumbline_engine::{GraspTable, ModelsCommand, TablesCommand};
use plumbline_widgets::format::{self, Quantity};
use plumbline_widgets::theme::{self, space};

use super::panel::quantity;
use super::rows::PointRow;
use crate::panels::PanelContext;

pub(super) fn show(ui: &mut Ui, cx: &mut PanelContext<'_>, rows: &[PointRow]) {
    let panel = &cx.state.models.tables;
    let table = panel.table;
    let Some(row) = panel.chosen.and_then(|point| rows.get(point)) else {
        ui.label(theme::strong(ui, "No point chosen"));
        ui.label(theme::small(
            ui,
            "Click a point to change its numbers; drag it, or push it with the arrow keys.",
        ));
        return;
    };
    ui.label(theme::strong(ui, format!("Point {} of {}", row.index + 1, rows.len())));
    let mut draft = panel.draft.filter(|draft| draft.index == row.index).unwrap_or(*row);
    let mut done = false;
    Grid::new("chosen point").num_columns(2).spacing([space::S, space::XS]).show(ui, |ui| {
        let axes = if table == GraspTable::Yaw { 3 } else { 2 };
        let names = ["x, forward", "y, left", "z, up"];
        for (name, value) in names.into_iter().zip(&mut draft.at_m).take(axes) {
            done |= field(ui, name, value, Quantity::Length);
        }
        let name = if table == GraspTable::Height { "grasp height" } else { "yaw" };
        done |= field(ui, name, &mut draft.value, quantity(table));
    });
    if let Some(error) = row.error {
        let text = format!("Left out, the others miss it by {}.", quantity(table).text(error));
        ui.label(theme::small(ui, text));
    }
    let changed = (draft.at_m, draft.value) != (row.at_m, row.value);
    cx.state.models.tables.draft = (changed && !done).then_some(draft);
    if changed && done {
        cx.outbox.send(ModelsCommand::Tables(TablesCommand::Change {
            table,
            point: row.index,
            at_m: draft.at_m,
            value: draft.value,
        }));
    }
}

/// One number in its unit on screen; `true` when the operator is done with it.
fn field(ui: &mut Ui, name: &str, si: &mut f64, quantity: Quantity) -> bool {
    let unit = quantity.on_screen(1.0);
    let label = ui.label(theme::weak(ui, name));
    let mut shown = quantity.on_screen(*si);
    let suffix = if quantity == Quantity::Angle { "°".to_owned() } else { format!(" {}", quantity.unit()) };
    let number = DragValue::new(&mut shown)
        .speed(0.2)
        .suffix(suffix)
        .update_while_editing(false)
        .custom_formatter(|value, _| format::fixed(value, 1))
        .custom_parser(parse);
    let response = ui.add_sized([96.0, ui.spacing().interact_size.y], number).labelled_by(label.id);
    ui.end_row();
    if response.changed() {
        *si = shown / unit;
    }
    // While it is dragged it changes all the time: only the end is sent.
    response.drag_stopped() || (response.changed() && !response.dragged()) || response.lost_focus()
}

/// With a comma too, and with the minus sign that the formats write.
fn parse(text: &str) -> Option<f64> {
    let text = text.trim().trim_end_matches("mm").trim_end_matches('°').trim();
    text.replace('−', "-").replace(',', ".").parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_they_are_written() {
        for (text, value) in [("12.5", 12.5), ("−3,25 mm", -3.25), ("-4.0°", -4.0), (" 7 ", 7.0)] {
            assert_eq!(parse(text), Some(value), "{text}");
        }
        for text in ["", "soon", "nan", "inf"] {
            assert_eq!(parse(text), None, "{text}");
        }
    }
}
