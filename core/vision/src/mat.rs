//! Between the images of the `image` crate and OpenCV's `Mat`, without copies where the memory
//! layout is the same. Channel order is RGB on both sides: nothing here ever makes BGR.

use image::{GrayImage, RgbImage};
use opencv::boxed_ref::{BoxedRef, BoxedRefMut};
use opencv::core::{Mat, MatTraitConst, MatTraitConstManual, Vec3b};
use opencv::{Result, imgproc};

/// A gray image seen as an 8-bit, one-channel `Mat`; no copy.
pub fn gray(image: &GrayImage) -> Result<BoxedRef<'_, Mat>> {
    let (rows, columns) = shape(image.width(), image.height())?;
    Mat::new_rows_cols_with_data::<u8>(rows, columns, image)
}

/// An RGB image seen as an 8-bit, three-channel `Mat`; no copy.
pub fn rgb(image: &RgbImage) -> Result<BoxedRef<'_, Mat>> {
    let (rows, columns) = shape(image.width(), image.height())?;
    Mat::new_rows_cols_with_bytes::<Vec3b>(rows, columns, image)
}

/// A gray image that OpenCV can write to; no copy as long as OpenCV keeps size and type.
pub fn gray_mut(image: &mut GrayImage) -> Result<BoxedRefMut<'_, Mat>> {
    let (rows, columns) = shape(image.width(), image.height())?;
    Mat::new_rows_cols_with_data_mut::<u8>(rows, columns, image)
}

/// An RGB image that OpenCV can write to; no copy as long as OpenCV keeps size and type.
pub fn rgb_mut(image: &mut RgbImage) -> Result<BoxedRefMut<'_, Mat>> {
    let (rows, columns) = shape(image.width(), image.height())?;
    Mat::new_rows_cols_with_bytes_mut::<Vec3b>(rows, columns, image)
}

/// Copies an 8-bit, one-channel `Mat`.
///
/// # Errors
/// When the `Mat` has another type.
pub fn to_gray(mat: &impl MatTraitConst) -> Result<GrayImage> {
    let whole = mat.try_clone()?;
    let (width, height) = (whole.cols() as u32, whole.rows() as u32);
    let pixels = whole.data_typed::<u8>()?.to_vec();
    GrayImage::from_raw(width, height, pixels).ok_or_else(too_large)
}

/// Copies an 8-bit, three-channel `Mat` in RGB order.
///
/// # Errors
/// When the `Mat` has another type.
pub fn to_rgb(mat: &impl MatTraitConst) -> Result<RgbImage> {
    let whole = mat.try_clone()?;
    let (width, height) = (whole.cols() as u32, whole.rows() as u32);
    let pixels = whole.data_typed::<Vec3b>()?.iter().flat_map(|pixel| pixel.0).collect();
    RgbImage::from_raw(width, height, pixels).ok_or_else(too_large)
}

/// Brightness of an RGB image (weights of ITU-R BT.601, as everywhere in OpenCV).
pub fn gray_from_rgb(image: &RgbImage) -> Result<GrayImage> {
    let mut out = GrayImage::new(image.width(), image.height());
    imgproc::cvt_color(&rgb(image)?, &mut gray_mut(&mut out)?, imgproc::COLOR_RGB2GRAY, 0)?;
    Ok(out)
}

fn shape(width: u32, height: u32) -> Result<(i32, i32)> {
    match (i32::try_from(height), i32::try_from(width)) {
        (Ok(rows), Ok(columns)) => Ok((rows, columns)),
        _ => Err(too_large()),
    }
}

fn too_large() -> opencv::Error {
    opencv::Error::new(opencv::core::StsOutOfRange, "the image is too large")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> RgbImage {
        RgbImage::from_fn(5, 3, |x, y| image::Rgb([x as u8 * 10, y as u8 * 20, 7]))
    }

    #[test]
    fn images_come_back_as_they_went() {
        assert_eq!(to_rgb(&rgb(&picture()).expect("mat")).expect("image"), picture());
        let gray_picture = GrayImage::from_fn(4, 6, |x, y| image::Luma([(x * 16 + y) as u8]));
        assert_eq!(to_gray(&gray(&gray_picture).expect("mat")).expect("image"), gray_picture);
    }

    #[test]
    fn rows_and_columns_are_not_mixed_up() {
        let picture = picture();
        let mat = rgb(&picture).expect("mat");
        assert_eq!((mat.rows(), mat.cols()), (3, 5));
        assert_eq!(mat.at_2d::<Vec3b>(2, 4).expect("inside").0, [40, 40, 7]);
    }

    #[test]
    fn red_is_red() {
        let red = RgbImage::from_pixel(1, 1, image::Rgb([255, 0, 0]));
        assert_eq!(gray_from_rgb(&red).expect("gray").get_pixel(0, 0).0, [76]);
    }

    #[test]
    fn another_type_is_refused() {
        assert!(to_gray(&rgb(&picture()).expect("mat")).is_err());
        let gray_picture = GrayImage::new(2, 2);
        assert!(to_rgb(&gray(&gray_picture).expect("mat")).is_err());
    }
}
