//! Fits frames and effects through the forward model.

use nalgebra::{Cholesky, DVector};
use plumbline_effects::measurements::Measurements;
use plumbline_effects::{Assumed, Effect, Present};
use plumbline_model::JobContext;

use super::linear::Linear;
use super::weights::{sets, weights};
use crate::error::GapError;
use crate::floor::Floor;

/// Relinearizations at most.
const ROUNDS: usize = 6;
/// A step below this, in usual sizes and meters, is none.
const STILL: f64 = 1e-4;
/// A frame turns no further in one step: the tangent does not reach, rad.
const FURTHEST_TURN_RAD: f64 = 0.3;
/// A value tells how large others are when its variance has fallen to this share.
const TOLD: f64 = 0.5;
/// Rounds of learning how large a family is, in one linearization.
const LEARNING_ROUNDS: usize = 8;
/// No family is smaller than this share of the usual size.
const SMALLEST_SHARE: f64 = 1e-3;
/// Values beyond this many usual sizes are not followed.
const FURTHEST: f64 = 6.0;

/// A model fitted to the rows.
#[derive(Clone, Debug)]
pub(super) struct Fitted {
    pub assumed: Assumed,
    /// Of each row.
    pub weights: Vec<f64>,
    /// Of each row, in floors.
    pub misses: Vec<Option<f64>>,
    /// Standard deviation of each value beforehand, in usual sizes: see [`Priors`].
    pub sds: Vec<f64>,
}

/// How large values are beforehand. An effect at one site is as large as usual. Where one sits at every
/// site, parts of one make are alike: what most rows tell of some of them says how large the others are,
/// those too that the poses hardly show (empirical Bayes, by expectation and maximization).
#[derive(Clone, Debug)]
struct Priors {
    /// Per value.
    sds: Vec<f64>,
    /// Values of each effect at every site.
    families: Vec<std::ops::Range<usize>>,
}

impl Priors {
    fn of(effects: &[Effect]) -> Self {
        let (mut families, mut at) = (vec![], 0);
        for effect in effects {
            let count = effect.parameters().len();
            if effect.is_of_every_site() {
                families.push(at..at + count);
            }
            at += count;
        }
        Self { sds: vec![1.0; at], families }
    }

    /// Learns from values and their variances.
    fn learn(&mut self, value: impl Fn(usize) -> f64, variance: impl Fn(usize) -> f64) {
        for family in &self.families {
            // What nothing tells has the variance that it had beforehand, and says nothing of its own.
            let told: Vec<usize> =
                family.clone().filter(|&k| variance(k) < TOLD * self.sds[k] * self.sds[k]).collect();
            if told.is_empty() {
                continue;
            }
            let square: f64 = told.iter().map(|&k| value(k).powi(2) + variance(k)).sum();
            let sd = (square / told.len() as f64).sqrt().clamp(SMALLEST_SHARE, 1.0);
            self.sds[family.clone()].fill(sd);
        }
    }
}

/// Frames and values of `effects`, from `start` on; its values are kept where it has the effect.
///
/// # Errors
/// Cancelled.
pub(super) fn refit(
    measurements: &Measurements,
    floor: &Floor,
    start: &Assumed,
    effects: &[Effect],
    context: &dyn JobContext,
) -> Result<Fitted, GapError> {
    let mut assumed = with(start, effects);
    let rows = measurements.rows.len();
    let sets = sets(measurements);
    let mut fitted = None;
    let mut priors = Priors::of(effects);
    for _ in 0..ROUNDS {
        let linear = Linear::of(measurements, floor, &assumed, effects, context)?;
        let columns = linear.lines.ncols() - 1;
        let now = linear.lines.column(columns).clone_owned();
        let misses = linear.misses(rows, &now);
        let mut own = weights(&misses, &sets);
        let values = usual(&assumed);
        let stands: Vec<f64> = linear.nuisances.iter().map(|nuisance| nuisance.value(&assumed)).collect();
        let mut step = DVector::zeros(columns);
        for _ in 0..4 {
            let Some(next) = solve(&linear, &own, &stands, &values, &mut priors, context)? else { break };
            step = next;
            let left = &now - linear.lines.columns(0, columns) * &step;
            own = weights(&linear.misses(rows, &left), &sets);
        }
        move_by(measurements, &mut assumed, &linear, &step);
        let still = step.amax() < STILL;
        fitted = Some(Fitted { assumed: assumed.clone(), weights: own, misses, sds: priors.sds.clone() });
        if still {
            break;
        }
    }
    let Some(mut fitted) = fitted else {
        let sds = priors.sds;
        return Ok(Fitted { assumed, weights: vec![1.0; rows], misses: vec![None; rows], sds });
    };
    let linear = Linear::of(measurements, floor, &assumed, &[], context)?;
    fitted.misses = linear.misses(rows, &linear.lines.column(linear.lines.ncols() - 1).clone_owned());
    fitted.weights = weights(&fitted.misses, &sets);
    Ok(fitted)
}

