//! What to do next with correction models: one button, named by what it does.

use plumbline_engine::view::{Figure, StepState, Subject};
use plumbline_engine::{Correction, View};
use plumbline_widgets::format;

use super::onward::to_grasping;
use super::sentence::{Guidance, say};
use super::standing::{Standing, no_better, standing};
use crate::operator::actions::too_few;
use crate::operator::snapshot::models::{FEWEST_FOR_A_NETWORK, Method};
use crate::operator::{Action, ModelsAction, Screen};

pub(super) fn models(view: &View) -> Guidance {
    let models = &view.models;
    match standing(models) {
        Standing::NothingTouched => say("Models learn from touches. Touch the screen first (step 3).")
            .then("Go to Touch", Action::Go(Screen::Touch)),
        Standing::NotChosen if models.session.is_some() => say(next_or(view, "The touches are being read.")),
        Standing::NotChosen => say(next_or(view, "Choose the session of touches to learn from."))
            .then("Go to Touch", Action::Go(Screen::Touch)),
        Standing::Unusable(why) => say(why).warn().then("Go to Touch", Action::Go(Screen::Touch)),
        Standing::Recorded(count) if count < FEWEST_FOR_A_NETWORK && is_without_need(view) => {
            to_grasping(view, &format!("{NO_NEED}; {}.", too_few(count)))
        }
        Standing::Recorded(count) if count < FEWEST_FOR_A_NETWORK => {
            say(format!("{}.", too_few(count))).then("Go to Touch", Action::Go(Screen::Touch))
        }
        Standing::Recorded(count) => {
            let touches = format::count(count, "touch");
            let said = match is_without_need(view) {
                true => format!("{NO_NEED}. They can be trained on {touches} all the same. Nothing moves."),
                false => format!("{touches} are recorded. Next: train models on them. Nothing moves."),
            };
            say(said)
                .then(format!("Train M1, M2 and M3 on {touches}"), Action::Models(ModelsAction::TrainAll))
        }
        Standing::Training => say("The models are being trained; nothing is used before you accept it."),
        Standing::Proposed(method, error_m) => proposed(view, method, error_m),
        Standing::InUse(method) => in_use(view, method),
    }
}

/// What the effects of the gap do, these models do in another way.
const NO_NEED: &str = "With the effects in use no model is needed";

/// Whether named effects correct the arm by now.
fn is_without_need(view: &View) -> bool {
    view.gap.step == StepState::Done && !view.gap.model.effects.is_empty()
}

fn proposed(view: &View, method: Method, error_m: Option<f64>) -> Guidance {
    let name = method.name();
    if let Some((error_m, (without_m, is_worse))) = error_m.zip(no_better(&view.models, method)) {
        let why = match is_worse {
            true => "it makes things worse. Look for a named cause.",
            false => "these touches do not tell that it helps. More of them may, or a named cause.",
        };
        let said = format!(
            "{name} misses by {} on touches that it had not seen, and without a model it is {}: {why}",
            format::mm(error_m),
            format::mm(without_m)
        );
        return say(said).warn().then("Go to Gap", Action::Go(Screen::Gap));
    }
    let said = match error_m {
        Some(error_m) => format!(
            "{name} is the one to use: {} on touches that it had not seen. Look at its map, then use it.",
            format::mm(error_m)
        ),
        None => format!("{name} was imported. How well it fits this robot is not known: check it after use."),
    };
    say(said).then(format!("Use {name}"), Action::Models(ModelsAction::Accept(method)))
}

fn in_use(view: &View, method: Method) -> Guidance {
    let name = method.name();
    if let StepState::Stale { why } = &view.models.step {
        let guidance = say(why.clone()).warn();
        // Training again helps where there are touches.
        return match &view.models.data {
            Some(Ok(data)) => guidance.then(
                format!("Train M1, M2 and M3 on {}", format::count(data.len(), "touch")),
                Action::Models(ModelsAction::TrainAll),
            ),
            _ => guidance.then("Go to Touch", Action::Go(Screen::Touch)),
        };
    }
    let waits = view.touch.correct_with == Some(Correction::Effects);
    if let Some(checked) = checked(view, method).filter(|_| !waits) {
        return checked;
    }
    // A model that is in use waits while targets go by something else.
    let said = if waits {
        format!(
            "{name} is in use, but targets are corrected by the named effects now (Touch, Targets corrected by). Checking {name} goes by {name}. Nothing moves yet."
        )
    } else {
        next_or(view, &format!("{name} is in use. Next: check it with new touches. Nothing moves yet."))
    };
    say(said).then(format!("Check {name} with new touches"), Action::Models(ModelsAction::Check))
}

/// What came of the newest check of the model, made since it is in use.
fn checked(view: &View, method: Method) -> Option<Guidance> {
    let timeline = &view.timeline;
    let since = timeline.in_use.iter().find(|now| now.subject == Subject::Correction)?.since?;
    let of_it = format!("corrected with {}", method.name());
    let mut newest = timeline.entries.iter().rev().filter(|entry| entry.subject == Subject::Check);
    let check = newest.find(|entry| entry.at >= since && entry.title.ends_with(&of_it))?;
    let Some(Figure::Meters(after_m)) = check.after else { return None };
    let before = match check.before {
        Some(Figure::Meters(before_m)) => format!(", {} without it", format::mm(before_m)),
        _ => String::new(),
    };
    let name = method.name();
    let said = format!(
        "{name} is in use and was checked: the finger lands {} beside new targets{before}.",
        format::mm(after_m)
    );
    Some(to_grasping(view, &said))
}

/// The engine's own sentence, where it has one.
fn next_or(view: &View, otherwise: &str) -> String {
    if view.models.next.is_empty() { otherwise.to_owned() } else { view.models.next.clone() }
}
