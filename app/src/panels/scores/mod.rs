//! Judging detectors on a labeled data set: choosing, the table, each class, what was taken for what.

mod cell;
mod choice;
mod classes;
mod confusion;
mod inspector;
mod parts;
pub mod state;
mod table;

pub use inspector::show as show_inspector;

use egui::Ui;

use super::{PanelContext, padded};
use crate::operator::Pane;

/// Draws one of the panes of this screen.
pub fn show(ui: &mut Ui, pane: Pane, cx: &mut PanelContext<'_>) {
    if let Some(table) = &cx.view.scores.table {
        cx.state.scores.model = cx.state.scores.model.min(table.rows.len().saturating_sub(1));
    }
    match pane {
        Pane::ScoreTable => padded(ui, |ui| table::show(ui, cx)),
        Pane::ScoreClasses => padded(ui, |ui| classes::show(ui, cx)),
        Pane::ScoreConfusion => padded(ui, |ui| confusion::show(ui, cx)),
        Pane::ScoreCell => cell::show(ui, cx),
        _ => padded(ui, |ui| choice::show(ui, cx)),
    }
}
