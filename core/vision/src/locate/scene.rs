//! A pair of images at several sizes, sampled along epipolar rays.

use image::GrayImage;
use image::imageops::{self, FilterType};
use plumbline_model::{Eye, Pixel, Raw};

use super::epipolar::{EpipolarGeometry, EpipolarRay};

/// Sizes kept: full, half, quarter.
pub(super) const LEVELS: usize = 3;

/// A pair of gray images ready for matching.
pub(super) struct Scene {
    /// Per eye, from full size down.
    levels: [Vec<GrayImage>; 2],
}

impl Scene {
    pub fn new(left: &GrayImage, right: &GrayImage) -> Self {
        let pyramid = |full: &GrayImage| {
            let mut levels = vec![full.clone()];
            for level in 1..LEVELS {
                let above = &levels[level - 1];
                let (width, height) = ((above.width() / 2).max(1), (above.height() / 2).max(1));
                levels.push(imageops::resize(above, width, height, FilterType::Triangle));
            }
            levels
        };
        Self { levels: [pyramid(left), pyramid(right)] }
    }

    /// Size of the full image.
    pub fn size_px(&self, eye: Eye) -> (u32, u32) {
        self.levels[eye.index()][0].dimensions()
    }

    /// Brightness at a raw pixel, from the image reduced by 2^`level`; `None` outside.
    fn at(&self, eye: Eye, level: usize, pixel: Pixel<Raw>) -> Option<f32> {
        let image = &self.levels[eye.index()][level];
        let shrink = f64::from(1u32 << level);
        // Pixel centers: reduced pixel i covers full pixels 2i and 2i + 1.
        let (x, y) = ((pixel.u_px + 0.5) / shrink - 0.5, (pixel.v_px + 0.5) / shrink - 0.5);
        let (width, height) = (image.width() as usize, image.height() as usize);
        if !(x >= 0.0 && y >= 0.0 && x < width as f64 - 1.0 && y < height as f64 - 1.0) {
            return None;
        }
        let (ix, iy) = (x as usize, y as usize);
        let (fx, fy) = ((x - ix as f64) as f32, (y - iy as f64) as f32);
        let pixels = image.as_raw();
        let value = |dx: usize, dy: usize| f32::from(pixels[(iy + dy) * width + ix + dx]);
        let top = value(0, 0) * (1.0 - fx) + value(1, 0) * fx;
        let bottom = value(0, 1) * (1.0 - fx) + value(1, 1) * fx;
        Some(top * (1.0 - fy) + bottom * fy)
    }

    /// Brightness along a ray; `None` where the eye does not see.
    pub fn along(
        &self,
        geometry: &EpipolarGeometry,
        eye: Eye,
        level: usize,
        ray: &EpipolarRay,
    ) -> Option<f32> {
        self.at(eye, level, geometry.pixel(eye, ray).ok()?)
    }
}
