//! Repairs of a disparity image: single wrong pixels, and patches too small to be trusted.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8};
use rayon::prelude::*;

use super::select::UNKNOWN;

/// Pixels handled at a time.
pub(super) const LANES: usize = 8;

/// Writes to `out` the median of each known disparity's 3×3 neighborhood; the outermost pixels
/// and those with mostly unknown neighbors stay as they are.
pub(super) fn median(disparities: &[f32], width: usize, out: &mut [f32]) {
    let level = Level::new();
    let height = disparities.len() / width;
    out.par_chunks_exact_mut(width).enumerate().for_each(|(y, out)| {
        let row = |y: usize| &disparities[y * width..][..width];
        out.copy_from_slice(row(y));
        if y > 0 && y + 1 < height && width >= LANES + 2 {
            dispatch!(level, simd => median_row(simd, [row(y - 1), row(y), row(y + 1)], out));
        }
    });
}

#[inline(always)]
fn median_row<S: Simd>(simd: S, rows: [&[f32]; 3], out: &mut [f32]) {
    let last = out.len() - LANES - 1;
    let unknown = f32x8::splat(simd, UNKNOWN);
    for start in (1..=last).step_by(LANES).chain([last]) {
        let at = |row: usize, x: usize| f32x8::from_slice(simd, &rows[row][x..][..LANES]);
        let (a, b, c) = (start - 1, start, start + 1);
        let mut v =
            [at(0, a), at(0, b), at(0, c), at(1, a), at(1, b), at(1, c), at(2, a), at(2, b), at(2, c)];
        let own = v[4];
        for (low, high) in MEDIAN_NETWORK {
            (v[low], v[high]) = (v[low].min(v[high]), v[low].max(v[high]));
        }
        let usable = v[4].max(own).simd_lt(unknown);
        usable.select(v[4], own).store_slice(&mut out[start..start + LANES]);
    }
}

/// Exchanges (smaller first) that bring the median of nine to the middle; after
/// Paeth: Median finding on a 3×3 grid (Graphics Gems, 1990).
pub(super) const MEDIAN_NETWORK: [(usize, usize); 19] = [
    (1, 2),
    (4, 5),
    (7, 8),
    (0, 1),
    (3, 4),
    (6, 7),
    (1, 2),
    (4, 5),
    (7, 8),
    (0, 3),
    (5, 8),
    (4, 7),
    (3, 6),
    (1, 4),
    (2, 5),
    (4, 7),
    (2, 4),
    (4, 6),
    (2, 4),
];

/// Makes patches of fewer than `least_pixels` connected pixels unknown; neighbors (above,
/// below, beside) are connected when they differ by at most `step_px`.
pub(super) fn remove_specks(disparities: &mut [f32], width: usize, least_pixels: usize, step_px: f32) {
    let rows: Vec<Vec<Range<usize>>> =
        disparities.par_chunks_exact(width).map(|row| connected_runs(row, step_px)).collect();
    // Runs are numbered from the top on.
    let mut first = Vec::with_capacity(rows.len());
    let mut patches = Patches::default();
    for runs in &rows {
        first.push(patches.parent.len());
        runs.iter().for_each(|run| patches.begin(run.len()));
    }
    for (y, pair) in rows.windows(2).enumerate() {
        let [above, below] = [y, y + 1].map(|y| &disparities[y * width..][..width]);
        let touch = |x: usize| (above[x] - below[x]).abs() <= step_px;
        let (mut a, mut b) = (0, 0);
        while let (Some(upper), Some(lower)) = (pair[0].get(a), pair[1].get(b)) {
            if (upper.start.max(lower.start)..upper.end.min(lower.end)).any(touch) {
                patches.join(first[y] + a, first[y + 1] + b);
            }
            if upper.end < lower.end { a += 1 } else { b += 1 }
        }
    }
    let keep = patches.of_at_least(least_pixels);
    disparities.par_chunks_exact_mut(width).zip(rows).zip(first).for_each(|((row, runs), first)| {
        for (run, keep) in runs.into_iter().zip(&keep[first..]) {
            if !keep {
                row[run].fill(UNKNOWN);
            }
        }
    });
}

/// Longest runs of known disparities without a larger step than `step_px`.
fn connected_runs(row: &[f32], step_px: f32) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    let mut before = UNKNOWN;
    for (x, d) in row.iter().enumerate().filter(|(_, d)| **d < UNKNOWN) {
        match runs.last_mut() {
            Some(run) if run.end == x && (d - before).abs() <= step_px => run.end += 1,
            _ => runs.push(x..x + 1),
        }
        before = *d;
    }
    runs
}

/// Sets of runs that touch (union–find).
#[derive(Default)]
struct Patches {
    parent: Vec<usize>,
    pixels: Vec<usize>,
}

impl Patches {
    /// A patch of one run.
    fn begin(&mut self, pixels: usize) {
        self.parent.push(self.parent.len());
        self.pixels.push(pixels);
    }

    fn root(&mut self, mut run: usize) -> usize {
        while self.parent[run] != run {
            self.parent[run] = self.parent[self.parent[run]];
            run = self.parent[run];
        }
        run
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            let (low, high) = (a.min(b), a.max(b));
            self.parent[high] = low;
            self.pixels[low] += self.pixels[high];
        }
    }

    /// For each run, whether its patch has at least that many pixels.
    fn of_at_least(&mut self, least_pixels: usize) -> Vec<bool> {
        (0..self.parent.len())
            .map(|run| {
                let root = self.root(run);
                self.pixels[root] >= least_pixels
            })
            .collect()
    }
}
