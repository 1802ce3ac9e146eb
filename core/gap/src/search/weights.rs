//! How far each row is believed.

use std::collections::BTreeMap;

use plumbline_effects::measurements::{Measurements, Observation};

use crate::compare::median;

/// Rows further off than this, in robust standard deviations, count less; from the second on they
/// do not count.
const HUBER: f64 = 3.0;
const BEYOND: f64 = 7.0;
/// Median of the root mean square of three standard-normal values.
const USUAL: f64 = 0.89;

/// So many rows of all are no outliers, however far they are off from most: what happened at a moment, to a screen that was
/// knocked late, moved all that came after it. The last of them is this far off then.
const NEVER_ALONE: f64 = 0.75;
const FAR: f64 = 5.0;

/// Of fewer rows nobody can tell whether all of them are off.
const LEAST_IN_SET: usize = 5;

/// Number of the set of each row, where the eyes measured in sets: an eye may have turned from one to the next.
pub(super) fn sets(measurements: &Measurements) -> Vec<Option<usize>> {
    let sets = measurements.sets_of_eyes();
    let number = |row: &Observation| {
        let own = row.set.as_ref().filter(|_| !row.what.is_placed());
        own.and_then(|own| sets.iter().position(|set| set == own))
    };
    measurements.rows.iter().map(number).collect()
}

/// Weights by how far each row is off (root mean square over coordinates, in floors). The scale
/// is that of most rows: while effects are missing, what they do must not count as an outlier. Nor is a row one in a set
/// (`sets`, as [`sets()`] numbers them) that is off as a whole.
pub(super) fn weights(misses: &[Option<f64>], sets: &[Option<usize>]) -> Vec<f64> {
    let mut of_sets = BTreeMap::<usize, Vec<f64>>::new();
    for (miss, set) in misses.iter().zip(sets) {
        if let (Some(miss), Some(set)) = (miss, set) {
            of_sets.entry(*set).or_default().push(*miss);
        }
    }
    let all = scale(&misses.iter().flatten().copied().collect::<Vec<_>>());
    let enough = of_sets.into_iter().filter(|(_, own)| own.len() >= LEAST_IN_SET);
    let of_sets: BTreeMap<usize, f64> = enough.map(|(set, own)| (set, scale(&own))).collect();
    let own = |set: &Option<usize>| set.and_then(|set| of_sets.get(&set)).map_or(all, |own| own.max(all));
    misses.iter().zip(sets).map(|(miss, set)| miss.map_or(0.0, |miss| weight(miss / own(set)))).collect()
}

/// How far a row of these is usually off, in floors; never less than one.
fn scale(own: &[f64]) -> f64 {
    let mut sorted = own.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.get((NEVER_ALONE * sorted.len() as f64) as usize);
    median(sorted.iter().copied())
        .map_or(1.0, |middle| (middle / USUAL).max(last.map_or(0.0, |last| last / FAR)).max(1.0))
}

fn weight(off: f64) -> f64 {
    if off <= HUBER {
        1.0
    } else if off < BEYOND {
        HUBER / off
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(misses: &[f64]) -> Vec<f64> {
        weights(&misses.iter().copied().map(Some).collect::<Vec<_>>(), &vec![None; misses.len()])
    }

    #[test]
    fn few_that_are_far_off_do_not_count_and_many_do() {
        let off = |many: usize| -> Vec<f64> {
            let own = of(&[vec![1.0; 100 - many], vec![20.0; many]].concat());
            own[100 - many..].to_vec()
        };
        assert!(off(20).iter().all(|weight| *weight == 0.0), "a fifth may be outliers");
        assert!(off(35).iter().all(|weight| *weight > 0.5), "a third was moved");
        assert!(of(&[1.0; 40]).iter().all(|weight| *weight == 1.0));
        assert_eq!(weights(&[None, Some(1.0)], &[None, None]), [0.0, 1.0]);
    }
}
