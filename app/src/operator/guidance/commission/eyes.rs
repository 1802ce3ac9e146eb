//! The eyes on the way: the board is shown to them, solved, accepted.

use jiff::Timestamp;
use plumbline_engine::View;
use plumbline_engine::view::SourceStatus;
use plumbline_widgets::format;

use super::super::{ENOUGH_PAIRS, dropped, source_trouble, verdict};
use super::Said;
use crate::operator::words::eyes::WARM_AFTER_MINUTES;
use crate::operator::words::health::not_offered;
use crate::operator::{Action, RobotAction};

/// Pairs that suffice on the way: the board is then looked at as it lies on the table.
const SUFFICE: usize = 12;

pub(super) fn said(view: &View) -> Said {
    if let Some(trouble) = source_trouble(view) {
        return trouble.into();
    }
    if view.source.status != SourceStatus::Running {
        return Said::wait("The eyes have to deliver: let the source go on.", None).warn();
    }
    if let Some(proposal) = view.eyes.proposal.as_ref().filter(|proposal| proposal.stale.is_none()) {
        if let Some(why) = not_offered(&view.eyes, Timestamp::now()) {
            let (label, action) = match why.may_be_judged_again {
                true => (Action::JudgeHealth.label(), Action::JudgeHealth),
                false => ("Discard the proposal".to_owned(), Action::Discard),
            };
            return Said::press(why.sentence, label, vec![action]).warn();
        }
        let verdict = verdict(proposal);
        if verdict.good {
            return Said::press(verdict.sentence, "Accept the calibration of the eyes", accepting(view));
        }
        return collecting(view, Some(verdict.sentence));
    }
    collecting(view, None)
}

/// Nothing is captured any more once the eyes are calibrated.
fn accepting(view: &View) -> Vec<Action> {
    let capture = view.eyes.auto_capture.then_some(Action::ToggleAutoCapture);
    [Some(Action::Accept), capture].into_iter().flatten().collect()
}

fn collecting(view: &View, doubt: Option<String>) -> Said {
    let said = if view.twin.running { twin(view, doubt.is_some()) } else { person(view, doubt.is_some()) };
    match doubt {
        Some(doubt) => Said { sentence: format!("{doubt} {}", said.sentence), warning: true, ..said },
        None => said,
    }
}

/// Those that count.
pub(super) fn pairs(view: &View) -> usize {
    view.eyes.collected.len() - dropped(&view.eyes)
}

fn solve(view: &View) -> Said {
    let count = pairs(view);
    let sentence = format!(
        "Collected: {}. Solving moves nothing, and nothing is used before you accept it.",
        format::count(count, "pair")
    );
    // What a person still holds is not collected while it is solved.
    let capture = view.eyes.auto_capture.then_some(Action::ToggleAutoCapture);
    let actions = [capture, Some(Action::Solve)].into_iter().flatten().collect();
    Said::press(sentence, format!("Solve {}", format::count(count, "pair")), actions)
}

/// Nobody is needed: an unseen hand shows the board.
fn twin(view: &View, again: bool) -> Said {
    let count = pairs(view);
    if view.twin.board.is_some() && view.eyes.auto_capture {
        let why =
            format!("The board is shown to the eyes, pairs are captured by themselves: {count} so far.");
        let places = if again { view.twin.board_places } else { view.twin.few_board_places };
        let fraction = count as f64 / places.max(1) as f64;
        return Said::wait(why, Some(fraction.min(1.0)));
    }
    if view.twin.eyes_on_s < 60.0 * WARM_AFTER_MINUTES && count == 0 {
        return Said::press(
            "The twin's eyes are cold, and turn in their mounts while they warm up, as real ones do. Nothing moves.",
            RobotAction::WarmUp.label(),
            vec![Action::Robot(RobotAction::WarmUp)],
        );
    }
    if count >= ENOUGH_PAIRS && !again {
        return solve(view);
    }
    let (places, action) = if again || count > 0 {
        (format!("all {} places", view.twin.board_places), RobotAction::TourBoard)
    } else {
        (format::count(view.twin.few_board_places, "place"), RobotAction::TourFew)
    };
    Said::press(
        format!(
            "An unseen hand shows the twin the board at {places}; pairs are captured by themselves. The robot stays."
        ),
        format!("Show the board at {places}"),
        // On the screen of collecting, that captures too.
        vec![Action::Robot(action)],
    )
}

/// A person holds the board to the outline.
fn person(view: &View, again: bool) -> Said {
    let (count, eyes) = (pairs(view), &view.eyes);
    let suffices =
        count >= SUFFICE || (count >= ENOUGH_PAIRS && (eyes.ghost.is_none() || !eyes.auto_capture));
    if suffices && !again {
        return solve(view);
    }
    if !eyes.auto_capture {
        return Said::press(
            "Take the printed board in your hands. It is captured by itself wherever you hold it still. The robot stays.",
            "Capture the board while I hold it",
            vec![Action::ToggleAutoCapture],
        );
    }
    let wanted = eyes.ghost.as_ref().map_or_else(|| "another place".to_owned(), |ghost| ghost.reason.clone());
    let why =
        format!("Hold the board still as the outline shows: {wanted}. {count} of {SUFFICE} pairs so far.");
    Said::wait(why, Some((count as f64 / SUFFICE as f64).min(1.0)))
}
