//! Between the images of the `image` crate and OpenCV's `Mat`, without copies where the memory
//! layout is the same. Channel order is RGB on both sides: nothing here ever makes BGR.

use image::{GrayImage, RgbImage};
use opencv::Result;
use opencv::boxed_ref::{BoxedRef, BoxedRefMut};
use opencv::core::{Mat, Vec3b};

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
    use opencv::core::MatTraitConst;

    use super::*;

    fn picture() -> RgbImage {
        RgbImage::from_fn(5, 3, |x, y| image::Rgb([x as u8 * 10, y as u8 * 20, 7]))
    }

    #[test]
    fn rows_and_columns_are_not_mixed_up() {
        let picture = picture();
        let mat = rgb(&picture).expect("mat");
        assert_eq!((mat.rows(), mat.cols()), (3, 5));
        assert_eq!(mat.at_2d::<Vec3b>(2, 4).expect("inside").0, [40, 40, 7]);
    }
}
