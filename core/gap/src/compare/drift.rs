//! Repeats that differ by when they were made: something changed in between, and that is no noise.
//!
//! Deviations of rows from the mean of their cell are fitted by a slow course over time and one
//! step. What that explains is a gap; what it leaves is noise. Without this a screen that was
//! bumped halfway, or a horn that slipped, would pass as noise of the repeats.

use nalgebra::DMatrix;

use super::spread::{FEWEST, SIGNIFICANT, Spread};

/// Slow courses: cosines over the whole time.
const COURSES: usize = 3;
/// Moments that are tried for a step.
const MOMENTS: usize = 25;
/// Rows must be spread over this time, s.
const SHORTEST_S: f64 = 60.0;

/// One row: its cell, its time (s) and its coordinates less the mean of its cell.
pub struct Deviation {
    pub cell: usize,
    pub t_secs: f64,
    pub off: Vec<f64>,
}

/// What changed over time.
#[derive(Clone, Debug)]
pub struct Drift {
    /// Probability by chance.
    pub p_value: f64,
    /// Root mean square of what it explains, in units of what it leaves.
    pub size_sigmas: f64,
    /// Variance that it leaves over the variance that there was, per coordinate.
    pub left: Vec<f64>,
}

/// The course over time of rows, where it is there beyond doubt. `free`: degrees of freedom of the
/// deviations.
pub fn drift(rows: &[Deviation], free: f64) -> Option<Drift> {
    let (first, last) = rows
        .iter()
        .fold((f64::MAX, f64::MIN), |(first, last), row| (first.min(row.t_secs), last.max(row.t_secs)));
    if rows.len() < FEWEST || !(last - first >= SHORTEST_S) || free < 2.0 * (COURSES + 2) as f64 {
        return None;
    }
    let width = rows.first()?.off.len();
    let spread = Spread::new(DMatrix::from_fn(rows.len(), width, |r, c| rows[r].off[c]), free);
    let share = |t: f64| (t - first) / (last - first);
    let fits = (1..MOMENTS).filter_map(|moment| {
        let at = moment as f64 / MOMENTS as f64;
        let design = of_cells(rows, |row| {
            let share = share(row.t_secs);
            let step = f64::from(u8::from(share > at));
            let courses = (1..=COURSES).map(|k| (std::f64::consts::PI * k as f64 * share).cos());
            std::iter::once(step).chain(courses).collect()
        });
        spread.fitted_by(&design)
    });
    let left = fits.min_by(|a, b| a.log_share().total_cmp(&b.log_share()))?;
    let p_value = left.p_value(MOMENTS - 1);
    (p_value <= SIGNIFICANT).then(|| Drift { p_value, size_sigmas: left.largest(), left: left.shares() })
}

/// Columns of a function of the rows less their means within cells.
fn of_cells(rows: &[Deviation], of: impl Fn(&Deviation) -> Vec<f64>) -> DMatrix<f64> {
    let columns: Vec<Vec<f64>> = rows.iter().map(of).collect();
    let width = columns.first().map_or(0, Vec::len);
    let mut sums = std::collections::HashMap::<usize, (Vec<f64>, f64)>::new();
    for (row, own) in rows.iter().zip(&columns) {
        let (sum, count) = sums.entry(row.cell).or_insert_with(|| (vec![0.0; width], 0.0));
        sum.iter_mut().zip(own).for_each(|(sum, value)| *sum += value);
        *count += 1.0;
    }
    DMatrix::from_fn(rows.len(), width, |r, c| {
        let (sum, count) = &sums[&rows[r].cell];
        columns[r][c] - sum[c] / count
    })
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::*;

    /// 40 cells of four rows at shuffled times; the second half of the time is off by `step`.
    fn rows(step: f64, seed: u64) -> Vec<Deviation> {
        let mut random = StdRng::seed_from_u64(seed);
        let mut noise = move || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
        let mut clock = StdRng::seed_from_u64(seed + 1);
        let mut all = vec![];
        for cell in 0..40 {
            let times: Vec<f64> = (0..4).map(|_| clock.random_range(0.0..900.0)).collect();
            let measured: Vec<[f64; 2]> =
                times.iter().map(|t| [noise() + if *t > 500.0 { step } else { 0.0 }, noise()]).collect();
            let mean = |c: usize| measured.iter().map(|m| m[c]).sum::<f64>() / 4.0;
            let middle = [mean(0), mean(1)];
            for (t_secs, m) in times.iter().zip(&measured) {
                all.push(Deviation { cell, t_secs: *t_secs, off: vec![m[0] - middle[0], m[1] - middle[1]] });
            }
        }
        all
    }

    #[test]
    fn a_step_between_repeats_is_found_and_leaves_the_noise() {
        for seed in 0..20 {
            let drift = drift(&rows(5.0, 100 + 7 * seed), 120.0).expect("five standard deviations");
            assert!(drift.p_value < 1e-6 && drift.size_sigmas > 1.0);
            // Spread within cells was noise and step; what is left is the noise alone.
            let spread: f64 = rows(5.0, 100 + 7 * seed).iter().map(|row| row.off[0] * row.off[0]).sum();
            let noise = (spread * drift.left[0] / 120.0).sqrt();
            assert!((noise - 1.0).abs() < 0.35, "{noise}");
        }
    }

    #[test]
    fn repeats_without_a_course_have_none() {
        let found = (0..200).filter(|seed| drift(&rows(0.0, 1000 + 7 * seed), 120.0).is_some()).count();
        assert_eq!(found, 0);
    }

    #[test]
    fn too_few_rows_say_nothing() {
        assert!(drift(&rows(5.0, 1)[..20], 15.0).is_none());
    }
}
