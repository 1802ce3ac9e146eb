//! What to do next with the gap: one button, named by what it does.

use plumbline_engine::View;
use plumbline_engine::view::{GapView, ShownFinding};

use super::onward::after_the_gap;
use super::sentence::{Guidance, say};
use crate::operator::snapshot::gap::{Finding, Verdict};
use crate::operator::words::gap::{add_label, heading, on_held_out, touch_label};
use crate::operator::words::proof::{Proof, Worth, proven_before};
use crate::operator::{Action, GapAction, Screen};

/// Below this the experiment goes before adding.
const SURE: f64 = 0.8;

pub(super) fn gap(view: &View) -> Guidance {
    let gap = &view.gap;
    if gap.searching.is_some() {
        return say("The gap is being looked for; nothing changes before you add what is found.");
    }
    if let Some(why) = &gap.failed {
        let guidance = say(why.clone()).warn();
        return match gap.chosen.is_empty() {
            true => guidance.then("Go to Touch", Action::Go(Screen::Touch)),
            false => guidance.then("Find what is missing", Action::Gap(GapAction::Find)),
        };
    }
    if gap.chosen.is_empty() {
        return say("The gap is found in sessions. Touch the screen first (step 3), or open one.")
            .then("Go to Touch", Action::Go(Screen::Touch));
    }
    if let Some(why) = &gap.stale {
        return say(why.clone()).warn().then("Find what is missing", Action::Gap(GapAction::Find));
    }
    match &gap.shown {
        Some(shown) if is_of_choice(gap) => found(view, shown),
        // A run that proves the effects is compared next.
        _ => Proof::of_model(view).map_or_else(|| next(gap), |proof| proven(&proof)),
    }
}

fn next(gap: &GapView) -> Guidance {
    let sessions = match gap.chosen.len() {
        1 => "the chosen session".to_owned(),
        n => format!("{n} sessions"),
    };
    say(format!("Next: hold {sessions} against the robot's model ({}). Nothing moves.", gap.model.name))
        .then("Find what is missing", Action::Gap(GapAction::Find))
}

fn found(view: &View, shown: &ShownFinding) -> Guidance {
    let finding = &shown.finding;
    let guidance = say(in_a_line(finding));
    let (addable, wanted) = (view.gap.addable(), view.gap.wanted());
    let experiment = GapAction::NextExperiment.refusal(view).is_none();
    let unsure = finding.effects.iter().any(|effect| effect.probability < SURE);
    let touch = |guidance: Guidance| guidance.then(touch_label(view), Action::Gap(GapAction::NextExperiment));
    match finding.verdict {
        Verdict::NoGap if !finding.is_all_clear() && experiment => touch(guidance),
        Verdict::NoGap => after_the_gap(view, guidance),
        Verdict::NotInLibrary if experiment => touch(guidance.warn()),
        Verdict::NotInLibrary => after_the_gap(view, guidance.warn()),
        Verdict::Class if unsure && experiment && !addable.is_empty() => touch(guidance),
        _ if !wanted.is_empty() => guidance.then(add_label(view, &wanted), Action::Gap(GapAction::Add)),
        _ if shown.added.iter().any(|added| *added) => added(view, shown, experiment),
        _ if experiment => touch(guidance),
        _ => after_the_gap(view, guidance),
    }
}

/// What the bottom line has room for at the smallest width of the window, letters.
const LINE: usize = 200;

/// What was found, or where all of it stands.
fn in_a_line(finding: &Finding) -> String {
    if finding.sentence.chars().count() <= LINE {
        return finding.sentence.clone();
    }
    format!("{}. The pane Name and add says all of it.", heading(finding).trim_end_matches('.'))
}

/// What was found is in the model: touches with it and without it tell what it is worth.
fn added(view: &View, shown: &ShownFinding, experiment: bool) -> Guidance {
    if let Some(proof) = Proof::of_model(view) {
        return proven(&proof);
    }
    if let Some(before) = proven_before(view) {
        return say(before).then("Find what is left", Action::Gap(GapAction::Find));
    }
    let closed = on_held_out(&shown.finding, "By what was found here, on held-out rows");
    // What was measured since, such as the hands, is in the model, too.
    let closed = closed.map_or_else(String::new, |closed| format!(" {closed}"));
    let said = format!("The model in use is {}.{closed}", view.gap.model.name);
    // Planning needs no robot, touching does.
    if view.robot.connection.is_connected() && GapAction::Prove.refusal(view).is_none() {
        return say(format!(
            "{said} Next: new touches with the effects and without them. Nothing moves before you start them."
        ))
        .then("Prove it", Action::Gap(GapAction::Prove));
    }
    if experiment {
        return say(said).then(touch_label(view), Action::Gap(GapAction::NextExperiment));
    }
    say(said).then("Find what is left", Action::Gap(GapAction::Find))
}

/// What the touches say of the effects comes before everything else.
fn proven(proof: &Proof) -> Guidance {
    let guidance = say(format!("{} {}", proof.headline(), proof.figures()));
    match proof.worth() {
        Worth::Help | Worth::Untold => guidance.then("Find what is left", Action::Gap(GapAction::Find)),
        Worth::Harm => guidance.warn().then("Take all effects out", Action::Gap(GapAction::UseNominal)),
    }
}

/// Whether the shown finding is about the sessions that are chosen now.
pub fn is_of_choice(gap: &GapView) -> bool {
    gap.shown.as_ref().is_some_and(|shown| shown.folders[..] == gap.chosen[..])
}
