//! Inputs of a network filled with pixels, at the place that their [`Letterbox`] says.

use image::RgbImage;
use opencv::core::{Mat, Size, Vec3b};
use opencv::imgproc;

use super::{DetectError, Letterbox, Region};
use crate::mat;

/// Brightness of the padding.
const GRAY: u8 = 114;

/// A number that a network takes as brightness, 0–1.
pub(super) trait Brightness: Copy {
    /// All 256, so that every pixel is exactly v / 255, rounded once.
    fn table() -> [Self; 256];
}

impl Brightness for f32 {
    fn table() -> [Self; 256] {
        std::array::from_fn(|value| value as f32 / 255.0)
    }
}

impl Brightness for half::f16 {
    fn table() -> [Self; 256] {
        std::array::from_fn(|value| half::f16::from_f32(value as f32 / 255.0))
    }
}

/// Fills inputs; keeps what it needs between images.
pub(super) struct Filler<T> {
    table: Box<[T; 256]>,
    scaled: RgbImage,
    /// What the padding of the input was made for.
    padded_for: Option<Letterbox>,
}

impl<T: Brightness> Filler<T> {
    /// With nothing filled yet.
    pub fn new() -> Self {
        Self { table: Box::new(T::table()), scaled: RgbImage::new(0, 0), padded_for: None }
    }

    /// Writes an image into an input of three planes, red first.
    ///
    /// `input` must hold 3 × width × height numbers of `letterbox.given`, and must be the same
    /// memory, untouched, as long as the letterbox stays the same.
    pub fn fill(
        &mut self,
        image: &RgbImage,
        letterbox: &Letterbox,
        input: &mut [T],
    ) -> Result<(), DetectError> {
        if self.padded_for != Some(*letterbox) {
            input.fill(self.table[usize::from(GRAY)]);
            self.padded_for = Some(*letterbox);
        }
        if letterbox.scaled == image.dimensions() {
            planes(&self.table, image, letterbox, input);
            return Ok(());
        }
        if self.scaled.dimensions() != letterbox.scaled {
            self.scaled = RgbImage::new(letterbox.scaled.0, letterbox.scaled.1);
        }
        let (width_px, height_px) = image.dimensions();
        resize(image, &mut self.scaled).map_err(|error| DetectError::Resize {
            width_px,
            height_px,
            reason: error.message,
        })?;
        planes(&self.table, &self.scaled, letterbox, input);
        Ok(())
    }
}

/// Bilinear, as `cv2.resize` with `INTER_LINEAR`.
fn resize(image: &RgbImage, scaled: &mut RgbImage) -> opencv::Result<()> {
    let size = Size::new(scaled.width() as i32, scaled.height() as i32);
    let from = mat::rgb(image)?;
    let mut to = Mat::new_rows_cols_with_bytes_mut::<Vec3b>(size.height, size.width, scaled)?;
    imgproc::resize(&from, &mut to, size, 0.0, 0.0, imgproc::INTER_LINEAR)
}

/// Pixels of the scaled image to planes, as far as the letterbox gives them.
fn planes<T: Brightness>(table: &[T; 256], image: &RgbImage, letterbox: &Letterbox, input: &mut [T]) {
    let Region { width_px, height_px, .. } = letterbox.given;
    let (width, size) = (width_px as usize, width_px as usize * height_px as usize);
    let ((left, top), (from, line)) = first(letterbox);
    let columns = (width - left).min(image.width() as usize - from);
    let (red, rest) = input.split_at_mut(size);
    let (green, blue) = rest.split_at_mut(size);
    let lines = image.as_raw().chunks_exact(3 * image.width() as usize).skip(line);
    let rows = |plane| rows_of(plane, width, top, left..left + columns);
    for (((pixels, red), green), blue) in lines.zip(rows(red)).zip(rows(green)).zip(rows(blue)) {
        let pixels = pixels[3 * from..][..3 * columns].chunks_exact(3);
        for (((pixel, red), green), blue) in pixels.zip(red).zip(green).zip(blue) {
            *red = table[usize::from(pixel[0])];
            *green = table[usize::from(pixel[1])];
            *blue = table[usize::from(pixel[2])];
        }
    }
}

/// Column and row of what the network is given at which the image begins, and of the scaled image
/// that lies there.
fn first(letterbox: &Letterbox) -> ((usize, usize), (usize, usize)) {
    let along = |offset: u32, given: u32| (offset.saturating_sub(given), given.saturating_sub(offset));
    let (left, from) = along(letterbox.offset.0, letterbox.given.x_px);
    let (top, line) = along(letterbox.offset.1, letterbox.given.y_px);
    ((left as usize, top as usize), (from as usize, line as usize))
}

/// A part of each row of a plane, from a row on.
fn rows_of<T>(
    plane: &mut [T],
    width: usize,
    top: usize,
    columns: std::ops::Range<usize>,
) -> impl Iterator<Item = &mut [T]> {
    plane.chunks_exact_mut(width).skip(top).map(move |row| &mut row[columns.clone()])
}

#[cfg(test)]
mod tests {
    use super::super::InputSize;
    use super::*;

    #[test]
    fn a_part_that_is_not_scaled_shows_its_own_pixels() {
        let image = RgbImage::from_fn(64, 64, |x, y| image::Rgb([x as u8, y as u8, 0]));
        let input = InputSize::Dynamic { width_px: 64, height_px: 64, stride_px: 8 };
        let region = Region { x_px: 24, y_px: 40, width_px: 16, height_px: 8 };
        let letterbox = Letterbox::of_region((64, 64), region, input).expect("an image");
        assert_eq!(letterbox.given, region);
        let mut planes = vec![0.0; 3 * 16 * 8];
        Filler::<f32>::new().fill(&image, &letterbox, &mut planes).expect("it fits");
        assert_eq!(planes[0], 24.0 / 255.0);
        assert_eq!(planes[16 * 8 - 1], 39.0 / 255.0);
        assert_eq!(planes[2 * 16 * 8 - 1], 47.0 / 255.0);
    }

    #[test]
    fn red_comes_first_and_the_rest_is_gray() {
        let image = RgbImage::from_pixel(4, 2, image::Rgb([255, 51, 0]));
        let input = InputSize::Fixed { width_px: 4, height_px: 4 };
        let letterbox = Letterbox::new((4, 2), input).expect("an image");
        let mut filler = Filler::<f32>::new();
        let mut planes = vec![9.0; 3 * 16];
        filler.fill(&image, &letterbox, &mut planes).expect("it fits");
        let gray = 114.0 / 255.0;
        for (plane, value) in planes.chunks(16).zip([1.0, 0.2, 0.0]) {
            assert_eq!(&plane[..4], [gray; 4]);
            assert_eq!(&plane[4..12], [value; 8]);
            assert_eq!(&plane[12..], [gray; 4]);
        }
    }

    #[test]
    fn another_size_leaves_nothing_of_the_image_before() {
        let input = InputSize::Fixed { width_px: 8, height_px: 8 };
        let mut filler = Filler::<f32>::new();
        let mut planes = vec![0.0; 3 * 64];
        let mut fill = |width, height| {
            let image = RgbImage::from_pixel(width, height, image::Rgb([255, 255, 255]));
            let letterbox = Letterbox::new((width, height), input).expect("an image");
            filler.fill(&image, &letterbox, &mut planes).expect("it fits");
            planes.iter().filter(|value| **value == 1.0).count()
        };
        assert_eq!(fill(8, 8), 3 * 64);
        assert_eq!(fill(8, 4), 3 * 32);
    }
}
