//! Effects that are taken for given, sized by the touches and by their usual sizes: least squares with
//! every parameter drawn to zero as far as robots usually have it (the posterior mode under normal
//! priors), the screen's place fitted with them.

use nalgebra::{DMatrix, DVector, Isometry3};
use plumbline_effects::measurements::Observation;
use plumbline_effects::{Assumed, Effect, Measurements, Present};

use super::plan::{NOISE_M, SCREEN_SD, beside};

/// Rounds of linearizing.
const ROUNDS: usize = 6;

/// A fit.
pub(super) struct Fit {
    /// Effects with their values, and where the screen lies.
    pub assumed: Assumed,
    /// Covariance of the values, in units of the parameters, effects in turn.
    pub covariance: DMatrix<f64>,
}

/// Fits effects to rows of one session of touches. `None` when the rows cannot be predicted.
pub(super) fn fit(measurements: &Measurements, rows: &[&Observation], effects: &[Effect]) -> Option<Fit> {
    let typical: Vec<f64> =
        effects.iter().flat_map(|effect| effect.parameters().iter().map(|p| p.typical)).collect();
    let count = 6 + typical.len();
    let sd = |k: usize| if k < 6 { SCREEN_SD[k / 3] } else { 1.0 };
    let mut assumed = Assumed {
        effects: effects
            .iter()
            .map(|effect| Present { effect: effect.clone(), values: vec![0.0; effect.parameters().len()] })
            .collect(),
        placements: vec![Isometry3::identity()],
    };
    // Where the fit stands, in the units of the tangents.
    let mut at = DVector::<f64>::zeros(count);
    let mut inverse = DMatrix::identity(count, count);
    for _ in 0..ROUNDS {
        let mut normal = DMatrix::from_diagonal(&DVector::from_fn(count, |k, _| sd(k).powi(-2)));
        let mut right = DVector::from_fn(count, |k, _| -at[k] / sd(k).powi(2));
        for row in rows {
            let tangents = measurements.tangents(row, &assumed, effects)?;
            let slopes = beside(&tangents.gauge, &tangents.effects);
            for (k, noise_m) in NOISE_M.into_iter().enumerate() {
                let weight = noise_m.powi(-2);
                let slope = slopes.row(k);
                normal += slope.transpose() * slope * weight;
                right += slope.transpose() * ((row.measured[k] - tangents.predicted[k]) * weight);
            }
        }
        let factor = normal.cholesky()?;
        let change = factor.solve(&right);
        inverse = factor.inverse();
        let twist: [f64; 6] = std::array::from_fn(|k| change[k]);
        assumed.placements[0] = measurements.moved(0, &assumed.placements[0], &twist);
        at += &change;
        let mut k = 6;
        for present in &mut assumed.effects {
            for value in &mut present.values {
                *value = at[k] * typical[k - 6];
                k += 1;
            }
        }
        if change.amax() < 1e-7 {
            break;
        }
    }
    let n = typical.len();
    let covariance = DMatrix::from_fn(n, n, |r, c| inverse[(6 + r, 6 + c)] * typical[r] * typical[c]);
    Some(Fit { assumed, covariance })
}

/// Error on rows that were not fitted, each group of repeats held out once: rms of the distance along
/// the glass and of the height together, m.
pub(super) fn held_out_m(measurements: &Measurements, effects: &[Effect]) -> Option<f64> {
    let mut squares = 0.0;
    for cell in 0..measurements.cell_count() {
        let (back, used): (Vec<&Observation>, Vec<&Observation>) =
            measurements.rows.iter().partition(|row| row.cell == cell);
        let fitted = fit(measurements, &used, effects)?;
        for row in back {
            let predicted = measurements.predict(row, &fitted.assumed)?;
            squares += (0..3).map(|k| (row.measured[k] - predicted[k]).powi(2)).sum::<f64>();
        }
    }
    let rows = measurements.rows.len();
    (rows > 0).then(|| (squares / rows as f64).sqrt())
}
