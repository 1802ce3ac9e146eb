//! What was watched, explained by name and corrected: one strip above the curves.

use egui::{RichText, Ui};
use plumbline_engine::View;
use plumbline_engine::view::{ShownFinding, Subject};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::{Action, GapAction};
use crate::panels::PanelContext;
use crate::panels::parts::{action_button, undo_button};

/// The finding of what was watched, where it is the one that is shown.
fn finding(view: &View) -> Option<&ShownFinding> {
    let log = view.drift.log.as_ref()?;
    let shown = view.gap.shown.as_deref()?;
    (shown.folders.as_slice() == std::slice::from_ref(log)).then_some(shown)
}

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let view = cx.view;
    if view.drift.is_busy || view.gap.searching.is_some() && view.drift.log.is_some() {
        ui.horizontal(|ui| {
            ui.spinner();
            ui.label("What was watched is being worked at.");
        });
        return;
    }
    let found = finding(view);
    if let Some(found) = found {
        ui.label(RichText::new(&found.finding.sentence).color(theme::tokens(ui).text_strong));
        if found.added.iter().any(|added| *added) {
            let text = "It is in the model: places are corrected from now on, by the time since the cameras were \
                switched on. The curves show what is left.";
            ui.label(RichText::new(text).color(Role::Predicted.color(theme::tokens(ui))));
        }
    } else if let (Some(_), Some(why)) = (&view.drift.log, &view.gap.failed) {
        ui.label(RichText::new(why).color(Role::Warning.color(theme::tokens(ui))));
    }
    if let Some(stated_m) = view.drift.stated_m {
        ui.label(theme::small(ui, stated(stated_m)));
    }
    ui.horizontal_wrapped(|ui| {
        if found.is_some_and(|found| !found.addable().is_empty()) {
            action_button(ui, cx, GapAction::Add, "Correct from now on");
        }
        if found.is_some_and(|found| found.added.iter().any(|added| *added)) {
            undo_button(ui, cx, Subject::Effects);
        }
        let text = if found.is_some() { "Explain anew" } else { "Explain" };
        action_button(ui, cx, Action::ExplainDrift, text);
    });
    ui.add_space(space::XS);
}

/// How well places are known with the correction, as it says itself.
fn stated(half_m: [f64; 3]) -> String {
    let [near, middle, far] = half_m.map(format::whole_mm);
    format!(
        "With the correction by time 95 % of places are stated to lie within {near} near, {middle} in the middle, {far} far \
         of where they come out."
    )
}
