//! From rows and a noise floor to named effects with probabilities.
//!
//! - [`linear`]: whitened residuals and tangents of all rows, and what they add up to;
//! - [`field`]: the evidence of any set of effects from those sums;
//! - [`explore`]: the search through sets;
//! - [`free`], [`steps`]: rivals that are in no library;
//! - [`refit`]: the fit through the forward model;
//! - [`sizes`]: how far sizes may be off by shapes and companions;
//! - [`naming`], [`knowledge`]: from sets with probabilities to names, classes, words.
//!
//! The method with its assumptions is described in the package's README.

mod beside;
mod explore;
mod field;
mod finish;
mod free;
mod knowledge;
mod library;
mod linear;
mod look;
mod many;
mod masses;
mod naming;
mod refit;
mod sizes;
mod stated;
mod steps;
#[cfg(test)]
mod tests;
mod undetermined;
mod unknown;
mod variants;
mod weights;

use nalgebra::DMatrix;
use plumbline_effects::Nuisance;
use plumbline_effects::{Assumed, Effect, Measurements};
use plumbline_model::{JobContext, Unattended};

use crate::compare::placed;
use crate::covariates::Covariates;
use crate::error::GapError;
use crate::finding::{Candidate, FloorSource, NamedEffect, Undetermined, Unexplained, Verdict};
use crate::floor::Floor;
use crate::options::Options;
use explore::Explored;
use finish::Finish;
use library::Library;
use look::Look;
pub(crate) use naming::{BEYOND_PLAUSIBLE, BOUND, MOST_DIRT};
use refit::refit;
pub(crate) use stated::still_right;
pub(crate) use unknown::{RIVAL_P, VETO_P};

/// Times that the model is linearized anew, at the effects found before.
const ROUNDS: usize = 3;
/// And so many more where the noise is found along with the effects.
const MORE_ROUNDS: usize = 3;
/// A noise that shrinks by less does not change what is seen.
const QUIETER: f64 = 0.93;
/// Fewer rows than this name nothing.
const FEWEST_ROWS: usize = 8;

/// What a search found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// The effects that are in the model now, and frames fitted with them.
    pub assumed: Assumed,
    /// The same with all of the most probable set, also what does too little to be named.
    pub probable: Assumed,
    /// The answer in a word.
    pub verdict: Verdict,
    /// Effects found, the largest first. With [`Verdict::NotInLibrary`]: what it looks partly like.
    pub effects: Vec<NamedEffect>,
    /// All candidates, the most probable first.
    pub candidates: Vec<Candidate>,
    /// What is left.
    pub unexplained: Unexplained,
    /// Per row of the measurements: 1 is believed, 0 is an outlier.
    pub weights: Vec<f64>,
    /// What the predictions with [`Found::assumed`] may still be off by.
    pub doubt: Doubt,
    /// Sets of effects that the data allow, the most probable first; probabilities sum to 1 or
    /// less.
    pub hypotheses: Vec<Hypothesis>,
    /// What of the effects the rows do not tell.
    pub undetermined: Vec<Undetermined>,
    /// The noise with which it was found: as given, or fitted.
    pub floor: Floor,
    /// Probability that everything is a little off at once, where that is more probable than a few effects.
    pub many: Option<f64>,
}

/// What predictions may be off by, beside the noise of one measurement.
#[derive(Clone, Debug)]
pub(crate) struct Doubt {
    /// Columns: parameters of these effects in turn, per usual size …
    pub effects: Vec<Effect>,
    /// … then these.
    pub nuisances: Vec<Nuisance>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Standard deviation of small unmodelled effects per cell, in units of the floor.
    pub dirt_sigmas: f64,
    /// The floor's standard deviations times this are the noise that was found (1 with repeats).
    pub noise_scale: f64,
}

/// A set of effects that the data allow.
#[derive(Clone, Debug)]
pub(crate) struct Hypothesis {
    /// `id@site` of each, in the order of the library.
    pub names: Vec<String>,
    /// Its probability.
    pub probability: f64,
    /// The model with it, fitted.
    pub assumed: Assumed,
}

