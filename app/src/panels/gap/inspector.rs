//! What is known of the finding that is shown.

use egui::Ui;
use plumbline_engine::View;
use plumbline_widgets::key_value::{KeyValue, key_value_grid};
use plumbline_widgets::{format, theme};

use crate::operator::Outbox;
use crate::operator::words::clock;
use crate::operator::words::gap as words;
use crate::panels::PanelState;

/// What is known of the finding that is shown.
pub fn show(ui: &mut Ui, view: &View, _state: &mut PanelState, _outbox: &mut Outbox) {
    let Some(shown) = &view.gap.shown else {
        let text = "The gap is what model and measurement differ by. A finding is described here.";
        ui.label(theme::weak(ui, text));
        return;
    };
    let finding = &shown.finding;
    ui.label(theme::strong(ui, words::heading(finding)));
    let comparison = &finding.comparison;
    key_value_grid(
        ui,
        "finding",
        &[
            KeyValue::text("made", clock(shown.entry.made)),
            KeyValue::text("model", shown.entry.model.clone()),
            KeyValue::text("rows", comparison.rows.to_string()),
            KeyValue::text("distinct poses", comparison.cells.to_string())
                .help("Distinct commands, sides, heights and weights"),
            KeyValue::text("searched for", format::fixed(finding.seconds, 1)).unit("s"),
        ],
    );
    let held_out = &finding.shown;
    if held_out.rows > 0 {
        // Without an effect nothing was held out.
        theme::group_heading(ui, if finding.effects.is_empty() { "All rows" } else { "Held-out rows" });
        key_value_grid(
            ui,
            "held out",
            &[
                KeyValue::text("before", words::error(held_out, held_out.before)),
                KeyValue::text("after", words::error(held_out, held_out.after)),
                KeyValue::text(words::floor_name(finding), words::error(held_out, held_out.floor)),
            ],
        );
    }
    theme::group_heading(ui, "Sessions");
    for session in &finding.sessions {
        ui.label(theme::small(ui, session));
    }
    if !finding.version.is_empty() {
        ui.label(theme::small(ui, format!("Found by Plumbline {}.", finding.version)));
    }
}
