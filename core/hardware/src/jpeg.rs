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

const START_OF_IMAGE: u8 = 0xD8;
const END_OF_IMAGE: u8 = 0xD9;
const START_OF_SCAN: u8 = 0xDA;
const HUFFMAN_TABLES: u8 = 0xC4;
const TEMPORARY: u8 = 0x01;

/// Whether the end-of-image marker is reached. Bytes after it (cameras pad their files) do not
/// matter, and an embedded preview with its own end marker is not mistaken for the end.
pub(crate) fn is_complete(bytes: &[u8]) -> bool {
    whole(bytes).is_some()
}

/// The image up to and with its end-of-image marker, without what stands behind it; `None`: it is cut or
/// damaged before. Video4Linux may hand out a frame with all of its buffer, which is as long as the longest frame
/// could be, and in which the rest of earlier frames stands behind the end of this one.
pub(crate) fn whole(bytes: &[u8]) -> Option<&[u8]> {
    let (_, after) = first_marker(bytes, |marker| marker == END_OF_IMAGE)?;
    bytes.get(..after)
}

/// Whether its Huffman tables stand in it, before its first scan. Many cameras leave them out of
/// their frames, because Motion JPEG has usual ones: OpenCV fills these in, and other decoders
/// refuse such a file.
pub(crate) fn has_huffman_tables(bytes: &[u8]) -> bool {
    let first = first_marker(bytes, |marker| matches!(marker, HUFFMAN_TABLES | START_OF_SCAN | END_OF_IMAGE));
    first.is_some_and(|(marker, _)| marker == HUFFMAN_TABLES)
}

/// Walks the markers (ITU-T T.81, annex B) to the first one that is wanted, and says where the bytes behind it
/// begin; `None`: the file is cut or damaged before.
fn first_marker(bytes: &[u8], is_wanted: impl Fn(u8) -> bool) -> Option<(u8, usize)> {
    let mut at = 0;
    let mut in_scan = false;
    loop {
        let (marker, after) = next_marker(bytes, at, in_scan)?;
        if is_wanted(marker) {
            return Some((marker, after));
        }
        at = after;
        match marker {
            // Markers without content; restart markers are part of the scan.
            0xD0..=0xD7 | START_OF_IMAGE | END_OF_IMAGE | TEMPORARY => {}
            _ => {
                let Some(&[high, low]) = bytes.get(at..at + 2) else { return None };
                let length = usize::from(u16::from_be_bytes([high, low]));
                // The length counts its own two bytes.
                if length < 2 || bytes.len() < at + length {
                    return None;
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

/// The same file without its Huffman tables, as many cameras send it.
#[cfg(test)]
pub(crate) fn without_huffman_tables(bytes: &[u8]) -> Vec<u8> {
    let mut kept = bytes[..2].to_vec();
    let mut at = 2;
    while bytes[at + 1] != START_OF_SCAN {
        let next = at + 2 + usize::from(u16::from_be_bytes([bytes[at + 2], bytes[at + 3]]));
        if bytes[at + 1] != HUFFMAN_TABLES {
            kept.extend(&bytes[at..next]);
        }
        at = next;
    }
    kept.extend(&bytes[at..]);
    kept
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
    fn huffman_tables_count_only_where_they_stand_before_the_scan_as_a_segment_of_their_own() {
        let bytes = jpeg();
        assert!(has_huffman_tables(&bytes));
        let bare = without_huffman_tables(&bytes);
        assert!(bare.len() < bytes.len() && is_complete(&bare) && !has_huffman_tables(&bare));
        // Those of an embedded preview, and those behind the first scan, are none of its own.
        let preview: [u8; 10] = [0xFF, 0xD8, 0xFF, 0xE1, 0, 6, 0xFF, HUFFMAN_TABLES, 0, 2];
        assert!(!has_huffman_tables(&[&preview, &bare[2..]].concat()));
        let late: [u8; 4] = [0xFF, HUFFMAN_TABLES, 0, 2];
        let end = bare.len() - 2;
        assert!(!has_huffman_tables(&[&bare[..end], &late, &bare[end..]].concat()));
        assert!(has_huffman_tables(&[&bare[..2], &late, &bare[2..]].concat()));
        assert!(!has_huffman_tables(&bytes[..2]) && !has_huffman_tables(&[]));
    }

    #[test]
    fn what_stands_behind_the_end_does_no_harm_and_is_no_part_of_it() {
        let bytes = jpeg();
        // Zeros, and the rest of a longer frame that was in the buffer before.
        for rest in [&[0; 100][..], &bytes[bytes.len() / 2..]] {
            let padded = [&bytes, rest].concat();
            assert!(is_complete(&padded));
            assert_eq!(whole(&padded), Some(&bytes[..]));
        }
        assert_eq!(whole(&bytes), Some(&bytes[..]));
        assert_eq!(whole(&bytes[..bytes.len() - 1]), None);
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
