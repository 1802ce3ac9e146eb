//! What rows that are near one another leave alike.
//!
//! Where nothing was measured twice, whatever a model leaves passes for noise. But noise does not know its neighbors: what rows
//! leave that are near one another in place, in posture or in time goes together only where something is at work. A smooth
//! test in each logged quantity alone does not see what winds through space, or swings in less time than a few turns of a
//! session. The sum over rows of the product with their nearest ones (Moran 1950), against permutations inside of sessions.

use std::collections::{BTreeMap, BTreeSet};

use plumbline_effects::measurements::{Measurements, Observation, What};
use plumbline_model::JobContext;
use rand::SeedableRng;
use rand::rngs::StdRng;
use rand::seq::SliceRandom;
use rayon::prelude::*;

use super::structure::Structure;
use crate::error::GapError;
use crate::statistics::{median, robust_sd};

/// Fewer rows than this say nothing.
const FEWEST: usize = 30;
/// So many repeats tell the noise of a kind of rows, whatever its neighbors do.
const ENOUGH_REPEATS: usize = 20;
/// Neighbors of each row.
const NEAREST: usize = 3;
/// Permutations: the smallest probability that they can show is one over one more.
const PERMUTATIONS: usize = 1999;
/// What counts, of all kinds of neighbors together.
const SIGNIFICANT: f64 = 0.002;
/// Neighbors that have less than this share of the spread in common may have it from the small things that are off in every robot.
const LEAST_SHARE: f64 = 0.15;
/// Residuals beyond this many robust standard deviations count as that far.
const FAR: f64 = 4.0;
/// Where more than this share of the rows lie on another one, neighbors are what was seen at once, or again, not what lies nearby.
const MOST_COINCIDE: f64 = 0.1;
/// What is said to be alike.
const OF_ALL: &str = "all that was measured";