/// Names what makes the measurements disagree with the model.
///
/// # Errors
/// When there are too few rows, or the work was cancelled.
pub(crate) fn search(
    measurements: &Measurements,
    floor: &Floor,
    options: &Options,
    context: &dyn JobContext,
) -> Result<Found, GapError> {
    let rows = measurements.rows.len();
    if rows < FEWEST_ROWS {
        return Err(GapError::TooFew { rows, needed: FEWEST_ROWS });
    }
    context.report(0.0, "placing frames");
    let mut library = Library::of(measurements, floor, options);
    let covariates = Covariates::of(measurements);
    let all: Vec<usize> = (0..rows).collect();
    let start = placed(measurements, &all, context)?;
    let bare = refit(measurements, floor, &start, &[], context)?;
    let mut fitted = bare.clone();
    let mut floor = floor.clone();
    let rounds = if floor.source == FloorSource::Fitted { ROUNDS + MORE_ROUNDS } else { ROUNDS };
    let mut seeds = vec![vec![]];
    let mut last: Option<(Look, Explored)> = None;
    for round in 0..rounds {
        context.report(0.1 + 0.8 * round as f64 / rounds as f64, "looking through sets of effects");
        let look =
            Look::at(measurements, &floor, &fitted.assumed, &library, &covariates, &fitted.weights, context)?;
        let explored = look.explore(&seeds, options.most_effects, true, context)?;
        let top = top(&look, &explored);
        let effects: Vec<Effect> = top.iter().map(|&block| library.effects[block].clone()).collect();
        let same = effects.iter().eq(fitted.assumed.effects.iter().map(|present| &present.effect));
        // What was found, and steps, are looked at again between their neighbors of the grid.
        let finer = if round + 1 < rounds {
            let steps = look.steps(&explored).into_iter().map(|block| library.effects[block].clone());
            library.finer(measurements, &effects.iter().cloned().chain(steps).collect::<Vec<_>>())
        } else {
            None
        };
        let more = finer.as_ref().map_or(0, |finer| finer.blocks.len() - library.blocks.len());
        let moved = |block: usize| if block < look.effects { block } else { block + more };
        seeds.truncate(1);
        let best = explored.models.iter().take(2);
        seeds.extend(best.map(|model| model.set.iter().map(|&block| moved(block)).collect()));
        last = Some((look, explored));
        let mut quieter = false;
        if !same {
            fitted = refit(measurements, &floor, &fitted.assumed, &effects, context)?;
        }
        if round + 1 < rounds {
            let columns = measurements.nuisances().len()
                + effects.iter().map(|effect| effect.parameters().len()).sum::<usize>();
            let left = crate::compare::residuals(measurements, &fitted.assumed);
            let next = match floor.source {
                FloorSource::Fitted => Some(floor.refitted(&measurements.rows, &left, columns)),
                _ => crate::compare::by_neighbors_of_eyes(measurements, &floor, &left, columns),
            };
            if let Some(next) = next.filter(|next| next.shrunk_to(&floor) < QUIETER) {
                quieter = true;
                floor = next;
            }
        }
        if same && !quieter && finer.is_none() {
            break;
        }
        library = finer.unwrap_or(library);
    }
    let Some((look, explored)) = last else {
        return Err(GapError::TooFew { rows, needed: FEWEST_ROWS });
    };
    context.report(0.9, "naming");
    let has_rival = |explored: &Explored| {
        explored.models.first().is_some_and(|model| model.set.iter().any(|&block| block >= look.effects))
    };
    let alone = if has_rival(&explored) {
        Some(look.explore(&seeds, options.most_effects, false, context)?)
    } else {
        None
    };
    context.checkpoint()?;
    let many = if explored.models.first().is_some_and(|model| model.set.len() >= many::LEAST_FEW) {
        many::Many::of(&look.ground, floor.source, look.gap(), context)?
    } else {
        None
    };
    let finish = Finish {
        measurements,
        floor: &floor,
        options,
        library: &library,
        look: &look,
        explored: &explored,
        alone: alone.as_ref(),
        many: many.as_ref(),
    };
    finish.found(&bare, &fitted, context)
}

/// Library's blocks of the most probable set.
fn top(look: &Look, explored: &Explored) -> Vec<usize> {
    let set = explored.models.first().map_or(&[][..], |model| &model.set);
    set.iter().copied().filter(|&block| block < look.effects).collect()
}

/// Fits where the sessions' frames lie, with the effects of `start`, against outliers; the rest
/// stays as it is.
pub(crate) fn place(measurements: &Measurements, floor: &Floor, start: &Assumed) -> Assumed {
    refit::frames(measurements, floor, start, &Unattended).unwrap_or_else(|_| start.clone())
}
