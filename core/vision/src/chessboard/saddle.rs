//! Saddle points of the brightness: where two black and two white squares meet.
//!
//! A chessboard corner is a saddle of the smoothed image: curved up along one diagonal and down
//! along the other. The measure is the Hessian's determinant, which does not care how a fisheye
//! turns, shears or bends the board. Takes a few milliseconds whether or not a board is there.

use image::GrayImage;
use nalgebra::Vector2;

/// A point where the brightness is a saddle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Saddle {
    /// Sub-pixel position.
    pub at: Vector2<f64>,
    /// √(−det H), gray levels per pixel².
    pub strength: f32,
    /// Direction (rad, modulo π) along which the brightness curves up. Neighboring corners of a
    /// chessboard differ by a quarter turn.
    pub axis_rad: f32,
}

/// Weakest saddle kept, gray levels per pixel². A corner between squares that differ by 30 gray
/// levels has about 3; sensor noise of 2 levels has less than 0.7 after smoothing.
const LEAST_STRENGTH: f32 = 1.0;
/// Most saddles kept, strongest first; bounds the time on textured scenes.
const MOST_SADDLES: usize = 2500;

/// How much detail to look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Detail {
    /// Squares from about 8 pixels, grain suppressed.
    Normal,
    /// Squares from about 5 pixels.
    Fine,
}

impl Detail {
    /// Passes of the smoothing kernel (each has a standard deviation of 1 px).
    fn passes(self) -> usize {
        match self {
            Self::Normal => 2,
            Self::Fine => 1,
        }
    }

    /// Radius of the circle on which the four quadrants are checked, pixels.
    fn ring_px(self) -> f32 {
        match self {
            Self::Normal => 3.0,
            Self::Fine => 2.0,
        }
    }
}

/// Brightness smoothed by a small binomial kernel, as floats.
struct Smooth {
    width: usize,
    height: usize,
    data: Vec<f32>,
}

impl Smooth {
    /// Passes of [1 4 6 4 1]/16 each way.
    fn new(gray: &GrayImage, passes: usize) -> Self {
        let (width, height) = (gray.width() as usize, gray.height() as usize);
        let mut data: Vec<f32> = gray.as_raw().iter().map(|&g| f32::from(g)).collect();
        let mut other = vec![0.0f32; data.len()];
        for _ in 0..passes {
            blur_rows(&data, &mut other, width);
            blur_columns(&other, &mut data, width, height);
        }
        Self { width, height, data }
    }

    fn at(&self, x: usize, y: usize) -> f32 {
        self.data[y * self.width + x]
    }

    fn bilinear(&self, x: f32, y: f32) -> f32 {
        let (x0, y0) = (x.floor().max(0.0), y.floor().max(0.0));
        let (ix, iy) = ((x0 as usize).min(self.width - 2), (y0 as usize).min(self.height - 2));
        let (fx, fy) = (x - ix as f32, y - iy as f32);
        let top = self.at(ix, iy) * (1.0 - fx) + self.at(ix + 1, iy) * fx;
        let bottom = self.at(ix, iy + 1) * (1.0 - fx) + self.at(ix + 1, iy + 1) * fx;
        top * (1.0 - fy) + bottom * fy
    }
}

fn blur_rows(from: &[f32], to: &mut [f32], width: usize) {
    for (row, out) in from.chunks_exact(width).zip(to.chunks_exact_mut(width)) {
        out.copy_from_slice(row);
        for (o, w) in out[2..width - 2].iter_mut().zip(row.windows(5)) {
            *o = (w[0] + w[4] + 4.0 * (w[1] + w[3]) + 6.0 * w[2]) * (1.0 / 16.0);
        }
    }
}

fn blur_columns(from: &[f32], to: &mut [f32], width: usize, height: usize) {
    to.copy_from_slice(from);
    for y in 2..height - 2 {
        let row = |dy: usize| &from[(y + dy - 2) * width..(y + dy - 1) * width];
        let (a, b, c, d, e) = (row(0), row(1), row(2), row(3), row(4));
        for (x, o) in to[y * width..(y + 1) * width].iter_mut().enumerate() {
            *o = (a[x] + e[x] + 4.0 * (b[x] + d[x]) + 6.0 * c[x]) * (1.0 / 16.0);
        }
    }
}

