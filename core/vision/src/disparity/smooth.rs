//! Repairs of a disparity image: single wrong pixels, and patches too small to be trusted.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8};
use rayon::prelude::*;

use super::select::UNKNOWN;

/// Pixels handled at a time.
const LANES: usize = 8;

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
pub(super) fn remove_specks(disparities: &mut [f32], width: usize, least_pixels: u32, step_px: f32) {
    let mut patches = Patches::default();
    // Runs of connected pixels along each row; run of every pixel.
    let mut run_of = vec![0u32; disparities.len()];
    for (row, runs) in disparities.chunks_exact(width).zip(run_of.chunks_exact_mut(width)) {
        let mut before = UNKNOWN;
        for (d, run) in row.iter().zip(runs) {
            if *d < UNKNOWN {
                let connected = (d - before).abs() <= step_px;
                *run = if connected { patches.grow() } else { patches.begin() };
            }
            before = *d;
        }
    }
    for y in 1..disparities.len() / width {
        let (above, below) = ((y - 1) * width, y * width);
        let mut joined = (u32::MAX, u32::MAX);
        for x in 0..width {
            let (a, b) = (disparities[above + x], disparities[below + x]);
            let runs = (run_of[above + x], run_of[below + x]);
            if a < UNKNOWN && b < UNKNOWN && runs != joined && (a - b).abs() <= step_px {
                patches.join(runs.0, runs.1);
                joined = runs;
            }
        }
    }
    let keep = patches.large(least_pixels);
    for (d, run) in disparities.iter_mut().zip(run_of) {
        if *d < UNKNOWN && !keep[run as usize] {
            *d = UNKNOWN;
        }
    }
}

/// Sets of runs that touch (union–find).
#[derive(Default)]
struct Patches {
    parent: Vec<u32>,
    pixels: Vec<u32>,
}

impl Patches {
    /// A new run of one pixel.
    fn begin(&mut self) -> u32 {
        let run = self.parent.len() as u32;
        self.parent.push(run);
        self.pixels.push(1);
        run
    }

    /// One more pixel in the newest run.
    fn grow(&mut self) -> u32 {
        let run = self.pixels.len() - 1;
        self.pixels[run] += 1;
        run as u32
    }

    fn root(&mut self, mut run: u32) -> u32 {
        while self.parent[run as usize] != run {
            let above = self.parent[self.parent[run as usize] as usize];
            self.parent[run as usize] = above;
            run = above;
        }
        run
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        if a != b {
            let (low, high) = (a.min(b), a.max(b));
            self.parent[high as usize] = low;
            self.pixels[low as usize] += self.pixels[high as usize];
        }
    }

    /// For each run, whether its patch has at least that many pixels.
    fn large(&mut self, least_pixels: u32) -> Vec<bool> {
        (0..self.parent.len() as u32)
            .map(|run| {
                let root = self.root(run);
                self.pixels[root as usize] >= least_pixels
            })
            .collect()
    }
}
