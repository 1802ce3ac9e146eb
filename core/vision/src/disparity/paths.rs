//! Semi-global matching: the disparity of a pixel should fit the image *and* its neighbors.
//!
//! Along each of eight straight paths that end in a pixel, the cheapest sequence of disparities
//! is found in which a step of one costs a little (slanted surfaces) and a larger one more
//! (edges of objects). The eight sums together decide. Assumes that surfaces are mostly smooth;
//! broken by thin things in front of a far background, which the left-right check then removes.
//!
//! Source: Hirschmüller: Stereo processing by semiglobal matching and mutual information (2008).
//!
//! Four of the paths come from above and the left and are found in one sweep down the image,
//! the others in one sweep up. Both sweeps run at the same time and meet in the middle; only
//! then each continues into the other's half, where the other's sums are waiting, so that no
//! more than one volume of sums is ever kept.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, u8x32};

use super::cost::{CostVolume, LANES, MOST_GROUPS};

/// What changes of disparity between neighbors cost, in census bits.
pub(super) struct Penalties {
    /// Of one step.
    pub small: u8,
    /// Of more, by how much the gray values of the neighbors differ: edges of objects tend to
    /// be edges of the image too. At most 63, so that the sum over four paths fits a byte.
    pub large: [u8; 256],
}

/// Paths followed per sweep.
const PATHS: usize = 4;
/// Around the lanes of a path, so that all have neighbors; large, but can take a penalty more.
const SENTINEL: u8 = 240;

/// Receives the totals of each finished row: per pixel and lane, over all eight paths.
pub(super) trait RowSink: Send {
    /// `totals` has `width * lanes` entries.
    fn row<S: Simd>(&mut self, simd: S, y: usize, totals: &[u16]);
}

/// Runs both sweeps over `costs`. `grays` is the left view, row by row; `partial` is working
/// memory. Each sink gets its half of the rows: `upper` those above the middle (from the middle
/// upwards), `lower` the others.
pub(super) fn aggregate(
    costs: &CostVolume,
    grays: &[u8],
    penalties: &Penalties,
    partial: &mut Vec<u8>,
    upper: &mut impl RowSink,
    lower: &mut impl RowSink,
) {
    // The inner loop over groups is unrolled for small numbers of them.
    match costs.lanes / LANES {
        1 => aggregate_groups::<1>(costs, grays, penalties, partial, upper, lower),
        2 => aggregate_groups::<2>(costs, grays, penalties, partial, upper, lower),
        3 => aggregate_groups::<3>(costs, grays, penalties, partial, upper, lower),
        4 => aggregate_groups::<4>(costs, grays, penalties, partial, upper, lower),
        8 => aggregate_groups::<8>(costs, grays, penalties, partial, upper, lower),
        16 => aggregate_groups::<16>(costs, grays, penalties, partial, upper, lower),
        groups => {
            assert_eq!(groups, MOST_GROUPS, "the cost volume stores a number of groups from the list");
            aggregate_groups::<MOST_GROUPS>(costs, grays, penalties, partial, upper, lower);
        }
    }
}

fn aggregate_groups<const GROUPS: usize>(
    costs: &CostVolume,
    grays: &[u8],
    penalties: &Penalties,
    partial: &mut Vec<u8>,
    upper: &mut impl RowSink,
    lower: &mut impl RowSink,
) {
    let (height, middle) = (costs.height, costs.height / 2);
    partial.resize(costs.bytes.len(), 0);
    let (above, below) = partial.split_at_mut(middle * costs.row_len());
    let mut down = Sweep::<GROUPS>::new(costs, grays, penalties, true);
    let mut up = Sweep::<GROUPS>::new(costs, grays, penalties, false);
    rayon::join(|| down.keep(0..middle, above), || up.keep(middle..height, below));
    let (above, below) = (&*above, &*below);
    rayon::join(|| down.finish(middle..height, below, lower), || up.finish(0..middle, above, upper));
}

/// Totals over all paths. Each sweep sums by how much its paths exceed the pixel's own cost,
/// which is part of all eight.
#[inline(always)]
fn add_up(down: &[u8], up: &[u8], costs: &[u8], totals: &mut [u16]) {
    for (((total, down), up), cost) in totals.iter_mut().zip(down).zip(up).zip(costs) {
        let own = u16::from(*cost).wrapping_mul(2 * PATHS as u16);
        *total = own.wrapping_add(u16::from(*down)).wrapping_add(u16::from(*up));
    }
}

fn row<'a>(volume: &'a [u8], index: usize, costs: &CostVolume) -> &'a [u8] {
    &volume[index * costs.row_len()..][..costs.row_len()]
}

