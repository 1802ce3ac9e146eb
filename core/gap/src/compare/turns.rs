//! A joint that turns the other way than in the model, or by half or twice as much. Everything that
//! follows would be nonsense, so it stops here and says which joint.
//!
//! Every joint is tried by itself: with its angles changed, frames and the zeros of all joints fitted
//! anew, so that a zero that is off does not look like a turn. The change is believed where it makes the
//! rest clearly smaller.

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::measurements::Measurements;
use plumbline_effects::{Assumed, Effect, Kind, Present};
use plumbline_model::JobContext;

use super::frames;
use crate::error::{GapError, Turns};

/// At most so many rows of a session take part: a joint that turns the other way shows everywhere.
const MOST_ROWS: usize = 150;
/// Fewer say nothing.
const FEWEST_ROWS: usize = 12;
/// Rows that fit this well (m) have no joint that turns the other way and matters.
const FITS_M: f64 = 2e-3;
/// A turn of a radian counts like so many meters.
const LEVER_M: f64 = 0.2;
/// Share of the rows that count, the nearest ones.
const KEPT: f64 = 0.95;
/// How far zeros may be off, rad.
const ZERO_SD_RAD: f64 = 0.1;
/// Standard deviation of a row, m, for weighing it against what zeros may be.
const ROW_SD_M: f64 = 3e-3;
/// Steps of the fit.
const STEPS: usize = 3;
/// What is tried, to which share of it what is left has to shrink, and what it means. A factor also takes up
/// what other effects leave, so it has to explain more.
const TRIED: [(f64, f64, Turns); 3] =
    [(-1.0, 0.6, Turns::TheOtherWay), (0.5, 0.35, Turns::HalfAsFar), (2.0, 0.35, Turns::TwiceAsFar)];

/// Stops where a joint turns otherwise than in the model.
///
/// # Errors
/// [`GapError::OtherTurn`], or cancelled.
pub fn check(measurements: &Measurements, session: usize, context: &dyn JobContext) -> Result<(), GapError> {
    let Some(arm) = &measurements.apparatuses[session].arm else { return Ok(()) };
    let own: Vec<usize> = (0..measurements.rows.len())
        .filter(|&i| measurements.rows[i].session == session && measurements.rows[i].what.is_placed())
        .collect();
    if own.len() < FEWEST_ROWS {
        return Ok(());
    }
    let every = own.len().div_ceil(MOST_ROWS);
    let only = measurements.only(own.into_iter().step_by(every));
    let left_m = left_m(&only, session, context)?;
    if left_m < FITS_M {
        return Ok(());
    }
    let mut best: Option<(f64, usize, Turns)> = None;
    for j in 0..arm.len() {
        for (factor, clearly, turns) in TRIED {
            let mut other = only.clone();
            for row in &mut other.rows {
                for angles in [&mut row.commanded_rad, &mut row.encoder_rad].into_iter().flatten() {
                    angles[j] *= factor;
                }
            }
            let with_m = self::left_m(&other, session, context)?;
            if with_m < clearly * left_m && best.is_none_or(|(best_m, ..)| with_m < best_m) {
                best = Some((with_m, j, turns));
            }
        }
    }
    match best {
        None => Ok(()),
        Some((with_m, j, turns)) => Err(GapError::OtherTurn {
            session: measurements.apparatuses[session].title.clone(),
            joint: arm.parts[j].joint.clone(),
            turns,
            off_m: left_m,
            with_m,
        }),
    }
}

/// Mean length of what is left with frames and zeros fitted, m.
fn left_m(measurements: &Measurements, session: usize, context: &dyn JobContext) -> Result<f64, GapError> {
    let rows: Vec<usize> = (0..measurements.rows.len()).collect();
    let mut assumed = frames::placed(measurements, &rows, context)?;
    let arm = measurements.apparatuses[session].arm.as_ref();
    let zeros: Vec<Effect> = Effect::sites(Kind::JointZero, arm, None)
        .into_iter()
        .filter(|effect| !effect.is_of_every_site())
        .collect();
    assumed.effects =
        zeros.iter().map(|effect| Present { effect: effect.clone(), values: vec![0.0] }).collect();
    let mut left_m = miss_m(measurements, &assumed);
    for _ in 0..STEPS {
        let Some(next) = stepped(measurements, &assumed, &zeros, left_m) else { break };
        let next_m = miss_m(measurements, &next);
        if next_m >= left_m {
            break;
        }
        (assumed, left_m) = (next, next_m);
    }
    Ok(left_m)
}

fn miss_m(measurements: &Measurements, assumed: &Assumed) -> f64 {
    let misses = measurements.rows.iter().filter_map(|row| {
        let predicted = measurements.predict(row, assumed)?;
        Some(length_m(row.measured.iter().zip(&predicted).map(|(m, p)| m - p)))
    });
    let mut misses: Vec<f64> = misses.collect();
    misses.sort_by(f64::total_cmp);
    // A joint may stand still in most rows; a few rows may be nonsense.
    misses.truncate((KEPT * misses.len() as f64).ceil() as usize);
    misses.iter().sum::<f64>() / misses.len().max(1) as f64
}

/// Turns count with their lever.
fn length_m(residual: impl Iterator<Item = f64>) -> f64 {
    residual.enumerate().map(|(c, off)| (off * lever(c)).powi(2)).sum::<f64>().sqrt()
}

fn lever(coordinate: usize) -> f64 {
    if coordinate < 3 { 1.0 } else { LEVER_M }
}

/// One step of frames, marker and zeros; rows that are far off count less.
fn stepped(
    measurements: &Measurements,
    assumed: &Assumed,
    zeros: &[Effect],
    typical_m: f64,
) -> Option<Assumed> {
    let free = measurements.nuisances();
    let columns = free.len() + zeros.len();
    let mut normal = DMatrix::zeros(columns, columns);
    let mut right = DVector::zeros(columns);
    for row in &measurements.rows {
        let tangents = measurements.tangents(row, assumed, zeros)?;
        let off = row.measured.iter().zip(&tangents.predicted).map(|(m, p)| m - p);
        let weight = 1.0 / (length_m(off) / typical_m.max(1e-9)).max(1.0);
        for c in 0..row.measured.len() {
            let scale = lever(c) / ROW_SD_M;
            let line = DVector::from_fn(columns, |k, _| match free.get(k) {
                Some(nuisance) => scale * measurements.nuisance_slope(row, &tangents, c, *nuisance),
                None => scale * tangents.effects[(c, k - free.len())],
            });
            right.axpy(weight * scale * (row.measured[c] - tangents.predicted[c]), &line, 1.0);
            normal.ger(weight, &line, &line, 1.0);
        }
    }
    for k in 0..columns {
        let (sd, stands) = match free.get(k) {
            Some(nuisance) => (nuisance.prior_sd(), nuisance.value(assumed)),
            None => {
                let zero = k - free.len();
                let typical = zeros[zero].parameters()[0].typical;
                (ZERO_SD_RAD / typical, assumed.effects[zero].values[0] / typical)
            }
        };
        normal[(k, k)] += sd.powi(-2);
        right[k] -= stands * sd.powi(-2);
    }
    let step = Cholesky::new(normal)?.solve(&right);
    let mut next = assumed.clone();
    measurements.move_nuisances(&mut next, &free, &step.as_slice()[..free.len()], 0.5);
    for (k, present) in next.effects.iter_mut().enumerate() {
        present.values[0] += step[free.len() + k] * present.effect.parameters()[0].typical;
    }
    Some(next)
}
