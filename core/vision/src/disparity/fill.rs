//! Guesses for pixels whose disparity could not be measured.
//!
//! A place that only one eye sees lies behind its neighbors: it belongs to the farther of the
//! two surfaces beside it. A gap between equal surfaces belongs to both.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8};
use rayon::prelude::*;

use super::select::UNKNOWN;
use super::smooth::{LANES, MEDIAN_NETWORK};

/// Half height of the median that evens out what rows guess for themselves, pixels.
const HALF_COLUMN: usize = 4;

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
    // The guesses alone; unknown where there is a measurement.
    let mut guesses = disparities.to_vec();
    guesses
        .par_iter_mut()
        .zip(filled)
        .filter(|(_, filled)| !**filled)
        .for_each(|(guess, _)| *guess = UNKNOWN);
    let (level, height) = (Level::new(), guesses.len() / width);
    disparities.par_chunks_exact_mut(width).enumerate().for_each(|(y, row)| {
        let rows = std::array::from_fn(|i| {
            let y = (y + i).saturating_sub(HALF_COLUMN).min(height - 1);
            &guesses[y * width..][..width]
        });
        dispatch!(level, simd => even_out_row(simd, rows, row));
    });
}

#[inline(always)]
fn even_out_row<S: Simd>(simd: S, rows: [&[f32]; 2 * HALF_COLUMN + 1], out: &mut [f32]) {
    let Some(last) = out.len().checked_sub(LANES) else { return };
    let unknown = f32x8::splat(simd, UNKNOWN);
    let mut start = 0;
    loop {
        let at = |row: usize| f32x8::from_slice(simd, &rows[row][start..start + LANES]);
        let own = at(HALF_COLUMN);
        let mut column = [own; 2 * HALF_COLUMN + 1];
        for (row, guess) in column.iter_mut().enumerate() {
            *guess = at(row).simd_lt(unknown).select(at(row), own);
        }
        for (low, high) in MEDIAN_NETWORK {
            (column[low], column[high]) = (column[low].min(column[high]), column[low].max(column[high]));
        }
        let out = &mut out[start..start + LANES];
        own.simd_lt(unknown).select(column[HALF_COLUMN], f32x8::from_slice(simd, out)).store_slice(out);
        if start == last {
            return;
        }
        start = (start + LANES).min(last);
    }
}
