//! The search itself: from two views to checked disparities of single pixels.

use image::GrayImage;
use image::imageops::flip_horizontal;

use super::Block;
use super::census::{Census, Columns, Window};
use super::cost::{CostVolume, Usable};
use super::paths::{Penalties, aggregate};
use super::select::{Selector, UNKNOWN};
use crate::rectify::Pair;

/// Gray values that differ by this much are likely to be an edge of something.
const EDGE_CONTRAST: f32 = 10.0;
/// Disparities found from both sides may differ by this much, pixels.
const MUTUAL_TOLERANCE_PX: f32 = 1.0;

/// What is searched.
#[derive(Clone, Copy)]
pub(super) struct Views<'a> {
    pub left: &'a GrayImage,
    pub right: &'a GrayImage,
    pub masks: Option<&'a Pair<GrayImage>>,
}

/// The same views as a pair of eyes would see them in a mirror: the right one is then the left.
pub(super) struct Mirrored {
    left: GrayImage,
    right: GrayImage,
    masks: Option<Pair<GrayImage>>,
}

/// Working memory.
#[derive(Default)]
pub(super) struct Search {
    left: Census,
    right: Census,
    costs: CostVolume,
    partial: Vec<u8>,
}

impl Block {
    fn window(self) -> Window {
        let (half_width, half_height) = match self {
            Self::Small => (2, 2),
            Self::Medium => (3, 2),
            Self::Large => (4, 3),
        };
        Window { half_width, half_height }
    }

    /// What changes of disparity cost, in proportion to the number of bits compared. Found by
    /// trying round numbers on pictures of both kinds, toys in a studio and the robot's table.
    fn penalties(self) -> Penalties {
        let bits = self.window().bits() as f32;
        let large = |difference: f32| (1.6 / (1.0 + difference / EDGE_CONTRAST)).clamp(0.4, 0.95);
        Penalties {
            small: (0.16 * bits) as u8,
            large: std::array::from_fn(|difference| (large(difference as f32) * bits) as u8),
        }
    }
}

impl Mirrored {
    pub fn of(left: &GrayImage, right: &GrayImage, masks: Option<&Pair<GrayImage>>) -> Self {
        let masks = masks
            .map(|masks| Pair { left: flip_horizontal(&masks.right), right: flip_horizontal(&masks.left) });
        Self { left: flip_horizontal(right), right: flip_horizontal(left), masks }
    }

    pub fn views(&self) -> Views<'_> {
        Views { left: &self.left, right: &self.right, masks: self.masks.as_ref() }
    }
}

impl Search {
    /// Disparities of the left view, 0 to `disparities` exclusive, into `found`: those that the
    /// right view shares.
    pub fn run(&mut self, views: Views<'_>, block: Block, disparities: usize, found: &mut Vec<f32>) {
        let Views { left, right, masks } = views;
        let (width, height) = (left.width() as usize, left.height() as usize);
        let window = block.window();
        self.left.compute(left, window, Columns::Forward);
        self.right.compute(right, window, Columns::Mirrored);
        let right_mirrored = masks.map(|masks| flip_horizontal(&masks.right));
        let usable = masks.zip(right_mirrored.as_ref()).map(|(masks, right_mirrored)| Usable {
            left: masks.left.as_raw(),
            right_mirrored: right_mirrored.as_raw(),
        });
        self.costs.reshape(width, height, disparities);
        self.costs.compute(&self.left, &self.right, window.bits(), usable.as_ref());
        found.resize(width * height, UNKNOWN);
        let (upper, lower) = found.split_at_mut(height / 2 * width);
        let mut upper = Selector::new(&self.costs, 0, upper);
        let mut lower = Selector::new(&self.costs, height / 2, lower);
        aggregate(&self.costs, left.as_raw(), &block.penalties(), &mut self.partial, &mut upper, &mut lower);
        if let Some(masks) = masks {
            drop_masked(found, masks, width);
        }
    }
}

/// Makes disparities unknown that belong to, or lead to, a masked pixel: the smoothness of
/// their surroundings alone has led to them.
fn drop_masked(found: &mut [f32], masks: &Pair<GrayImage>, width: usize) {
    let rows = masks.left.as_raw().chunks_exact(width).zip(masks.right.as_raw().chunks_exact(width));
    for (row, (left, right)) in found.chunks_exact_mut(width).zip(rows) {
        for (x, d) in row.iter_mut().enumerate().filter(|(_, d)| **d < UNKNOWN) {
            let seen_by_right = x.checked_sub(d.round() as usize).is_some_and(|x| right[x] > 0);
            if left[x] == 0 || !seen_by_right {
                *d = UNKNOWN;
            }
        }
    }
}

/// Makes disparities unknown that the search from the other side, whose rows run the other way,
/// did not find.
pub(super) fn keep_mutual(found: &mut [f32], mirrored: &[f32], width: usize) {
    for (row, mirrored) in found.chunks_exact_mut(width).zip(mirrored.chunks_exact(width)) {
        for (x, d) in row.iter_mut().enumerate() {
            // An unknown disparity saturates to a column far outside.
            let column = (width - 1 - x).saturating_add(d.round() as usize);
            let shared = mirrored.get(column).is_some_and(|other| (other - *d).abs() <= MUTUAL_TOLERANCE_PX);
            if !shared {
                *d = UNKNOWN;
            }
        }
    }
}
