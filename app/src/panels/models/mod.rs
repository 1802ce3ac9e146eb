//! Correction models: training, comparison, maps, and the tables of grasp height and yaw.

mod comparison;
mod drawn;
mod inspector;
mod map;
mod parts;
mod sessions;
pub mod state;
mod tables;
mod training;
mod verdict;

pub use inspector::show as show_inspector;

use egui::Ui;

use super::PanelContext;
use crate::operator::Pane;

/// Draws one of the panes of this step.
pub fn show(ui: &mut Ui, pane: Pane, cx: &mut PanelContext<'_>) {
    match pane {
        Pane::ModelComparison => comparison::show(ui, cx),
        Pane::ModelMap => map::show(ui, cx),
        Pane::GraspTables => tables::show(ui, cx),
        _ => training::show(ui, cx),
    }
}
