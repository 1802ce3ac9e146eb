//! Which disparity each pixel of a box votes for, and on which the object's own pixels agree.
//!
//! Windows of color are compared along epipolar lines (sum of absolute differences, truncated so that
//! what is seen past an edge counts little). A pixel votes only if its best place is clearly better
//! than all others, and only within the disparities that keep it inside the right box: so neither
//! a plain surface nor the background has a say. The most frequent disparity wins, and the
//! voters near it are averaged.

mod costs;

use image::RgbImage;
use plumbline_model::{Eye, PixelBox};

use crate::locate::epipolar::EpipolarGeometry;

use super::boxes::EpipolarBox;
use super::pairing::px_rad;
use super::patch::{Grid, Patch};
use super::votes::Votes;

/// Cells that a box's longer side is cut into, if they do not get finer than [`FINEST_PX`].
const CELLS: f64 = 22.0;
/// Finest cell, raw px: nothing finer is in the image.
const FINEST_PX: f64 = 0.7;
/// Half side of the window that is compared, cells.
const HALF_WINDOW: usize = 2;
/// Cells around the box that are looked at too.
const RING: usize = HALF_WINDOW + 1;
/// Most disparities that are tried.
const MOST_DISPARITIES: usize = 144;
/// Most cells along a side of the left patch; a box never comes near it, whatever the lens does.
const MOST_SIDE: usize = 64;
/// Share of the box's half sides up to which pixels are taken for the object's own.
const OWN_ELLIPSE: f32 = 0.85;
/// Fewest pixels that may decide, and fewest for their share of the ellipse.
const FEWEST_VOTERS: usize = 12;
const FEWEST_SHARE: f64 = 0.04;

/// What the pixels of a box say.
#[derive(Clone, Copy, Debug)]
pub(super) struct Matching {
    /// Mean disparity of the voters, rad.
    pub disparity_rad: f64,
    /// Its standard deviation as the scatter of the voters tells it, rad.
    pub sigma_rad: f64,
    pub votes: Votes,
}

/// What the other pixels of a box say, judged against a disparity of the object.
#[derive(Clone, Copy, Debug)]
pub(super) struct Behind {
    /// Median disparity of those behind (or in front), rad.
    pub disparity_rad: f64,
    /// Their share of all pixels of the box that could be matched.
    pub share: f64,
    /// Median disparity of all pixels of the box that could be matched.
    pub median_rad: f64,
    /// Disparity at the middle of the box, if it could be matched.
    pub middle_rad: Option<f64>,
}

/// Memory of the matching.
#[derive(Debug, Default)]
pub(super) struct Matcher {
    left: Patch,
    right: Patch,
    /// Cost of one disparity: truncated differences, then window sums.
    differences: Vec<u8>,
    column_sums: Vec<i16>,
    /// Window costs, disparity by disparity.
    costs: Vec<i16>,
    best: Vec<i16>,
    best_at: Vec<i16>,
    second: Vec<i16>,
    /// Disparity (cells from the least) that each left cell votes for; not finite: none.
    votes: Vec<f32>,
    sorted: Vec<f32>,
    frame: Option<Frame>,
}

/// Geometry of the box that was matched last.
#[derive(Clone, Copy, Debug)]
struct Frame {
    grid: Grid,
    cell_px: f64,
    /// Disparity of index 0, rad.
    least_rad: f64,
    count: usize,
    area: PixelBox,
}

impl Frame {
    fn index(&self, disparity_rad: f64) -> f64 {
        (disparity_rad - self.least_rad) / self.grid.along_step_rad
    }

    fn disparity_rad(&self, index: f64) -> f64 {
        self.least_rad + index * self.grid.along_step_rad
    }
}

