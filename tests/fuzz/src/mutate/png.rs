//! Changes inside PNG files with the checks made right again, so that the decoder meets them.

use crate::dice::Dice;

const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Whether a file begins like a PNG.
pub fn is_png(content: &[u8]) -> bool {
    content.starts_with(SIGNATURE) && content.len() > SIGNATURE.len() + 25
}

/// Changes a PNG once.
pub fn change(dice: &mut Dice, content: &[u8]) -> (String, Vec<u8>) {
    let mut out = content.to_vec();
    let header = SIGNATURE.len() + 8;
    let what = match dice.below(3) {
        0 => {
            let side = header + 4 * dice.below(2);
            let size = *dice.pick(&[0_u32, 1, 7, 4000, 65_535, 100_000, 0x7fff_ffff, 0xffff_ffff]);
            out[side..side + 4].copy_from_slice(&size.to_be_bytes());
            format!("a side of {size} pixels")
        }
        1 => {
            let byte = header + 8 + dice.below(5);
            out[byte] = *dice.pick(&[0, 1, 2, 3, 4, 6, 8, 16, 255]);
            "another depth, color or interlace".to_owned()
        }
        _ => {
            let at = header + dice.below(out.len() - header);
            out[at] ^= 1 << dice.below(8);
            format!("a bit at byte {at}")
        }
    };
    mend(&mut out);
    (what, out)
}

/// Makes the checks of all whole chunks right.
fn mend(png: &mut [u8]) {
    let mut at = SIGNATURE.len();
    while let Some(length) = png.get(at..at + 4) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let Some(end) = (at + 8).checked_add(length).filter(|end| end + 4 <= png.len()) else { return };
        let mut check = flate2::Crc::new();
        check.update(&png[at + 4..end]);
        let sum = check.sum().to_be_bytes();
        png[end..end + 4].copy_from_slice(&sum);
        at = end + 4;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mended_file_is_decoded_again() {
        let mut bytes = std::io::Cursor::new(vec![]);
        let image = image::RgbImage::from_fn(9, 5, |x, y| image::Rgb([x as u8, y as u8, 7]));
        image.write_to(&mut bytes, image::ImageFormat::Png).expect("in memory");
        let good = bytes.into_inner();
        assert!(is_png(&good));
        let mut bad = good.clone();
        // A wrong check of the header.
        bad[SIGNATURE.len() + 8 + 13] ^= 0xff;
        assert!(image::load_from_memory(&bad).is_err());
        mend(&mut bad);
        assert_eq!(bad, good);
    }
}
