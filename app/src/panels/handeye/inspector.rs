//! The inspector of tying the arms to the eyes: what is looked at before anything moves.

use egui::Ui;
use plumbline_engine::View;
use plumbline_widgets::theme::{self, group_heading};

use crate::operator::Outbox;
use crate::panels::show_gates;

pub fn show(ui: &mut Ui, view: &View, outbox: &mut Outbox) {
    group_heading(ui, "Before anything moves");
    show_gates(ui, &view.handeye.gates, view, outbox);
    group_heading(ui, "What it is good for");
    ui.label(theme::small(
        ui,
        "The model in use then says where a hand is in what the eyes see. Grasping (by the method M5) goes by it; places and moves use it, too.",
    ));
    ui.label(theme::small(ui, "Taken back like any step of the model: Gap, History."));
}
