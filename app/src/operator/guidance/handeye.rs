//! What to do next so that the arms are tied to the eyes.

use plumbline_engine::View;
use plumbline_engine::view::{Gate, HandEyeSummary, Need};
use plumbline_widgets::format;

use super::sentence::{Guidance, say};
use crate::operator::{Action, HandEyeAction, RobotAction, Screen};

/// What moves, before it is pressed.
const MOVES: &str = "Clear the table. The head turns, then each open hand is held over it at 12 places: 2 to 4 min, nothing is touched. An arm that stands elsewhere goes home first.";
/// The same of a twin, which clears its table by itself.
const MOVES_OF_THE_TWIN: &str = "The head turns, then each open hand is held over the table at 12 places: 2 to 4 min, nothing is touched. An arm that stands elsewhere goes home first.";

pub(super) fn handeye(view: &View) -> Guidance {
    let handeye = &view.handeye;
    if handeye.is_looking {
        let doing = view.running_job().and_then(|job| match &job.state {
            plumbline_engine::view::JobState::Running { doing, .. } => Some(doing.as_str()),
            _ => None,
        });
        let doing = doing.unwrap_or("looking at the hands");
        return say(format!("{doing}. The head and the arms move; Esc or space stops."));
    }
    if let Some(proposal) = &handeye.proposal {
        let accept = Action::HandEye(HandEyeAction::Accept);
        return said(proposal).then(HandEyeAction::Accept.label(), accept);
    }
    if let Some(why) = handeye.trouble() {
        let guidance = say(why).warn();
        return match first_lacking(view) {
            Some((label, screen)) => guidance.then(label, Action::Go(screen)),
            None => guidance,
        };
    }
    let look = Action::HandEye(HandEyeAction::Look);
    let moves = if view.twin.running { MOVES_OF_THE_TWIN } else { MOVES };
    if let Some(doubt) = handeye.doubt() {
        return doubtful(view, doubt, moves);
    }
    match (&handeye.stale, &handeye.in_use) {
        (Some(why), _) => say(format!("{why} {moves}")).warn().then("Look again", look),
        (None, Some(_)) => say(format!(
            "The arms are tied to the eyes. Look again when eyes or an arm were taken apart. {moves}"
        ))
        .then("Look again", look),
        (None, None) => say(moves).then(HandEyeAction::Look.label(), look),
    }
}

/// Eyes of a twin that are colder than when they were calibrated get warm at a press; `None`: that is not what makes it
/// doubtful.
pub(super) fn to_be_warmed(view: &View, doubt: &Gate) -> Option<Guidance> {
    let is_cold = doubt.of == Need::Warmth && view.eyes.health.colder_wait_min.is_some();
    let warm = RobotAction::WarmUp;
    (is_cold && view.twin.running).then(|| {
        let sentence = format!("{} Warming moves nothing.", doubt.text);
        say(sentence).warn().then(warm.label(), Action::Robot(warm))
    })
}

/// What speaks against looking now goes first.
fn doubtful(view: &View, doubt: &Gate, moves: &str) -> Guidance {
    if let Some(warm) = to_be_warmed(view, doubt) {
        return warm;
    }
    let why = &doubt.text;
    let label = if view.handeye.in_use.is_some() { "Look again" } else { HandEyeAction::Look.label() };
    say(format!("{why} {moves}")).warn().then(label, Action::HandEye(HandEyeAction::Look))
}

/// What came of a look, in a sentence.
pub fn said(proposal: &HandEyeSummary) -> Guidance {
    match proposal.worse() {
        Some((hand, [before_m, after_m])) => {
            let (before, after) = (format::mm(before_m), format::mm(after_m));
            let which = if proposal.hands.len() > 1 { ", the worse of both then," } else { "" };
            let guidance = say(format!(
                "The {} hand{which} is seen {after} beside its arm with what was learned, {before} before (looks that \
                 were not used). Accepting moves nothing.",
                hand.name()
            ));
            if after_m > before_m { guidance.warn() } else { guidance }
        }
        None => say(
            "The eyes have looked at the hands; of the looks that judge none was found. Accepting puts what was \
             learned into the model in use; nothing moves.",
        )
        .warn(),
    }
}

/// Where the first thing that is missing is made.
fn first_lacking(view: &View) -> Option<(&'static str, Screen)> {
    if !view.robot.connection.is_connected() {
        return None;
    }
    if view.eyes.in_use.is_none() {
        return Some(("Calibrate the eyes", Screen::Collect));
    }
    if view.mount.in_use.is_none() {
        return Some(("Go to Mount", Screen::Mount));
    }
    let touches = view.handeye.gates.iter().find(|gate| gate.of == Need::Touches);
    let lacks_touches = touches.is_some_and(|gate| gate.state == plumbline_engine::view::GateState::Shut);
    lacks_touches.then_some(("Go to Touch", Screen::Touch))
}
