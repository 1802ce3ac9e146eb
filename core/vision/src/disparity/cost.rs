//! How badly each pixel of the left view matches each candidate in the right view.

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

use super::census::Census;

/// Disparities are handled in groups of this many: one register of bytes.
pub(super) const LANES: usize = 32;

/// Numbers of groups that the aggregation is compiled for.
const GROUPS: [usize; 7] = [1, 2, 3, 4, 8, 16, MOST_GROUPS];
/// The largest of them.
pub(super) const MOST_GROUPS: usize = 32;

/// Cost of a candidate that cannot be seen: outside the right view or masked. About a third of
/// the differing places that two unrelated pixels have, so that the neighbors decide.
const UNSEEN_PER_BIT: f32 = 1.0 / 3.0;

/// Cost of the lanes that only fill up a group; never wins.
const NEVER: u8 = 150;

/// One byte per pixel and disparity; disparities of a pixel are neighbors in memory.
#[derive(Default)]
pub(super) struct CostVolume {
    pub bytes: Vec<u8>,
    pub width: usize,
    pub height: usize,
    /// Number of disparities searched: 0 to this, exclusive.
    pub disparities: usize,
    /// Number of disparities stored: rounded up to a number of groups that the aggregation knows.
    pub lanes: usize,
}

/// Pixels that may be matched, row by row; the right one mirrored.
pub(super) struct Usable<'a> {
    pub left: &'a [u8],
    pub right_mirrored: &'a [u8],
}

impl Usable<'_> {
    fn hides_some_of(&self, y: usize, width: usize) -> bool {
        [self.left, self.right_mirrored].iter().any(|mask| mask[y * width..][..width].contains(&0))
    }
}

impl CostVolume {
    /// Sets the shape; keeps the memory where it fits.
    pub fn reshape(&mut self, width: usize, height: usize, disparities: usize) {
        self.width = width;
        self.height = height;
        self.disparities = disparities;
        let needed = disparities.div_ceil(LANES);
        self.lanes = LANES * GROUPS.into_iter().find(|groups| *groups >= needed).unwrap_or(MOST_GROUPS);
        self.bytes.resize(width * height * self.lanes, 0);
    }

    /// Bytes of one row.
    pub fn row_len(&self) -> usize {
        self.width * self.lanes
    }

    /// Costs of one row, all pixels.
    #[inline(always)]
    pub fn row(&self, y: usize) -> &[u8] {
        &self.bytes[y * self.row_len()..][..self.row_len()]
    }

    /// Counts differing census bits of `bits` for every pixel and disparity.
    pub fn compute(
        &mut self,
        left: &Census,
        right_mirrored: &Census,
        bits: usize,
        usable: Option<&Usable<'_>>,
    ) {
        let (width, lanes, disparities) = (self.width, self.lanes, self.disparities);
        let level = Level::new();
        let unseen = (bits as f32 * UNSEEN_PER_BIT) as u8;
        self.bytes.par_chunks_mut(width * lanes).enumerate().for_each_init(
            || Candidates::new(right_mirrored.planes(), width, lanes),
            |candidates, (y, row)| {
                // Most rows are seen whole by both eyes.
                let usable = usable.filter(|usable| usable.hides_some_of(y, width));
                candidates.load(right_mirrored, y, usable, width);
                let mut wanted = vec![0; left.planes()];
                dispatch!(level, _simd => {
                    for (x, costs) in row.chunks_exact_mut(lanes).enumerate() {
                        if usable.is_some_and(|usable| usable.left[y * width + x] == 0) {
                            costs.fill(unseen);
                        } else {
                            // In the mirrored row, the candidate for disparity d is d places on.
                            let start = width - 1 - x;
                            for (plane, wanted) in wanted.iter_mut().enumerate() {
                                *wanted = left.plane(y, plane)[x];
                            }
                            candidates.compare(&wanted, start, costs);
                            if usable.is_some() {
                                candidates.soften(start, unseen, costs);
                            }
                            if x + 1 < lanes {
                                costs[x + 1..].fill(unseen);
                            }
                        }
                        costs[disparities..].fill(NEVER);
                    }
                });
            },
        );
    }
}

/// One mirrored row of the right view, with room for candidates past its end.
struct Candidates {
    /// Census bytes, one plane after the other.
    bytes: Vec<u8>,
    /// 255 where the candidate may be used, 0 where not.
    usable: Vec<u8>,
    /// Length of a plane.
    stride: usize,
}

impl Candidates {
    fn new(planes: usize, width: usize, lanes: usize) -> Self {
        let stride = width + lanes;
        Self { bytes: vec![0; planes * stride], usable: vec![0; stride], stride }
    }

    fn load(&mut self, census: &Census, y: usize, usable: Option<&Usable<'_>>, width: usize) {
        for (index, plane) in self.bytes.chunks_exact_mut(self.stride).enumerate() {
            plane[..width].copy_from_slice(census.plane(y, index));
        }
        if let Some(usable) = usable {
            let row = &usable.right_mirrored[y * width..][..width];
            for (to, from) in self.usable.iter_mut().zip(row) {
                *to = if *from == 0 { 0 } else { u8::MAX };
            }
        }
    }

    /// Counts the places where each candidate from `start` on differs from `wanted`.
    #[inline(always)]
    fn compare(&self, wanted: &[u8], start: usize, costs: &mut [u8]) {
        let (groups, _) = costs.as_chunks_mut::<LANES>();
        for (group, costs) in groups.iter_mut().enumerate() {
            let mut sum = [0u8; LANES];
            let planes = self.bytes[start + group * LANES..].chunks(self.stride);
            for (plane, wanted) in planes.zip(wanted) {
                let Some(candidates) = plane.first_chunk::<LANES>() else { continue };
                for (sum, candidate) in sum.iter_mut().zip(candidates) {
                    *sum = sum.wrapping_add((candidate ^ wanted).count_ones() as u8);
                }
            }
            *costs = sum;
        }
    }

    /// Replaces the cost of masked candidates.
    #[inline(always)]
    fn soften(&self, start: usize, unseen: u8, costs: &mut [u8]) {
        for (cost, usable) in costs.iter_mut().zip(&self.usable[start..]) {
            *cost = (*cost & usable) | (unseen & !usable);
        }
    }
}
