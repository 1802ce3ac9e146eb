//! The gap between model and measurement, in the order compare, find, name, add, show.

mod candidates;
mod compare;
mod drawn;
mod history;
mod inspector;
mod map;
mod names;
mod next;
mod parts;
mod points;
mod shown;
mod sizes;
pub mod state;

pub use inspector::show as show_inspector;

use egui::Ui;

use super::PanelContext;
use crate::operator::Pane;

/// Draws one of the panes of this step.
pub fn show(ui: &mut Ui, pane: Pane, cx: &mut PanelContext<'_>) {
    let id = cx.view.gap.shown.as_ref().map(|shown| shown.entry.id.clone()).unwrap_or_default();
    if cx.state.gap.of != id {
        cx.state.gap.of = id;
        cx.state.gap.covariate = None;
    }
    match pane {
        Pane::GapNames => names::show(ui, cx),
        Pane::GapCandidates => candidates::show(ui, cx),
        Pane::GapMap => map::show(ui, cx),
        Pane::GapShown => shown::show(ui, cx),
        Pane::GapNext => next::show(ui, cx),
        Pane::GapHistory => history::show(ui, cx),
        _ => compare::show(ui, cx),
    }
}
