//! Round numbers for scales.

/// At most `most` round values (1, 2, 5 times a power of ten) inside a range, ascending. Empty
/// for a range that is empty or not finite.
pub fn ticks(low: f64, high: f64, most: usize) -> Vec<f64> {
    let step = match step(low, high, most) {
        Some(step) => step,
        None => return Vec::new(),
    };
    let [first, last] = inside(low, high, step).map(|i| i as i64);
    (first..=last).map(|i| i as f64 * step).collect()
}

/// First and last multiple of the step inside the range. Ends that went through `f32` count as
/// the round numbers that they were.
fn inside(low: f64, high: f64, step: f64) -> [f64; 2] {
    [(low / step - 1e-5).ceil(), (high / step + 1e-5).floor()]
}

/// The smallest round step that gives at most `most` ticks.
fn step(low: f64, high: f64, most: usize) -> Option<f64> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0 && most > 0) {
        return None;
    }
    let rough = span / most as f64;
    let power = 10f64.powf(rough.log10().floor());
    let fits = |step: f64| {
        let [first, last] = inside(low, high, step);
        last - first + 1.0 <= most as f64
    };
    [1.0, 2.0, 5.0, 10.0, 20.0].into_iter().map(|factor| factor * power).find(|step| fits(*step))
}

/// Where a scale from zero should end so that `largest` fits and the end is round.
pub fn round_up(largest: f64) -> f64 {
    if !(largest.is_finite() && largest > 0.0) {
        return 1.0;
    }
    let power = 10f64.powf(largest.log10().floor());
    let factors = [1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
    let fits = |factor: &f64| factor * power >= largest * (1.0 - 1e-9);
    factors.into_iter().find(fits).unwrap_or(10.0) * power
}

/// Labels for ticks, all with the same number of decimals: as few as tell them apart.
pub fn labels(ticks: &[f64]) -> Vec<String> {
    let decimals = (0..6)
        .find(|d| {
            let unit = 10f64.powi(*d);
            ticks.iter().all(|t| (t * unit - (t * unit).round()).abs() < 1e-6)
        })
        .unwrap_or(6);
    ticks.iter().map(|t| crate::format::fixed(*t, decimals as usize)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_inside_and_few() {
        assert_eq!(ticks(0.0, 0.31, 4), [0.0, 0.1, 0.2, 0.30000000000000004]);
        assert_eq!(ticks(-7.0, 12.0, 5), [-5.0, 0.0, 5.0, 10.0]);
        assert_eq!(ticks(0.0, f64::from(0.005f32) * 1e3, 6).len(), 6);
        for (low, high) in [(0.0, 1.0), (0.2, 0.6), (-3e-4, 9e-4), (0.0, 12_345.0)] {
            for most in 2..9 {
                let found = ticks(low, high, most);
                assert!(found.len() <= most && !found.is_empty(), "{low}..{high}, {most}: {found:?}");
                assert!(found.iter().all(|t| (low - 1e-5..=high + 1e-5).contains(t)));
            }
        }
    }

    #[test]
    fn empty_ranges_have_no_ticks() {
        assert!(ticks(1.0, 1.0, 5).is_empty());
        assert!(ticks(f64::NAN, 1.0, 5).is_empty());
        assert!(ticks(2.0, 1.0, 5).is_empty());
    }

    #[test]
    fn scales_end_at_round_numbers_above() {
        assert!((round_up(0.096) - 0.1).abs() < 1e-12);
        assert!((round_up(0.101) - 0.12).abs() < 1e-12);
        assert!((round_up(3.0) - 3.0).abs() < 1e-12);
        assert_eq!(round_up(0.0), 1.0);
    }

    #[test]
    fn labels_share_their_decimals() {
        assert_eq!(labels(&[0.0, 0.05, 0.1]), ["0.00", "0.05", "0.10"]);
        assert_eq!(labels(&[-5.0, 0.0, 5.0]), ["−5", "0", "5"]);
    }
}
