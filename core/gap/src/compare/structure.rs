//! Repeats that differ by what was logged of them: noise with structure is no noise.
//!
//! Deviations of rows from the mean of their cell are regressed, one covariate at a time, on a wobble
//! over time (or over the order of the rows), on a jump at a moment that is not the same everywhere, on how each joint came to
//! its angle, and on temperature.
//! What that explains beyond chance is a gap; what it leaves is noise.

use nalgebra::DMatrix;

use super::levers::{by_lag, by_levers};
use super::slips::by_slips;
use super::spread::{SIGNIFICANT, Spread};
use crate::statistics::robust_sd;

/// Fewer rows with repeats than this say nothing.
const FEWEST: usize = 20;
/// Full turns of a wobble that are tried at most, and rows that each needs.
const MOST_TURNS: usize = 60;
const ROWS_PER_TURN: usize = 6;
/// Moments at which something may have jumped that are tried at most (Quandt 1960).
const MOST_MOMENTS: usize = 24;
/// The same of a thing that was watched, by halves of a turn; fewer rows say nothing.
const LOOKS_PER_TURN: usize = 4;
const FEWEST_LOOKS: usize = 16;
/// A joint that came from further away than this came all the way from one side, rad.
pub const SIDE_RAD: f64 = 0.02;
/// A covariate that repeats hardly differ in (share of its variance) says nothing.
pub const LEAST_WITHIN: f64 = 0.05;
/// Deviations beyond this many robust standard deviations count as that far.
const FAR: f64 = 4.0;

/// One repeat: what is known of it, and its coordinates less the mean of its cell.
pub struct Repeat {
    pub cell: usize,
    /// Time (s), or place in the order of the rows where times are not known.
    pub when: f64,
    /// How far each joint turned since the row before, rad; empty for the first.
    pub turned_rad: Vec<f64>,
    /// Mean temperature, °C.
    pub temperature_c: Option<f64>,
    /// Where its cell lies, along two axes in their units; `None` where that is no place of the arm.
    pub at: Option<[f64; 2]>,
    pub off: Vec<f64>,
    /// What the turn of each joint does to each coordinate, where that differs from pose to pose; else empty.
    pub levers: Vec<Vec<f64>>,
    /// What it does to each coordinate that the joints lag as they do; empty where they lag alike in all repeats.
    pub lagged: Vec<f64>,
}

/// What repeats depend on.
#[derive(Clone, Debug)]
pub struct Structure {
    /// For people: what depends.
    pub of: &'static str,
    /// For people: "time", "where the elbow came from".
    pub on: String,
    /// Probability by chance, of all that was tried.
    pub p_value: f64,
    /// Root mean square over coordinates of what it explains, in units of what it leaves.
    pub size_sigmas: f64,
    /// Variance that it leaves over the variance that there was, per coordinate.
    pub left: Vec<f64>,
}

impl Structure {
    /// Of what is left.
    pub fn new(on: String, p_value: f64, left: Vec<f64>) -> Self {
        let explained = left.iter().map(|left| (1.0 - left).max(0.0) / left.max(1e-12));
        let size_sigmas = (explained.sum::<f64>() / left.len().max(1) as f64).sqrt();
        Self { of: "spread of repeats", on, p_value, size_sigmas, left }
    }
}

/// The strongest dependence beyond doubt. `free`: degrees of freedom of the deviations; `when`: what
/// [`Repeat::when`] is, `joints`: names of those that turned, for people.
pub fn structure(rows: &[Repeat], free: f64, when: &str, joints: &[String]) -> Option<Structure> {
    let width = rows.first()?.off.len();
    if rows.len() < FEWEST || free < 0.5 * FEWEST as f64 {
        return None;
    }
    let spread = Spread::new(tamed(rows, width), free);
    let has_levers = rows.iter().all(|row| !row.levers.is_empty());
    let tried = covariates(rows, when, joints);
    let fits = tried.len() + 1 + if has_levers { joints.len() } else { 0 };
    let by_levers = if has_levers { by_levers(rows, &spread, joints, fits) } else { None };
    let by_slips = if has_levers { by_slips(rows, &spread, joints.len(), fits, when) } else { None };
    let by_lag = by_lag(rows, &spread, fits);
    let others = by_levers.into_iter().chain(by_slips).chain(by_lag);
    let mut best = others.min_by(|a, b| a.p_value.total_cmp(&b.p_value));
    for (on, columns) in tried {
        let Some(design) = within_cells(rows, &columns) else { continue };
        let Some(left) = spread.fitted_by(&design) else { continue };
        let p_value = left.p_value(fits);
        if p_value <= SIGNIFICANT && best.as_ref().is_none_or(|best| p_value < best.p_value) {
            best = Some(Structure::new(on, p_value, left.shares()));
        }
    }
    best
}

