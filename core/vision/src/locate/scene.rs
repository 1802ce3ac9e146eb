//! A pair of images at several sizes, sampled along epipolar rays.

use image::GrayImage;
use plumbline_model::{Eye, Pixel, Raw};

use super::epipolar::{EpipolarGeometry, EpipolarRay};

/// Sizes kept: full, half, quarter.
pub(super) const LEVELS: usize = 3;

/// A pair of gray images ready for matching.
pub(crate) struct Scene {
    /// Per eye, from full size down.
    levels: [Vec<Level>; 2],
}

/// Brightness at one size.
struct Level {
    width: usize,
    height: usize,
    data: Vec<f32>,
}

impl Level {
    /// Full size, smoothed by [1 2 1]/4 each way: bilinear sampling between the pixels of an edge
    /// sharper than that is wrong by up to a tenth of a pixel.
    fn full(gray: &GrayImage) -> Self {
        let (width, height) = (gray.width() as usize, gray.height() as usize);
        let raw: Vec<f32> = gray.as_raw().iter().map(|&g| f32::from(g)).collect();
        let smooth = |from: &[f32], stride: usize| -> Vec<f32> {
            let mut to = from.to_vec();
            for i in stride..from.len().saturating_sub(stride) {
                to[i] = 0.25 * (from[i - stride] + from[i + stride]) + 0.5 * from[i];
            }
            to
        };
        // The outermost pixels mix with the next row's; no patch reaches them.
        Self { width, height, data: smooth(&smooth(&raw, 1), width) }
    }

    /// Half the size, each pixel the mean of four.
    fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let mut data = Vec::with_capacity(width * height);
        for y in 0..height {
            let (top, bottom) = (&self.data[2 * y * self.width..], &self.data[(2 * y + 1) * self.width..]);
            data.extend(
                (0..width).map(|x| 0.25 * (top[2 * x] + top[2 * x + 1] + bottom[2 * x] + bottom[2 * x + 1])),
            );
        }
        Self { width, height, data }
    }

    /// Bilinear; `None` outside.
    fn at(&self, x: f64, y: f64) -> Option<f32> {
        if !(x >= 0.0 && y >= 0.0 && x + 1.0 < self.width as f64 && y + 1.0 < self.height as f64) {
            return None;
        }
        let (ix, iy) = (x as usize, y as usize);
        let (fx, fy) = ((x - ix as f64) as f32, (y - iy as f64) as f32);
        let row = &self.data[iy * self.width + ix..];
        let top = row[0] * (1.0 - fx) + row[1] * fx;
        let bottom = row[self.width] * (1.0 - fx) + row[self.width + 1] * fx;
        Some(top * (1.0 - fy) + bottom * fy)
    }
}

impl Scene {
    pub fn new(left: &GrayImage, right: &GrayImage) -> Self {
        let pyramid = |gray: &GrayImage| {
            let full = Level::full(gray);
            let half = full.halved();
            let quarter = half.halved();
            vec![full, half, quarter]
        };
        let (left, right) = rayon::join(|| pyramid(left), || pyramid(right));
        Self { levels: [left, right] }
    }

    /// Size of the full image.
    pub fn size_px(&self, eye: Eye) -> (u32, u32) {
        let full = &self.levels[eye.index()][0];
        (full.width as u32, full.height as u32)
    }

    /// Brightness at a raw pixel, from the image reduced by 2^`level`; `None` outside.
    fn at(&self, eye: Eye, level: usize, pixel: Pixel<Raw>) -> Option<f32> {
        let shrink = f64::from(1u32 << level);
        // Pixel centers: reduced pixel i covers full pixels 2i and 2i + 1.
        self.levels[eye.index()][level]
            .at((pixel.u_px + 0.5) / shrink - 0.5, (pixel.v_px + 0.5) / shrink - 0.5)
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
