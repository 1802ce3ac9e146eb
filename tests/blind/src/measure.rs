//! How large an effect is: in units of the spread of repeats, less what a moved screen, another frame or another
//! place of a marker would do.

use nalgebra::{DMatrix, DVector, Matrix6, Vector3, Vector6};

use crate::bench::Bench;
use crate::stage::Met;

/// A direction of which others leave less than this is none of its own.
const OWN_SHARE: f64 = 1e-6;

/// What a touch says beyond the description: along u, against v, out of the glass, m.
pub fn residual_m(bench: &Bench, met: &Met, height_m: f64) -> Vector3<f64> {
    let tip = bench.nominal_tip_m(&met.encoder_rad);
    Vector3::new(met.at_m[0] - tip.x, met.at_m[1] - tip.y, height_m - tip.z)
}

/// Where the tip was sent, less where the encoders say that it was: along u, against v, out of the
/// glass, m.
pub fn lag_m(bench: &Bench, met: &Met) -> Vector3<f64> {
    bench.nominal_tip_m(&met.commanded_rad) - bench.nominal_tip_m(&met.encoder_rad)
}

/// Spread of a touch about the mean of its repeats, per coordinate, m.
pub fn sigma_m(residuals: &[(usize, Vector3<f64>)]) -> Vector3<f64> {
    let cells = residuals.iter().map(|(cell, _)| cell + 1).max().unwrap_or(0);
    let mut sums = vec![(0.0, Vector3::zeros()); cells];
    for (cell, residual) in residuals {
        sums[*cell].0 += 1.0;
        sums[*cell].1 += residual;
    }
    let square: Vector3<f64> = residuals
        .iter()
        .map(|(cell, residual)| (residual - sums[*cell].1 / sums[*cell].0).map(|d| d * d))
        .sum();
    let freedom = residuals.len() as f64 - sums.iter().filter(|(n, _)| *n > 0.0).count() as f64;
    (square / freedom.max(1.0)).map(f64::sqrt)
}

/// Root mean square of displacements at places on the screen, in units of sigma, once the rigid
/// motion of the screen that explains most of them is taken off.
pub fn size_sigmas(places_m: &[Vector3<f64>], moved_m: &[Vector3<f64>], sigma_m: &Vector3<f64>) -> f64 {
    let n = places_m.len();
    let mut design = DMatrix::zeros(3 * n, 6);
    let mut right = DVector::zeros(3 * n);
    for (i, (place, moved)) in places_m.iter().zip(moved_m).enumerate() {
        for k in 0..3 {
            let weight = 1.0 / sigma_m[k];
            design[(3 * i + k, k)] = weight;
            for turn in 0..3 {
                design[(3 * i + k, 3 + turn)] = Vector3::ith(turn, 1.0).cross(place)[k] * weight;
            }
            right[3 * i + k] = moved[k] * weight;
        }
    }
    let normal: Matrix6<f64> = (design.transpose() * &design).fixed_view::<6, 6>(0, 0).into();
    let toward: Vector6<f64> = (design.transpose() * &right).fixed_rows::<6>(0).into();
    let motion = plumbline_model::decompose::pseudo_inverse(normal, 1e-12)
        .map_or_else(Vector6::zeros, |inverse| inverse * toward);
    let left = right - design * motion;
    (left.norm_squared() / (3 * n).max(1) as f64).sqrt()
}

/// Root mean square of residuals per coordinate, where nothing is hidden.
pub fn spread(residuals: &[Vec<f64>]) -> Vec<f64> {
    let each = residuals.first().map_or(0, Vec::len);
    let square = |c: usize| residuals.iter().map(|residual| residual[c].powi(2)).sum::<f64>();
    (0..each).map(|c| (square(c) / residuals.len().max(1) as f64).sqrt()).collect()
}

/// What is left of changes once the part is taken off that columns of what nobody knows explain. All of it is divided
/// by sigma already.
pub fn beside(moved: &DVector<f64>, unknown: &DMatrix<f64>) -> DVector<f64> {
    let mut apart: Vec<DVector<f64>> = vec![];
    for column in unknown.column_iter() {
        let left = without(&apart, column.clone_owned());
        // What columns before explain, up to rounding, is no direction of its own.
        if left.norm() > OWN_SHARE * column.norm() {
            apart.push(left.normalize());
        }
    }
    without(&apart, moved.clone())
}

/// What is left beside directions that are square to each other; twice, since once leaves roundings (Gram and Schmidt).
fn without(apart: &[DVector<f64>], mut left: DVector<f64>) -> DVector<f64> {
    for direction in apart.iter().chain(apart) {
        left.axpy(-direction.dot(&left), direction, 1.0);
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_moved_screen_has_no_size_and_a_bow_has() {
        let places: Vec<Vector3<f64>> =
            (0..40).map(|i| Vector3::new(0.05 * f64::from(i % 8), 0.05 * f64::from(i / 8), 0.0)).collect();
        let turn = Vector3::new(0.01, -0.02, 0.03);
        let rigid: Vec<_> = places.iter().map(|p| turn.cross(p) + Vector3::new(0.004, 0.0, -0.001)).collect();
        let sigma = Vector3::new(1e-3, 1e-3, 5e-4);
        assert!(size_sigmas(&places, &rigid, &sigma) < 1e-6);
        let bowed: Vec<_> = places.iter().map(|p| Vector3::new(0.0, 0.0, 0.3 * p.x * p.x)).collect();
        assert!(size_sigmas(&places, &bowed, &sigma) > 1.0);
    }

    #[test]
    fn what_the_unknown_explains_has_no_size() {
        let columns = DMatrix::from_fn(30, 3, |i, k| (0.3 * i as f64).powi(k as i32) * [1.0, 1e-3, 1e4][k]);
        let inside = &columns * DVector::from_vec(vec![2.0, -700.0, 3e-5]);
        let outside = DVector::from_fn(30, |i, _| if i % 2 == 0 { 1.0 } else { -1.0 });
        let size = |moved: &DVector<f64>| beside(moved, &columns).norm() / 30f64.sqrt();
        assert!(size(&inside) < 1e-6);
        assert!((0.9..1.0).contains(&size(&(inside + &outside))));
        assert_eq!(beside(&outside, &DMatrix::zeros(30, 0)), outside);
    }

    #[test]
    fn the_spread_is_that_of_repeats() {
        let residuals: Vec<(usize, Vector3<f64>)> = (0..200)
            .map(|i| (i / 2, Vector3::new((i / 2) as f64 + if i % 2 == 0 { 1.0 } else { -1.0 }, 0.0, 0.0)))
            .collect();
        assert!((sigma_m(&residuals).x - 2f64.sqrt()).abs() < 1e-9);
    }
}
