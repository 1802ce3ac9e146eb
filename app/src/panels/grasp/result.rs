//! What became of the attempt, large and plain, and what the operator saw of it.

use egui::{RichText, TextStyle, Ui};
use plumbline_engine::view::{GraspOutcome, GraspPhase, GraspRun, SinceHeld, is_halted, is_unseen};
use plumbline_widgets::format;
use plumbline_widgets::theme::{self, Role, space};

use crate::operator::GraspAction;
use crate::operator::words::grasp::{closed, held_now};
use crate::panels::PanelContext;
use crate::panels::parts::chosen_button;

pub fn show(ui: &mut Ui, cx: &mut PanelContext<'_>, run: &GraspRun) {
    let Some(outcome) = run.outcome.as_ref().filter(|_| cx.view.grasp.phase == GraspPhase::Idle) else {
        return;
    };
    // A plan that could not be made is told below, and is no result of a grasp.
    if run.name.is_empty() {
        if let GraspOutcome::Failed { why, .. } | GraspOutcome::Refused { why } = outcome {
            crate::panels::parts::warning(ui, &closed(why));
        }
        return;
    }
    let object = run.object.to_lowercase();
    let (role, text, why) = match (run.told, outcome) {
        // Whatever was said of it before.
        (Some(true) | None, GraspOutcome::Success) if matches!(run.since, SinceHeld::Slipped(_)) => {
            (Role::Warning, held_now(run), None)
        }
        (Some(true), _) => (Role::Accepted, format!("The {object} was held, as you said."), None),
        (Some(false), _) => (Role::Warning, format!("The {object} was not held, as you said."), None),
        (None, GraspOutcome::Success) => (Role::Accepted, held_now(run), None),
        (None, GraspOutcome::Failed { why, .. }) if is_halted(outcome) => {
            (Role::Warning, "Broken off.".to_owned(), Some(why))
        }
        (None, GraspOutcome::Failed { why, .. }) if is_unseen(outcome) => {
            (Role::Warning, "Not grasped.".to_owned(), Some(why))
        }
        (None, GraspOutcome::Failed { why, .. }) => (Role::Warning, "Not held.".to_owned(), Some(why)),
        (None, GraspOutcome::Refused { why }) => (Role::Warning, "Not grasped.".to_owned(), Some(why)),
    };
    let color = role.color(theme::tokens(ui));
    ui.label(RichText::new(text).text_style(TextStyle::Heading).color(color));
    if let Some(why) = why {
        ui.label(closed(why));
    }
    let mut facts = vec![];
    if let Some(open_rad) = run.fingers_open_rad {
        facts.push(format!("fingers kept open by {}", format::degrees(open_rad)));
    }
    if let Some(seconds) = run.seconds {
        facts.push(format!("lifted after {} s", format::fixed(seconds, 0)));
    }
    if !facts.is_empty() {
        ui.label(theme::small(ui, closed(&facts.join(", "))));
    }
    // What was never lifted was not held: nobody has to say so.
    let never_lifted = is_halted(outcome) && run.seconds.is_none();
    if matches!(outcome, GraspOutcome::Refused { .. }) || is_unseen(outcome) || never_lifted {
        return;
    }
    ui.add_space(space::XS);
    ui.horizontal(|ui| {
        ui.label(theme::weak(ui, "What did you see?"));
        // The answer stays marked, and can be changed.
        chosen_button(ui, cx, GraspAction::Held, "Held", run.told == Some(true));
        chosen_button(ui, cx, GraspAction::NotHeld, "Not held", run.told == Some(false));
    });
}
