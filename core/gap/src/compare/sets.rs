//! Whether one set of what the eyes saw is off by itself.
//!
//! An eye that was knocked while one set was measured is off in all of its rows alike, and in no other row. What goes
//! smoothly with anything that was logged hardly shows that where every set has its own posture of the head, and few rows.

use std::collections::BTreeMap;

use plumbline_effects::measurements::{Measurements, What};
use plumbline_model::JobContext;
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand::seq::SliceRandom;

use crate::error::GapError;

/// Exchanges of rows between sets: the smallest probability that they can show is one over one more.
const EXCHANGES: usize = 1999;
/// The share of what counts as chance that this test takes; the rest is that of the test for what goes smoothly
/// (weighted Bonferroni), which tells of more.
const SHARE: f64 = 0.2;

/// Probability by chance that some set's mean lies so far from that of all rows. `None` where the eyes did not measure in
/// sets.
///
/// # Errors
/// Cancelled.
pub(super) fn by_chance(
    measurements: &Measurements,
    told: &[(usize, &[f64])],
    seed: u64,
    context: &dyn JobContext,
) -> Result<Option<f64>, GapError> {
    let labels = measurements.sets_of_eyes();
    let mut of_kind = BTreeMap::<What, Vec<(usize, &[f64])>>::new();
    for (row, residual) in told {
        let row = &measurements.rows[*row];
        let set = row.set.as_ref().and_then(|own| labels.iter().position(|label| label == own));
        if let Some(set) = set.filter(|_| !row.what.is_placed()) {
            of_kind.entry(row.what).or_default().push((set, residual));
        }
    }
    // Of two kinds the one with more rows speaks.
    let Some(rows) = of_kind.into_values().max_by_key(Vec::len) else { return Ok(None) };
    let residuals: Vec<&[f64]> = rows.iter().map(|(_, residual)| *residual).collect();
    let mut sets: Vec<usize> = rows.iter().map(|(set, _)| *set).collect();
    let observed = farthest(&sets, &residuals, labels.len());
    let mut random = StdRng::seed_from_u64(seed);
    let mut as_far = 0_usize;
    for _ in 0..EXCHANGES {
        context.checkpoint()?;
        sets.shuffle(&mut random);
        as_far += usize::from(farthest(&sets, &residuals, labels.len()) >= observed);
    }
    Ok(Some((as_far + 1) as f64 / (EXCHANGES + 1) as f64))
}

/// Probability by chance of both tests together.
pub(super) fn together(by_dependence: f64, by_sets: f64) -> f64 {
    (by_dependence / (1.0 - SHARE)).min(by_sets / SHARE).min(1.0)
}

/// How far the mean of the set that lies farthest off lies from that of all rows: squares of all coordinates, times its
/// number of rows.
fn farthest(sets: &[usize], residuals: &[&[f64]], count: usize) -> f64 {
    let coordinates = residuals.first().map_or(0, |residual| residual.len());
    let mut sums = vec![vec![0.0; coordinates]; count];
    let mut rows = vec![0.0_f64; count];
    let mut whole = vec![0.0; coordinates];
    for (&set, residual) in sets.iter().zip(residuals) {
        rows[set] += 1.0;
        for (c, value) in residual.iter().enumerate() {
            sums[set][c] += value;
            whole[c] += value / residuals.len() as f64;
        }
    }
    let off = |(sum, rows): (&Vec<f64>, &f64)| {
        let square = |(sum, mean): (&f64, &f64)| (sum / rows - mean).powi(2);
        rows * sum.iter().zip(&whole).map(square).sum::<f64>()
    };
    sums.iter().zip(&rows).filter(|(_, rows)| **rows > 0.0).map(off).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_set_that_is_off_by_itself_lies_farthest() {
        let near = [0.1, -0.1];
        let off = [1.0, 0.0];
        let residuals: Vec<&[f64]> = vec![&near, &near, &off, &off];
        let apart = farthest(&[0, 0, 1, 1], &residuals, 2);
        let mixed = farthest(&[0, 1, 0, 1], &residuals, 2);
        assert!(apart > 0.4 && mixed < 1e-12, "{apart} {mixed}");
    }

    #[test]
    fn either_test_can_tell_of_a_gap_and_both_together_are_no_surer_than_chance() {
        assert!(together(0.0025, 1.0) < 0.01 && together(1.0, 0.0005) < 0.01);
        assert!(together(0.009, 0.5) > 0.01 && together(0.5, 0.009) > 0.01);
        assert!((together(0.9, 0.9) - 1.0).abs() < 1e-12);
    }
}
