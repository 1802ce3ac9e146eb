//! A picture at several sizes, and a small piece of one found again in another.

use image::GrayImage;
use nalgebra::{Matrix4, Vector2, Vector4};

/// Sizes kept: full, half, quarter, eighth.
pub(super) const LEVELS: usize = 4;
/// Pixels to each side of the middle of a patch, at every size.
const HALF_PX: i32 = 7;
const MOST_ITERATIONS: usize = 12;
const CONVERGED_PX: f64 = 5e-3;
/// What moves farther than this within one size has found something else, px.
const MOST_MOVE_PX: f64 = 6.0;
/// Patches less alike than this are not the same place.
const LEAST_CORRELATION: f64 = 0.9;

/// Brightness at one size.
#[derive(Clone, Debug)]
struct Level {
    width: usize,
    height: usize,
    data: Vec<f32>,
}

impl Level {
    /// Smoothed by [1 2 1]/4 each way: bilinear sampling of an edge sharper than that is wrong by up to a
    /// tenth of a pixel.
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
    fn at(&self, x: f64, y: f64) -> Option<f64> {
        if !(x >= 0.0 && y >= 0.0 && x + 1.0 < self.width as f64 && y + 1.0 < self.height as f64) {
            return None;
        }
        let (ix, iy) = (x as usize, y as usize);
        let (fx, fy) = (x - ix as f64, y - iy as f64);
        let value = |x: usize, y: usize| f64::from(self.data[y * self.width + x]);
        let top = value(ix, iy) * (1.0 - fx) + value(ix + 1, iy) * fx;
        let bottom = value(ix, iy + 1) * (1.0 - fx) + value(ix + 1, iy + 1) * fx;
        Some(top * (1.0 - fy) + bottom * fy)
    }
}

/// A picture at several sizes.
#[derive(Clone, Debug)]
pub(super) struct Pyramid {
    levels: Vec<Level>,
}

impl Pyramid {
    pub fn new(gray: &GrayImage) -> Self {
        let mut levels = vec![Level::full(gray)];
        while levels.len() < LEVELS {
            let next = levels[levels.len() - 1].halved();
            levels.push(next);
        }
        Self { levels }
    }
}

/// A patch that was found again.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Where, px of the full size.
    pub at_px: Vector2<f64>,
    /// Standard deviation of each coordinate by the patch's own brightness, px.
    pub sigma_px: f64,
}

/// Looks in `now` for what was at `at_px` of `before`, first near `near_px` and in the smallest of so many
/// sizes. `None`: it left the picture, is
/// not alike, or does not settle.
pub(super) fn find(
    before: &Pyramid,
    now: &Pyramid,
    at_px: Vector2<f64>,
    near_px: Vector2<f64>,
    levels: usize,
) -> Option<Found> {
    let mut shift_px = near_px - at_px;
    let mut sigma_px = f64::INFINITY;
    for level in (0..levels.min(LEVELS)).rev() {
        let shrink = f64::from(1u32 << level);
        // Pixel centers: reduced pixel i covers full pixels 2i and 2i + 1.
        let reduced = |px: Vector2<f64>| (px.add_scalar(0.5)) / shrink - Vector2::new(0.5, 0.5);
        let start = shift_px / shrink;
        match align(&before.levels[level], &now.levels[level], reduced(at_px), start, level == 0) {
            Some((shift, sigma)) => (shift_px, sigma_px) = (shift * shrink, sigma * shrink),
            // A small picture may hold too little of it; the next larger one decides.
            None if level > 0 => {}
            None => return None,
        }
    }
    Some(Found { at_px: at_px + shift_px, sigma_px })
}

/// Shift, and gain and offset of brightness, by least squares. `must_match`: it has to be alike.
fn align(
    before: &Level,
    now: &Level,
    at: Vector2<f64>,
    start: Vector2<f64>,
    must_match: bool,
) -> Option<(Vector2<f64>, f64)> {
    let offsets = || (-HALF_PX..=HALF_PX).flat_map(|y| (-HALF_PX..=HALF_PX).map(move |x| (x, y)));
    let mut patch = Vec::with_capacity(225);
    for (x, y) in offsets() {
        let (x, y) = (f64::from(x), f64::from(y));
        patch.push((x, y, before.at(at.x + x, at.y + y)?));
    }
    let mut p = Vector4::new(start.x, start.y, 1.0, 0.0);
    for _ in 0..MOST_ITERATIONS {
        let (mut normal, mut right, mut square) = (Matrix4::zeros(), Vector4::zeros(), 0.0);
        for (x, y, value) in &patch {
            let (u, v) = (at.x + x + p[0], at.y + y + p[1]);
            let there = now.at(u, v)?;
            let along = now.at(u + 0.5, v)? - now.at(u - 0.5, v)?;
            let down = now.at(u, v + 0.5)? - now.at(u, v - 0.5)?;
            let jacobian = Vector4::new(p[2] * along, p[2] * down, there, 1.0);
            let residual = value - (p[2] * there + p[3]);
            square += residual * residual;
            normal += jacobian * jacobian.transpose();
            right += jacobian * residual;
        }
        let factor = normal.cholesky()?;
        let delta = factor.solve(&right);
        p += delta;
        if !((p[0] - start.x).hypot(p[1] - start.y) <= MOST_MOVE_PX) {
            return None;
        }
        if delta[0].hypot(delta[1]) < CONVERGED_PX {
            let count = patch.len() as f64;
            let mean = patch.iter().map(|(_, _, value)| value).sum::<f64>() / count;
            let spread = patch.iter().map(|(_, _, value)| (value - mean).powi(2)).sum::<f64>();
            // What is left against what there was: 1 − r².
            if must_match && square > (1.0 - LEAST_CORRELATION.powi(2)) * spread {
                return None;
            }
            let inverse = factor.inverse();
            let sigma = (0.5 * (inverse[(0, 0)] + inverse[(1, 1)]) * square / (count - 4.0)).sqrt();
            return Some((Vector2::new(p[0], p[1]), sigma));
        }
    }
    None
}
