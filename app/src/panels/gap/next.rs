//! What to measure next.

use egui::{ScrollArea, Ui};
use plumbline_widgets::empty::{EmptyState, Message};
use plumbline_widgets::format;
use plumbline_widgets::probability::{ShareRow, probability_bar, share_rows};
use plumbline_widgets::theme::{self, Role, space};

use super::parts::finding;
use crate::operator::snapshot::gap::Verdict;
use crate::operator::words::capitalized;
use crate::operator::words::gap::touch_label;
use crate::operator::{GapAction, gap_plan};
use crate::panels::parts::action_button;
use crate::panels::{PanelContext, padded};

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>) {
    let what = "A finding says which experiment would tell most.";
    let Some(shown) = finding(ui, cx, what) else { return };
    let Some(next) = &shown.finding.next else {
        if shown.finding.verdict == Verdict::NoGap && !shown.finding.is_all_clear() {
            let text = "The noise is not known: repeat one pose a few times, each time from the same side, and look again.";
            EmptyState::empty(Message::new("Repeat some poses", text)).show(ui);
            return;
        }
        let (what, text) = match shown.finding.verdict {
            Verdict::NoGap => {
                ("No experiment is needed", "Model and measurement agree; there is nothing to tell apart.")
            }
            _ if shown.finding.many.is_some() => (
                "No experiment is worth its time",
                "So much is a little off at once that none of them would tell every name. What was found can be added \
                 and proven all the same.",
            ),
            _ => {
                ("No experiment is needed", "Nothing is left to tell apart with the experiments of the menu.")
            }
        };
        EmptyState::empty(Message::new(what, text)).show(ui);
        return;
    };
    padded(ui, |ui| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            ui.label(theme::strong(ui, capitalized(&next.what)));
            ui.label(&next.why);
            let minutes = format::significant(next.minutes, 2);
            ui.label(theme::weak(
                ui,
                format!("{}, about {minutes} min.", format::count(next.count, "measurement")),
            ));
            ui.add_space(space::XS);
            ui.label(theme::small(ui, "How likely its first name is the right one after it"));
            probability_bar(ui, "After the experiment", next.expected_probability, Role::Predicted);
            ui.add_space(space::S);
            if gap_plan(cx.view).is_some() {
                action_button(ui, cx, GapAction::NextExperiment, &touch_label(cx.view));
                ui.label(theme::small(
                    ui,
                    "Opens step 3, Touch, with this plan. Nothing moves before you start it there.",
                ));
            } else {
                ui.label(theme::small(
                    ui,
                    "This experiment is not touched by the wizard: do it by hand, then open its session.",
                ));
            }
            if !next.others.is_empty() {
                theme::group_heading(ui, "Others");
                let rows: Vec<ShareRow> = next
                    .others
                    .iter()
                    .map(|(what, probability, minutes)| ShareRow {
                        name: what.clone(),
                        share: *probability,
                        note: format!("{} min", format::significant(*minutes, 2)),
                        role: Role::Weak,
                    })
                    .collect();
                share_rows(ui, &rows);
            }
        });
    });
}