impl Matcher {
    /// Matches the pixels of the left box; `expected_rad` is the disparity of the surface that the
    /// box middles suggest, `reach_rad` how far from it the truth may be, `spread_rad` by how much an
    /// end of the object may differ from its middle. `None` if too few pixels can be told apart.
    pub fn find(
        &mut self,
        geometry: &EpipolarGeometry,
        images: [&RgbImage; 2],
        left: &EpipolarBox,
        expected_rad: f64,
        [reach_rad, spread_rad]: [f64; 2],
    ) -> Option<Matching> {
        self.frame = None;
        let frame = frame(geometry, left, expected_rad + reach_rad)?;
        self.left.sample(geometry, Eye::Left, images[0], &frame.grid);
        let mut there = frame.grid;
        there.columns += frame.count - 1;
        there.first.along_rad -= frame.disparity_rad((frame.count - 1) as f64);
        self.right.sample(geometry, Eye::Right, images[1], &there);
        self.equalize(&frame, &there, expected_rad);
        self.compare(&frame, &there);
        self.choose(&frame);
        self.frame = Some(frame);
        self.agree(&frame, expected_rad, [reach_rad, spread_rad])
    }

    /// The disparity that most of the object's own pixels agree on.
    fn agree(
        &mut self,
        frame: &Frame,
        expected_rad: f64,
        [reach_rad, spread_rad]: [f64; 2],
    ) -> Option<Matching> {
        let (expected, reach) =
            (frame.index(expected_rad) as f32, (reach_rad / frame.grid.along_step_rad) as f32);
        self.sorted.clear();
        let mut own_cells = 0usize;
        for (vote, raw_px) in self.votes.iter().zip(&self.left.raw_px) {
            if own(&frame.area, *raw_px) {
                own_cells += 1;
                if (vote - expected).abs() <= reach {
                    self.sorted.push(*vote);
                }
            }
        }
        self.sorted.sort_unstable_by(f32::total_cmp);
        // The window of disparities with most votes, as wide as two pixels.
        let width = (2.0 / frame.cell_px) as f32;
        let mode = densest(&self.sorted, width)?;
        let spread = (spread_rad / frame.grid.along_step_rad) as f32;
        let (low, high) = (self.sorted[mode.start] - spread, self.sorted[mode.end - 1] + spread);
        let first = self.sorted.partition_point(|vote| *vote < low);
        let last = self.sorted.partition_point(|vote| *vote <= high);
        let voters = &self.sorted[first..last];
        let enough = FEWEST_VOTERS.max((FEWEST_SHARE * own_cells as f64) as usize);
        if voters.len() < enough {
            return None;
        }
        let n = voters.len() as f64;
        let mean = voters.iter().map(|v| f64::from(*v)).sum::<f64>() / n;
        let variance = voters.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>() / n;
        // Windows overlap: only every so many votes are independent.
        let independent = (n / ((2 * HALF_WINDOW + 1) as f64).powi(2)).max(1.0);
        let mut votes = Votes::none(frame.area);
        for (vote, raw_px) in self.votes.iter().zip(&self.left.raw_px) {
            if own(&frame.area, *raw_px) && (low..=high).contains(vote) {
                votes.vote(raw_px[0] + 0.5, raw_px[1] + 0.5);
            }
        }
        Some(Matching {
            disparity_rad: frame.disparity_rad(mean),
            sigma_rad: (variance / independent).sqrt() * frame.grid.along_step_rad,
            votes,
        })
    }

