//! Guesses for pixels whose disparity could not be measured.
//!
//! A place that only one eye sees lies behind its neighbors: it belongs to the farther of the
//! two surfaces beside it. A gap between equal surfaces belongs to both.

use rayon::prelude::*;

use super::select::UNKNOWN;
use super::smooth::MEDIAN_NETWORK;

/// Fills every unknown pixel that has a known one in its row and for which `fillable` is true;
/// tells which were filled.
pub(super) fn fill(
    disparities: &mut [f32],
    width: usize,
    fillable: impl Fn(usize) -> bool + Sync,
) -> Vec<bool> {
    let mut filled = vec![false; disparities.len()];
    disparities
        .par_chunks_exact_mut(width)
        .zip(filled.par_chunks_exact_mut(width))
        .enumerate()
        .for_each(|(y, (row, filled))| fill_row(row, filled, |x| fillable(y * width + x)));
    even_out(disparities, &filled, width);
    filled
}

fn fill_row(row: &mut [f32], filled: &mut [bool], fillable: impl Fn(usize) -> bool) {
    let mut x = 0;
    while x < row.len() {
        if row[x] < UNKNOWN {
            x += 1;
            continue;
        }
        let end = (x..row.len()).find(|i| row[*i] < UNKNOWN).unwrap_or(row.len());
        let before = if x > 0 { row[x - 1] } else { UNKNOWN };
        let after = if end < row.len() { row[end] } else { UNKNOWN };
        // Unknown is larger than everything, so the one known side wins at the edges.
        let farther = before.min(after);
        if farther < UNKNOWN {
            for i in (x..end).filter(|i| fillable(*i)) {
                row[i] = farther;
                filled[i] = true;
            }
        }
        x = end;
    }
}

/// Median over the nine pixels above and below, as far as they were filled.
fn even_out(disparities: &mut [f32], filled: &[bool], width: usize) {
    let guesses = disparities.to_vec();
    let height = guesses.len() / width;
    disparities.par_chunks_exact_mut(width).enumerate().for_each(|(y, row)| {
        for (x, d) in row.iter_mut().enumerate().filter(|(x, _)| filled[y * width + x]) {
            let own = *d;
            let mut column = [own; 9];
            for (i, guess) in column.iter_mut().enumerate() {
                let place = (y + i).checked_sub(4).filter(|y| *y < height).map(|y| y * width + x);
                if let Some(place) = place.filter(|place| filled[*place]) {
                    *guess = guesses[place];
                }
            }
            for (low, high) in MEDIAN_NETWORK {
                if column[high] < column[low] {
                    column.swap(low, high);
                }
            }
            *d = column[4];
        }
    });
}
