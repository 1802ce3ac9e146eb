//! How touching is looked at.

use plumbline_model::touch_plan::{PlanOptions, TouchArea};

use crate::operator::Monitor;

/// How touching is looked at: kept from frame to frame, never saved.
#[derive(Clone, Debug, Default)]
pub struct TouchPanels {
    /// The plan as it is being changed.
    pub(crate) draft: Draft,
    /// The touch that the inspector speaks of, by number.
    pub(crate) chosen: Option<usize>,
    /// The map shows the table rather than the screen.
    pub(crate) on_table: bool,
    /// The operator was asked whether to finish early.
    pub(crate) finishing: bool,
    /// Monitors of this machine.
    pub monitors: Vec<Monitor>,
    /// The monitor that the touch window opens on, by its place among them; `None`: a window.
    pub monitor: Option<usize>,
    /// Whether the monitor was chosen by the operator.
    pub monitor_chosen: bool,
    /// Whether the touch window is open.
    pub window_open: bool,
}

/// The options as the operator has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Draft {
    pub(crate) options: Option<PlanOptions>,
    /// The engine's options that the draft began with.
    pub(crate) from: Option<PlanOptions>,
    /// Whether it has to be planned.
    pub(crate) changed: bool,
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
    pub(super) fn follow(&mut self, planned: Option<&PlanOptions>) {
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