/// The model with exactly these effects.
pub(super) fn with(start: &Assumed, effects: &[Effect]) -> Assumed {
    let present = effects.iter().map(|effect| {
        let old = start.effects.iter().find(|present| present.effect == *effect);
        let values =
            old.map_or_else(|| vec![0.0; effect.parameters().len()], |present| present.values.clone());
        Present { effect: effect.clone(), values }
    });
    Assumed { effects: present.collect(), ..start.clone() }
}

/// Values of all effects in turn, in usual sizes.
pub(super) fn usual(assumed: &Assumed) -> DVector<f64> {
    let values = assumed.effects.iter().flat_map(|present| {
        present
            .values
            .iter()
            .zip(present.effect.parameters())
            .map(|(value, parameter)| value / parameter.typical)
    });
    DVector::from_vec(values.collect())
}

/// A step from where nuisances (m, rad) and values (usual sizes) stand.
fn solve(
    linear: &Linear,
    weights: &[f64],
    stands: &[f64],
    values: &DVector<f64>,
    priors: &mut Priors,
    context: &dyn JobContext,
) -> Result<Option<DVector<f64>>, GapError> {
    let (gram, _) = linear.sums(weights, context)?.gram(0.05, context)?;
    let columns = gram.ncols() - 1;
    let mut normal = gram.view((0, 0), (columns, columns)).clone_owned();
    let mut right =
        DVector::from_column_slice(gram.view((0, columns), (columns, 1)).clone_owned().as_slice());
    for (k, nuisance) in linear.nuisances.iter().enumerate() {
        let precision = nuisance.prior_sd().powi(-2);
        normal[(k, k)] += precision;
        right[k] -= stands[k] * precision;
    }
    let gauge = linear.gauge;
    let rounds = if priors.families.is_empty() { 1 } else { LEARNING_ROUNDS };
    let mut step = None;
    for _ in 0..rounds {
        let (mut own, mut pull) = (normal.clone(), right.clone());
        for (k, sd) in priors.sds.iter().enumerate().take(columns - gauge) {
            own[(gauge + k, gauge + k)] += sd.powi(-2);
            pull[gauge + k] -= values[k] * sd.powi(-2);
        }
        let Some(cholesky) = Cholesky::new(own) else { return Ok(None) };
        let next = cholesky.solve(&pull);
        if !priors.families.is_empty() {
            let inverse = cholesky.inverse();
            priors.learn(|k| values[k] + next[gauge + k], |k| inverse[(gauge + k, gauge + k)]);
        }
        step = Some(next);
    }
    Ok(step)
}

/// Moves frames and values by a step of the columns of `linear`.
pub(super) fn move_by(
    measurements: &Measurements,
    assumed: &mut Assumed,
    linear: &Linear,
    step: &DVector<f64>,
) {
    let of_nuisances = &step.as_slice()[..linear.gauge];
    measurements.move_nuisances(assumed, &linear.nuisances, of_nuisances, FURTHEST_TURN_RAD);
    let mut at = linear.gauge;
    for present in &mut assumed.effects {
        for (value, parameter) in present.values.iter_mut().zip(present.effect.parameters()) {
            let moved = *value + step[at] * parameter.typical;
            *value = moved.clamp(-FURTHEST * parameter.typical, FURTHEST * parameter.typical);
            at += 1;
        }
    }
}

/// Fits frames only.
///
/// # Errors
/// Cancelled.
pub(super) fn frames(
    measurements: &Measurements,
    floor: &Floor,
    start: &Assumed,
    context: &dyn JobContext,
) -> Result<Assumed, GapError> {
    let rows = measurements.rows.len();
    let sets = sets(measurements);
    let mut assumed = start.clone();
    for _ in 0..ROUNDS {
        let linear = Linear::of(measurements, floor, &assumed, &[], context)?;
        if linear.gauge == 0 {
            break;
        }
        let now = linear.lines.column(linear.gauge).clone_owned();
        let mut own = weights(&linear.misses(rows, &now), &sets);
        let mut step = DVector::zeros(linear.gauge);
        let stands: Vec<f64> = linear.nuisances.iter().map(|nuisance| nuisance.value(&assumed)).collect();
        for _ in 0..4 {
            let (none, mut priors) = (DVector::zeros(0), Priors::of(&[]));
            let Some(next) = solve(&linear, &own, &stands, &none, &mut priors, context)? else { break };
            step = next;
            let left = &now - linear.lines.columns(0, linear.gauge) * &step;
            own = weights(&linear.misses(rows, &left), &sets);
        }
        let mut bare = Assumed { effects: vec![], ..assumed.clone() };
        move_by(measurements, &mut bare, &linear, &step);
        (assumed.placements, assumed.mounts) = (bare.placements, bare.mounts);
        if step.amax() < STILL {
            break;
        }
    }
    Ok(assumed)
}