    /// What the pixels of the box say whose disparity lies outside a range around the object's;
    /// `None` if there are none.
    pub fn behind(&mut self, nearest_rad: f64, farthest_rad: f64) -> Option<Behind> {
        let frame = self.frame?;
        let (near, far) = (frame.index(nearest_rad) as f32, frame.index(farthest_rad) as f32);
        self.sorted.clear();
        let middle =
            [0.5 * (frame.area.x0_px + frame.area.x1_px), 0.5 * (frame.area.y0_px + frame.area.y1_px)];
        let mut at_middle: Option<(f32, f32)> = None;
        for (vote, [u, v]) in self.votes.iter().zip(&self.left.raw_px) {
            let (x, y) = (u + 0.5, v + 0.5);
            let inside = x >= frame.area.x0_px
                && x < frame.area.x1_px
                && y >= frame.area.y0_px
                && y < frame.area.y1_px;
            if inside && vote.is_finite() {
                self.sorted.push(*vote);
                let off = (x - middle[0]).hypot(y - middle[1]);
                if off < 1.5 * frame.cell_px as f32 && at_middle.is_none_or(|(o, _)| off < o) {
                    at_middle = Some((off, *vote));
                }
            }
        }
        self.sorted.sort_unstable_by(f32::total_cmp);
        let all = self.sorted.len();
        let farther = self.sorted.partition_point(|d| *d < far);
        let nearer = all - self.sorted.partition_point(|d| *d <= near);
        let strangers =
            if farther >= nearer { &self.sorted[..farther] } else { &self.sorted[all - nearer..] };
        let rad = |index: f32| frame.disparity_rad(f64::from(index));
        Some(Behind {
            disparity_rad: rad(*strangers.get(strangers.len() / 2)?),
            share: strangers.len() as f64 / all as f64,
            median_rad: rad(self.sorted[all / 2]),
            middle_rad: at_middle.map(|(_, vote)| rad(vote)),
        })
    }
}

/// Whether a raw pixel lies in the ellipse that is taken for the object.
fn own(area: &PixelBox, [u, v]: [f32; 2]) -> bool {
    let x = (u + 0.5 - 0.5 * (area.x0_px + area.x1_px)) / (0.5 * area.width_px());
    let y = (v + 0.5 - 0.5 * (area.y0_px + area.y1_px)) / (0.5 * area.height_px());
    x * x + y * y <= OWN_ELLIPSE * OWN_ELLIPSE
}

/// The run of sorted values no wider than `width` that has most of them; `None` if there are none.
fn densest(sorted: &[f32], width: f32) -> Option<std::ops::Range<usize>> {
    let (mut best, mut first) = (0..0, 0);
    for (last, value) in sorted.iter().enumerate() {
        while value - sorted[first] > width {
            first += 1;
        }
        if last + 1 - first > best.len() {
            best = first..last + 1;
        }
    }
    (!best.is_empty()).then_some(best)
}

/// Lays the lattice over a left box; `None` for a box too small or too odd to be matched.
fn frame(geometry: &EpipolarGeometry, left: &EpipolarBox, most_rad: f64) -> Option<Frame> {
    let px_rad = px_rad(geometry, Eye::Left);
    let longer_px = f64::from(left.area.width_px().max(left.area.height_px()));
    let cell_px = (longer_px / CELLS).max(FINEST_PX);
    let along_step_rad = cell_px * px_rad;
    let plane_step_rad = along_step_rad / left.middle.along_rad.cos().max(0.1);
    let cells = |size_rad: f64, step_rad: f64| {
        // Not finite becomes 0 and is refused below.
        (size_rad / step_rad).ceil() as usize + 1 + 2 * RING
    };
    let [top, bottom] = left.planes_rad;
    let [start, end] = left.alongs_rad;
    let columns = cells((end - start).abs(), along_step_rad);
    let rows = cells((bottom - top).abs(), plane_step_rad);
    if columns > MOST_SIDE || rows > MOST_SIDE || columns < 2 * RING + 3 || rows < 2 * RING + 3 {
        return None;
    }
    let middle = |a: f64, b: f64| 0.5 * (a + b);
    let first = crate::locate::epipolar::EpipolarRay {
        plane_rad: middle(top, bottom) - 0.5 * (rows - 1) as f64 * plane_step_rad,
        along_rad: middle(start, end) - 0.5 * (columns - 1) as f64 * along_step_rad,
    };
    // From the horizon on, unless that is too many.
    let count = ((most_rad / along_step_rad).ceil() + 3.0).clamp(8.0, MOST_DISPARITIES as f64) as usize;
    let least_rad = most_rad - (count - 2) as f64 * along_step_rad;
    let grid = Grid { first, along_step_rad, plane_step_rad, columns, rows };
    Some(Frame { grid, cell_px, least_rad, count, area: left.area })
}
