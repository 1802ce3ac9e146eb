//! Whether a JPEG file is all there. Decoders fill what is missing with gray and report
//! nothing; for a calibration such a picture is worse than none. And how images are made into one.

use image::RgbImage;
use opencv::core::{Mat, Vec3b, Vector};
use opencv::{imgcodecs, imgproc};

use crate::cv::message;

/// What images are recorded at, of 100: what a camera would send, and little more.
pub const QUALITY: u8 = 92;

/// An image as a JPEG file, with half the resolution in color, as cameras send it.
///
/// # Errors
/// When the image is empty or too large for the format (65,500 pixels a side).
pub fn encode(image: &RgbImage, quality: u8) -> Result<Vec<u8>, String> {
    let too_large = |_| "a JPEG is at most 65,500 pixels wide and high".to_owned();
    let rows = i32::try_from(image.height()).map_err(too_large)?;
    let columns = i32::try_from(image.width()).map_err(too_large)?;
    by_opencv(rows, columns, image, quality).map_err(|error| message(&error))
}

/// Three times as fast as encoders written in Rust: its library is libjpeg-turbo.
fn by_opencv(rows: i32, columns: i32, image: &RgbImage, quality: u8) -> opencv::Result<Vec<u8>> {
    let rgb = Mat::new_rows_cols_with_bytes::<Vec3b>(rows, columns, image)?;
    let mut bgr = Mat::default();
    imgproc::cvt_color_def(&rgb, &mut bgr, imgproc::COLOR_RGB2BGR)?;
    let mut file = Vector::<u8>::new();
    let how = Vector::from_slice(&[imgcodecs::IMWRITE_JPEG_QUALITY, i32::from(quality)]);
    if !imgcodecs::imencode(".jpg", &bgr, &mut file, &how)? {
        return Err(opencv::Error::new(opencv::core::StsError, "imencode returned false"));
    }
    Ok(file.as_slice().to_vec())
}

/// Walks the markers (ITU-T T.81, annex B) and returns whether the end-of-image marker is
/// reached. Bytes after it (cameras pad their files) do not matter, and an embedded preview
/// with its own end marker is not mistaken for the end.
pub(crate) fn is_complete(bytes: &[u8]) -> bool {
    const START_OF_IMAGE: u8 = 0xD8;
    const END_OF_IMAGE: u8 = 0xD9;
    const START_OF_SCAN: u8 = 0xDA;
    const TEMPORARY: u8 = 0x01;

    let mut at = 0;
    let mut in_scan = false;
    loop {
        let Some((marker, after)) = next_marker(bytes, at, in_scan) else { return false };
        at = after;
        match marker {
            END_OF_IMAGE => return true,
            // Markers without content; restart markers are part of the scan.
            0xD0..=0xD7 | START_OF_IMAGE | TEMPORARY => {}
            _ => {
                let Some(&[high, low]) = bytes.get(at..at + 2) else { return false };
                let length = usize::from(u16::from_be_bytes([high, low]));
                // The length counts its own two bytes.
                if length < 2 || bytes.len() < at + length {
                    return false;
                }
                at += length;
                in_scan = marker == START_OF_SCAN;
            }
        }
    }
}

/// The next marker code at or after `at`, and the position behind it. Inside a scan, `FF 00`
/// is a stuffed data byte and other bytes are data; outside, a marker must follow at once.
fn next_marker(bytes: &[u8], mut at: usize, in_scan: bool) -> Option<(u8, usize)> {
    loop {
        if in_scan {
            at += bytes.get(at..)?.iter().position(|&byte| byte == 0xFF)?;
        }
        if *bytes.get(at)? != 0xFF {
            return None;
        }
        // Any number of FF bytes may fill up before the code.
        at += bytes.get(at..)?.iter().position(|&byte| byte != 0xFF)?;
        let code = bytes[at];
        at += 1;
        match (code, in_scan) {
            (0, true) => {}
            (0, false) => return None,
            _ => return Some((code, at)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ImageFormat, RgbImage};
    use std::io::Cursor;

    #[test]
    fn what_is_encoded_is_decoded_to_the_same_colors_and_an_empty_image_is_refused() {
        let image = RgbImage::from_fn(64, 48, |u, v| image::Rgb([200, (3 * u) as u8, (4 * v) as u8]));
        let bytes = encode(&image, QUALITY).expect("small");
        assert!(is_complete(&bytes));
        let back = image::load_from_memory_with_format(&bytes, ImageFormat::Jpeg).expect("a JPEG").to_rgb8();
        assert_eq!(back.dimensions(), image.dimensions());
        let off = back.iter().zip(image.iter()).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>();
        assert!(off / (image.len() as f64) < 3.0, "{}", off / image.len() as f64);
        assert!(encode(&RgbImage::new(0, 0), QUALITY).is_err());
    }

    fn jpeg() -> Vec<u8> {
        let image = RgbImage::from_fn(64, 48, |x, y| image::Rgb([(x * 7 + y * 13) as u8, (x * y) as u8, 9]));
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, ImageFormat::Jpeg).expect("encoding to memory");
        bytes.into_inner()
    }

    #[test]
    fn a_whole_file_is_complete_and_no_shorter_one_is() {
        let bytes = jpeg();
        assert!(is_complete(&bytes));
        for length in 0..bytes.len() {
            assert!(!is_complete(&bytes[..length]), "cut at {length} of {}", bytes.len());
        }
    }

    #[test]
    fn padding_behind_the_end_does_no_harm() {
        let mut bytes = jpeg();
        bytes.extend([0; 100]);
        assert!(is_complete(&bytes));
    }

    #[test]
    fn the_end_of_an_embedded_preview_is_not_the_end() {
        let preview = jpeg();
        let whole = jpeg();
        let length = u16::try_from(preview.len() + 2).expect("a small preview");
        let mut bytes = vec![0xFF, 0xD8, 0xFF, 0xE1];
        bytes.extend(length.to_be_bytes());
        bytes.extend(&preview);
        bytes.extend(&whole[2..]);
        assert!(is_complete(&bytes));
        bytes.truncate(bytes.len() - 40);
        assert!(!is_complete(&bytes));
    }
}
