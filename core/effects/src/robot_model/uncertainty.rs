//! What the uncertainty of effects' values means for a place.

use nalgebra::{Matrix3, Matrix3xX, Vector3};

use crate::library::Present;
use crate::rig_model::Measured;

/// Steps of differences, as a share of a parameter's usual size.
const STEP: f64 = 1e-3;

/// Covariance (m²) of a place by what is not known of the values of effects, symmetric. `place` says where it
/// is with given effects. Effects without a covariance count as known. `None`: there is no place.
pub(super) fn of_values(
    effects: &Measured,
    place: impl Fn(&[Present]) -> Option<Vector3<f64>>,
) -> Option<Matrix3<f64>> {
    let mut present = effects.present.clone();
    let here = place(&present)?;
    let mut slopes = Matrix3xX::zeros(effects.covariance.ncols());
    let mut column = 0;
    for (i, own) in effects.present.iter().enumerate() {
        for (k, parameter) in own.effect.parameters().iter().enumerate() {
            // What is known costs nothing.
            if effects.covariance[(column, column)] > 0.0 {
                let mut at = |step: f64| {
                    present[i].values[k] = own.values[k] + step;
                    let place = place(&present);
                    present[i].values[k] = own.values[k];
                    place
                };
                slopes.set_column(column, &slope(&mut at, &here, STEP * parameter.typical)?);
            }
            column += 1;
        }
    }
    let spread = &slopes * &effects.covariance * slopes.transpose();
    let spread: Matrix3<f64> = spread.fixed_view::<3, 3>(0, 0).into();
    Some((spread + spread.transpose()) * 0.5)
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
