//! Sets of effects that the data allow, fitted, with what their sizes may be off by.

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::measurements::Measurements;
use plumbline_effects::{Assumed, Effect, Present};
use plumbline_model::JobContext;

use crate::error::GapError;
use crate::finding::NamedEffect;
use crate::floor::Floor;
use crate::search::{Found, Hypothesis};

/// At most so many rows are looked at; the others count as more of the same.
const MOST_ROWS: usize = 240;
/// A frame is not known better than this beforehand, m and rad.
pub(super) const FRAME_SD: f64 = 0.5;
/// A frame turns no further in one step, rad.
const FURTHEST_TURN_RAD: f64 = 0.3;
/// Steps of the fit.
const STEPS: usize = 2;

/// One set.
#[derive(Clone, Debug)]
pub(super) struct Rival {
    /// `id@site` of each effect.
    pub names: Vec<String>,
    /// Probability; those of all rivals sum to 1.
    pub probability: f64,
    /// Fitted.
    pub assumed: Assumed,
    /// Covariance of all parameters in turn, in usual sizes.
    pub covariance: DMatrix<f64>,
}

impl Rival {
    /// Its effects.
    pub fn effects(&self) -> Vec<Effect> {
        self.assumed.effects.iter().map(|present| present.effect.clone()).collect()
    }

    /// Standard deviation over size, of the effect that is known worst.
    pub fn relative_doubt(&self) -> f64 {
        let mut at = 0;
        let mut worst: f64 = 0.0;
        for present in &self.assumed.effects {
            let (mut size, mut doubt) = (0.0, 0.0);
            for (value, parameter) in present.values.iter().zip(present.effect.parameters()) {
                size += (value / parameter.typical).powi(2);
                doubt += self.covariance[(at, at)];
                at += 1;
            }
            worst = worst.max((doubt / size.max(1e-12)).sqrt());
        }
        worst
    }
}

/// All sets that the search left over, and those that a name of a class takes the place of another
/// in.
pub(super) fn all(
    measurements: &Measurements,
    floor: &Floor,
    found: &Found,
    context: &dyn JobContext,
) -> Result<Vec<Rival>, GapError> {
    let mut hypotheses = found.hypotheses.clone();
    for effect in &found.effects {
        let others = swapped(measurements, found, effect);
        hypotheses.extend(others.into_iter().filter(|other| {
            let name = other.names.iter().find(|name| !own_names(found).contains(name));
            name.is_some_and(|name| !found.hypotheses.iter().any(|known| known.names.contains(name)))
        }));
    }
    if hypotheses.is_empty() {
        hypotheses.push(as_found(found));
    }
    fitted(measurements, floor, found, hypotheses, context)
}

/// What was found, with each name of the class of one effect in turn.
pub(super) fn of_class(
    measurements: &Measurements,
    floor: &Floor,
    found: &Found,
    effect: &NamedEffect,
    context: &dyn JobContext,
) -> Result<Vec<Rival>, GapError> {
    let mut hypotheses = vec![Hypothesis {
        probability: effect.class.first().map_or(1.0, |own| own.probability),
        ..as_found(found)
    }];
    hypotheses.extend(swapped(measurements, found, effect));
    fitted(measurements, floor, found, hypotheses, context)
}

/// Probability that the names of the right set have now, as expected from the rivals' own.
pub(super) fn certainty(rivals: &[Rival]) -> f64 {
    let probabilities: Vec<f64> = rivals.iter().map(|rival| rival.probability).collect();
    rivals.iter().enumerate().map(|(i, rival)| rival.probability * right(rivals, i, &probabilities)).sum()
}

/// When set `truth` is right and sets have these probabilities: mean probability of its names.
pub(super) fn right(rivals: &[Rival], truth: usize, probabilities: &[f64]) -> f64 {
    let names = &rivals[truth].names;
    if names.is_empty() {
        return rivals.iter().zip(probabilities).filter(|(r, _)| r.names.is_empty()).map(|(_, p)| p).sum();
    }
    let of = |name: &String| -> f64 {
        rivals.iter().zip(probabilities).filter(|(rival, _)| rival.names.contains(name)).map(|(_, p)| p).sum()
    };
    names.iter().map(of).sum::<f64>() / names.len() as f64
}

fn own_names(found: &Found) -> Vec<String> {
    found.assumed.effects.iter().map(|present| present.effect.name()).collect()
}

fn as_found(found: &Found) -> Hypothesis {
    Hypothesis { names: own_names(found), probability: 1.0, assumed: found.assumed.clone() }
}

/// What was found, with another name of its class in the place of an effect; its values are zero
/// until they are fitted.
fn swapped(measurements: &Measurements, found: &Found, effect: &NamedEffect) -> Vec<Hypothesis> {
    let name = name_of(&effect.id, &effect.site);
    let Some(place) = found.assumed.effects.iter().position(|present| present.effect.name() == name) else {
        return vec![];
    };
    let candidates = Effect::candidates(measurements);
    effect
        .class
        .iter()
        .filter_map(|member| {
            let name = name_of(&member.id, &member.site);
            let mut named = candidates.iter().filter(|candidate| candidate.name() == name);
            let alike = |candidate: &&Effect| candidate.shape == effect.shape;
            let other = named.clone().find(alike).or_else(|| named.next())?;
            let mut assumed = found.assumed.clone();
            if assumed.effects.iter().any(|present| present.effect == *other) {
                return None;
            }
            let values = vec![0.0; other.parameters().len()];
            assumed.effects[place] = Present { effect: other.clone(), values };
            let names = assumed.effects.iter().map(|present| present.effect.name()).collect();
            Some(Hypothesis { names, probability: member.probability.max(0.01), assumed })
        })
        .collect()
}