/// What makes rows neighbors: how it is called, and the coordinates of a row, if they are known.
type Space = (&'static str, fn(&Observation) -> Option<Vec<f64>>);

const SPACES: [Space; 3] = [
    ("the place", place),
    ("the posture", |row| Some(posture(row)).filter(|posture| !posture.is_empty())),
    ("time", |row| Some(vec![row.t_secs?])),
];

/// The strongest likeness of neighbors beyond doubt, of rows of any kind that were measured once and not watched. One row of each
/// moment or pose counts: what several markers, or things seen at once, have in common is how the arm stood, or the head.
///
/// # Errors
/// Cancelled.
pub fn alike(
    measurements: &Measurements,
    residuals: &[Option<Vec<f64>>],
    seed: u64,
    context: &dyn JobContext,
) -> Result<Option<Structure>, GapError> {
    let mut best: Option<Structure> = None;
    for what in What::ALL {
        let own = measurements.rows.iter().zip(residuals);
        let own: Vec<(&Observation, &Vec<f64>)> = own
            .filter(|(row, _)| row.what == what && row.stand.is_none())
            .filter_map(|(row, residual)| Some((row, residual.as_ref()?)))
            .collect();
        let cells: BTreeSet<usize> = own.iter().map(|(row, _)| row.cell).collect();
        if own.len() - cells.len() >= ENOUGH_REPEATS {
            continue;
        }
        let mut sessions = BTreeMap::<usize, BTreeMap<Moment, (&Observation, &Vec<f64>)>>::new();
        let mut seen = BTreeSet::new();
        for (row, residual) in own {
            // Of the few that were measured twice the first one counts: they are alike anyway.
            if seen.insert((row.session, row.cell)) {
                let moments = sessions.entry(row.session).or_default();
                moments.entry(moment(row)).or_insert((row, residual));
            }
        }
        // Each session by itself: so few permutations could not tell two of them were the probability multiplied by their number.
        for rows in sessions.into_values().filter(|rows| rows.len() >= FEWEST) {
            let mut left: Vec<Vec<f64>> = rows.values().map(|(_, residual)| (*residual).clone()).collect();
            tame(&mut left);
            for (name, coordinates) in SPACES {
                let at: Option<Vec<Vec<f64>>> = rows.values().map(|(row, _)| coordinates(row)).collect();
                let Some(at) = at else { continue };
                let Some((p_value, share)) = by_neighbors(&left, &at, seed, context)? else { continue };
                let is_more = best.as_ref().is_none_or(|best| share > 1.0 - best.left[0]);
                if p_value <= SIGNIFICANT && share >= LEAST_SHARE && is_more {
                    let left = vec![1.0 - share.min(1.0 - 1e-6); what.len()];
                    best = Some(Structure { of: OF_ALL, ..Structure::new(name.to_owned(), p_value, left) });
                }
            }
        }
    }
    Ok(best)
}

/// What was measured at one moment, or in one pose: where neither is known, each cell by itself.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
enum Moment {
    Pose(usize),
    Milliseconds(i64),
    Cell(usize),
}

fn moment(row: &Observation) -> Moment {
    match (row.pose, row.t_secs) {
        (Some(pose), _) => Moment::Pose(pose),
        (None, Some(t_secs)) => Moment::Milliseconds((t_secs * 1e3).round() as i64),
        (None, None) => Moment::Cell(row.cell),
    }
}

/// In units of their spread, about their middle; what is far out counts as less far, what does not differ as nothing.
fn tame(left: &mut [Vec<f64>]) {
    let width = left.first().map_or(0, Vec::len);
    for c in 0..width {
        let middle = median(left.iter().map(|row| row[c])).unwrap_or(0.0);
        let sd = robust_sd(left.iter().map(|row| row[c] - middle));
        let unit = |value: f64| if sd > 0.0 { ((value - middle) / sd).clamp(-FAR, FAR) } else { 0.0 };
        left.iter_mut().for_each(|row| row[c] = unit(row[c]));
        let mean = left.iter().map(|row| row[c]).sum::<f64>() / left.len() as f64;
        left.iter_mut().for_each(|row| row[c] -= mean);
    }
}

/// Probability by chance that neighbors are as alike as they are, of all spaces together, and the share of the spread that they
/// have in common. `None` where nothing differs, or many rows lie on others.
fn by_neighbors(
    left: &[Vec<f64>],
    at: &[Vec<f64>],
    seed: u64,
    context: &dyn JobContext,
) -> Result<Option<(f64, f64)>, GapError> {
    let near = nearest(at);
    let coincide = near.iter().enumerate().filter(|(i, near)| near.iter().any(|&j| at[j] == at[*i]));
    if coincide.count() as f64 > MOST_COINCIDE * at.len() as f64 {
        return Ok(None);
    }
    let whole: f64 = left.iter().flatten().map(|value| value * value).sum();
    if whole <= 0.0 {
        return Ok(None);
    }
    let order: Vec<usize> = (0..left.len()).collect();
    let observed = in_common(left, &near, &order);
    let as_alike: Result<Vec<bool>, GapError> = (0..PERMUTATIONS as u64)
        .into_par_iter()
        .map(|round| {
            context.checkpoint()?;
            let mut random = StdRng::seed_from_u64(seed.wrapping_mul(0x9E37_79B9).wrapping_add(round));
            let mut order = order.clone();
            order.shuffle(&mut random);
            Ok(in_common(left, &near, &order) >= observed)
        })
        .collect();
    let as_alike = as_alike?.into_iter().filter(|as_alike| *as_alike).count();
    let p_value = (as_alike + 1) as f64 / (PERMUTATIONS + 1) as f64;
    Ok(Some(((SPACES.len() as f64 * p_value).min(1.0), observed / whole)))
}

/// The sum over rows of the product of what they leave with what their neighbors leave in the mean, with what is left dealt out
/// in this order.
fn in_common(left: &[Vec<f64>], near: &[Vec<usize>], order: &[usize]) -> f64 {
    let product = |i: usize, j: usize| -> f64 {
        left[order[i]].iter().zip(&left[order[j]]).map(|(one, other)| one * other).sum()
    };
    let with_near = |(i, near): (usize, &Vec<usize>)| {
        near.iter().map(|&j| product(i, j)).sum::<f64>() / near.len().max(1) as f64
    };
    near.iter().enumerate().map(with_near).sum()
}

/// The nearest others of each point.
fn nearest(at: &[Vec<f64>]) -> Vec<Vec<usize>> {
    let apart = |i: usize, j: usize| -> f64 {
        at[i].iter().zip(&at[j]).map(|(one, other)| (one - other) * (one - other)).sum()
    };
    (0..at.len())
        .into_par_iter()
        .map(|i| {
            let mut others: Vec<(f64, usize)> =
                (0..at.len()).filter(|&j| j != i).map(|j| (apart(i, j), j)).collect();
            let kept = NEAREST.min(others.len());
            if kept < others.len() {
                others.select_nth_unstable_by(kept, |a, b| a.0.total_cmp(&b.0));
                others.truncate(kept);
            }
            others.into_iter().map(|(_, j)| j).collect()
        })
        .collect()
}

/// Where it was measured, m.
fn place(row: &Observation) -> Option<Vec<f64>> {
    match (row.what, row.truth_m) {
        (What::Touch, _) => Some(vec![*row.measured.first()?, *row.measured.get(1)?, row.screen_height_m]),
        (_, Some(truth)) => Some(truth.iter().copied().collect()),
        _ => row.measured.get(..3).map(<[f64]>::to_vec),
    }
}

/// How the joints stand, of the arm and of the neck, rad.
fn posture(row: &Observation) -> Vec<f64> {
    row.angles_rad().iter().chain(&row.neck_rad).copied().collect()
}

#[cfg(test)]
mod tests {
    use plumbline_model::Unattended;
    use rand::Rng;

    use super::*;

    /// Rows at random places of a square, with noise of one and what `of` adds by place.
    fn shares(seed: u64, of: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
        let mut random = StdRng::seed_from_u64(seed);
        let mut at = vec![];
        let mut left: Vec<Vec<f64>> = (0..120)
            .map(|_| {
                let mut noise = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
                let both = [noise(), noise()];
                let x = random.random_range(-1.0..1.0);
                at.push(vec![x, random.random_range(-1.0..1.0)]);
                let by = of(x);
                vec![both[0] + by, both[1] - by]
            })
            .collect();
        tame(&mut left);
        by_neighbors(&left, &at, seed, &Unattended).expect("nobody cancels")
    }

    #[test]
    fn a_field_that_winds_through_space_is_found_and_noise_is_not() {
        let mut by_chance = 0;
        for seed in 0..30 {
            let (p_value, share) = shares(seed, |x| 3.0 * (4.0 * x).sin()).expect("they differ");
            assert!(p_value <= SIGNIFICANT && share > LEAST_SHARE, "{p_value} {share}");
            let (p_value, _) = shares(seed, |_| 0.0).expect("they differ");
            by_chance += usize::from(p_value <= SIGNIFICANT);
        }
        assert_eq!(by_chance, 0, "two in a thousand");
    }

    #[test]
    fn what_was_seen_at_once_has_no_neighbors_in_time() {
        let mut random = StdRng::seed_from_u64(3);
        // Three things in each of forty looks, which share what the eyes did then.
        let mut left: Vec<Vec<f64>> = vec![];
        for _ in 0..40 {
            let shared: f64 = random.random_range(-1.0..1.0);
            left.extend((0..3).map(|_| vec![shared]));
        }
        tame(&mut left);
        let at: Vec<Vec<f64>> = (0..120).map(|i| vec![f64::from(i / 3)]).collect();
        assert_eq!(by_neighbors(&left, &at, 1, &Unattended).expect("nobody cancels"), None);
    }

    #[test]
    fn rows_of_one_pose_or_moment_are_one() {
        use plumbline_effects::measurements::Observation;

        let row = |pose: Option<usize>, t_secs: Option<f64>, cell: usize| {
            moment(&Observation { pose, t_secs, cell, ..Observation::imagined(What::Pose) })
        };
        assert!(row(Some(2), Some(1.0), 7) == row(Some(2), Some(1.2), 8), "markers of one pose");
        assert!(row(None, Some(1.0), 7) == row(None, Some(1.0002), 8), "things seen at once");
        assert!(row(None, Some(1.0), 7) != row(None, Some(1.1), 7));
        assert!(row(None, None, 7) != row(None, None, 8));
    }

    #[test]
    fn where_nothing_differs_nothing_is_alike() {
        let mut left = vec![vec![1.0, 2.0]; 40];
        tame(&mut left);
        let at: Vec<Vec<f64>> = (0..40).map(|i| vec![f64::from(i)]).collect();
        assert_eq!(by_neighbors(&left, &at, 1, &Unattended).expect("nobody cancels"), None);
    }
}
