//! What the doubt about masses leaves of sizes that were found from loads.
//!
//! A compliance is a turn over a torque, and the torque is that of the description's masses. Every mass is
//! free beside what was found, within what descriptions are usually off by; a known weight that hangs on some
//! rows only tells compliances from masses, and then little is added.

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::Assumed;
use plumbline_effects::measurements::Measurements;
use plumbline_model::JobContext;
use rayon::prelude::*;

use super::linear::Linear;
use super::refit::usual;
use crate::beforehand::{MASS_SD, standard};
use crate::error::GapError;
use crate::floor::Floor;

/// Share of a mass by which the tangent is taken.
const STEP: f64 = 0.1;

/// Covariance that is added to that of the values of all effects in turn, in usual sizes: what other masses
/// would do to them, and how far the values would move with the masses that fit best. `sds`: of each value
/// beforehand. `None` where nothing that was found depends on a load.
///
/// # Errors
/// Cancelled.
pub(super) fn doubt(
    measurements: &Measurements,
    floor: &Floor,
    assumed: &Assumed,
    weights: &[f64],
    (noise, cell): (f64, f64),
    sds: &[f64],
    context: &dyn JobContext,
) -> Result<Option<DMatrix<f64>>, GapError> {
    if !assumed.effects.iter().any(|present| present.effect.kind.is_of_load()) {
        return Ok(None);
    }
    let effects: Vec<_> = assumed.effects.iter().map(|present| present.effect.clone()).collect();
    let mut linear = Linear::of(measurements, floor, assumed, &effects, context)?;
    let count = linear.effects();
    let columns = slopes(measurements, floor, assumed, &linear);
    context.checkpoint()?;
    let masses = columns.ncols();
    if masses == 0 || count != sds.len() {
        return Ok(None);
    }
    linear.append(&columns);
    let (gram, _) = linear.sums(weights, context)?.gram(cell * cell, context)?;
    let gram = gram / (noise * noise);
    let own = linear.gauge + count;
    let mut normal = gram.view((0, 0), (own, own)).clone_owned();
    for k in 0..own {
        let sd =
            linear.nuisances.get(k).map_or_else(|| sds[k - linear.gauge], |nuisance| nuisance.prior_sd());
        normal[(k, k)] += sd.powi(-2);
    }
    let mixed = gram.view((0, own), (own, masses)).clone_owned();
    let mut rest = gram.view((own, own), (masses, masses)).clone_owned();
    // What the values still want, were they alone, is not what masses want.
    let last = own + masses;
    let values = usual(assumed);
    let pull = DVector::from_fn(own, |k, _| match k.checked_sub(linear.gauge) {
        Some(k_own) => gram[(k, last)] - values[k_own] * sds[k_own].powi(-2),
        None => gram[(k, last)],
    });
    let Some(normal) = Cholesky::new(normal) else { return Ok(None) };
    // How values follow masses, the rows given.
    let follow = normal.solve(&mixed);
    let toward = gram.view((own, last), (masses, 1)).clone_owned() - follow.tr_mul(&pull);
    rest -= mixed.tr_mul(&follow);
    for k in 0..masses {
        rest[(k, k)] += MASS_SD.powi(-2);
    }
    let Some(rest) = Cholesky::new(rest) else { return Ok(None) };
    let shift = -(&follow * rest.solve(&toward));
    let added = &follow * rest.solve(&follow.transpose()) + &shift * shift.transpose();
    Ok(Some(added.view((linear.gauge, linear.gauge), (count, count)).clone_owned()))
}

/// How each line changes with each mass, as a share of it.
fn slopes(measurements: &Measurements, floor: &Floor, assumed: &Assumed, linear: &Linear) -> DMatrix<f64> {
    let arms = measurements.apparatuses.iter().filter_map(|apparatus| apparatus.arm.as_ref());
    // Loads of masses that were made up have no size.
    let parts = arms.filter(|arm| !arm.masses_made_up).map(|arm| arm.len()).max().unwrap_or(0);
    let predicted = |measurements: &Measurements| -> Vec<Option<Vec<f64>>> {
        let rows = measurements.rows.par_iter().with_min_len(8);
        rows.map(|row| measurements.predict(row, assumed)).collect()
    };
    let before = predicted(measurements);
    let mut columns = DMatrix::zeros(linear.row.len(), parts);
    for part in 0..parts {
        let mut heavier = measurements.clone();
        for apparatus in &mut heavier.apparatuses {
            let own = apparatus.arm.as_mut().and_then(|arm| arm.parts.get_mut(part));
            own.into_iter().for_each(|part| part.mass_kg *= 1.0 + STEP);
        }
        let after = predicted(&heavier);
        for (line, (&i, &c)) in linear.row.iter().zip(&linear.coordinate).enumerate() {
            let (row, Some((after, before))) =
                (&measurements.rows[i], after[i].as_ref().zip(before[i].as_ref()))
            else {
                continue;
            };
            let Some(own) = floor.of(row.what) else { continue };
            let sd = standard(row.what, c, own.of_row(row, c));
            columns[(line, part)] = (after[c] - before[c]) / STEP / sd;
        }
    }
    columns
}
