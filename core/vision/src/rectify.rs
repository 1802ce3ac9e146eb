//! From raw images to the views of the aimed pair.

use image::{GrayImage, RgbImage};
use opencv::core::{BORDER_CONSTANT, Mat, Scalar};
use opencv::imgproc::{INTER_LINEAR, convert_maps, remap};
use plumbline_model::aim::AimedPair;
use plumbline_model::{Eye, Pixel, Rectified};
use rayon::prelude::*;

use crate::{cv_words, mat};

/// The same thing of both eyes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair<T> {
    /// Of the left eye.
    pub left: T,
    /// Of the right eye.
    pub right: T,
}

impl<T> Pair<T> {
    /// Of one eye.
    pub fn of(&self, eye: Eye) -> &T {
        match eye {
            Eye::Left => &self.left,
            Eye::Right => &self.right,
        }
    }
}

/// Why a pair cannot be rectified.
#[derive(Debug, thiserror::Error)]
pub enum RectifyError {
    /// The image is not of the size that the calibration is for.
    #[error(
        "the {eye} image is {width_px}x{height_px} px but the calibration is for {expected_width_px}x{expected_height_px} px: set the cameras to that size or calibrate at this one"
    )]
    Size {
        /// Whose image.
        eye: Eye,
        /// Width of the image.
        width_px: u32,
        /// Height of the image.
        height_px: u32,
        /// Width that the calibration is for.
        expected_width_px: u32,
        /// Height that the calibration is for.
        expected_height_px: u32,
    },
    /// Nothing of the view is on the raw image.
    #[error(
        "the {eye} eye sees nothing of the aimed view: the calibration does not fit these eyes; calibrate again"
    )]
    NothingVisible {
        /// Which eye.
        eye: Eye,
    },
    /// OpenCV refused.
    #[error("the image could not be rectified: {}", cv_words::words(.0))]
    OpenCv(#[from] opencv::Error),
}

/// Turns raw pairs into aimed pairs with maps computed once.
pub struct Rectifier {
    pair: AimedPair,
    maps: Pair<Map>,
    masks: Pair<GrayImage>,
}

/// Where each pixel of the view comes from: whole pixels, and an index into a table of 32×32
/// fractions.
struct Map {
    whole: Mat,
    fraction: Mat,
}

impl Rectifier {
    /// Computes the maps for both eyes (some milliseconds).
    ///
    /// # Errors
    /// [`RectifyError::NothingVisible`] when an eye does not see the aimed view at all.
    pub fn new(pair: &AimedPair) -> Result<Self, RectifyError> {
        let (left, right) = rayon::join(|| map_of(pair, Eye::Left), || map_of(pair, Eye::Right));
        let ((left, left_mask), (right, right_mask)) = (left?, right?);
        Ok(Self {
            pair: *pair,
            maps: Pair { left, right },
            masks: Pair { left: left_mask, right: right_mask },
        })
    }

    /// The pair that this rectifies to.
    pub fn aimed(&self) -> &AimedPair {
        &self.pair
    }

    /// What the eyes can see of their views: 255 where the raw image has a pixel, 0 where the
    /// view reaches beyond the lens or the sensor. Rectified images are black there, which
    /// means nothing.
    pub fn masks(&self) -> &Pair<GrayImage> {
        &self.masks
    }

    /// Rectifies a gray pair (raw left, raw right).
    pub fn rectify_gray(&self, left: &GrayImage, right: &GrayImage) -> Result<Pair<GrayImage>, RectifyError> {
        let one = |image: &GrayImage, eye| -> Result<GrayImage, RectifyError> {
            self.check_size(image.dimensions(), eye)?;
            let mut view = GrayImage::new(self.pair.width_px, self.pair.height_px);
            self.apply(&mat::gray(image)?, &mut mat::gray_mut(&mut view)?, eye)?;
            Ok(view)
        };
        let (left, right) = rayon::join(|| one(left, Eye::Left), || one(right, Eye::Right));
        Ok(Pair { left: left?, right: right? })
    }

    /// Rectifies a color pair (raw left, raw right).
    pub fn rectify_rgb(&self, left: &RgbImage, right: &RgbImage) -> Result<Pair<RgbImage>, RectifyError> {
        let one = |image: &RgbImage, eye| -> Result<RgbImage, RectifyError> {
            self.check_size(image.dimensions(), eye)?;
            let mut view = RgbImage::new(self.pair.width_px, self.pair.height_px);
            self.apply(&mat::rgb(image)?, &mut mat::rgb_mut(&mut view)?, eye)?;
            Ok(view)
        };
        let (left, right) = rayon::join(|| one(left, Eye::Left), || one(right, Eye::Right));
        Ok(Pair { left: left?, right: right? })
    }

    fn apply(
        &self,
        raw: &impl opencv::core::ToInputArray,
        view: &mut impl opencv::core::ToOutputArray,
        eye: Eye,
    ) -> Result<(), RectifyError> {
        let map = self.maps.of(eye);
        remap(raw, view, &map.whole, &map.fraction, INTER_LINEAR, BORDER_CONSTANT, Scalar::default())?;
        Ok(())
    }

    fn check_size(&self, (width_px, height_px): (u32, u32), eye: Eye) -> Result<(), RectifyError> {
        let (expected_width_px, expected_height_px) = self.pair.cameras.camera(eye).size_px();
        if (width_px, height_px) == (expected_width_px, expected_height_px) {
            Ok(())
        } else {
            Err(RectifyError::Size { eye, width_px, height_px, expected_width_px, expected_height_px })
        }
    }
}

fn map_of(pair: &AimedPair, eye: Eye) -> Result<(Map, GrayImage), RectifyError> {
    let (width, height) = (pair.width_px as usize, pair.height_px as usize);
    let mut columns = vec![-1f32; width * height];
    let mut rows = vec![-1f32; width * height];
    let mut mask = GrayImage::new(pair.width_px, pair.height_px);
    let raw_size = pair.cameras.camera(eye).size_px();
    columns
        .par_chunks_mut(width)
        .zip(rows.par_chunks_mut(width))
        .zip(mask.par_chunks_mut(width))
        .enumerate()
        .for_each(|(y, ((columns, rows), mask))| {
            for x in 0..width {
                let pixel = Pixel::<Rectified>::new(x as f64, y as f64);
                if let Ok(raw) = pair.raw_from_rectified(eye, pixel)
                    && raw.is_inside(raw_size)
                {
                    (columns[x], rows[x], mask[x]) = (raw.u_px as f32, raw.v_px as f32, u8::MAX);
                }
            }
        });
    if mask.iter().all(|seen| *seen == 0) {
        return Err(RectifyError::NothingVisible { eye });
    }
    let shape = (height as i32, width as i32);
    let columns = Mat::new_rows_cols_with_data::<f32>(shape.0, shape.1, &columns)?;
    let rows = Mat::new_rows_cols_with_data::<f32>(shape.0, shape.1, &rows)?;
    let (mut whole, mut fraction) = (Mat::default(), Mat::default());
    convert_maps(&columns, &rows, &mut whole, &mut fraction, opencv::core::CV_16SC2, false)?;
    Ok((Map { whole, fraction }, mask))
}
