//! What to do next with a calibration of the eyes that was solved: judging it, putting it in use.

use jiff::Timestamp;
use plumbline_engine::View;
use plumbline_engine::view::EyesView;
use plumbline_widgets::format;

use super::onward::after_the_eyes;
use super::sentence::{Guidance, say};
use super::{dropped, verdict};
use crate::operator::words::eyes::all_cold;
use crate::operator::words::health::not_offered;
use crate::operator::{Action, Screen};

pub(super) fn judge(view: &View) -> Guidance {
    let eyes = &*view.eyes;
    let count = eyes.collected.len() - dropped(eyes);
    let Some(proposal) = &eyes.proposal else {
        if let Some(guidance) = after_the_eyes(view, "The calibration is in use.") {
            return guidance;
        }
        return match (&eyes.in_use, count) {
            (Some(_), _) => say("Nothing is proposed; the calibration in use is shown.")
                .then("Collect pairs", Action::Go(Screen::Collect)),
            (None, 0) => say("There is nothing to judge yet: collect pairs first.")
                .then("Collect pairs", Action::Go(Screen::Collect)),
            (None, n) => {
                let pairs = format::count(n, "pair");
                say(format!("Collected, not solved: {pairs}.")).then(format!("Solve {pairs}"), Action::Solve)
            }
        };
    };
    if let Some(why) = &proposal.stale {
        return say(why.clone()).then(format!("Solve {} again", format::count(count, "pair")), Action::Solve);
    }
    if let Some(against) = against(eyes) {
        return against;
    }
    let verdict = verdict(proposal);
    if !verdict.good {
        return say(verdict.sentence).warn().then("Collect more pairs", Action::Go(Screen::Collect));
    }
    let but = all_cold(eyes).map_or_else(String::new, |cold| format!(" {cold}"));
    if eyes.in_use.is_some() {
        say(format!("Nothing speaks against this calibration. Next: see what it would change.{but}"))
            .then("Compare with the one in use", Action::Go(Screen::Accept))
    } else {
        say(format!("Nothing speaks against this calibration. Look at single pairs, or accept it.{but}"))
            .then("Accept calibration", Action::Accept)
    }
}

/// Where the proposal is not offered.
fn against(eyes: &EyesView) -> Option<Guidance> {
    let why = not_offered(eyes, Timestamp::now())?;
    let said = say(why.sentence).warn();
    Some(match why.may_be_judged_again {
        true => said.then(Action::JudgeHealth.label(), Action::JudgeHealth),
        false => said.then("Discard the proposal", Action::Discard),
    })
}

pub(super) fn accept(view: &View) -> Guidance {
    let eyes = &*view.eyes;
    match (&eyes.proposal, &eyes.in_use) {
        (Some(proposal), _) if proposal.stale.is_some() => {
            say(proposal.stale.clone().unwrap_or_default()).then("Solve again", Action::Solve)
        }
        (Some(proposal), _) => {
            if let Some(against) = against(eyes) {
                return against;
            }
            let verdict = verdict(proposal);
            if verdict.good {
                let changes = proposal.difference.as_ref().and_then(|map| map.greatest_m());
                let said = match changes {
                    Some(most_m) => {
                        format!("Accepting moves points on the table by up to {}.", format::mm(most_m))
                    }
                    None => "Accepting puts this calibration in use.".to_owned(),
                };
                say(said).then("Accept calibration", Action::Accept)
            } else {
                say(verdict.sentence).warn().then("Accept it all the same", Action::Accept)
            }
        }
        (None, Some(_)) => after_the_eyes(view, "The calibration is in use.").unwrap_or_else(|| {
            say("The calibration is in use.").then("Look at the eyes", Action::Go(Screen::Live))
        }),
        (None, None) => {
            say("No calibration is in use yet.").then("Collect pairs", Action::Go(Screen::Collect))
        }
    }
}