/// All saddles of an image, strongest first.
pub(super) fn find(gray: &GrayImage, detail: Detail) -> Vec<Saddle> {
    if gray.width() < 16 || gray.height() < 16 {
        return Vec::new();
    }
    let smooth = Smooth::new(gray, detail.passes());
    let response = negative_determinant(&smooth);
    let mut found = Vec::new();
    let margin = detail.ring_px() as usize + 2;
    for y in margin..smooth.height - margin {
        for x in margin..smooth.width - margin {
            let value = response[y * smooth.width + x];
            if value > LEAST_STRENGTH * LEAST_STRENGTH
                && is_largest_nearby(&response, smooth.width, x, y, value)
                && let Some(saddle) = refine(&smooth, x, y, value)
                && has_four_quadrants(&smooth, saddle.at, detail.ring_px())
            {
                found.push(saddle);
            }
        }
    }
    found.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    found.truncate(MOST_SADDLES);
    found
}

/// −det of the Hessian at every pixel (zero at the border).
fn negative_determinant(smooth: &Smooth) -> Vec<f32> {
    let width = smooth.width;
    let mut out = vec![0.0f32; smooth.data.len()];
    for y in 1..smooth.height - 1 {
        let above = &smooth.data[(y - 1) * width..y * width];
        let here = &smooth.data[y * width..(y + 1) * width];
        let below = &smooth.data[(y + 1) * width..(y + 2) * width];
        let target = &mut out[y * width..(y + 1) * width];
        for x in 1..width - 1 {
            let xx = here[x + 1] + here[x - 1] - 2.0 * here[x];
            let yy = below[x] + above[x] - 2.0 * here[x];
            let xy = 0.25 * (below[x + 1] + above[x - 1] - below[x - 1] - above[x + 1]);
            target[x] = xy * xy - xx * yy;
        }
    }
    out
}

fn is_largest_nearby(response: &[f32], width: usize, x: usize, y: usize, value: f32) -> bool {
    for dy in 0..5 {
        for dx in 0..5 {
            let other = response[(y + dy - 2) * width + x + dx - 2];
            // Of equal neighbors the first in reading order wins.
            if other > value || (other == value && (dy, dx) < (2, 2)) {
                return false;
            }
        }
    }
    true
}

/// Newton step to where the gradient vanishes; `None` if that is not within the pixel's
/// neighborhood (an edge or a blob, not a saddle).
fn refine(smooth: &Smooth, x: usize, y: usize, value: f32) -> Option<Saddle> {
    let g = |dx: usize, dy: usize| smooth.at(x + dx - 1, y + dy - 1);
    let (gx, gy) = (0.5 * (g(2, 1) - g(0, 1)), 0.5 * (g(1, 2) - g(1, 0)));
    let xx = g(2, 1) + g(0, 1) - 2.0 * g(1, 1);
    let yy = g(1, 2) + g(1, 0) - 2.0 * g(1, 1);
    let xy = 0.25 * (g(2, 2) + g(0, 0) - g(0, 2) - g(2, 0));
    let det = xx * yy - xy * xy;
    let step = Vector2::new(-(yy * gx - xy * gy) / det, -(xx * gy - xy * gx) / det);
    if !(step.x.abs() < 1.5 && step.y.abs() < 1.5) {
        return None;
    }
    Some(Saddle {
        at: Vector2::new(x as f64 + f64::from(step.x), y as f64 + f64::from(step.y)),
        strength: value.sqrt(),
        axis_rad: 0.5 * (2.0 * xy).atan2(xx - yy),
    })
}

/// Walking once around the point, brightness crosses its mean exactly four times.
fn has_four_quadrants(smooth: &Smooth, at: Vector2<f64>, radius_px: f32) -> bool {
    let mut ring = [0.0f32; 16];
    for (i, value) in ring.iter_mut().enumerate() {
        let (sin, cos) = (i as f32 * std::f32::consts::TAU / 16.0).sin_cos();
        *value = smooth.bilinear(at.x as f32 + radius_px * cos, at.y as f32 + radius_px * sin);
    }
    let mean = ring.iter().sum::<f32>() / 16.0;
    (0..16).filter(|&i| (ring[i] > mean) != (ring[(i + 1) % 16] > mean)).count() == 4
}
