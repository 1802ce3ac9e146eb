//! Whether places stay where they are: curves over time, and arrows over the table.

mod chart;
mod course;
mod explain;
mod grid;
mod grid_map;
mod inspector;
mod table;

pub use course::show as show_course;
pub use grid::show as show_grid;
pub use inspector::show as show_inspector;
pub use table::show as show_table;

use egui::Ui;
use plumbline_engine::View;
use plumbline_widgets::empty::{EmptyState, Message};

/// What stands where there is no course to draw.
fn nothing_yet(ui: &mut Ui, view: &View) {
    let drift = &view.drift;
    match (&drift.failed, drift.is_watching) {
        (Some(why), true) => EmptyState::failed(Message::new("Nothing could be made of the pairs", why)).show(ui),
        (None, true) => {
            let why = drift.waits_because.as_deref().unwrap_or("Looks for the first time.");
            EmptyState::loading(why).show(ui)
        }
        (_, false) => EmptyState::empty(Message::new(
            "Not watched yet",
            "Start watching, at the bottom: now and then a pair is looked at, and these curves say how far places wander.",
        ))
        .show(ui),
    };
}
