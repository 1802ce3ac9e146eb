//! How sharp the board is: the width of the edges between its squares.

use image::GrayImage;
use plumbline_model::{Chessboard, Corners};

/// Edges with less contrast than this (in gray levels) tell nothing.
const LEAST_CONTRAST: f64 = 20.0;
/// Sampling distance across an edge, pixels.
const STEP_PX: f64 = 0.25;
/// An edge is looked at over at most this distance to either side, pixels.
const REACH_PX: f64 = 6.0;

/// Median width of the edges between neighboring squares, pixels: contrast over steepest slope.
/// A perfect lens gives about 1. `None` when the board is too small or too dark to tell.
pub fn edge_width_px(image: &GrayImage, board: &Chessboard, corners: &Corners) -> Option<f64> {
    let columns = board.inner_columns as usize;
    let mut widths: Vec<f64> = (0..corners.len())
        .filter(|index| index % columns + 1 < columns)
        .filter_map(|index| {
            let from = corners[index]?.vector();
            let to = corners.get(index + 1).copied().flatten()?.vector();
            width_between(image, from, to)
        })
        .collect();
    widths.sort_by(f64::total_cmp);
    widths.get(widths.len() / 2).copied()
}

/// The wider of both eyes' edges; `None` when neither can tell.
pub fn of_both(board: &Chessboard, images: [&GrayImage; 2], corners: [Option<&Corners>; 2]) -> Option<f64> {
    let widths =
        images.into_iter().zip(corners).filter_map(|(image, corners)| edge_width_px(image, board, corners?));
    widths.reduce(f64::max)
}

/// Width of the edge that runs from one corner to the next, measured across its middle.
fn width_between(image: &GrayImage, from: nalgebra::Vector2<f64>, to: nalgebra::Vector2<f64>) -> Option<f64> {
    let along = to - from;
    let reach_px = (0.35 * along.norm()).min(REACH_PX);
    if reach_px < 2.0 {
        return None;
    }
    let across = nalgebra::Vector2::new(-along.y, along.x).normalize();
    let middle = 0.5 * (from + to);
    let half = (reach_px / STEP_PX) as i32;
    let profile: Option<Vec<f64>> =
        (-half..=half).map(|i| sample(image, middle + across * (f64::from(i) * STEP_PX))).collect();
    let profile = profile?;
    let end = (profile.len() / 6).max(1);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let contrast = (mean(&profile[..end]) - mean(&profile[profile.len() - end..])).abs();
    if contrast < LEAST_CONTRAST {
        return None;
    }
    // Slope over one pixel: shorter would see the noise, longer would blur a sharp edge.
    let span = (1.0 / STEP_PX) as usize;
    let steepest =
        profile.windows(span + 1).map(|window| (window[span] - window[0]).abs()).reduce(f64::max)?;
    Some(contrast / steepest)
}

/// Gray level between pixel centers; `None` outside the image.
fn sample(image: &GrayImage, at: nalgebra::Vector2<f64>) -> Option<f64> {
    let (u, v) = (at.x.floor(), at.y.floor());
    if u < 0.0 || v < 0.0 || u + 1.0 >= f64::from(image.width()) || v + 1.0 >= f64::from(image.height()) {
        return None;
    }
    let (du, dv) = (at.x - u, at.y - v);
    let gray = |x: u32, y: u32| f64::from(image.get_pixel(x, y).0[0]);
    let (u, v) = (u as u32, v as u32);
    let upper = gray(u, v) * (1.0 - du) + gray(u + 1, v) * du;
    let lower = gray(u, v + 1) * (1.0 - du) + gray(u + 1, v + 1) * du;
    Some(upper * (1.0 - dv) + lower * dv)
}

#[cfg(test)]
mod tests {
    use super::*;
    use plumbline_model::Pixel;

    const SQUARE_PX: f64 = 20.0;

    fn board() -> Chessboard {
        Chessboard { inner_columns: 4, inner_rows: 3, square_m: 0.03 }
    }

    /// A board blurred by a Gaussian of this standard deviation.
    fn drawn(sigma_px: f32, dark: u8, bright: u8) -> (GrayImage, Corners) {
        let sharp = GrayImage::from_fn(160, 120, |u, v| {
            let square = |at: u32| (f64::from(at) / SQUARE_PX) as u32;
            image::Luma([if (square(u) + square(v)).is_multiple_of(2) { dark } else { bright }])
        });
        let image = if sigma_px > 0.0 { image::imageops::blur(&sharp, sigma_px) } else { sharp };
        let corners = (0..12)
            .map(|i| {
                Some(Pixel::new(
                    f64::from(i % 4 + 1) * SQUARE_PX - 0.5,
                    f64::from(i / 4 + 1) * SQUARE_PX - 0.5,
                ))
            })
            .collect();
        (image, corners)
    }

    #[test]
    fn more_blur_makes_wider_edges() {
        let width = |sigma_px| {
            let (image, corners) = drawn(sigma_px, 30, 220);
            edge_width_px(&image, &board(), &corners).expect("a width")
        };
        assert!((width(0.0) - 1.0).abs() < 0.05, "{}", width(0.0));
        // The steepest slope of a Gaussian edge is contrast / (σ √2π).
        for sigma_px in [1.0f32, 2.0] {
            let expected = f64::from(sigma_px) * (2.0 * std::f64::consts::PI).sqrt();
            let measured = width(sigma_px);
            assert!(
                (measured / expected - 1.0).abs() < 0.15,
                "σ {sigma_px}: {measured} instead of {expected}"
            );
        }
    }

    #[test]
    fn a_board_without_contrast_or_too_small_has_no_width() {
        let (image, corners) = drawn(0.0, 100, 110);
        assert_eq!(edge_width_px(&image, &board(), &corners), None);
        let (image, corners) = drawn(0.0, 30, 220);
        let shrunk: Corners =
            corners.iter().map(|c| c.map(|c| Pixel::new(c.u_px * 0.2, c.v_px * 0.2))).collect();
        assert_eq!(edge_width_px(&image, &board(), &shrunk), None);
    }
}
