//! Dense disparity of a rectified pair.
//!
//! Census transform → number of differing bits as matching cost → semi-global aggregation →
//! left-right check → median, removal of specks → sub-pixel refinement → filling of what is
//! left. Everything works on whole rows in groups of 32 disparities, on as many cores as the
//! rayon pool has, except for the aggregation, which uses two.
//!
//! Assumes that both views show a point on the same row (see the epipolar error of the
//! calibration: half a pixel is too much) and that surfaces look alike from both eyes. Broken
//! on bare, shiny and repetitive surfaces: there the two views disagree, and the pixel is
//! reported as filled in, not as measured.

pub mod bench;
mod census;
mod cost;
mod fill;
mod map;
mod paths;
mod pfm;
mod refine;
mod select;
mod smooth;

use image::GrayImage;

use crate::rectify::Pair;
pub use map::{DisparityMap, Origin};
pub use pfm::{PfmError, read_pfm, write_pfm};

/// Largest disparity that can be searched for, pixels.
pub const MAX_DISPARITY_PX: u32 = 1023;
/// Patches with fewer pixels than this are not trusted.
const SPECK_PIXELS: u32 = 60;
/// Neighbors in a patch differ by at most this much, pixels.
const SPECK_STEP_PX: f32 = 1.0;

/// How much time a disparity map may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Quality {
    /// For a live view: one refinement.
    Live,
    /// For results: everything.
    #[default]
    Full,
}

/// What the matcher is asked to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Largest disparity searched for, 1 to [`MAX_DISPARITY_PX`] pixels. Sets the nearest depth
    /// that can be seen; time grows with it.
    pub max_disparity_px: u32,
    /// Neighborhood that is compared.
    pub block: Block,
    /// Time against quality.
    pub quality: Quality,
}

/// Neighborhood that is compared (width × height in pixels). A larger one tells more surfaces
/// apart and rounds off more corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Block {
    /// 5 × 5.
    Small,
    /// 7 × 5.
    Medium,
    /// 9 × 7.
    #[default]
    Large,
}

/// Why there is no disparity map.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DisparityError {
    /// The range cannot be searched.
    #[error("a largest disparity of {asked_px} px cannot be searched for: give 1 to {MAX_DISPARITY_PX}")]
    Range {
        /// What was asked for.
        asked_px: u32,
    },
    /// Left and right views or masks have different sizes.
    #[error(
        "the {what} is {width_px}x{height_px} px but the left view is {left_width_px}x{left_height_px} px: both have to come from the same rectified pair"
    )]
    Sizes {
        /// Which image.
        what: &'static str,
        /// Its width.
        width_px: u32,
        /// Its height.
        height_px: u32,
        /// Width of the left view.
        left_width_px: u32,
        /// Height of the left view.
        left_height_px: u32,
    },
    /// No pixels, or fewer than a window needs.
    #[error("a view of {width_px}x{height_px} px is too small to be matched: it needs at least 16x16")]
    Small {
        /// Width of the view.
        width_px: u32,
        /// Height of the view.
        height_px: u32,
    },
}

/// Finds disparities; keeps its working memory between calls.
pub struct Matcher {
    settings: Settings,
    left: census::Census,
    right: census::Census,
    costs: cost::CostVolume,
    partial: Vec<u8>,
    raw: Vec<f32>,
    refiner: refine::Refiner,
}

impl Settings {
    /// For a live view.
    pub fn live(max_disparity_px: u32) -> Self {
        Self { max_disparity_px, block: Block::Large, quality: Quality::Live }
    }

    /// For results.
    pub fn full(max_disparity_px: u32) -> Self {
        Self { max_disparity_px, block: Block::Large, quality: Quality::Full }
    }
}

impl Block {
    fn window(self) -> census::Window {
        let (half_width, half_height) = match self {
            Self::Small => (2, 2),
            Self::Medium => (3, 2),
            Self::Large => (4, 3),
        };
        census::Window { half_width, half_height }
    }

    /// What changes of disparity cost, in proportion to the number of bits compared.
    fn penalties(self) -> paths::Penalties {
        let bits = self.window().bits() as f32;
        paths::Penalties { small: (bits * 8.0 / 62.0) as u8, large: (bits * 60.0 / 62.0) as u8 }
    }
}

