//! From rows and a noise floor to named effects with probabilities.

use nalgebra::DMatrix;
use plumbline_effects::{Assumed, Effect, Measurements};
use plumbline_model::JobContext;

use crate::error::GapError;
use crate::finding::{Candidate, NamedEffect, Unexplained, Verdict};
use crate::floor::Floor;
use crate::options::Options;

/// What a search found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    /// The effects that are in the model now, and frames fitted with them.
    pub assumed: Assumed,
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
}

/// What predictions may be off by, beside the noise of one measurement.
#[derive(Clone, Debug)]
pub(crate) struct Doubt {
    /// Columns: parameters of these effects in turn, per usual size; then six per session as
    /// [`plumbline_effects::Tangents::gauge`].
    pub effects: Vec<Effect>,
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
    let _ = (floor, options);
    context.checkpoint()?;
    Ok(Found {
        assumed: Assumed::nominal(measurements),
        verdict: Verdict::NoGap,
        effects: vec![],
        candidates: vec![],
        unexplained: Unexplained { p_value: 1.0, probability: 0.0, depends_on: vec![], share: 1.0 },
        weights: vec![1.0; measurements.rows.len()],
        doubt: Doubt { effects: vec![], covariance: DMatrix::zeros(0, 0), dirt_sigmas: 0.0, noise_scale: 1.0 },
        hypotheses: vec![],
    })
}

/// Fits where the sessions' frames lie, with the effects of `start`, against outliers; the rest
/// stays as it is.
pub(crate) fn place(measurements: &Measurements, floor: &Floor, start: &Assumed) -> Assumed {
    let _ = (measurements, floor);
    start.clone()
}
