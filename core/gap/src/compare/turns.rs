//! A joint that turns the other way than in the model, or by half or twice as much. Everything that
//! follows would be nonsense, so it stops here and says which joint.
//!
//! Every joint is tried by itself: with its angles changed, frames and the zeros of all joints fitted
//! anew, so that a zero that is off does not look like a turn. The change is believed where it makes the
//! rest clearly smaller, and, of a factor, where errors of usual size do not make it nearly as small: on a few
//! lines of touches in one posture a wrong ratio of another joint and a stretched screen look like half a turn. Where
//! they leave clearly less, a joint that turns the other way is not believed either: a screen that is too wide, or a link of
//! another length beside a zero, look like a wrist that does.

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::measurements::{Measurements, What};
use plumbline_effects::{Assumed, Effect, Kind, Present};
use plumbline_model::JobContext;

use super::{frames, mirror};
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

/// Errors of usual size explain as much as a factor when they leave no more than so many times as much.
const AS_WELL: f64 = 2.0;
/// They explain more than a joint that turns the other way when they leave less than this share of what that leaves, as
/// much less as it has to leave than zeros alone.
const CLEARLY_BETTER: f64 = 0.6;
/// What they are: all that changes smoothly with the posture.
const USUAL: [Kind; 5] =
    [Kind::JointScale, Kind::AxisSkew, Kind::LinkLength, Kind::TipOffset, Kind::ScreenScale];

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
    mirror::check(&only, session, best.map(|(with_m, ..)| with_m), context)?;
    let Some((with_m, j, turns)) = best else { return Ok(()) };
    let kinds: Vec<Kind> = [Kind::JointZero].into_iter().chain(USUAL).collect();
    let enough = if turns == Turns::TheOtherWay { CLEARLY_BETTER } else { AS_WELL };
    if left_with_m(&only, session, &kinds, context)? < enough * with_m {
        return Ok(());
    }
    Err(GapError::OtherTurn {
        session: measurements.apparatuses[session].title.clone(),
        joint: arm.parts[j].joint.clone(),
        turns,
        off_m: left_m,
        with_m,
    })
}

/// Mean length of what is left with frames and zeros fitted, m.
pub(super) fn left_m(
    measurements: &Measurements,
    session: usize,
    context: &dyn JobContext,
) -> Result<f64, GapError> {
    left_with_m(measurements, session, &[Kind::JointZero], context)
}

/// The same with all that these kinds can do at single sites, in usual sizes.
fn left_with_m(
    measurements: &Measurements,
    session: usize,
    kinds: &[Kind],
    context: &dyn JobContext,
) -> Result<f64, GapError> {
    let rows: Vec<usize> = (0..measurements.rows.len()).collect();
    let mut assumed = frames::placed(measurements, &rows, context)?;
    let arm = measurements.apparatuses[session].arm.as_ref();
    let touches = measurements.has(What::Touch);
    let effects: Vec<Effect> = kinds
        .iter()
        .filter(|kind| touches || **kind != Kind::ScreenScale)
        .flat_map(|kind| Effect::sites(*kind, arm, None))
        .filter(|effect| !effect.is_of_every_site())
        .collect();
    let absent = |effect: &Effect| vec![0.0; effect.parameters().len()];
    assumed.effects =
        effects.iter().map(|effect| Present { effect: effect.clone(), values: absent(effect) }).collect();
    let mut left_m = miss_m(measurements, &assumed);
    for _ in 0..STEPS {
        let Some(next) = stepped(measurements, &assumed, &effects, left_m) else { break };
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

/// One step of frames, marker and effects; rows that are far off count less.
fn stepped(
    measurements: &Measurements,
    assumed: &Assumed,
    effects: &[Effect],
    typical_m: f64,
) -> Option<Assumed> {
    let free = measurements.nuisances();
    // How far each value may be off and where it stands, in usual sizes.
    let values: Vec<(f64, f64)> = effects
        .iter()
        .zip(&assumed.effects)
        .flat_map(|(effect, present)| {
            let zero = effect.kind == Kind::JointZero;
            let parameters = effect.parameters().iter().zip(&present.values);
            parameters.map(move |(parameter, value)| {
                (if zero { ZERO_SD_RAD / parameter.typical } else { 1.0 }, value / parameter.typical)
            })
        })
        .collect();
    let columns = free.len() + values.len();
    let mut normal = DMatrix::zeros(columns, columns);
    let mut right = DVector::zeros(columns);
    for row in &measurements.rows {
        let tangents = measurements.tangents(row, assumed, effects)?;
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
            None => values[k - free.len()],
        };
        normal[(k, k)] += sd.powi(-2);
        right[k] -= stands * sd.powi(-2);
    }
    let step = Cholesky::new(normal)?.solve(&right);
    let mut next = assumed.clone();
    measurements.move_nuisances(&mut next, &free, &step.as_slice()[..free.len()], 0.5);
    let mut at = free.len();
    for present in &mut next.effects {
        for (value, parameter) in present.values.iter_mut().zip(present.effect.parameters()) {
            *value += step[at] * parameter.typical;
            at += 1;
        }
    }
    Some(next)
}
