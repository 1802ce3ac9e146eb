//! Two images of the same moment, laid over or beside each other.

use egui::{Color32, ColorImage};
use image::RgbImage;
use plumbline_model::Eye;

use crate::overlay::{Mark, Overlay};
use crate::theme::{ON_IMAGE, Role};

/// Images that cannot be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    /// They differ in size.
    #[error(
        "the left image is {}×{} px and the right one {}×{} px: set both cameras to the same size",
        left_px[0], left_px[1], right_px[0], right_px[1]
    )]
    Size {
        /// Left width and height.
        left_px: [u32; 2],
        /// Right width and height.
        right_px: [u32; 2],
    },
}

fn same_size(left: &RgbImage, right: &RgbImage) -> Result<[usize; 2], CompareError> {
    if left.dimensions() != right.dimensions() {
        return Err(CompareError::Size {
            left_px: left.dimensions().into(),
            right_px: right.dimensions().into(),
        });
    }
    Ok([left.width() as usize, left.height() as usize])
}

/// Luma of an RGB pixel (Rec. 601), 8 bit.
fn luma(p: &[u8]) -> u8 {
    ((u32::from(p[0]) * 77 + u32::from(p[1]) * 150 + u32::from(p[2]) * 29) >> 8) as u8
}

/// Red-cyan anaglyph: the left eye's brightness in red, the right eye's green and blue. Points
/// at the same place in both images have no colored fringe.
pub fn anaglyph(left: &RgbImage, right: &RgbImage) -> Result<ColorImage, CompareError> {
    let size = same_size(left, right)?;
    let pixels = left
        .as_raw()
        .chunks_exact(3)
        .zip(right.as_raw().chunks_exact(3))
        .map(|(l, r)| Color32::from_rgb(luma(l), r[1], r[2]))
        .collect();
    Ok(ColorImage::new(size, pixels))
}

/// Left and right beside each other with straight lines across both, `spacing_px` apart. On a
/// rectified pair a line touches the same point in both images.
pub fn side_by_side(
    left: &RgbImage,
    right: &RgbImage,
    spacing_px: usize,
) -> Result<ColorImage, CompareError> {
    let [width, height] = same_size(left, right)?;
    let mut pixels = Vec::with_capacity(2 * width * height);
    let line = Role::Difference.color(&ON_IMAGE);
    for row in 0..height {
        if is_line(row, spacing_px) {
            pixels.extend(std::iter::repeat_n(line, 2 * width));
            continue;
        }
        for image in [left, right] {
            let bytes = &image.as_raw()[3 * width * row..3 * width * (row + 1)];
            pixels.extend(bytes.chunks_exact(3).map(|p| Color32::from_rgb(p[0], p[1], p[2])));
        }
    }
    Ok(ColorImage::new([2 * width, height], pixels))
}

/// Lines are centered, so that the first is not at the border. No lines for a spacing of 0.
fn is_line(row: usize, spacing_px: usize) -> bool {
    spacing_px > 0 && row % spacing_px == spacing_px / 2
}

/// The lines of [`side_by_side`] as marks, for two linked views. They keep their width under
/// zoom and do not cover the pixels.
pub fn epipolar_lines(size_px: [usize; 2], spacing_px: usize) -> Overlay {
    let mut overlay = Overlay::new();
    let right = size_px[0] as f64 - 0.5;
    for row in (0..size_px[1]).filter(|row| is_line(*row, spacing_px)) {
        overlay.push(Mark::Line {
            points_px: vec![[-0.5, row as f64], [right, row as f64]],
            closed: false,
            dashed: false,
            width_pt: 1.0,
            ink: Role::Difference.into(),
        });
    }
    overlay
}

/// The eye to show at a time when both alternate every `period_s` seconds. Ask for a repaint
/// after [`blink_remaining_s`].
pub fn blink(time_s: f64, period_s: f64) -> Eye {
    if (time_s / period_s).floor().rem_euclid(2.0) < 1.0 { Eye::Left } else { Eye::Right }
}

/// Seconds until the other eye is due.
pub fn blink_remaining_s(time_s: f64, period_s: f64) -> f64 {
    period_s - time_s.rem_euclid(period_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    fn plain(width: u32, height: u32, color: [u8; 3]) -> RgbImage {
        RgbImage::from_pixel(width, height, Rgb(color))
    }

    #[test]
    fn a_gray_pair_without_disparity_stays_gray() {
        let image = RgbImage::from_fn(16, 9, |x, y| Rgb([(13 * x + 7 * y) as u8; 3]));
        let mixed = anaglyph(&image, &image).expect("same size");
        for (pixel, source) in mixed.pixels.iter().zip(image.pixels()) {
            for channel in [pixel.r(), pixel.g(), pixel.b()] {
                assert!(channel.abs_diff(source.0[0]) <= 1);
            }
        }
    }

    #[test]
    fn left_is_red_and_right_is_cyan() {
        let (white, black) = (plain(2, 2, [255; 3]), plain(2, 2, [0; 3]));
        let left_only = anaglyph(&white, &black).expect("same size").pixels[0];
        assert!(left_only.r() >= 254 && left_only.g() == 0 && left_only.b() == 0);
        let right_only = anaglyph(&black, &white).expect("same size").pixels[0];
        assert_eq!(right_only, Color32::from_rgb(0, 255, 255));
    }

    #[test]
    fn different_sizes_are_refused_with_a_reason() {
        let error = anaglyph(&plain(4, 3, [0; 3]), &plain(3, 4, [0; 3])).expect_err("sizes differ");
        assert!(error.to_string().contains("4×3") && error.to_string().contains("same size"));
        assert!(side_by_side(&plain(4, 3, [0; 3]), &plain(4, 4, [0; 3]), 8).is_err());
    }

    #[test]
    fn both_images_and_the_lines_are_where_they_belong() {
        let (left, right) = (plain(5, 20, [10; 3]), plain(5, 20, [200; 3]));
        let both = side_by_side(&left, &right, 8).expect("same size");
        assert_eq!(both.size, [10, 20]);
        assert_eq!((both[(4, 0)].r(), both[(5, 0)].r()), (10, 200));
        let line = Role::Difference.color(&ON_IMAGE);
        let lines: Vec<usize> = (0..20).filter(|row| both[(0, *row)] == line).collect();
        assert_eq!(lines, [4, 12]);
        assert_eq!(epipolar_lines([5, 20], 8).marks.len(), 2);
        assert!(epipolar_lines([5, 20], 0).marks.is_empty());
    }

    #[test]
    fn blinking_alternates() {
        assert_eq!(
            [0.1, 0.6, 1.1, 1.6].map(|t| blink(t, 0.5)),
            [Eye::Left, Eye::Right, Eye::Left, Eye::Right]
        );
        assert!((blink_remaining_s(0.6, 0.5) - 0.4).abs() < 1e-12);
    }
}
