//! How different the windows around two pixels are, and which disparity each pixel votes for.

use super::super::patch::Grid;
use super::{Frame, HALF_WINDOW, Matcher, own};

/// Color difference (sum of three channels) beyond which a pixel is simply different.
const DIFFERENT: u8 = 150;
/// Color difference of windows that show the same thing, per pixel: noise and compression.
const NOISE: f32 = 5.0;
/// The best place must beat all others by this factor (after noise).
const DISTINCT: f32 = 1.25;
/// Places this near to the best one are the same place, raw px.
const SAME_PLACE_PX: f64 = 1.6;
/// Beyond this the eyes' colors differ by more than exposure and white balance explain.
const MOST_GAIN: f32 = 1.5;

impl Matcher {
    /// Gives the right patch the left one's brightness, by the means within the boxes.
    pub(super) fn equalize(&mut self, frame: &Frame, there: &Grid, expected_rad: f64) {
        let shift = (frame.count - 1) as isize - frame.index(expected_rad).round() as isize;
        let (mut left, mut right, mut count) = ([0u32; 3], [0u32; 3], 0u32);
        for row in 0..frame.grid.rows {
            for column in 0..frame.grid.columns {
                let here = row * frame.grid.columns + column;
                let Some(x) = column.checked_add_signed(shift).filter(|x| *x < there.columns) else {
                    continue;
                };
                let other = row * there.columns + x;
                if own(&frame.area, self.left.raw_px[here])
                    && self.left.seen[here] & self.right.seen[other] != 0
                {
                    for c in 0..3 {
                        left[c] += u32::from(self.left.channels[c][here]);
                        right[c] += u32::from(self.right.channels[c][other]);
                    }
                    count += 1;
                }
            }
        }
        if count > 0 {
            let gains = [0, 1, 2].map(|c| (left[c] as f32 + count as f32) / (right[c] as f32 + count as f32));
            if gains.iter().all(|gain| (1.0 / MOST_GAIN..MOST_GAIN).contains(gain)) {
                self.right.scale(gains);
            }
        }
    }

    /// Fills `costs`.
    pub(super) fn compare(&mut self, frame: &Frame, there: &Grid) {
        let Grid { columns, rows, .. } = frame.grid;
        let cells = columns * rows;
        self.costs.clear();
        self.costs.resize(cells * frame.count, i16::MAX);
        self.differences.clear();
        self.differences.resize(cells, 0);
        self.column_sums.clear();
        self.column_sums.resize(columns, 0);
        for k in 0..frame.count {
            let shift = frame.count - 1 - k;
            for row in 0..rows {
                let (here, other) = (row * columns, row * there.columns + shift);
                let to = &mut self.differences[here..here + columns];
                let channel = |c: usize| {
                    let left = &self.left.channels[c][here..here + columns];
                    (left, &self.right.channels[c][other..other + columns])
                };
                let ((l0, r0), (l1, r1), (l2, r2)) = (channel(0), channel(1), channel(2));
                let seen = &self.right.seen[other..other + columns];
                let colors = l0.iter().zip(r0).zip(l1.iter().zip(r1)).zip(l2.iter().zip(r2));
                for (((((a0, b0), (a1, b1)), (a2, b2)), seen), to) in colors.zip(seen).zip(to) {
                    let sum = a0.abs_diff(*b0).saturating_add(a1.abs_diff(*b1));
                    let sum = sum.saturating_add(a2.abs_diff(*b2)).min(DIFFERENT);
                    *to = sum.max(DIFFERENT & !seen);
                }
            }
            self.sum_windows(&frame.grid, k);
        }
    }

    /// Sums the differences of disparity `k` over windows; cells at the rim keep the largest cost.
    /// No sum comes near the largest number, so nothing wraps (and checks would forbid vectors).
    fn sum_windows(&mut self, grid: &Grid, k: usize) {
        const SIDE: usize = 2 * HALF_WINDOW + 1;
        let Grid { columns, rows, .. } = *grid;
        let costs = &mut self.costs[k * columns * rows..][..columns * rows];
        let inner = columns - 2 * HALF_WINDOW;
        let row_of = |y: usize| &self.differences[y * columns..][..columns];
        let sums = &mut self.column_sums[..columns];
        sums.fill(0);
        for y in 0..SIDE - 1 {
            for (sum, d) in sums.iter_mut().zip(row_of(y)) {
                *sum = sum.wrapping_add(i16::from(*d));
            }
        }
        for row in HALF_WINDOW..rows - HALF_WINDOW {
            for (sum, d) in sums.iter_mut().zip(row_of(row + HALF_WINDOW)) {
                *sum = sum.wrapping_add(i16::from(*d));
            }
            let to = &mut costs[row * columns + HALF_WINDOW..][..inner];
            to.copy_from_slice(&sums[..inner]);
            for i in 1..SIDE {
                for (cost, sum) in to.iter_mut().zip(&sums[i..]) {
                    *cost = cost.wrapping_add(*sum);
                }
            }
            for (sum, d) in sums.iter_mut().zip(row_of(row - HALF_WINDOW)) {
                *sum = sum.wrapping_sub(i16::from(*d));
            }
        }
    }

    /// Fills `votes`: the disparity of each cell whose best place is clearly the best.
    pub(super) fn choose(&mut self, frame: &Frame) {
        let cells = frame.grid.len();
        for (vector, value) in
            [(&mut self.best, i16::MAX), (&mut self.best_at, 0), (&mut self.second, i16::MAX)]
        {
            vector.clear();
            vector.resize(cells, value);
        }
        for (k, costs) in self.costs.chunks_exact(cells).enumerate() {
            let k = k as i16;
            // Without branches, so that it becomes vector instructions.
            for ((cost, best), at) in costs.iter().zip(&mut self.best).zip(&mut self.best_at) {
                let better = -i16::from(cost < best);
                *at = (*at & !better) | (k & better);
                *best = (*best).min(*cost);
            }
        }
        let same = (SAME_PLACE_PX / frame.cell_px).ceil().max(2.0) as i16;
        for (k, costs) in self.costs.chunks_exact(cells).enumerate() {
            let k = k as i16;
            for ((cost, at), second) in costs.iter().zip(&self.best_at).zip(&mut self.second) {
                let near = -i16::from(k.wrapping_sub(*at).wrapping_abs() <= same);
                *second = (*second).min(*cost | (near & i16::MAX));
            }
        }
        let noise = NOISE * ((2 * HALF_WINDOW + 1) * (2 * HALF_WINDOW + 1)) as f32;
        self.votes.clear();
        for i in 0..cells {
            let (best, second, at) =
                (f32::from(self.best[i]), f32::from(self.second[i]), self.best_at[i] as usize);
            let is_distinct = self.best[i] < i16::MAX && second + noise > DISTINCT * (best + noise);
            let at_end = at == 0 || at + 1 == frame.count;
            let vote = if is_distinct && !at_end {
                let cost = |k: usize| f32::from(self.costs[k * cells + i]);
                let (before, after) = (cost(at - 1), cost(at + 1));
                // Two straight lines with the same slope: what sums of absolute differences look like.
                let slope = before.max(after) - best;
                at as f32 + if slope > 0.0 { 0.5 * (before - after) / slope } else { 0.0 }
            } else {
                f32::NAN
            };
            self.votes.push(vote);
        }
    }
}
