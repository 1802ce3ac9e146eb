//! Sub-pixel refinement on the gray values themselves.
//!
//! Around each pixel, the shift of the right view is found that makes it fit the left one best
//! in the least-squares sense, apart from a constant difference in brightness. Every pixel of
//! the window is compared at its own disparity, so a slanted surface keeps its slant. Assumes
//! that the disparities are right to within about half a pixel; broken at edges of things,
//! where the correction found is too large and is not applied.
//!
//! Source: Lucas, Kanade: An iterative image registration technique with an application to
//! stereo vision (1981).

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8};
use image::GrayImage;
use rayon::prelude::*;

use super::select::UNKNOWN;

/// Half side of the window, pixels.
const HALF_WINDOW: usize = 3;
/// Neighbors that differ by at most this much belong to the same surface, pixels.
const SAME_SURFACE_PX: f32 = 1.0;
/// A larger correction means that the window does not show one surface, pixels.
const LARGEST_CORRECTION_PX: f32 = 0.75;
/// Noise of the gray values.
const NOISE: f32 = 2.0;
/// What is on the surface has to fix its place along the row to this standard deviation, given
/// the noise; otherwise it is too bare to be matched, pixels.
const LARGEST_SIGMA_PX: f32 = 0.5;
/// Pixels handled at a time.
const LANES: usize = 8;
/// What is summed over a window: gradient², gradient × difference, gradient, difference, and
/// the number of pixels.
const SUMS: usize = 5;

/// Working memory.
#[derive(Default)]
pub(super) struct Refiner {
    smooth: Vec<f32>,
    /// Per row, one after the other, the sums along it.
    along_rows: Vec<f32>,
}

impl Refiner {
    /// Improves the known disparities in place. Tells for each pixel whether its surface is too
    /// bare to be matched, so that its disparity came from its surroundings.
    pub fn refine(&mut self, left: &GrayImage, right: &GrayImage, disparities: &mut [f32]) -> Vec<bool> {
        let (level, width) = (Level::new(), left.width() as usize);
        self.smooth.resize(disparities.len(), UNKNOWN);
        self.along_rows.resize(disparities.len() * SUMS, 0.0);
        average(disparities, width, &mut self.smooth);
        let smooth = &self.smooth;
        self.along_rows.par_chunks_exact_mut(width * SUMS).enumerate().for_each_init(
            || vec![0.0; padded(width) * SUMS],
            |terms, (y, sums)| {
                let row = y * width..(y + 1) * width;
                compare_row(&left.as_raw()[row.clone()], &right.as_raw()[row.clone()], &smooth[row], terms);
                dispatch!(level, _simd => sum_along(terms, sums, width));
            },
        );
        let along_rows = &self.along_rows;
        let mut bare = vec![false; disparities.len()];
        disparities
            .par_chunks_exact_mut(width)
            .zip(bare.par_chunks_exact_mut(width))
            .enumerate()
            .for_each_init(
                || vec![0.0; width * SUMS],
                |sums, (y, (disparities, bare))| {
                    dispatch!(level, _simd => sum_across(along_rows, y, sums));
                    correct(disparities, bare, &smooth[y * width..][..width], sums);
                },
            );
        bare
    }
}

/// Length of a row with room for the window at both ends.
fn padded(width: usize) -> usize {
    width + 2 * HALF_WINDOW
}

/// Adds the least-squares shift, with the mean difference in brightness taken out.
fn correct(disparities: &mut [f32], bare: &mut [bool], smooth: &[f32], sums: &[f32]) {
    // Both views are noisy.
    let least_contrast = 2.0 * (NOISE / LARGEST_SIGMA_PX).powi(2);
    let width = disparities.len();
    for (x, (d, smooth)) in disparities.iter_mut().zip(smooth).enumerate() {
        if *d < UNKNOWN {
            let [gg, ge, g, e, n] = [0, 1, 2, 3, 4].map(|term| sums[term * width + x]);
            let contrast = gg - g * g / n;
            let delta = (ge - g * e / n) / (contrast + n * NOISE * NOISE);
            // Also false when there is nothing in the window.
            let usable = delta.abs() <= LARGEST_CORRECTION_PX;
            *d = if usable { (smooth + delta).max(0.0) } else { *smooth };
            // Not a number when there is nothing in the window.
            bare[x] = contrast.is_nan() || contrast < least_contrast;
        }
    }
}

