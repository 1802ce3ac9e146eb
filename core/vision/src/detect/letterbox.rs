//! Letterbox: an image scaled into the input of a network, its sides kept in proportion, the
//! rest gray.
//!
//! The numbers are those of the reference (`LetterBox` and `scale_boxes` of ultralytics 8.4), so
//! that a network sees here what it saw in training: the scaled sides and the left and upper
//! padding are rounded half to even, padding splits as ⌊d/2 − 0.1⌉ and ⌊d/2 + 0.1⌉, gray is 114,
//! and pixels are resampled bilinearly as OpenCV's `resize` does. Checked against numbers of the
//! reference in `tests/detect_reference.rs`.

use image::RgbImage;
use opencv::core::{Mat, Size, Vec3b};
use opencv::imgproc;
use plumbline_model::detection::PixelBox;

use super::{DetectError, InputSize};
use crate::mat;

/// Brightness of the padding.
const GRAY: u8 = 114;

/// Where an image lies in the input of a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Letterbox {
    /// Size (width, height) of the image, px.
    pub image: (u32, u32),
    /// Size (width, height) of the input, px.
    pub input: (u32, u32),
    /// Size (width, height) of the image in it, px.
    pub scaled: (u32, u32),
    /// Column and row of the image's first pixel in the input.
    pub offset: (u32, u32),
}

impl Letterbox {
    /// For an image of a size (width, height) and a network; `None` if the image is empty.
    pub fn new(image: (u32, u32), input: InputSize) -> Option<Self> {
        if image.0 == 0 || image.1 == 0 {
            return None;
        }
        let (within, stride) = match input {
            InputSize::Fixed { width_px, height_px } => ((width_px, height_px), None),
            InputSize::Dynamic { width_px, height_px, stride_px } => ((width_px, height_px), Some(stride_px)),
        };
        let ratio = |inner: u32, outer: u32| f64::from(inner) / f64::from(outer);
        let scale = ratio(within.1, image.1).min(ratio(within.0, image.0));
        let side = |length: u32| ((f64::from(length) * scale).round_ties_even() as u32).max(1);
        let scaled = (side(image.0), side(image.1));
        // Both fit but for the rounding of a side that is scaled exactly to the input's.
        let spare = |outer: u32, inner: u32| {
            let spare = outer.saturating_sub(inner);
            stride.map_or(spare, |stride| spare % stride.max(1))
        };
        let spare = (spare(within.0, scaled.0), spare(within.1, scaled.1));
        let before = |spare: u32| (0.5 * f64::from(spare) - 0.1).round_ties_even() as u32;
        Some(Self {
            image,
            input: (scaled.0 + spare.0, scaled.1 + spare.1),
            scaled,
            offset: (before(spare.0), before(spare.1)),
        })
    }

    /// A box of the input on the image, clipped to it.
    pub fn on_image(&self, [x0, y0, x1, y1]: [f32; 4]) -> PixelBox {
        let axis = |at: f32, offset: u32, scaled: u32, length: u32| {
            let gain = (f64::from(scaled) / f64::from(length)) as f32;
            ((at - offset as f32) / gain).clamp(0.0, length as f32)
        };
        let x = |at| axis(at, self.offset.0, self.scaled.0, self.image.0);
        let y = |at| axis(at, self.offset.1, self.scaled.1, self.image.1);
        PixelBox::new(x(x0), y(y0), x(x1), y(y1))
    }
}

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
    /// `input` must hold 3 × width × height numbers of `letterbox.input`, and must be the same
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

/// Pixels to planes at the letterbox's offset.
fn planes<T: Brightness>(table: &[T; 256], image: &RgbImage, letterbox: &Letterbox, input: &mut [T]) {
    let (width, height) = (letterbox.input.0 as usize, letterbox.input.1 as usize);
    let (left, top) = (letterbox.offset.0 as usize, letterbox.offset.1 as usize);
    let columns = image.width() as usize;
    let (red, rest) = input.split_at_mut(width * height);
    let (green, blue) = rest.split_at_mut(width * height);
    for (row, pixels) in image.as_raw().chunks_exact(3 * columns).enumerate() {
        let begin = (top + row) * width + left;
        let part = begin..begin + columns;
        let (red, green, blue) = (&mut red[part.clone()], &mut green[part.clone()], &mut blue[part]);
        for (((pixel, red), green), blue) in pixels.chunks_exact(3).zip(red).zip(green).zip(blue) {
            *red = table[usize::from(pixel[0])];
            *green = table[usize::from(pixel[1])];
            *blue = table[usize::from(pixel[2])];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: InputSize = InputSize::Fixed { width_px: 640, height_px: 640 };

    #[test]
    fn a_camera_image_is_padded_above_and_below() {
        let letterbox = Letterbox::new((640, 480), SQUARE).expect("an image");
        assert_eq!(letterbox.scaled, (640, 480));
        assert_eq!(letterbox.offset, (0, 80));
        assert_eq!(letterbox.input, (640, 640));
    }

    #[test]
    fn a_network_of_any_size_gets_no_more_padding_than_it_needs() {
        let any = InputSize::Dynamic { width_px: 640, height_px: 640, stride_px: 32 };
        let letterbox = Letterbox::new((640, 470), any).expect("an image");
        assert_eq!((letterbox.input, letterbox.offset), ((640, 480), (0, 5)));
    }

    #[test]
    fn boxes_come_back_to_where_they_are_on_the_image() {
        for image in [(640, 480), (1, 1), (333, 517), (1920, 1080), (3000, 1)] {
            let letterbox = Letterbox::new(image, SQUARE).expect("an image");
            let (left, top) = (letterbox.offset.0 as f32, letterbox.offset.1 as f32);
            let whole = [left, top, left + letterbox.scaled.0 as f32, top + letterbox.scaled.1 as f32];
            let back = letterbox.on_image(whole);
            assert!((back.width_px() - image.0 as f32).abs() < 1e-3, "{image:?}: {back:?}");
            assert!((back.height_px() - image.1 as f32).abs() < 1e-3, "{image:?}: {back:?}");
            let everywhere = letterbox.on_image([-1e9, -1e9, 1e9, 1e9]);
            assert_eq!(everywhere, PixelBox::new(0.0, 0.0, image.0 as f32, image.1 as f32));
        }
    }

    #[test]
    fn an_empty_image_has_no_place() {
        assert_eq!(Letterbox::new((0, 480), SQUARE), None);
        assert_eq!(Letterbox::new((640, 0), SQUARE), None);
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
