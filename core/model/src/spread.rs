//! What holds 95 of 100, of standard deviations and covariances: so wide is every ± that people read.

use nalgebra::Matrix3;

/// Of a normal distribution 95 % lie within so many standard deviations.
pub const NORMAL_95: f64 = 1.96;
/// The same, one-sided.
const NORMAL_95_ONE_SIDED: f64 = 1.645;

/// Radius of the ball around its middle that holds 95 % of a normal distribution in space, of its covariance, m²; m.
/// The squared distance is taken for a scaled χ² of the same mean and variance (Satterthwaite 1946), whose 95 % is
/// that of Wilson and Hilferty (1931): within 2 % for any shape. No number where the covariance is none.
pub fn radius_95_m(covariance_m2: &Matrix3<f64>) -> f64 {
    let (mean_m2, squares_m4) = (covariance_m2.trace(), covariance_m2.norm_squared());
    if mean_m2 == 0.0 && squares_m4 == 0.0 {
        return 0.0;
    }
    let freedom = mean_m2.powi(2) / squares_m4;
    let part = 2.0 / (9.0 * freedom);
    (mean_m2 * (1.0 - part + NORMAL_95_ONE_SIDED * part.sqrt()).powi(3)).sqrt()
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Vector3};

    use super::*;

    /// Exact: 1.960 in one direction, 2.448 in two, 2.795 in three.
    #[test]
    fn flat_and_round_ones_are_as_in_the_tables() {
        for (variances, exact) in
            [([1.0, 0.0, 0.0], 1.960), ([1.0, 1.0, 0.0], 2.448), ([1.0, 1.0, 1.0], 2.795)]
        {
            let turn = Rotation3::new(Vector3::new(0.3, -0.8, 0.5));
            let covariance_m2 = turn * Matrix3::from_diagonal(&variances.into()) * turn.inverse();
            let radius_m = radius_95_m(&covariance_m2);
            assert!((radius_m / exact - 1.0).abs() < 0.02, "{variances:?}: {radius_m}");
        }
        assert_eq!(radius_95_m(&Matrix3::zeros()), 0.0);
        assert!(radius_95_m(&Matrix3::from_element(f64::NAN)).is_nan());
    }

    /// Sums of twelve even numbers are near enough to a normal distribution for this.
    #[test]
    fn ninety_five_of_a_hundred_are_within() {
        let mut state = 7_u64;
        let mut even = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let mut normal = || (0..12).map(|_| even()).sum::<f64>() - 6.0;
        for sd_m in [[3.0, 2.0, 1.0], [5.0, 1.0, 1.0], [2.0, 2.0, 0.3]] {
            let radius_m = radius_95_m(&Matrix3::from_diagonal(&sd_m.map(|sd: f64| sd * sd).into()));
            let draws = 40_000;
            let within =
                (0..draws).filter(|_| Vector3::from(sd_m.map(|sd| sd * normal())).norm() < radius_m).count();
            let share = within as f64 / f64::from(draws);
            assert!((share - 0.95).abs() < 0.007, "{sd_m:?}: {share}");
        }
    }
}
