//! Which experiment to do next.
//!
//! Every experiment of the menu that the rig allows and the sessions do not hold yet is made up
//! of rows that were measured (`menu`), predicted with each set of effects that the data allow
//! (`rival`), and scored (`design`): by how far the predictions lie apart for the noise (Box and
//! Hill), and by the probability that the right names will have after it, from simulated outcomes.
//! Once names are settled, by how much the experiment pins down their sizes (D-optimality).

mod design;
mod menu;
mod plan;
mod poses;
mod rival;
#[cfg(test)]
mod tests;
mod words;

use plumbline_effects::Measurements;
use plumbline_model::JobContext;

use crate::error::GapError;
use crate::finding::{Experiment, NamedEffect, NextExperiment, Verdict};
use crate::floor::Floor;
use crate::options::Options;
use crate::search::Found;
use design::Score;
use menu::Trial;
use rival::Rival;

pub use plan::plan_for;

/// Names are settled from this probability on.
const SETTLED: f64 = 0.9;
/// An experiment that brings less is none.
const LEAST_GAIN: f64 = 0.02;
/// Experiments this close to the best one are as good; the quickest for its worth is taken.
const AS_GOOD: f64 = 0.05;
/// Sizes known to this share are pinned down, one standard deviation.
const PINNED: f64 = 0.25;

/// The experiment that tells most; `None` when nothing is left to tell apart or none of the menu
/// would tell it.
///
/// # Errors
/// When the work was cancelled.
pub(crate) fn advise(
    measurements: &Measurements,
    floor: &Floor,
    found: &Found,
    options: &Options,
    context: &dyn JobContext,
) -> Result<Option<NextExperiment>, GapError> {
    // Where everything probably is a little off at once, no experiment of the menu makes few names likely.
    if !options.advise || found.verdict == Verdict::NoGap || found.many.is_some() {
        return Ok(None);
    }
    let trials = menu::of(measurements, found);
    if found.verdict == Verdict::NotInLibrary {
        return Ok(off_library(found, &trials));
    }
    let rivals = rival::all(measurements, floor, found, context)?;
    let now = rival::certainty(&rivals);
    let settled = now > SETTLED && found.effects.iter().all(|effect| effect.class.len() < 2);
    if settled && is_pinned(&rivals) {
        return Ok(None);
    }
    let mut scored = vec![];
    for (i, trial) in trials.iter().enumerate() {
        context.checkpoint()?;
        context.report(i as f64 / trials.len() as f64, "next experiment");
        if let Some(score) = design::score(measurements, floor, found, &rivals, trial, options.seed) {
            scored.push((trial, score));
        }
    }
    if settled {
        return Ok(pin_down(scored, &rivals, now));
    }
    // Of what was watched a turn and a shift of the image are told apart by little else than more of the view.
    let watched = measurements.rows.iter().any(|row| row.stand.is_some());
    let most = scored.iter().max_by(|a, b| a.1.separation.total_cmp(&b.1.separation));
    let most = most.filter(|_| watched).map(|(trial, score)| {
        let why = score.pair.map_or(String::new(), |(a, b)| words::tells(&rivals[a], &rivals[b]));
        answer(trial, why, score.promised, &[])
    });
    Ok(tell_apart(scored, &rivals, now).or(most))
}

/// Fills [`NamedEffect::split_by`] of every effect that may have another name.
///
/// # Errors
/// When the work was cancelled.
pub(crate) fn split_by(
    effects: &mut [NamedEffect],
    measurements: &Measurements,
    floor: &Floor,
    found: &Found,
    options: &Options,
    context: &dyn JobContext,
) -> Result<(), GapError> {
    if effects.iter().all(|effect| effect.class.len() < 2) {
        return Ok(());
    }
    let trials = menu::of(measurements, found);
    for effect in effects.iter_mut().filter(|effect| effect.class.len() > 1) {
        context.checkpoint()?;
        let rivals = rival::of_class(measurements, floor, found, effect, context)?;
        let now = rival::certainty(&rivals);
        let scored: Vec<(&Trial, Score)> = trials
            .iter()
            .filter_map(|trial| {
                Some((trial, design::score(measurements, floor, found, &rivals, trial, options.seed)?))
            })
            .collect();
        effect.split_by = best(&scored, now).map(|at| scored[at].0.what.clone());
    }
    Ok(())
}

/// The most telling one for its time, by place, if any tells enough.
fn best(scored: &[(&Trial, Score)], now: f64) -> Option<usize> {
    let most = scored.iter().map(|(_, score)| score.expected).fold(0.0, f64::max);
    if most < now + LEAST_GAIN {
        return None;
    }
    let per_minute = |at: &usize| scored[*at].1.separation / scored[*at].0.minutes;
    (0..scored.len())
        .filter(|&at| scored[at].1.expected >= (most - AS_GOOD).max(now + LEAST_GAIN))
        .max_by(|a, b| per_minute(a).total_cmp(&per_minute(b)))
}

fn tell_apart(mut scored: Vec<(&Trial, Score)>, rivals: &[Rival], now: f64) -> Option<NextExperiment> {
    let (trial, score) = scored.remove(best(&scored, now)?);
    scored.retain(|(_, score)| score.expected >= now + LEAST_GAIN);
    scored.sort_by(|a, b| b.1.promised.total_cmp(&a.1.promised));
    let why = score.pair.map_or(String::new(), |(a, b)| words::tells(&rivals[a], &rivals[b]));
    Some(answer(trial, why, score.promised, &scored))
}

fn pin_down(mut scored: Vec<(&Trial, Score)>, rivals: &[Rival], now: f64) -> Option<NextExperiment> {
    let per_minute = |(trial, score): &(&Trial, Score)| score.information / trial.minutes;
    scored.sort_by(|a, b| per_minute(b).total_cmp(&per_minute(a)));
    if scored.is_empty() {
        return None;
    }
    let (trial, score) = scored.remove(0);
    let why = words::pins(rivals.first()?, 1.0 - score.doubt_left);
    Some(answer(trial, why, score.promised.max(now), &scored))
}

/// Whether the sizes of the most probable set are known well enough.
fn is_pinned(rivals: &[Rival]) -> bool {
    rivals.first().is_none_or(|rival| rival.relative_doubt() < PINNED)
}

/// No name is right: more of the same shows better what the rest depends on.
fn off_library(found: &Found, trials: &[Trial]) -> Option<NextExperiment> {
    let trial = trials.iter().find(|trial| trial.kind == Experiment::MorePlaces).or(trials.first())?;
    let why = found.unexplained.depends_on.first().map_or_else(
        || "It shows better what the unknown error depends on".to_owned(),
        |on| format!("It shows better how the {} depends on the {}", on.of, on.on),
    );
    Some(answer(trial, why, 1.0 - found.unexplained.probability, &[]))
}

fn answer(
    trial: &Trial,
    why: String,
    expected_probability: f64,
    others: &[(&Trial, Score)],
) -> NextExperiment {
    NextExperiment {
        what: trial.what.clone(),
        why,
        kind: trial.kind,
        count: trial.rows.len(),
        minutes: trial.minutes,
        expected_probability,
        others: others
            .iter()
            .map(|(trial, score)| (trial.what.clone(), score.promised, trial.minutes))
            .collect(),
    }
}
