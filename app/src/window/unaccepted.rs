//! What is lost when the window closes.

use egui::Ui;
use plumbline_engine::View;
use plumbline_engine::view::Connection;
use plumbline_model::listed;

use super::sheet::{Asked, buttons_with_care, title};
use crate::operator::guidance::is_screen_to_be_decided;

/// What was solved, is proposed, and is kept nowhere before it is accepted.
pub(super) fn unaccepted(view: &View) -> Vec<&'static str> {
    let eyes = view.eyes.proposal.as_ref().is_some_and(|proposal| proposal.stale.is_none());
    let of = [
        (eyes, "the calibration of the eyes"),
        (view.mount.proposal.is_some(), "the mount of the eyes"),
        (is_place_open(view), "the place of the screen"),
        (are_models_open(view), "the correction models"),
        (view.handeye.proposal.is_some(), "what hand and eyes agree on"),
    ];
    of.into_iter().filter_map(|(is_open, what)| is_open.then_some(what)).collect()
}

/// An older place beside one that is in use was passed over already.
fn is_place_open(view: &View) -> bool {
    let touch = &view.touch;
    is_screen_to_be_decided(touch) && (touch.placement.is_none() || !touch.proposal_is_older)
}

/// Of models that were trained on the same touches one is enough.
fn are_models_open(view: &View) -> bool {
    let models = &view.models;
    let Some(in_use) = &models.in_use else { return !models.proposals.is_empty() };
    let used = in_use.provenance();
    models.proposals.iter().any(|proposal| {
        let made_of = proposal.provenance();
        made_of.session != used.session || made_of.touches != used.touches
    })
}

/// What becomes of the twin.
pub(super) const TWIN_BEGINS_ANEW: &str =
    "The twin ends with the program: next time it stands at home, and its toys where they were at first.";

/// Whether what would be left alone is the twin.
pub(super) fn is_twin(view: &View) -> bool {
    matches!(view.robot.connection, Connection::Connected { twin: true, .. })
}

/// What a hand holds, and what becomes of it; `None`: nothing.
pub(super) fn held(view: &View) -> Option<String> {
    let held = view.grasp.held.as_ref()?;
    let (hand, object) = (held.hand.name(), held.object.to_lowercase());
    Some(match is_twin(view) {
        true => format!("The {hand} hand holds the {object}. {TWIN_BEGINS_ANEW}"),
        false => format!(
            "The {hand} hand holds the {object}: its fingers go on pressing, and nobody looks any more whether it \
             slips. Put it down first."
        ),
    })
}

/// The same in sentences; `None`: nothing is lost, and nothing is held.
pub(super) fn lost_by_closing(view: &View) -> Option<String> {
    let open = unaccepted(view);
    let lost = (!open.is_empty())
        .then(|| format!("Solved and not accepted: {}. Closing loses that.", listed(&open)));
    match (held(view), lost) {
        (Some(held), Some(lost)) => Some(format!("{held} {lost}")),
        (held, lost) => held.or(lost),
    }
}

/// Asks whether to close although something was not accepted.
pub(super) fn sheet_of_unaccepted(ui: &mut Ui, view: &View) -> Asked {
    let question = match held(view) {
        Some(_) => "Close while a hand holds something?",
        None => "Close without accepting?",
    };
    title(ui, question, &lost_by_closing(view).unwrap_or_default());
    match buttons_with_care(ui, "Close all the same") {
        Some(true) => Asked::Close,
        Some(false) => Asked::Closed,
        None => Asked::Open,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_asked_where_nothing_is_open() {
        assert!(unaccepted(&View::default()).is_empty());
    }
}
