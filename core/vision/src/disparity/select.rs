//! From the totals of a row to its disparities: the cheapest candidate of each pixel, checked
//! against the choice that the right view makes.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u16x16};

use super::cost::CostVolume;
use super::paths::RowSink;

/// Totals handled at a time.
const HALF: usize = 16;

/// Where a disparity is not known.
pub(super) const UNKNOWN: f32 = f32::INFINITY;

/// Writes the disparities of a block of rows.
pub(super) struct Selector<'a> {
    /// First row of the block.
    first_row: usize,
    width: usize,
    lanes: usize,
    /// Number of lanes that are disparities; the others only fill up.
    candidates: usize,
    /// Disparities of the block, [`UNKNOWN`] where the two views disagree.
    disparities: &'a mut [f32],
    right: RightChoice,
    chosen: Vec<u16>,
    fraction: Vec<f32>,
}

/// What the right view would choose; by mirrored column.
struct RightChoice {
    total: Vec<u16>,
    disparity: Vec<u16>,
}

/// A choice is clear when every other candidate costs more than it by this part of it. On a bare
/// surface all cost the same, on a repetitive one several do.
const CLEAR_PART: u16 = 20;
/// Instead of a choice that is not clear; no disparity is that large.
const AMBIGUOUS: u16 = u16::MAX;

/// The two choices of a match may differ by this much, pixels.
const TOLERANCE: u16 = 1;

impl<'a> Selector<'a> {
    /// For the rows from `first_row` on, as many as `disparities` has room for.
    pub fn new(costs: &CostVolume, first_row: usize, disparities: &'a mut [f32]) -> Self {
        let (width, lanes) = (costs.width, costs.lanes);
        let right = RightChoice { total: vec![0; width + lanes], disparity: vec![0; width + lanes] };
        Self {
            first_row,
            width,
            lanes,
            candidates: costs.disparities,
            disparities,
            right,
            chosen: vec![0; width],
            fraction: vec![0.0; width],
        }
    }

    /// Keeps the choices that the right view shares.
    #[inline(always)]
    fn check(&mut self, y: usize) {
        let out = &mut self.disparities[(y - self.first_row) * self.width..][..self.width];
        for (x, out) in out.iter_mut().enumerate() {
            let chosen = self.chosen[x];
            // Past the end of the mirrored row lies the outside of the right view.
            let mirrored = self.width - 1 - x + usize::from(chosen);
            let agrees =
                mirrored < self.width && self.right.disparity[mirrored].abs_diff(chosen) <= TOLERANCE;
            *out = if agrees { f32::from(chosen) + self.fraction[x] } else { UNKNOWN };
        }
    }
}

impl RowSink for Selector<'_> {
    #[inline(always)]
    fn row<S: Simd>(&mut self, simd: S, y: usize, totals: &[u16]) {
        self.right.total.fill(u16::MAX);
        for (x, totals) in totals.chunks_exact(self.lanes).enumerate() {
            let chosen = cheapest(simd, totals);
            let least = totals[usize::from(chosen)];
            let rival = cheapest_apart(simd, totals, chosen);
            let clear = rival > least + least / CLEAR_PART;
            self.chosen[x] = if clear { chosen } else { AMBIGUOUS };
            self.fraction[x] = vertex(&totals[..self.candidates], usize::from(chosen));
            self.right.offer(simd, self.width - 1 - x, totals);
        }
        self.check(y);
    }
}

impl RightChoice {
    /// Candidate d of the left pixel is the pixel `start + d` of the mirrored right row.
    #[inline(always)]
    fn offer<S: Simd>(&mut self, simd: S, start: usize, totals: &[u16]) {
        let best = &mut self.total[start..start + totals.len()];
        let disparity = &mut self.disparity[start..start + totals.len()];
        let mut index = u16x16::from_fn(simd, |i| i as u16);
        for ((totals, best), disparity) in
            totals.chunks_exact(HALF).zip(best.chunks_exact_mut(HALF)).zip(disparity.chunks_exact_mut(HALF))
        {
            let total = u16x16::from_slice(simd, totals);
            let before = u16x16::from_slice(simd, best);
            let better = total.simd_lt(before);
            better.select(total, before).store_slice(best);
            better.select(index, u16x16::from_slice(simd, disparity)).store_slice(disparity);
            index += HALF as u16;
        }
    }
}

/// Index of the smallest total; the first of equals.
#[inline(always)]
fn cheapest<S: Simd>(simd: S, totals: &[u16]) -> u16 {
    let mut least = u16x16::splat(simd, u16::MAX);
    let mut place = u16x16::splat(simd, 0);
    let mut index = u16x16::from_fn(simd, |i| i as u16);
    for group in totals.chunks_exact(HALF) {
        let total = u16x16::from_slice(simd, group);
        let better = total.simd_lt(least);
        least = better.select(total, least);
        place = better.select(index, place);
        index += HALF as u16;
    }
    // Of the places that hold the smallest total, the first.
    let smallest = u16x16::splat(simd, least_of(least));
    least_of(least.simd_eq(smallest).select(place, u16x16::splat(simd, u16::MAX)))
}

/// Smallest total more than one disparity away from the chosen one.
#[inline(always)]
fn cheapest_apart<S: Simd>(simd: S, totals: &[u16], chosen: u16) -> u16 {
    let mut least = u16x16::splat(simd, u16::MAX);
    let mut place = u16x16::from_fn(simd, |i| (i as u16).wrapping_sub(chosen.wrapping_sub(1)));
    let three = u16x16::splat(simd, 3);
    for group in totals.chunks_exact(HALF) {
        let near = place.simd_lt(three);
        least = near.select(least, least.min(u16x16::from_slice(simd, group)));
        place += HALF as u16;
    }
    least_of(least)
}

/// Smallest of a group.
#[inline(always)]
fn least_of<S: Simd>(group: u16x16<S>) -> u16 {
    let (low, high) = group.split();
    // Halves against each other until one is left; a fold is not always compiled well.
    let mut least = low.min(high);
    least = least.min(least.slide::<4>(least));
    least = least.min(least.slide::<2>(least));
    least = least.min(least.slide::<1>(least));
    least[0]
}

/// Offset (pixels, −0.5..=0.5) of the tip of a V through the chosen total and its neighbors.
/// Census totals grow linearly away from the match, so a V fits them better than a parabola.
#[inline(always)]
fn vertex(totals: &[u16], chosen: usize) -> f32 {
    let (Some(before), Some(after)) =
        (chosen.checked_sub(1).and_then(|i| totals.get(i)), totals.get(chosen + 1))
    else {
        return 0.0;
    };
    let (before, middle, after) = (f32::from(*before), f32::from(totals[chosen]), f32::from(*after));
    let rise = before.max(after) - middle;
    if rise > 0.0 { 0.5 * (before - after) / rise } else { 0.0 }
}