/// A wobble over time of things that were watched, or of poses, beyond doubt: `cell` tells what stood still, and a course that goes
/// one way is none. `free`: as in [`structure`].
pub fn wobble(rows: &[Repeat], free: f64) -> Option<Structure> {
    let width = rows.first()?.off.len();
    if rows.len() < FEWEST_LOOKS || free < 0.5 * FEWEST_LOOKS as f64 {
        return None;
    }
    let spread = Spread::new(tamed(rows, width), free);
    let looks = rows.iter().filter(|row| row.cell == rows[0].cell).count();
    let tried: Vec<Vec<Vec<f64>>> =
        (2..=2 * looks / LOOKS_PER_TURN).map(|halves| turning(rows, 0.5 * halves as f64)).collect();
    let fits = tried.len();
    let of = |columns: &Vec<Vec<f64>>| {
        let left = spread.fitted_by(&within_cells(rows, columns)?)?;
        Some((left.p_value(fits), left.shares()))
    };
    let (p_value, left) = tried.iter().filter_map(of).min_by(|a, b| a.0.total_cmp(&b.0))?;
    (p_value <= SIGNIFICANT).then(|| Structure::new("time".to_owned(), p_value, left))
}

/// So many turns over all rows: sine and cosine.
fn turning(rows: &[Repeat], turns: f64) -> Vec<Vec<f64>> {
    let ends = rows.iter().fold((f64::MAX, f64::MIN), |(a, b), row| (a.min(row.when), b.max(row.when)));
    let phase = |row: &Repeat| std::f64::consts::TAU * turns * (row.when - ends.0) / (ends.1 - ends.0);
    [f64::sin, f64::cos].map(|of| rows.iter().map(|row| of(phase(row))).collect()).to_vec()
}

/// Deviations, one row each; what is far out is taken as less far.
fn tamed(rows: &[Repeat], width: usize) -> DMatrix<f64> {
    let limit: Vec<f64> = (0..width).map(|c| FAR * robust_sd(rows.iter().map(|row| row.off[c]))).collect();
    DMatrix::from_fn(rows.len(), width, |r, c| {
        let (off, limit) = (rows[r].off[c], limit[c]);
        if limit > 0.0 { off.clamp(-limit, limit) } else { off }
    })
}

/// Everything that is tried: what it is, and its columns.
fn covariates(rows: &[Repeat], when: &str, joints: &[String]) -> Vec<(String, Vec<Vec<f64>>)> {
    let mut all = vec![];
    let (first, last) =
        rows.iter().fold((f64::MAX, f64::MIN), |(a, b), row| (a.min(row.when), b.max(row.when)));
    if last > first {
        for turns in 1..=MOST_TURNS.min(rows.len() / ROWS_PER_TURN) {
            all.push((when.to_owned(), turning(rows, turns as f64)));
        }
        all.extend(jumps(rows).into_iter().map(|columns| (when.to_owned(), columns)));
    }
    for (j, joint) in joints.iter().enumerate() {
        let turned = |row: &Repeat| row.turned_rad.get(j).copied().unwrap_or(0.0);
        let side = rows.iter().map(|row| (turned(row) / SIDE_RAD).tanh()).collect();
        let far = rows.iter().map(turned).collect();
        all.push((format!("where {joint} came from"), vec![side, far]));
    }
    let known: Option<Vec<f64>> = rows.iter().map(|row| row.temperature_c).collect();
    all.extend(known.map(|warmth| ("temperature".to_owned(), vec![warmth])));
    all
}

