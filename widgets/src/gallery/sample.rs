//! Made-up data for the pages. Deterministic.

use egui::ColorImage;
use image::{Rgb, RgbImage};
use plumbline_model::{CornerResidual, Eye, Pixel};

use crate::bars::PairBar;

pub(super) const SIZE: [u32; 2] = [320, 240];

/// A number of -1..=1 that looks random, from an index.
pub(super) fn noise(index: usize) -> f64 {
    let mut x = (index as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(0x1234_5678);
    x ^= x >> 29;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^= x >> 32;
    (x % 20_001) as f64 / 10_000.0 - 1.0
}

/// A fisheye-like picture of a table with a chessboard; `shift_px` is the disparity.
pub(super) fn eye(shift_px: f64) -> RgbImage {
    let [w, h] = SIZE;
    RgbImage::from_fn(w, h, |x, y| {
        let (u, v) = (f64::from(x) + shift_px, f64::from(y));
        let r = (f64::from(x) - f64::from(w) / 2.0).hypot(v - f64::from(h) / 2.0) / 170.0;
        let shade = (1.0 - 0.55 * r * r).max(0.0);
        let grain = 6.0 * noise((y * w + x) as usize);
        let color = match board_square(u, v) {
            Some(true) => [225.0, 222.0, 214.0],
            Some(false) => [28.0, 28.0, 32.0],
            None if v > 90.0 => [150.0 + 10.0 * (u / 23.0).sin(), 118.0, 84.0],
            None => [96.0, 108.0, 122.0 + 12.0 * (u / 40.0).cos()],
        };
        Rgb(color.map(|c| (c * shade + grain).clamp(0.0, 255.0) as u8))
    })
}

/// White, black or not on the board.
fn board_square(u: f64, v: f64) -> Option<bool> {
    let (a, b) = ((u - 120.0) * 0.97 + (v - 70.0) * 0.12, (v - 70.0) * 0.97 - (u - 120.0) * 0.10);
    let (column, row) = ((a / 16.0).floor(), (b / 16.0).floor());
    let inside = (0.0..9.0).contains(&column) && (0.0..6.0).contains(&row);
    inside.then_some((column + row).rem_euclid(2.0) < 1.0)
}

/// Where an inner corner of that board is.
pub(super) fn corner_px(column: usize, row: usize) -> [f64; 2] {
    let (a, b) = (16.0 * (column as f64 + 1.0), 16.0 * (row as f64 + 1.0));
    let determinant = 0.97 * 0.97 + 0.12 * 0.10;
    [120.0 + (0.97 * a - 0.12 * b) / determinant, 70.0 + (0.10 * a + 0.97 * b) / determinant - 0.5]
}

pub(super) fn residuals() -> Vec<CornerResidual> {
    (0..40)
        .map(|i| {
            let [u, v] = corner_px(i % 8, i / 8);
            let left_out = i == 13;
            let size = if left_out { 0.9 } else { 0.08 };
            CornerResidual {
                eye: Eye::Left,
                corner: i,
                measured: Pixel::new(u, v),
                error_px: [size * noise(2 * i), size * noise(2 * i + 1)],
                left_out,
            }
        })
        .collect()
}

pub(super) fn pairs() -> Vec<PairBar> {
    (0..30)
        .map(|i| PairBar {
            name: format!("pair-{:02}", i + 1),
            left: (i != 21).then(|| 0.07 + 0.03 * noise(i).abs() + if i == 8 { 0.11 } else { 0.0 }),
            right: Some(0.075 + 0.028 * noise(i + 50).abs() + if i == 8 { 0.06 } else { 0.0 }),
            dropped: i == 4,
        })
        .collect()
}

/// Depth in meters, NaN where there is none.
pub(super) fn depth_m() -> Vec<f32> {
    let [w, h] = SIZE.map(|n| n as usize);
    (0..w * h)
        .map(|i| {
            let (x, y) = (i % w, i / w);
            let hole = (x as f64 - 90.0).hypot(y as f64 - 150.0) < 24.0 || x < 18;
            let can = (x as f64 - 210.0).hypot((y as f64 - 120.0) * 0.6) < 34.0;
            let depth = 0.66 - 0.0013 * y as f64 - if can { 0.09 } else { 0.0 };
            if hole { f32::NAN } else { depth as f32 }
        })
        .collect()
}

pub(super) fn gray_ramp() -> ColorImage {
    let pixels: Vec<u8> = (0..32 * 24).map(|i| ((i % 32) * 6 + (i / 32) * 2) as u8).collect();
    ColorImage::from_gray([32, 24], &pixels)
}
