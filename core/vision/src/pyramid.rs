//! A picture at several sizes, sampled between its pixels.

use image::GrayImage;
use nalgebra::Vector2;

/// A gray picture at several sizes, each half of the one before.
#[derive(Clone, Debug)]
pub(crate) struct Pyramid {
    /// From full size down.
    levels: Vec<Level>,
}

impl Pyramid {
    /// `levels`: sizes kept, the full one included.
    pub fn new(gray: &GrayImage, levels: usize) -> Self {
        let all = std::iter::successors(Some(Level::full(gray)), |level| Some(level.halved()));
        Self { levels: all.take(levels).collect() }
    }

    /// Width and height of the full picture, px.
    pub fn size_px(&self) -> (u32, u32) {
        self.levels.first().map_or((0, 0), |full| (full.width as u32, full.height as u32))
    }

    /// Where a pixel of the full picture lies in the one reduced by 2^`level`, px.
    pub fn reduced(level: usize, full_px: Vector2<f64>) -> Vector2<f64> {
        // Pixel centers: reduced pixel i covers full pixels 2i and 2i + 1.
        full_px.add_scalar(0.5) / f64::from(1u32 << level) - Vector2::repeat(0.5)
    }

    /// Brightness at a pixel of the picture reduced by 2^`level`, px of that size; `None` outside.
    pub fn at(&self, level: usize, reduced_px: Vector2<f64>) -> Option<f32> {
        self.levels.get(level)?.at(reduced_px.x, reduced_px.y)
    }
}

/// Brightness at one size.
#[derive(Clone, Debug)]
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