/// A jump at each of some moments, the same everywhere and growing along both axes of the place: a screen that was knocked has
/// turned as well, which moves touches on its two sides to opposite sides, by nothing on average.
fn jumps(rows: &[Repeat]) -> Vec<Vec<Vec<f64>>> {
    let Some(places) = rows.iter().map(|row| row.at).collect::<Option<Vec<[f64; 2]>>>() else {
        return vec![];
    };
    let along = |axis: usize| -> Vec<f64> {
        let mean = places.iter().map(|at| at[axis]).sum::<f64>() / places.len() as f64;
        let square = places.iter().map(|at| (at[axis] - mean).powi(2)).sum::<f64>() / places.len() as f64;
        places.iter().map(|at| (at[axis] - mean) / square.sqrt().max(1e-12)).collect()
    };
    let axes = [vec![1.0; rows.len()], along(0), along(1)];
    let jump = |from: f64| {
        let of = |axis: &Vec<f64>| {
            let after = rows.iter().zip(axis);
            after.map(|(row, place)| if row.when >= from { *place } else { 0.0 }).collect()
        };
        axes.iter().map(of).collect()
    };
    moments(rows).into_iter().map(jump).collect()
}

/// Moments at which something may have jumped, as many rows between any two.
pub(super) fn moments(rows: &[Repeat]) -> Vec<f64> {
    let mut all: Vec<f64> = rows.iter().map(|row| row.when).collect();
    all.sort_by(f64::total_cmp);
    let tried = MOST_MOMENTS.min(rows.len() / ROWS_PER_TURN);
    (0..tried).map(|k| all[(k + 1) * rows.len() / (tried + 1)]).collect()
}

