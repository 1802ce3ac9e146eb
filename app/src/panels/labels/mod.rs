//! The lab's own data sets: the list of images, the image with its boxes, what is wrong.

mod canvas;
mod checks;
mod gallery;
mod inspector;
mod list;
mod parts;
pub mod state;

pub use inspector::show as show_inspector;

use egui::Ui;
use plumbline_widgets::empty::{EmptyState, Message};

use super::{PanelContext, padded};
use crate::operator::{Action, LabelsAction, Pane};

/// Draws one of the panes of this screen.
pub fn show(ui: &mut Ui, pane: Pane, cx: &mut PanelContext<'_>) {
    cx.state.labels.follow(&cx.view.labels);
    if cx.view.labels.set.is_none() {
        return match pane {
            Pane::LabelCanvas => no_set(ui, cx),
            Pane::LabelList => padded(ui, |ui| list::without_set(ui, cx)),
            _ => {}
        };
    }
    match pane {
        Pane::LabelList => padded(ui, |ui| list::show(ui, cx)),
        Pane::LabelGallery => gallery::show(ui, cx),
        Pane::LabelChecks => padded(ui, |ui| checks::show(ui, cx)),
        _ => canvas::show(ui, cx),
    }
}

/// What there is to do without a data set.
fn no_set(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let labels = &cx.view.labels;
    if labels.working.is_some() {
        EmptyState::loading("Reading the data set.").show(ui);
        return;
    }
    if let Some(why) = &labels.failed {
        let message = Message::new("The data set could not be opened", why).button("Open a data set…");
        if EmptyState::failed(message).show(ui) {
            cx.outbox.act(Action::Labels(LabelsAction::Open));
        }
        return;
    }
    let message = Message::new(
        "Teach a detector what your eyes see",
        "Open a data set in the YOLO layout, drop its folder here, or make a new one and capture pairs into it.",
    );
    if EmptyState::empty(message.button("Open a data set…")).show(ui) {
        cx.outbox.act(Action::Labels(LabelsAction::Open));
    }
}