impl Matcher {
    /// A matcher with these settings.
    ///
    /// # Errors
    /// [`DisparityError::Range`] when the range cannot be searched.
    pub fn new(settings: Settings) -> Result<Self, DisparityError> {
        if !(1..=MAX_DISPARITY_PX).contains(&settings.max_disparity_px) {
            return Err(DisparityError::Range { asked_px: settings.max_disparity_px });
        }
        Ok(Self {
            settings,
            left: census::Census::default(),
            right: census::Census::default(),
            costs: cost::CostVolume::default(),
            partial: Vec::new(),
            raw: Vec::new(),
            refiner: refine::Refiner::default(),
        })
    }

    /// The settings.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Disparities of the left view. Pixels where a mask is 0 are neither matched nor filled.
    ///
    /// # Errors
    /// When views and masks differ in size or are too small.
    pub fn compute(
        &mut self,
        left: &GrayImage,
        right: &GrayImage,
        masks: Option<&Pair<GrayImage>>,
    ) -> Result<DisparityMap, DisparityError> {
        check(left, right, masks)?;
        let (width, height) = (left.width() as usize, left.height() as usize);
        self.match_views(left, right, masks);
        let mut disparities = vec![select::UNKNOWN; width * height];
        smooth::median(&self.raw, width, &mut disparities);
        smooth::remove_specks(&mut disparities, width, SPECK_PIXELS, SPECK_STEP_PX);
        self.refiner.refine(left, right, &mut disparities);
        let filled =
            fill::fill(&mut disparities, width, |i| masks.is_none_or(|masks| masks.left.as_raw()[i] > 0));
        Ok(DisparityMap::new(left.width(), left.height(), disparities, filled))
    }

    /// Checked whole-pixel matches, with a first guess of the fraction, into `self.raw`.
    fn match_views(&mut self, left: &GrayImage, right: &GrayImage, masks: Option<&Pair<GrayImage>>) {
        let (width, height) = (left.width() as usize, left.height() as usize);
        let window = self.settings.block.window();
        self.left.compute(left, window, census::Columns::Forward);
        self.right.compute(right, window, census::Columns::Mirrored);
        let right_mirrored = masks.map(|masks| image::imageops::flip_horizontal(&masks.right));
        let usable = masks.zip(right_mirrored.as_ref()).map(|(masks, right_mirrored)| cost::Usable {
            left: masks.left.as_raw(),
            right_mirrored: right_mirrored.as_raw(),
        });
        self.costs.reshape(width, height, self.settings.max_disparity_px as usize + 1);
        self.costs.compute(&self.left, &self.right, window.bits(), usable.as_ref());
        self.raw.resize(width * height, select::UNKNOWN);
        let (upper, lower) = self.raw.split_at_mut(height / 2 * width);
        let lanes = self.costs.lanes;
        let mut upper = select::Selector::new(0, width, lanes, upper);
        let mut lower = select::Selector::new(height / 2, width, lanes, lower);
        let penalties = self.settings.block.penalties();
        paths::aggregate(&self.costs, penalties, &mut self.partial, &mut upper, &mut lower);
        if let Some(masks) = masks {
            for (d, usable) in self.raw.iter_mut().zip(masks.left.as_raw()) {
                if *usable == 0 {
                    *d = select::UNKNOWN;
                }
            }
        }
    }
}

fn check(left: &GrayImage, right: &GrayImage, masks: Option<&Pair<GrayImage>>) -> Result<(), DisparityError> {
    let (left_width_px, left_height_px) = left.dimensions();
    if left_width_px < 16 || left_height_px < 16 {
        return Err(DisparityError::Small { width_px: left_width_px, height_px: left_height_px });
    }
    let mut others = vec![("right view", right)];
    if let Some(masks) = masks {
        others.extend([("mask of the left view", &masks.left), ("mask of the right view", &masks.right)]);
    }
    for (what, image) in others {
        let (width_px, height_px) = image.dimensions();
        if (width_px, height_px) != (left_width_px, left_height_px) {
            return Err(DisparityError::Sizes { what, width_px, height_px, left_width_px, left_height_px });
        }
    }
    Ok(())
}
