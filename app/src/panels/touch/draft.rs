//! The plan as it is being changed. Changes are planned by themselves as soon as nothing is held:
//! planning moves nothing.

use egui::Ui;
use plumbline_engine::TouchCommand;

use crate::operator::{Action, Preset, TouchAction};
use crate::panels::PanelContext;

/// Follows the engine, and plans what was changed once the mouse is let go.
pub fn keep_up(ui: &Ui, cx: &mut PanelContext<'_>) {
    let planned = cx.view.touch.plan.as_ref().map(|plan| &plan.options);
    let draft = &mut cx.state.touch.draft;
    draft.follow(planned);
    let held = ui.input(|input| input.pointer.any_down() || input.pointer.any_released());
    let possible = Action::Touch(TouchAction::Plan(Preset::First)).refusal(cx.view).is_none();
    if draft.changed
        && !held
        && possible
        && let Some(options) = &draft.options
    {
        cx.outbox.send(TouchCommand::Plan(options.clone()));
        draft.changed = false;
    }
}
