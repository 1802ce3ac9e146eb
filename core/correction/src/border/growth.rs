//! Variance as a sum of parts that grow with distance.

/// Parts of the variance: local, gap, near, far.
pub(super) const PARTS: usize = 4;

const UPDATES: usize = 500;
/// Of a standard normal distribution; 95 % lie within it.
pub(super) const Z_95: f64 = 1.96;

/// A squared residual, and what each part of the variance is multiplied by there.
pub(super) struct Evidence {
    pub squared: f64,
    pub growth: [f64; PARTS],
}

/// Non-negative parts of greatest likelihood under zero-mean normal residuals, by multiplicative
/// updates (each of them raises the likelihood). A part that no evidence speaks of is 0, so are
/// those not `allowed`.
pub(super) fn parts(evidence: &[Evidence], allowed: [bool; PARTS]) -> [f64; PARTS] {
    let squares: f64 = evidence.iter().map(|e| e.squared).sum();
    let mut parts: [f64; PARTS] = std::array::from_fn(|k| {
        let growth: f64 = evidence.iter().map(|e| e.growth[k]).sum();
        if allowed[k] && growth > 0.0 { squares / growth / PARTS as f64 } else { 0.0 }
    });
    for _ in 0..UPDATES {
        let (mut pull, mut push) = ([0.0; PARTS], [0.0; PARTS]);
        for e in evidence {
            let variance = dot(&parts, &e.growth);
            if variance > 0.0 {
                for k in 0..PARTS {
                    pull[k] += e.growth[k] * e.squared / variance.powi(2);
                    push[k] += e.growth[k] / variance;
                }
            }
        }
        for k in 0..PARTS {
            if push[k] > 0.0 {
                parts[k] *= (pull[k] / push[k]).sqrt();
            }
        }
    }
    parts
}

/// Twice the negative logarithm of the likelihood of the parts, less a constant.
pub(super) fn deviance(evidence: &[Evidence], parts: &[f64; PARTS]) -> f64 {
    let term = |e: &Evidence| {
        let variance = dot(parts, &e.growth).max(f64::MIN_POSITIVE);
        variance.ln() + e.squared / variance
    };
    evidence.iter().map(term).sum()
}

pub(super) fn dot(a: &[f64; PARTS], b: &[f64; PARTS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// By how much a standard deviation from `freedom` degrees of freedom must be widened so that
/// 1.96 of it hold 95 %: the quantile of Student's t (expansion of Cornish and Fisher) over that
/// of the normal distribution.
pub(super) fn student_factor(freedom: f64) -> f64 {
    let z = Z_95;
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
    (z + first / freedom + second / freedom.powi(2) + third / freedom.powi(3)) / z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_those_of_the_table_of_students_t() {
        for (freedom, quantile) in [(2.0, 4.303), (3.0, 3.182), (5.0, 2.571), (10.0, 2.228), (30.0, 2.042)] {
            let found = student_factor(freedom) * Z_95;
            assert!((found / quantile - 1.0).abs() < 0.04, "{freedom}: {found}, the table says {quantile}");
        }
    }

    /// Squares that equal a sum of parts exactly are explained by parts of the same sum; a part
    /// that is 0 is approached slowly.
    #[test]
    fn variances_are_recovered() {
        let truth = [2.0, 0.5, 0.0, 0.1];
        let evidence: Vec<Evidence> = (0..200)
            .map(|i| {
                let (g, h) = (f64::from(i % 7) / 2.0, f64::from(i % 11) / 3.0);
                let growth = [1.0, g.powi(2), h.powi(2), h.powi(4)];
                Evidence { squared: dot(&truth, &growth), growth }
            })
            .collect();
        let found = parts(&evidence, [true; PARTS]);
        for Evidence { squared, growth } in evidence {
            let variance = dot(&found, &growth);
            assert!((variance / squared - 1.0).abs() < 0.06, "{growth:?}: {variance} for {squared}");
        }
        let near = Evidence { squared: 4.0, growth: [1.0, 0.0, 0.0, 0.0] };
        let [local, growth @ ..] = parts(&[near], [true; PARTS]);
        assert!((local - 4.0).abs() < 1e-9 && growth == [0.0; PARTS - 1]);
    }
}
