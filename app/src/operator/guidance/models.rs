//! What to do next with correction models: one button, named by what it does.

use plumbline_engine::view::StepState;
use plumbline_engine::{Correction, View};
use plumbline_widgets::format;

use super::sentence::{Guidance, say};
use super::standing::{Standing, standing};
use crate::operator::actions::too_few;
use crate::operator::snapshot::models::{FEWEST_FOR_A_NETWORK, Method};
use crate::operator::{Action, ModelsAction, Screen};

pub(super) fn models(view: &View) -> Guidance {
    let models = &view.models;
    match standing(models) {
        Standing::NothingTouched => say("Models learn from touches. Touch the screen first (step 3).")
            .then("Go to Touch", Action::Go(Screen::Touch)),
        Standing::NotChosen => say(next_or(view, "Choose the session of touches to learn from.")),
        Standing::Unusable(why) => say(why).warn().then("Go to Touch", Action::Go(Screen::Touch)),
        Standing::Recorded(count) if count < FEWEST_FOR_A_NETWORK => {
            say(format!("{}.", too_few(count))).then("Go to Touch", Action::Go(Screen::Touch))
        }
        Standing::Recorded(count) => {
            let touches = format::count(count, "touch");
            say(format!("{touches} are recorded. Next: train models on them. Nothing moves."))
                .then(format!("Train M1, M2 and M3 on {touches}"), Action::Models(ModelsAction::TrainAll))
        }
        Standing::Training => say("The models are being trained; nothing is used before you accept it."),
        Standing::Proposed(method, error_m) => proposed(method, error_m),
        Standing::InUse(method) => in_use(view, method),
    }
}

fn proposed(method: Method, error_m: Option<f64>) -> Guidance {
    let name = method.name();
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
    // A model that is in use waits while targets go by something else.
    let said = if view.touch.correct_with == Some(Correction::Effects) {
        format!(
            "{name} is in use, but targets are corrected by the named effects now (Touch, Targets corrected by). Checking {name} goes by {name}. Nothing moves yet."
        )
    } else {
        next_or(view, &format!("{name} is in use. Next: check it with new touches. Nothing moves yet."))
    };
    say(said).then(format!("Check {name} with new touches"), Action::Models(ModelsAction::Check))
}

/// The engine's own sentence, where it has one.
fn next_or(view: &View, otherwise: &str) -> String {
    if view.models.next.is_empty() { otherwise.to_owned() } else { view.models.next.clone() }
}