fn name_of(id: &str, site: &str) -> String {
    if site.is_empty() { id.to_owned() } else { format!("{id}@{site}") }
}

fn fitted(
    measurements: &Measurements,
    floor: &Floor,
    found: &Found,
    hypotheses: Vec<Hypothesis>,
    context: &dyn JobContext,
) -> Result<Vec<Rival>, GapError> {
    let sum: f64 = hypotheses.iter().map(|hypothesis| hypothesis.probability).sum();
    let mut rivals = vec![];
    for hypothesis in hypotheses {
        context.checkpoint()?;
        let Hypothesis { names, probability, assumed } = hypothesis;
        if let Some((assumed, covariance)) = fit(measurements, floor, found, assumed) {
            rivals.push(Rival { names, probability: probability / sum.max(1e-12), assumed, covariance });
        }
    }
    let sum: f64 = rivals.iter().map(|rival| rival.probability).sum();
    rivals.iter_mut().for_each(|rival| rival.probability /= sum.max(1e-12));
    rivals.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    Ok(rivals)
}

/// Values and frames by Gauss–Newton steps, and the covariance of the values.
fn fit(
    measurements: &Measurements,
    floor: &Floor,
    found: &Found,
    start: Assumed,
) -> Option<(Assumed, DMatrix<f64>)> {
    let mut assumed = start;
    let mut covariance = None;
    for _ in 0..STEPS {
        let (normal, right) = normal_equations(measurements, floor, found, &assumed)?;
        let inverse = Cholesky::new(normal)?.inverse();
        let step = &inverse * right;
        let nuisances = measurements.nuisances();
        let gauge = nuisances.len();
        measurements.move_nuisances(&mut assumed, &nuisances, &step.as_slice()[..gauge], FURTHEST_TURN_RAD);
        let mut at = gauge;
        for present in &mut assumed.effects {
            for (value, parameter) in present.values.iter_mut().zip(present.effect.parameters()) {
                *value += step[at] * parameter.typical;
                at += 1;
            }
        }
        let count = at - gauge;
        covariance = Some(inverse.view((gauge, gauge), (count, count)).clone_owned());
    }
    Some((assumed, covariance?))
}

/// A column per nuisance, then all parameters in usual sizes.
fn normal_equations(
    measurements: &Measurements,
    floor: &Floor,
    found: &Found,
    assumed: &Assumed,
) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let effects: Vec<Effect> = assumed.effects.iter().map(|present| present.effect.clone()).collect();
    let nuisances = measurements.nuisances();
    let gauge = nuisances.len();
    let count: usize = effects.iter().map(|effect| effect.parameters().len()).sum();
    let mut normal = DMatrix::zeros(gauge + count, gauge + count);
    let mut right = DVector::zeros(gauge + count);
    let mut cells = vec![0.0; measurements.cell_count()];
    measurements.rows.iter().for_each(|row| cells[row.cell] += 1.0);
    let every = measurements.rows.len().div_ceil(MOST_ROWS).max(1);
    for (i, row) in measurements.rows.iter().enumerate().step_by(every) {
        let (Some(floor), Some(tangents)) =
            (floor.of(row.what), measurements.tangents(row, assumed, &effects))
        else {
            continue;
        };
        // Repeats of a cell share its own small error.
        let dirt = found.doubt.dirt_sigmas.powi(2) * cells[row.cell];
        let weight = every as f64 * found.weights.get(i).copied().unwrap_or(1.0) / (1.0 + dirt);
        for c in 0..row.measured.len() {
            let sd = floor.of_row(row, c) * found.doubt.noise_scale;
            let mut line = DVector::zeros(gauge + count);
            for (k, nuisance) in nuisances.iter().enumerate() {
                line[k] = measurements.nuisance_slope(row, &tangents, c, *nuisance) / sd;
            }
            for k in 0..count {
                line[gauge + k] = tangents.effects[(c, k)] / sd;
            }
            let residual = (row.measured[c] - tangents.predicted[c]) / sd;
            normal.ger(weight, &line, &line, 1.0);
            right.axpy(weight * residual, &line, 1.0);
        }
    }
    let mut at = gauge;
    for (k, nuisance) in nuisances.iter().enumerate() {
        let precision = nuisance.prior_sd().powi(-2);
        normal[(k, k)] += precision;
        right[k] -= nuisance.value(assumed) * precision;
    }
    for present in &assumed.effects {
        for (value, parameter) in present.values.iter().zip(present.effect.parameters()) {
            normal[(at, at)] += 1.0;
            right[at] -= value / parameter.typical;
            at += 1;
        }
    }
    Some((normal, right))
}