fn row_mut<'a>(volume: &'a mut [u8], index: usize, costs: &CostVolume) -> &'a mut [u8] {
    &mut volume[index * costs.row_len()..][..costs.row_len()]
}

/// Path costs of one row: per pixel four paths, each with a sentinel at both ends so that
/// every lane has neighbors. One pixel is added at both ends of the row, with no cost at all:
/// there a path begins.
struct PathRow {
    bytes: Vec<u8>,
    least: Vec<[u8; PATHS]>,
}

/// One direction through the image.
struct Sweep<'a, const GROUPS: usize> {
    costs: &'a CostVolume,
    grays: &'a [u8],
    penalties: &'a Penalties,
    downward: bool,
    level: Level,
    before: PathRow,
    current: PathRow,
    /// Per pixel of the row, what a large change costs on each path.
    large: Vec<[u8; PATHS]>,
}

impl<'a, const GROUPS: usize> Sweep<'a, GROUPS> {
    /// Bytes of one path at one pixel.
    const STRIDE: usize = GROUPS * LANES + 2;
    /// Bytes of all paths at one pixel.
    const PIXEL: usize = PATHS * Self::STRIDE;

    fn new(costs: &'a CostVolume, grays: &'a [u8], penalties: &'a Penalties, downward: bool) -> Self {
        let row = || PathRow {
            bytes: vec![0; (costs.width + 2) * Self::PIXEL],
            least: vec![[0; PATHS]; costs.width + 2],
        };
        Self {
            costs,
            grays,
            penalties,
            downward,
            level: Level::new(),
            before: row(),
            current: row(),
            large: vec![[0; PATHS]; costs.width],
        }
    }

    /// Follows the paths through `rows` and keeps their sums in `block`, which starts there.
    fn keep(&mut self, rows: Range<usize>, block: &mut [u8]) {
        dispatch!(self.level, simd => self.keep_with(simd, rows, block));
    }

    #[inline(always)]
    fn keep_with<S: Simd>(&mut self, simd: S, rows: Range<usize>, block: &mut [u8]) {
        for step in 0..rows.len() {
            let y = self.nth(&rows, step);
            self.follow(simd, y, row_mut(block, y - rows.start, self.costs));
        }
    }

    /// Follows the paths through `rows`, adds the other sweep's sums in `block`, which starts
    /// there, and hands on the totals.
    fn finish(&mut self, rows: Range<usize>, block: &[u8], sink: &mut impl RowSink) {
        dispatch!(self.level, simd => self.finish_with(simd, rows, block, sink));
    }

    #[inline(always)]
    fn finish_with<S: Simd>(&mut self, simd: S, rows: Range<usize>, block: &[u8], sink: &mut impl RowSink) {
        let mut sums = vec![0; self.costs.row_len()];
        let mut totals = vec![0; self.costs.row_len()];
        for step in 0..rows.len() {
            let y = self.nth(&rows, step);
            self.follow(simd, y, &mut sums);
            add_up(&sums, row(block, y - rows.start, self.costs), self.costs.row(y), &mut totals);
            sink.row(simd, y, &totals);
        }
    }

    /// Row number `step` of `rows` in the direction of the sweep.
    #[inline(always)]
    fn nth(&self, rows: &Range<usize>, step: usize) -> usize {
        if self.downward { rows.start + step } else { rows.end - 1 - step }
    }

    /// Column number `step` of a row in the direction of the sweep.
    #[inline(always)]
    fn column(&self, step: usize) -> usize {
        if self.downward { step } else { self.costs.width - 1 - step }
    }

    /// Looks up what large changes cost in row `y`. A path that begins there has nothing to
    /// change from: then it does not matter what it finds.
    fn look_up_penalties(&mut self, y: usize) {
        let (width, last) = (self.costs.width, self.costs.height - 1);
        let y_before = if self.downward { y.saturating_sub(1) } else { (y + 1).min(last) };
        let own_row = &self.grays[y * width..][..width];
        let row_before = &self.grays[y_before * width..][..width];
        for step in 0..width {
            let behind = self.column(step.saturating_sub(1));
            let x = self.column(step);
            let ahead = self.column((step + 1).min(width - 1));
            let from = [row_before[behind], row_before[x], row_before[ahead], own_row[behind]];
            for (large, from) in self.large[step].iter_mut().zip(from) {
                *large = self.penalties.large[usize::from(own_row[x].abs_diff(from))];
            }
        }
    }

