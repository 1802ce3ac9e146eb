//! Fits frames and effects through the forward model.

use nalgebra::{Cholesky, DVector};
use plumbline_effects::measurements::Measurements;
use plumbline_effects::{Assumed, Effect, Present};
use plumbline_model::JobContext;

use super::linear::Linear;
use super::weights::weights;
use crate::error::GapError;
use crate::floor::Floor;

/// Relinearizations at most.
const ROUNDS: usize = 6;
/// A step below this, in usual sizes and meters, is none.
const STILL: f64 = 1e-4;
/// A frame turns no further in one step: the tangent does not reach, rad.
const FURTHEST_TURN_RAD: f64 = 0.3;
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
    let mut fitted = None;
    for _ in 0..ROUNDS {
        let linear = Linear::of(measurements, floor, &assumed, effects, context)?;
        let columns = linear.lines.ncols() - 1;
        let now = linear.lines.column(columns).clone_owned();
        let misses = linear.misses(rows, &now);
        let mut own = weights(&misses);
        let values = usual(&assumed);
        let stands: Vec<f64> = linear.nuisances.iter().map(|nuisance| nuisance.value(&assumed)).collect();
        let mut step = DVector::zeros(columns);
        for _ in 0..4 {
            let Some(next) = solve(&linear, &own, &stands, &values) else { break };
            step = next;
            let left = &now - linear.lines.columns(0, columns) * &step;
            own = weights(&linear.misses(rows, &left));
        }
        move_by(measurements, &mut assumed, &linear, &step);
        let still = step.amax() < STILL;
        fitted = Some(Fitted { assumed: assumed.clone(), weights: own, misses });
        if still {
            break;
        }
    }
    let Some(mut fitted) = fitted else {
        return Ok(Fitted { assumed, weights: vec![1.0; rows], misses: vec![None; rows] });
    };
    let linear = Linear::of(measurements, floor, &assumed, &[], context)?;
    fitted.misses = linear.misses(rows, &linear.lines.column(linear.lines.ncols() - 1).clone_owned());
    fitted.weights = weights(&fitted.misses);
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
fn solve(linear: &Linear, weights: &[f64], stands: &[f64], values: &DVector<f64>) -> Option<DVector<f64>> {
    let sums = linear.sums(weights);
    let (gram, _) = sums.gram(0.05);
    let columns = gram.ncols() - 1;
    let mut normal = gram.view((0, 0), (columns, columns)).clone_owned();
    let mut right =
        DVector::from_column_slice(gram.view((0, columns), (columns, 1)).clone_owned().as_slice());
    for k in 0..columns {
        let sd = linear.nuisances.get(k).map_or(1.0, |nuisance| nuisance.prior_sd());
        let stands = if k < linear.gauge { stands[k] } else { values[k - linear.gauge] };
        normal[(k, k)] += 1.0 / (sd * sd);
        right[k] -= stands / (sd * sd);
    }
    Some(Cholesky::new(normal)?.solve(&right))
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
    let mut assumed = start.clone();
    for _ in 0..ROUNDS {
        let linear = Linear::of(measurements, floor, &assumed, &[], context)?;
        if linear.gauge == 0 {
            break;
        }
        let now = linear.lines.column(linear.gauge).clone_owned();
        let mut own = weights(&linear.misses(rows, &now));
        let mut step = DVector::zeros(linear.gauge);
        let stands: Vec<f64> = linear.nuisances.iter().map(|nuisance| nuisance.value(&assumed)).collect();
        for _ in 0..4 {
            let Some(next) = solve(&linear, &own, &stands, &DVector::zeros(0)) else { break };
            step = next;
            let left = &now - linear.lines.columns(0, linear.gauge) * &step;
            own = weights(&linear.misses(rows, &left));
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
