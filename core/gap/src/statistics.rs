//! Small statistics that several steps share.

use statrs::function::beta::checked_beta_reg;
use statrs::function::erf::erfc;

/// Median; `None` of nothing.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    if values.is_empty() {
        return None;
    }
    let middle = values.len() / 2;
    let (below, at, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    let at = *at;
    if below.len() == middle && values.len().is_multiple_of(2) {
        let lower = values[..middle].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        return Some(0.5 * (lower + at));
    }
    Some(at)
}

/// ln 2Φ(mean/sd): by how much the evidence of a normal parameter changes when it cannot be negative.
pub fn ln_not_negative(mean: f64, variance: f64) -> f64 {
    const FAR: f64 = -25.0;
    let sigmas = mean / variance.max(f64::MIN_POSITIVE).sqrt();
    if sigmas < FAR {
        // The integral is nearly smaller than any number; its tail is the density over the distance.
        -0.5 * sigmas * sigmas - (-sigmas * std::f64::consts::FRAC_PI_2.sqrt()).ln()
    } else {
        erfc(-sigmas / std::f64::consts::SQRT_2).ln()
    }
}

/// Standard deviation about zero by the median of absolute values; right for normal noise, and not
/// moved by outliers. 0 of nothing.
pub fn robust_sd(values: impl IntoIterator<Item = f64>) -> f64 {
    1.4826 * median(values.into_iter().map(f64::abs)).unwrap_or(0.0)
}

/// Where a detector goes in steps, more than half of the values may be the very same: their spread is what this
/// share of them lies within, and what that is of a standard deviation.
const WITHIN: f64 = 0.8;
const WITHIN_SIGMAS: f64 = 1.2816;

/// Standard deviation about zero of values that may go in steps; a fifth of them may be anything. 0 of nothing.
pub fn stepped_sd(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let last = (WITHIN * sizes.len() as f64).ceil() as usize;
    let within = last.checked_sub(1).and_then(|k| sizes.get(k)).map_or(0.0, |size| size / WITHIN_SIGMAS);
    within.max(robust_sd(sizes))
}

/// Noise of the coordinates of what eyes watch is of one kind, pixels: none is less than this share of the largest,
/// however often a detector says the very same.
pub const ALIKE: f64 = 0.25;

/// Probability that a value of Fisher's F with these degrees of freedom is at least `value`.
pub fn f_tail(value: f64, above: f64, below: f64) -> f64 {
    if !(value > 0.0) {
        return 1.0;
    }
    checked_beta_reg(below / 2.0, above / 2.0, below / (below + above * value)).unwrap_or(f64::NAN)
}

/// Quantile of the normal distribution for the 95 % interval.
pub const NORMAL_95: f64 = 1.959_964;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_are_those_of_the_tables() {
        // Upper 5 % and 1 % points of F.
        for (value, above, below, tail) in [
            (3.3258, 5.0, 10.0, 0.05),
            (1.8389, 20.0, 40.0, 0.05),
            (2.3689, 20.0, 40.0, 0.01),
            (161.448, 1.0, 1.0, 0.05),
        ] {
            assert!(
                (f_tail(value, above, below) - tail).abs() < 2e-4,
                "{value}: {}",
                f_tail(value, above, below)
            );
        }
    }

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median([3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median([]), None);
    }

    #[test]
    fn a_parameter_that_cannot_be_negative_gains_at_most_a_factor_of_two_and_loses_with_the_square() {
        assert!(ln_not_negative(0.0, 4.0).abs() < 1e-12);
        assert!((ln_not_negative(12.0, 4.0) - 2_f64.ln()).abs() < 1e-6);
        assert!((ln_not_negative(-4.0, 4.0) - (2.0 * 0.022_750_131_9_f64).ln()).abs() < 1e-6);
        // No step where the formula changes, and no infinity.
        let [near, far] = [-24.999, -25.001].map(|sigmas| ln_not_negative(sigmas, 1.0));
        assert!(near > far && near - far < 0.1, "{near} {far}");
        assert!(ln_not_negative(-1e6, 1.0).is_finite());
    }
}
