//! Small statistics that several steps share.

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

/// Standard deviation about zero by the median of absolute values; right for normal noise, and not
/// moved by outliers. 0 of nothing.
pub fn robust_sd(values: impl IntoIterator<Item = f64>) -> f64 {
    1.4826 * median(values.into_iter().map(f64::abs)).unwrap_or(0.0)
}

/// Probability that a value of Fisher's F with these degrees of freedom is at least `value`.
pub fn f_tail(value: f64, above: f64, below: f64) -> f64 {
    if !(value > 0.0) {
        return 1.0;
    }
    incomplete_beta(below / 2.0, above / 2.0, below / (below + above * value))
}

/// Quantile of the normal distribution for the 95 % interval.
pub const NORMAL_95: f64 = 1.959_964;

/// Regularized incomplete beta function by its continued fraction (Lentz).
fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    let front = (ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * x.ln() + b * (1.0 - x).ln()).exp();
    // The fraction converges fast on one side of the mean only.
    if x < (a + 1.0) / (a + b + 2.0) {
        front * fraction(a, b, x) / a
    } else {
        1.0 - front * fraction(b, a, 1.0 - x) / b
    }
}

fn fraction(a: f64, b: f64, x: f64) -> f64 {
    let tiny = 1e-300;
    let away = |value: f64| if value.abs() < tiny { tiny } else { value };
    let mut d = 1.0 / away(1.0 - (a + b) * x / (a + 1.0));
    let (mut c, mut product) = (1.0, d);
    for m in 1..20_000 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / away(1.0 + even * d);
        c = away(1.0 + even / c);
        product *= d * c;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / away(1.0 + odd * d);
        c = away(1.0 + odd / c);
        product *= d * c;
        if (d * c - 1.0).abs() < 1e-12 {
            break;
        }
    }
    product
}

/// Logarithm of the gamma function (Lanczos).
fn ln_gamma(x: f64) -> f64 {
    const COEFFICIENTS: [f64; 6] = [
        76.180_091_729_471_46,
        -86.505_320_329_416_77,
        24.014_098_240_830_91,
        -1.231_739_572_450_155,
        0.120_865_097_386_617_9e-2,
        -0.539_523_938_495_3e-5,
    ];
    let shifted = x + 5.5;
    let base = (x + 0.5) * shifted.ln() - shifted;
    let series: f64 = COEFFICIENTS.iter().enumerate().map(|(i, c)| c / (x + 1.0 + i as f64)).sum::<f64>()
        + 1.000_000_000_190_015;
    base + (2.506_628_274_631_000_5 * series / x).ln()
}

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
}
