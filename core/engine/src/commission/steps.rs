//! Which steps are done, and which comes next.

use super::around::{CommissionAround, Found, Made};
use super::kept::{Kept, KeptRun, Learned};
use super::view::{CommissionDone, CommissionFigure, CommissionState, CommissionStep, CommissionStepView};
use crate::ground::Time;
use crate::touch::RunStanding;

/// All steps in their order.
pub fn steps(around: &CommissionAround, kept: Option<&Kept>) -> [CommissionStepView; 8] {
    let mut first_open = None;
    CommissionStep::ALL.map(|step| {
        let state = match (done(step, around, kept), first_open) {
            (Some(done), _) => CommissionState::Done(done),
            (None, Some(earlier)) => CommissionState::Waits(earlier),
            (None, None) => {
                first_open = Some(step);
                CommissionState::Now
            }
        };
        CommissionStepView { step, state }
    })
}

fn done(step: CommissionStep, around: &CommissionAround, kept: Option<&Kept>) -> Made {
    match step {
        CommissionStep::Eyes => counts(&around.eyes, kept),
        CommissionStep::Mount => counts(&around.mount, kept),
        CommissionStep::Screen => counts(&around.screen, kept),
        CommissionStep::Touches => touched(around, kept),
        CommissionStep::Effects => effects(around, kept),
        CommissionStep::Hands => counts(&around.hands, kept),
        CommissionStep::Check => checked(around, kept),
        CommissionStep::Grasp => held(around, kept),
    }
}

/// What is done once more counts only when it was done since.
fn counts(made: &Made, kept: Option<&Kept>) -> Made {
    let since = kept.filter(|kept| kept.is_anew).map(|kept| kept.began);
    made.clone().filter(|made| since.is_none_or(|since| made.at.is_some_and(|at| at >= since)))
}

/// Touches that were seen to be finished; else those of an earlier search for effects.
fn touched(around: &CommissionAround, kept: Option<&Kept>) -> Made {
    if let Some(touched) = kept.and_then(|kept| kept.touched.as_ref()) {
        let figure = CommissionFigure::Touches(touched.touched);
        return Some(CommissionDone { at: Some(touched.at), figure });
    }
    let done = counts(&around.found.as_ref().map(|found| found.done.clone()), kept)?;
    Some(CommissionDone { at: done.at, figure: CommissionFigure::Unknown })
}

/// What was learned of the touches counts as long as the model in use has it, whatever is looked for later.
fn effects(around: &CommissionAround, kept: Option<&Kept>) -> Made {
    let Some(touched) = kept.and_then(|kept| kept.touched.as_ref()) else {
        let found = around.found.as_ref().filter(|found| !found.is_open)?;
        return counts(&Some(found.done.clone()), kept);
    };
    let learned = kept?.learned.as_ref().filter(|learned| learned.session == touched.session);
    let Some(learned) = learned else {
        // An earlier version did not keep it.
        let found = around.found.as_ref().filter(|found| !found.is_open)?;
        return found.sessions.contains(&touched.session).then(|| found.done.clone());
    };
    // What was learned later may be taken back alone: all that was found of these touches is there still.
    let has_all_found = |found: &Found| {
        !found.is_open && found.sessions.contains(&touched.session) && !around.effects.names.is_empty()
    };
    let is_in_use = learned.effects.iter().all(|name| around.effects.names.contains(name))
        || around.found.as_ref().is_some_and(has_all_found);
    let figure = match learned.is_not_in_library {
        true => CommissionFigure::NotInLibrary,
        false => CommissionFigure::Effects(around.effects.told.clone()),
    };
    is_in_use.then_some(CommissionDone { at: learned.at, figure })
}

/// Keeps what a search made of the touches once it leaves nothing open; one that changed nothing in the model
/// says nothing new.
pub fn take_effects(kept: &mut Kept, around: &CommissionAround, time: Time) {
    let Some(touched) = &kept.touched else { return };
    let Some(found) = around.found.as_ref().filter(|found| !found.is_open) else { return };
    let known = kept.learned.as_ref().filter(|learned| learned.session == touched.session);
    let is_of_these = known.is_some() || found.sessions.contains(&touched.session);
    if !is_of_these || known.is_some_and(|known| known.effects == around.effects.names) {
        return;
    }
    kept.learned = Some(Learned {
        session: touched.session.clone(),
        effects: around.effects.names.clone(),
        is_not_in_library: found.done.figure == CommissionFigure::NotInLibrary,
        // What changed later was changed now, whenever it was found.
        at: if known.is_some() { Some(time.day) } else { found.done.at },
    });
}

/// A check says something of the model only when it was made after the search for effects and the look at the
/// hands, and of the place of the screen that is in use.
fn checked(around: &CommissionAround, kept: Option<&Kept>) -> Made {
    let checked = kept?.checked.as_ref()?;
    let effects = effects(around, kept)?;
    let hands = counts(&around.hands, kept)?;
    let screen = around.screen.as_ref()?;
    let after = [effects.at, hands.at, screen.at].into_iter().flatten().all(|made| checked.at >= made);
    let figure = CommissionFigure::Missed { mean_m: checked.mean_m, touches: checked.touched };
    after.then_some(CommissionDone { at: Some(checked.at), figure })
}

/// A grasp of before commissioning was begun is none of it.
fn held(around: &CommissionAround, kept: Option<&Kept>) -> Made {
    let since = kept.map(|kept| kept.began);
    around.held.clone().filter(|held| since.is_none_or(|since| held.at.is_some_and(|at| at >= since)))
}

/// A run that has just been seen to be finished, for keeping.
pub fn finished(run: &RunStanding, at: jiff::Timestamp) -> KeptRun {
    KeptRun { session: run.session.clone(), touched: run.touched, mean_m: run.mean_m, at }
}
