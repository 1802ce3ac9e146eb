//! Touching the screen: planning, the map of touches, the run, the place of the screen.

use egui::Ui;
use plumbline_engine::View;
use plumbline_widgets::theme;

use super::{PanelContext, PanelState};
use crate::window::Outbox;

/// How touching is looked at: kept from frame to frame, never saved.
#[derive(Clone, Debug, Default)]
pub struct TouchPanels {}

pub fn show_plan(ui: &mut Ui, _cx: &mut PanelContext<'_>) {
    ui.label(theme::weak(ui, "Nothing is planned."));
}

pub fn show_map(ui: &mut Ui, _cx: &mut PanelContext<'_>) {
    ui.label(theme::weak(ui, "Nothing is planned."));
}

pub fn show_run(ui: &mut Ui, _cx: &mut PanelContext<'_>) {
    ui.label(theme::weak(ui, "Nothing is planned."));
}

pub fn show_place(ui: &mut Ui, _cx: &mut PanelContext<'_>) {
    ui.label(theme::weak(ui, "Nothing is planned."));
}

/// What is known of the touch that is chosen.
pub fn show_inspector(ui: &mut Ui, _view: &View, _state: &mut PanelState, _outbox: &mut Outbox) {
    ui.label(theme::weak(ui, "Click a touch to see its numbers."));
}
