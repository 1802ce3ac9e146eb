//! Correction models: training, comparison, maps, and the tables of grasp height and yaw.

use egui::Ui;
use plumbline_engine::View;
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::theme;

use super::{PanelContext, PanelState};
use crate::window::{Outbox, Pane};

/// How models are looked at: kept from frame to frame, never saved.
#[derive(Clone, Debug, Default)]
pub struct ModelsPanels {}

/// Draws one of the panes of this step.
pub fn show(ui: &mut Ui, _pane: Pane, _cx: &mut PanelContext<'_>) {
    EmptyState::empty(Message::new("No model yet", "Touch the screen first; models learn from touches."))
        .show(ui);
}

/// What is known of the model that is shown.
pub fn show_inspector(ui: &mut Ui, _view: &View, _state: &mut PanelState, _outbox: &mut Outbox) {
    ui.label(theme::weak(ui, "Models learn from touches."));
}
