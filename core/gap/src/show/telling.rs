//! Which covariates gave the effects away.

use nalgebra::{DMatrix, DVector, Vector3};
use plumbline_model::decompose;

use crate::covariates::Covariates;

/// Names at most.
const MOST: usize = 6;
/// A covariate tells when it explains at least this share beyond what chance would …
const LEAST_SHARE: f64 = 0.05;
/// … and at least this many times as much as chance.
const BEYOND_CHANCE: f64 = 4.0;

/// Covariates by the share of the squared residual that a cubic curve over them explains, the
/// strongest first.
pub(super) fn telling(covariates: &Covariates, arrows: &[(usize, Vector3<f64>)]) -> Vec<usize> {
    let mut shares: Vec<(f64, usize)> =
        (0..covariates.names.len()).filter_map(|c| Some((share(covariates, arrows, c)?, c))).collect();
    shares.sort_by(|a, b| b.0.total_cmp(&a.0));
    shares.into_iter().take(MOST).map(|(_, c)| c).collect()
}

fn share(covariates: &Covariates, arrows: &[(usize, Vector3<f64>)], c: usize) -> Option<f64> {
    let known: Vec<(f64, Vector3<f64>)> =
        arrows.iter().filter_map(|(row, arrow)| Some((covariates.values[*row][c]?, *arrow))).collect();
    let count = known.len();
    if count < 12 {
        return None;
    }
    let low = known.iter().map(|(value, _)| *value).fold(f64::INFINITY, f64::min);
    let high = known.iter().map(|(value, _)| *value).fold(f64::NEG_INFINITY, f64::max);
    if !(high > low) {
        return None;
    }
    let levels =
        known.iter().map(|(value, _)| value.to_bits()).collect::<std::collections::BTreeSet<_>>().len();
    let degree = (levels - 1).min(3);
    let curve = DMatrix::from_fn(count, degree + 1, |i, k| {
        let scaled = 2.0 * (known[i].0 - low) / (high - low) - 1.0;
        scaled.powi(i32::try_from(k).unwrap_or(0))
    });
    let svd = decompose::svd(curve.clone(), true, true)?;
    let (mut explained, mut whole) = (0.0, 0.0);
    for axis in 0..3 {
        let values = DVector::from_iterator(count, known.iter().map(|(_, arrow)| arrow[axis]));
        let mean = values.mean();
        let values = values.add_scalar(-mean);
        let fit = &curve * svd.solve(&values, 1e-9).ok()?;
        explained += fit.norm_squared();
        whole += values.norm_squared();
    }
    let share = explained / whole.max(f64::MIN_POSITIVE);
    let chance = degree as f64 / (count as f64 - 1.0);
    (share > LEAST_SHARE + chance && share > BEYOND_CHANCE * chance).then_some(share)
}