    /// Follows the four paths of this sweep through row `y`; `sums` gets by how much they
    /// exceed the pixels' own costs.
    #[inline(always)]
    fn follow<S: Simd>(&mut self, simd: S, y: usize, sums: &mut [u8]) {
        let (width, lanes) = (self.costs.width, GROUPS * LANES);
        self.look_up_penalties(y);
        std::mem::swap(&mut self.before, &mut self.current);
        let downward = self.downward;
        let (before, current) = (&self.before, &mut self.current);
        let costs = self.costs.row(y);
        let (stride, pixel) = (Self::STRIDE, Self::PIXEL);
        for step in 0..width {
            let x = if downward { step } else { width - 1 - step };
            // Places are counted in the direction of the sweep; place 0 lies outside, this
            // pixel is at place `step + 1`.
            let [least_before, least] = &mut current.least[step..step + 2] else { return };
            let [behind, same, ahead] = &before.least[step..step + 3] else { return };
            let beside = &before.bytes[step * pixel..][..3 * pixel];
            let (last, out) = current.bytes[step * pixel..][..2 * pixel].split_at_mut(pixel);
            let incoming = Incoming {
                costs: [
                    &beside[..stride],
                    &beside[pixel + stride..][..stride],
                    &beside[2 * pixel + 2 * stride..][..stride],
                    &last[3 * stride..][..stride],
                ],
                least: [behind[0], same[1], ahead[2], least_before[3]],
                large: self.large[step],
            };
            let costs = groups::<GROUPS>(&costs[x * lanes..][..lanes]);
            let sums = groups_mut::<GROUPS>(&mut sums[x * lanes..][..lanes]);
            *least = extend(simd, self.penalties.small, &incoming, costs, out, sums);
        }
    }
}

/// The paths into a pixel, at the pixels that they come from.
struct Incoming<'a> {
    /// Costs, with sentinels.
    costs: [&'a [u8]; PATHS],
    /// The smallest of each.
    least: [u8; PATHS],
    /// What a large change costs on the way.
    large: [u8; PATHS],
}

/// Extends the paths into one pixel. Returns the new smallest costs.
#[inline(always)]
fn extend<S: Simd, const GROUPS: usize>(
    simd: S,
    small: u8,
    incoming: &Incoming<'_>,
    costs: &[[u8; LANES]; GROUPS],
    out: &mut [u8],
    sums: &mut [[u8; LANES]; GROUPS],
) -> [u8; PATHS] {
    let stride = GROUPS * LANES + 2;
    let small = u8x32::splat(simd, small);
    let zero = u8x32::splat(simd, 0);
    let mut smallest = [0; PATHS];
    for path in 0..PATHS {
        let lower = groups::<GROUPS>(incoming.costs[path]);
        let same = groups::<GROUPS>(&incoming.costs[path][1..]);
        let upper = groups::<GROUPS>(&incoming.costs[path][2..]);
        let out = &mut out[path * stride..][..stride];
        out[0] = SENTINEL;
        out[stride - 1] = SENTINEL;
        let out = groups_mut::<GROUPS>(&mut out[1..]);
        let large = u8x32::splat(simd, incoming.large[path]);
        let floor = u8x32::splat(simd, incoming.least[path]);
        let mut best = u8x32::splat(simd, u8::MAX);
        for group in 0..GROUPS {
            let load = |groups: &[[u8; LANES]; GROUPS]| u8x32::from_slice(simd, &groups[group]);
            let neighbor = load(lower).min(load(upper)) + small;
            let excess = (load(same).min(neighbor) - floor).min(large);
            let total = load(costs) + excess;
            total.store_slice(&mut out[group]);
            best = best.min(total);
            let sum = if path == 0 { zero } else { u8x32::from_slice(simd, &sums[group]) };
            (sum + excess).store_slice(&mut sums[group]);
        }
        smallest[path] = least_of(best);
    }
    smallest
}

/// The first whole groups of some bytes.
#[inline(always)]
fn groups<const GROUPS: usize>(bytes: &[u8]) -> &[[u8; LANES]; GROUPS] {
    bytes[..GROUPS * LANES].as_chunks().0.try_into().expect("cut to that many groups")
}

#[inline(always)]
fn groups_mut<const GROUPS: usize>(bytes: &mut [u8]) -> &mut [[u8; LANES]; GROUPS] {
    bytes[..GROUPS * LANES].as_chunks_mut().0.try_into().expect("cut to that many groups")
}

/// Smallest of a group.
#[inline(always)]
fn least_of<S: Simd>(group: u8x32<S>) -> u8 {
    let (low, high) = group.split();
    // Halves against each other until one is left; a fold is not always compiled well.
    let mut least = low.min(high);
    least = least.min(least.slide::<8>(least));
    least = least.min(least.slide::<4>(least));
    least = least.min(least.slide::<2>(least));
    least = least.min(least.slide::<1>(least));
    least[0]
}
