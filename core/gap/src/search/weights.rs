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
    let scale = |own: &[f64]| median(own.iter().copied()).map_or(1.0, |middle| (middle / USUAL).max(1.0));
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

fn weight(off: f64) -> f64 {
    if off <= HUBER {
        1.0
    } else if off < BEYOND {
        HUBER / off
    } else {
        0.0
    }
}