/// Columns less their means within cells, of unit length; `None` where repeats hardly differ in them.
fn within_cells(rows: &[Repeat], columns: &[Vec<f64>]) -> Option<DMatrix<f64>> {
    let mut members = std::collections::BTreeMap::<usize, Vec<usize>>::new();
    rows.iter().enumerate().for_each(|(r, row)| members.entry(row.cell).or_default().push(r));
    let mut design = DMatrix::zeros(rows.len(), columns.len());
    for (k, column) in columns.iter().enumerate() {
        for own in members.values() {
            let mean = own.iter().map(|&r| column[r]).sum::<f64>() / own.len() as f64;
            own.iter().for_each(|&r| design[(r, k)] = column[r] - mean);
        }
        let mean = column.iter().sum::<f64>() / column.len() as f64;
        let whole: f64 = column.iter().map(|value| (value - mean).powi(2)).sum();
        let within = design.column(k).norm_squared();
        if within <= LEAST_WITHIN * whole || within < 1e-12 {
            return None;
        }
        design.column_mut(k).scale_mut(within.sqrt().recip() * (rows.len() as f64).sqrt());
    }
    Some(design)
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::*;

    /// Where a cell lies along an axis, -1 to 1.
    fn place(row: i32, stride: i32) -> f64 {
        f64::from(row % 40 * stride % 40) / 19.5 - 1.0
    }

    /// 40 cells of four repeats in an order drawn by chance; `of` is added to the first coordinate.
    fn rows(seed: u64, of: impl Fn(f64, f64) -> f64) -> Vec<Repeat> {
        let mut random = StdRng::seed_from_u64(seed);
        let mut all: Vec<Repeat> = (0..160)
            .map(|i| {
                let mut noise = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
                let off = [noise(), noise()];
                let (when, turned) = (7.0 * f64::from(i), random.random_range(-0.5..0.5));
                let off = vec![off[0] + of(when, turned), off[1]];
                let cell = usize::try_from(i % 40).expect("small");
                Repeat {
                    cell,
                    when,
                    turned_rad: vec![turned],
                    temperature_c: None,
                    at: Some([place(i, 7), place(i, 11)]),
                    off,
                    levers: vec![],
                    lagged: vec![],
                }
            })
            .collect();
        for cell in 0..40 {
            let own: Vec<usize> = (0..all.len()).filter(|&r| all[r].cell == cell).collect();
            for c in 0..2 {
                let mean = own.iter().map(|&r| all[r].off[c]).sum::<f64>() / own.len() as f64;
                own.iter().for_each(|&r| all[r].off[c] -= mean);
            }
        }
        all
    }

    fn found(rows: &[Repeat]) -> Option<Structure> {
        structure(rows, 120.0, "time", &["the elbow".to_owned()])
    }

    #[test]
    fn a_wobble_over_time_is_found() {
        for seed in 0..10 {
            let rows = rows(seed, |t, _| 2.0 * (t / 17.0).sin());
            let structure = found(&rows).expect("two standard deviations");
            assert_eq!(structure.on, "time");
            assert!(structure.size_sigmas > 0.5, "{structure:?}");
        }
    }

    #[test]
    fn a_screen_that_turns_about_its_middle_between_two_repeats_is_found() {
        for seed in 0..10 {
            let mut rows = rows(200 + seed, |_, _| 0.0);
            // From the third pass on; what it does is nothing on average.
            let turn = |cell: usize, pass: usize| {
                let turned = if pass >= 2 { 0.5 } else { -0.5 };
                5.0 * turned * place(i32::try_from(cell).expect("small"), 7)
            };
            for (i, row) in rows.iter_mut().enumerate() {
                row.off[0] += turn(row.cell, i / 40);
            }
            let structure = found(&rows).expect("five standard deviations");
            assert_eq!(structure.on, "time");
            let spread: f64 = rows.iter().map(|row| row.off[0] * row.off[0]).sum();
            let noise = (spread * structure.left[0] / 120.0).sqrt();
            assert!((noise - 1.0).abs() < 0.35, "{noise}");
        }
    }

    #[test]
    fn a_joint_that_remembers_where_it_came_from_is_found() {
        for seed in 0..10 {
            let rows = rows(100 + seed, |_, turned| 1.5 * turned.signum());
            let structure = found(&rows).expect("one and a half standard deviations");
            assert_eq!(structure.on, "where the elbow came from");
            // What it leaves is the noise alone.
            let spread: f64 = rows.iter().map(|row| row.off[0] * row.off[0]).sum();
            let noise = (spread * structure.left[0] / 120.0).sqrt();
            assert!((noise - 1.0).abs() < 0.35, "{noise}");
        }
    }

    /// Eleven cells of three repeats, one pass after the other; something slips in the middle of the second.
    fn three_passes(seed: u64, by: f64) -> Vec<Repeat> {
        let mut few: Vec<Repeat> = rows(seed, |_, _| 0.0).into_iter().take(33).collect();
        for (i, row) in few.iter_mut().enumerate() {
            row.cell = i % 11;
            row.off[0] += if i >= 16 { by } else { 0.0 };
        }
        for cell in 0..11 {
            for c in 0..2 {
                let own: Vec<usize> = (0..33).filter(|&r| few[r].cell == cell).collect();
                let mean = own.iter().map(|&r| few[r].off[c]).sum::<f64>() / 3.0;
                own.iter().for_each(|&r| few[r].off[c] -= mean);
            }
        }
        few
    }

    #[test]
    fn a_step_in_three_passes_over_a_few_places_is_no_noise() {
        let of = |rows: &[Repeat]| structure(rows, 22.0, "time", &["the elbow".to_owned()]);
        for seed in 0..10 {
            let structure = of(&three_passes(300 + seed, 6.0)).expect("six standard deviations");
            assert_eq!(structure.on, "time");
        }
        let alarms = (0..200).filter(|seed| of(&three_passes(2000 + seed, 0.0)).is_some()).count();
        assert_eq!(alarms, 0);
    }

    #[test]
    fn noise_has_no_structure() {
        let alarms = (0..200).filter(|seed| found(&rows(1000 + seed, |_, _| 0.0)).is_some()).count();
        assert_eq!(alarms, 0);
    }
}
