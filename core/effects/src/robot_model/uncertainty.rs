//! What the uncertainty of effects' values means for a place.

use nalgebra::{DMatrix, Matrix3, Matrix3xX, Vector3};

use crate::library::Present;
use crate::rig_model::Measured;

/// Steps of differences, as a share of a parameter's usual size.
const STEP: f64 = 1e-3;

/// Covariance (m²) of a place by what is not known of the values of effects. `place` says where it is
/// with given effects. Effects without a covariance count as known. `None`: there is no place.
pub(super) fn of_values(
    effects: &[Measured],
    place: impl Fn(&[Present]) -> Option<Vector3<f64>>,
) -> Option<Matrix3<f64>> {
    let mut present: Vec<Present> = effects.iter().map(|measured| measured.present.clone()).collect();
    let here = place(&present)?;
    let mut sum = Matrix3::zeros();
    for (i, measured) in effects.iter().enumerate() {
        let Some(covariance) = &measured.covariance else { continue };
        let parameters = measured.present.effect.parameters();
        let mut slopes = Matrix3xX::zeros(parameters.len());
        for (k, parameter) in parameters.iter().enumerate() {
            let value = present[i].values[k];
            let mut at = |step: f64| {
                present[i].values[k] = value + step;
                let place = place(&present);
                present[i].values[k] = value;
                place
            };
            slopes.set_column(k, &slope(&mut at, &here, STEP * parameter.typical)?);
        }
        sum += spread(&slopes, covariance);
    }
    Some(sum)
}

/// J C Jᵀ, symmetric.
fn spread(slopes: &Matrix3xX<f64>, covariance: &DMatrix<f64>) -> Matrix3<f64> {
    let spread = slopes * covariance * slopes.transpose();
    let spread: Matrix3<f64> = spread.fixed_view::<3, 3>(0, 0).into();
    (spread + spread.transpose()) * 0.5
}

/// How a place changes; at the border of what can be seen from one side only. `None`: there is no
/// place to either side.
pub(super) fn slope(
    at: &mut impl FnMut(f64) -> Option<Vector3<f64>>,
    here: &Vector3<f64>,
    step: f64,
) -> Option<Vector3<f64>> {
    match (at(step), at(-step)) {
        (Some(ahead), Some(behind)) => Some((ahead - behind) / (2.0 * step)),
        (Some(ahead), None) => Some((ahead - here) / step),
        (None, Some(behind)) => Some((here - behind) / step),
        (None, None) => None,
    }
}
