//! What several panels are put together of.

use egui::{Button, Response, RichText, Ui, WidgetInfo};
use plumbline_engine::view::{JobState, Subject};
use plumbline_engine::{JobId, View};
use plumbline_widgets::theme::{self, Role};

use super::PanelContext;
use crate::operator::Action;
use crate::operator::actions::undo::of_result;
use crate::operator::words::capitalized;

/// A button of an action, with its reason where it cannot be pressed.
pub fn action_button(
    ui: &mut Ui,
    cx: &mut PanelContext<'_>,
    action: impl Into<Action>,
    text: &str,
) -> Response {
    chosen_button(ui, cx, action, text, false)
}

/// The same of one among several answers, marked where it is the one that was given.
pub fn chosen_button(
    ui: &mut Ui,
    cx: &mut PanelContext<'_>,
    action: impl Into<Action>,
    text: &str,
    is_chosen: bool,
) -> Response {
    let action = action.into();
    let why = action.refusal(cx.view);
    let button = Button::new(text).selected(is_chosen);
    let button = ui.add_enabled(why.is_none(), button).on_hover_text(action.label());
    let button = button.on_disabled_hover_text(why.unwrap_or_default());
    if button.clicked() {
        cx.outbox.act(action);
    }
    button
}

/// Undo of what is in use of a kind, as at the foot of the inspector: the same word, and the same is said of it. Not
/// drawn where there is nothing to take back.
pub fn undo_button(ui: &mut Ui, cx: &mut PanelContext<'_>, subject: Subject) {
    let Ok(undo) = of_result(cx.view, subject) else { return };
    let button = ui.add(Button::new("Undo"));
    // Each says which one it is of to whoever does not see what stands beside it.
    button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, format!("Undo: {}", undo.what)));
    if button.on_hover_text(capitalized(&undo.help())).clicked() {
        cx.outbox.send(undo.command);
    }
}

/// A sentence that warns.
pub fn warning(ui: &mut Ui, text: &str) {
    let color = Role::Warning.color(theme::tokens(ui));
    ui.label(RichText::new(capitalized(text)).color(color));
}

/// How far a job is and what it does just now; `None` where none runs.
pub fn progress(view: &View, job: Option<JobId>) -> Option<(f64, String)> {
    let job = view.jobs.iter().find(|known| Some(known.id) == job)?;
    match &job.state {
        JobState::Running { fraction, doing, .. } => Some((*fraction, doing.clone())),
        _ => None,
    }
}
