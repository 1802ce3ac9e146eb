//! The inspector of grasping: gates, and the chosen attempt.

use egui::Ui;
use plumbline_engine::View;
use plumbline_engine::view::{AttemptView, GraspOutcome};
use plumbline_widgets::format;
use plumbline_widgets::key_value::{KeyValue, key_value_grid};
use plumbline_widgets::theme::{self, group_heading, space};

use crate::operator::Outbox;
use crate::operator::words::clock;
use crate::operator::words::grasp::{closed, method, result};
use crate::panels::{PanelState, show_gates};

pub fn show(ui: &mut Ui, view: &View, state: &PanelState, outbox: &mut Outbox) {
    group_heading(ui, "Before anything moves");
    show_gates(ui, &view.grasp.gates, view, outbox);
    let chosen = state.grasp.chosen.as_ref();
    let mut attempts = view.grasp.attempts.iter();
    let shown = match chosen {
        Some(name) => attempts.find(|attempt| attempt.name == *name),
        None => attempts.next(),
    };
    let Some(attempt) = shown else { return };
    group_heading(ui, if chosen.is_some() { "Chosen attempt" } else { "Newest attempt" });
    key_value_grid(ui, "attempt", &rows(attempt));
    if let Some(GraspOutcome::Failed { why, .. } | GraspOutcome::Refused { why }) = &attempt.outcome {
        ui.label(theme::small(ui, closed(why)));
    }
    ui.add_space(space::XS);
    ui.label(theme::small(ui, format!("Sent by the robot {}.", attempt.model)))
        .on_hover_text("The model of the robot that the arm was sent by");
    ui.label(theme::small(ui, format!("Kept as {}", attempt.name)))
        .on_hover_text(attempt.folder.display().to_string());
}

fn rows(attempt: &AttemptView) -> Vec<KeyValue> {
    let mut rows = vec![
        KeyValue::text("When", clock(attempt.began)),
        KeyValue::text("Method", method(attempt.method)),
        KeyValue::text("Hand", attempt.hand.name()),
        KeyValue::text("Object", attempt.object.to_lowercase()),
        KeyValue::text("Result", result(attempt)),
    ];
    if let Some(step) = attempt.reached.filter(|_| attempt.outcome != Some(GraspOutcome::Success)) {
        rows.push(KeyValue::text("Came to", step.title()));
    }
    if let Some(alignment_m) = attempt.alignment_m {
        rows.push(KeyValue::text("Hand beside", format::mm(alignment_m)).help("At the last look"));
    }
    if let Some(seconds) = attempt.seconds {
        rows.push(KeyValue::text("Lifted after", format::fixed(seconds, 1)).unit("s"));
    }
    rows
}
