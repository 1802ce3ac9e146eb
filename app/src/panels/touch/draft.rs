//! The plan as it is being changed. Changes are planned by themselves as soon as nothing is held:
//! planning moves nothing.

use egui::Ui;
use plumbline_engine::TouchCommand;
use plumbline_model::touch_plan::{PlanOptions, TouchArea};

use crate::operator::{Action, Preset, TouchAction};
use crate::panels::PanelContext;

/// The options as the operator has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Draft {
    options: Option<PlanOptions>,
    /// The engine's options that the draft began with.
    from: Option<PlanOptions>,
    /// Whether it has to be planned.
    changed: bool,
    /// Lists of numbers while they are typed: heights, weights.
    pub typed: [Option<String>; 2],
}

impl Draft {
    /// What stands in the fields.
    pub fn options(&self) -> Option<&PlanOptions> {
        self.options.as_ref()
    }

    /// Whether what stands in the fields is not what was planned.
    pub fn is_ahead(&self) -> bool {
        self.changed || (self.options.is_some() && self.options != self.from)
    }

    /// Follows the engine when it has planned something else.
    fn follow(&mut self, planned: Option<&PlanOptions>) {
        if self.from.as_ref() == planned {
            return;
        }
        self.from = planned.cloned();
        if !self.changed {
            self.options = planned.cloned();
            self.typed = Default::default();
        }
    }

    /// Changes what stands in the fields.
    pub fn change(&mut self, options: PlanOptions) {
        if self.options.as_ref() != Some(&options) {
            self.options = Some(options);
            self.changed = true;
        }
    }

    /// Drags the area.
    pub fn change_area(&mut self, area: TouchArea) {
        if let Some(options) = &self.options {
            self.change(PlanOptions { area, ..options.clone() });
        }
    }
}

/// Follows the engine, and plans what was changed once the mouse is let go.
pub fn keep_up(ui: &Ui, cx: &mut PanelContext<'_>) {
    let planned = cx.view.touch.plan.as_ref().map(|plan| &plan.options);
    let draft = &mut cx.state.touch.draft;
    draft.follow(planned);
    let held = ui.input(|input| input.pointer.any_down());
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

#[cfg(test)]
mod tests {
    use super::*;

    fn options(columns: f64) -> PlanOptions {
        PlanOptions::first(TouchArea { u_px: [0.0, columns], v_px: [0.0, 100.0] })
    }

    #[test]
    fn what_is_being_changed_is_not_overwritten_by_an_older_plan() {
        let mut draft = Draft::default();
        draft.follow(Some(&options(100.0)));
        assert_eq!(draft.options(), Some(&options(100.0)));
        draft.change(options(200.0));
        draft.follow(Some(&options(150.0)));
        assert_eq!(draft.options(), Some(&options(200.0)));
        assert!(draft.is_ahead());
        draft.changed = false;
        draft.follow(Some(&options(200.0)));
        assert!(!draft.is_ahead());
    }

    #[test]
    fn a_closed_run_clears_the_fields() {
        let mut draft = Draft::default();
        draft.follow(Some(&options(100.0)));
        draft.follow(None);
        assert_eq!(draft.options(), None);
    }
}