/// Mean over the neighbors on the same surface; the outermost pixels stay as they are.
fn average(disparities: &[f32], width: usize, out: &mut [f32]) {
    let level = Level::new();
    let height = disparities.len() / width;
    out.par_chunks_exact_mut(width).enumerate().for_each(|(y, out)| {
        let row = |y: usize| &disparities[y * width..][..width];
        out.copy_from_slice(row(y));
        if y > 0 && y + 1 < height && width >= LANES + 2 {
            dispatch!(level, simd => average_row(simd, [row(y - 1), row(y), row(y + 1)], out));
        }
    });
}

#[inline(always)]
fn average_row<S: Simd>(simd: S, rows: [&[f32]; 3], out: &mut [f32]) {
    let last = out.len() - LANES - 1;
    let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
    let tolerance = f32x8::splat(simd, SAME_SURFACE_PX);
    let mut start = 1;
    loop {
        let own = f32x8::from_slice(simd, &rows[1][start..start + LANES]);
        let (mut sum, mut count) = (zero, zero);
        for row in rows {
            for x in start - 1..start + 2 {
                let other = f32x8::from_slice(simd, &row[x..x + LANES]);
                // Not so where either is unknown: the difference is infinite or not a number.
                let same = (other - own).abs().simd_le(tolerance);
                sum += same.select(other, zero);
                count += same.select(one, zero);
            }
        }
        let known = count.simd_gt(zero);
        known.select(sum / count, own).store_slice(&mut out[start..start + LANES]);
        if start == last {
            return;
        }
        start = (start + LANES).min(last);
    }
}

/// What each pixel of a row contributes at its disparity, one term after the other.
fn compare_row(left: &[u8], right: &[u8], disparities: &[f32], terms: &mut [f32]) {
    let width = left.len();
    terms.fill(0.0);
    let (gg, rest) = terms.split_at_mut(padded(width));
    let (ge, rest) = rest.split_at_mut(padded(width));
    let (g, rest) = rest.split_at_mut(padded(width));
    let (e, n) = rest.split_at_mut(padded(width));
    for x in 1..width - 1 {
        let place = x as f32 - disparities[x];
        // Two pixels to either side are needed; also false where the disparity is unknown.
        if !(place >= 1.0 && place < width as f32 - 2.0) {
            continue;
        }
        let index = place as usize;
        let Some(around) = right[index - 1..].first_chunk::<4>() else { continue };
        let (value, slope) = catmull_rom(around.map(f32::from), place - index as f32);
        let left_slope = 0.5 * (f32::from(left[x + 1]) - f32::from(left[x - 1]));
        // The mean of both slopes makes the step right to second order.
        let gradient = 0.5 * (slope + left_slope);
        let difference = value - f32::from(left[x]);
        let at = x + HALF_WINDOW;
        (gg[at], ge[at]) = (gradient * gradient, gradient * difference);
        (g[at], e[at], n[at]) = (gradient, difference, 1.0);
    }
}

/// Value and slope at `t` between the two middle samples.
fn catmull_rom([a, b, c, d]: [f32; 4], t: f32) -> (f32, f32) {
    let k1 = 0.5 * (c - a);
    let k2 = a - 2.5 * b + 2.0 * c - 0.5 * d;
    let k3 = 0.5 * (d - a) + 1.5 * (b - c);
    (((k3 * t + k2) * t + k1) * t + b, (3.0 * k3 * t + 2.0 * k2) * t + k1)
}

/// Window sums along a row, for each term.
#[inline(always)]
fn sum_along(terms: &[f32], sums: &mut [f32], width: usize) {
    for (terms, sums) in terms.chunks_exact(padded(width)).zip(sums.chunks_exact_mut(width)) {
        sums.copy_from_slice(&terms[..width]);
        for shift in 1..=2 * HALF_WINDOW {
            for (sum, term) in sums.iter_mut().zip(&terms[shift..]) {
                *sum += term;
            }
        }
    }
}

/// Adds up the row sums above and below row `y`.
#[inline(always)]
fn sum_across(along_rows: &[f32], y: usize, sums: &mut [f32]) {
    let row_len = sums.len();
    let height = along_rows.len() / row_len;
    sums.fill(0.0);
    for row in y.saturating_sub(HALF_WINDOW)..(y + HALF_WINDOW + 1).min(height) {
        for (sum, term) in sums.iter_mut().zip(&along_rows[row * row_len..]) {
            *sum += term;
        }
    }
}
