//! How far each row is believed.

use crate::compare::median;

/// Rows further off than this, in robust standard deviations, count less; from the second on they
/// do not count.
const HUBER: f64 = 3.0;
const BEYOND: f64 = 7.0;
/// Median of the root mean square of three standard-normal values.
const USUAL: f64 = 0.89;

/// Weights by how far each row is off (root mean square over coordinates, in floors). The scale
/// is that of most rows: while effects are missing, what they do must not count as an outlier.
pub(super) fn weights(misses: &[Option<f64>]) -> Vec<f64> {
    let scale = median(misses.iter().flatten().copied()).map_or(1.0, |middle| (middle / USUAL).max(1.0));
    misses.iter().map(|miss| miss.map_or(0.0, |miss| weight(miss / scale))).collect()
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
