//! Dense disparity of a rectified pair.
//!
//! Census transform → number of differing bits as matching cost → semi-global aggregation →
//! left-right check → median, removal of specks → sub-pixel refinement → filling of what is
//! left. Everything works on whole rows in groups of 32 disparities, on as many cores as the
//! rayon pool has, except for the aggregation, which uses two.
//!
//! Assumes that both views show a point on the same row (see the epipolar error of the
//! calibration: half a pixel is too much) and that surfaces look alike from both eyes. On bare
//! surfaces, and where only one eye sees, disparities come from the surroundings and are
//! reported as filled in, not as measured. Broken by mirrors, which are measured at the depth
//! of what they show, and by patterns that repeat along the rows, which may be taken for one
//! another.

mod census;
mod cost;
mod fill;
mod map;
mod paths;
mod pfm;
mod refine;
mod search;
mod select;
mod smooth;

use image::GrayImage;

use crate::rectify::Pair;
pub use map::{DisparityMap, Origin};
pub use pfm::{PfmError, read_pfm, write_pfm};
use search::{Mirrored, Search, Views};

/// Largest disparity that can be searched for, pixels.
pub const MAX_DISPARITY_PX: u32 = 1023;
/// Most candidates (pixels times disparities) compared at once; twice as many bytes are needed.
const MOST_CANDIDATES: u64 = 1 << 31;
/// Patches with fewer pixels than this are not trusted.
const SPECK_PIXELS: usize = 60;
/// Neighbors in a patch differ by at most this much, pixels.
const SPECK_STEP_PX: f32 = 1.0;

/// How much time a disparity map may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Quality {
    /// For a live view: the right view's choice is read from the left view's matching costs.
    Live,
    /// For results: the right view is matched in its own right. Takes twice the time and finds
    /// a quarter more of the wrong matches.
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
    /// More memory than a laptop has to spare.
    #[error(
        "comparing views of {width_px}x{height_px} px over {max_disparity_px} px of disparity needs more than 4 GB: make the views smaller or the range shorter"
    )]
    Memory {
        /// Width of the views.
        width_px: u32,
        /// Height of the views.
        height_px: u32,
        /// Range asked for.
        max_disparity_px: u32,
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
    search: Search,
    found: Vec<f32>,
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

impl Matcher {
    /// A matcher with these settings.
    ///
    /// # Errors
    /// [`DisparityError::Range`] when the range cannot be searched.
    pub fn new(settings: Settings) -> Result<Self, DisparityError> {
        if !(1..=MAX_DISPARITY_PX).contains(&settings.max_disparity_px) {
            return Err(DisparityError::Range { asked_px: settings.max_disparity_px });
        }
        let (search, refiner) = (Search::default(), refine::Refiner::default());
        Ok(Self { settings, search, found: Vec::new(), refiner })
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
        self.check_memory(left.dimensions())?;
        // Masks that hide nothing only take time.
        let masks = masks.filter(|masks| masks.left.contains(&0) || masks.right.contains(&0));
        let width = left.width() as usize;
        let disparity_count = self.settings.max_disparity_px as usize + 1;
        self.search.run(Views { left, right, masks }, self.settings.block, disparity_count, &mut self.found);
        if self.settings.quality == Quality::Full {
            let mirrored = Mirrored::of(left, right, masks);
            let mut seen_from_right = Vec::new();
            self.search.run(mirrored.views(), self.settings.block, disparity_count, &mut seen_from_right);
            search::keep_mutual(&mut self.found, &seen_from_right, width);
        }
        let mut disparities = vec![select::UNKNOWN; self.found.len()];
        smooth::median(&self.found, width, &mut disparities);
        smooth::remove_specks(&mut disparities, width, SPECK_PIXELS, SPECK_STEP_PX);
        let bare = self.refiner.refine(left, right, &mut disparities);
        let mut filled =
            fill::fill(&mut disparities, width, |i| masks.is_none_or(|masks| masks.left.as_raw()[i] > 0));
        filled.iter_mut().zip(bare).for_each(|(filled, bare)| *filled |= bare);
        Ok(DisparityMap::new(left.width(), left.height(), disparities, filled))
    }

    fn check_memory(&self, (width_px, height_px): (u32, u32)) -> Result<(), DisparityError> {
        let max_disparity_px = self.settings.max_disparity_px;
        let candidates = u64::from(width_px) * u64::from(height_px) * (u64::from(max_disparity_px) + 1);
        if candidates <= MOST_CANDIDATES {
            Ok(())
        } else {
            Err(DisparityError::Memory { width_px, height_px, max_disparity_px })
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
