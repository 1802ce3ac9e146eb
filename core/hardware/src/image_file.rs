//! One image file into 8-bit RGB, with precise words about what is wrong or was converted.

use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageError, ImageFormat, ImageReader, RgbImage};
use plumbline_model::files::{self, FileError, Size};

use crate::jpeg;

/// An image and what had to be done to it.
#[derive(Clone, Debug)]
pub struct LoadedImage {
    /// 8-bit RGB.
    pub image: RgbImage,
    /// Conversions, none for an 8-bit RGB file.
    pub notes: Vec<ImageNote>,
}

/// A conversion on the way to 8-bit RGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, thiserror::Error)]
pub enum ImageNote {
    /// One channel, copied to three.
    #[error("gray image, shown as gray RGB")]
    Gray,
    /// 16 bits per channel, scaled so that 65535 becomes 255.
    #[error("16-bit image, reduced to 8 bits")]
    SixteenBit,
    /// 16 bits per channel, but only the lower 12 or fewer are used: nearly black.
    #[error(
        "16-bit image whose brightest value is at most 4095 of 65535, so it is nearly black: store 10- and 12-bit camera images scaled up to 16 bits, or as 8 bits"
    )]
    SixteenBitDark,
    /// An alpha channel, left out.
    #[error("image with transparency, which is ignored")]
    Alpha,
    /// The extension says another format than the content.
    #[error("the file is not of the format its extension says; its content decides")]
    OtherFormat,
}

/// Why an image file cannot be used. Every message names the file and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImageProblem {
    /// No such file.
    #[error("{file} does not exist: it was moved or deleted; open the folder again")]
    Missing {
        /// File name.
        file: String,
    },
    /// The operating system does not hand it out.
    #[error("{file} cannot be read ({detail}): check its permissions and the disk")]
    Unreadable {
        /// File name.
        file: String,
        /// What the operating system says.
        detail: String,
    },
    /// Zero bytes.
    #[error("{file} is empty (0 bytes): the recording was interrupted; delete it or record the pair again")]
    Empty {
        /// File name.
        file: String,
    },
    /// Not an image at all.
    #[error("{file} is not an image, it {looks_like}: give PNG or JPEG files, or take it out of the folder")]
    NotAnImage {
        /// File name.
        file: String,
        /// What its first bytes look like.
        looks_like: String,
    },
    /// Cut off.
    #[error(
        "{file} is cut off after {bytes} bytes, its lower part is missing: copy it again from where it was recorded, or delete it"
    )]
    Truncated {
        /// File name.
        file: String,
        /// Bytes that are there.
        bytes: usize,
    },
    /// Damaged inside, or of an unusual kind.
    #[error("{file} is damaged or of an unusual kind ({detail}): save it again as PNG, or delete it")]
    Damaged {
        /// File name.
        file: String,
        /// What the decoder says.
        detail: String,
    },
}

/// Reads a PNG or JPEG file of any bit depth and color type.
///
/// 16-bit channels are scaled to 8 bits (65535 becomes 255), gray is copied to three channels,
/// alpha is dropped, an orientation tag is ignored (the sensor's pixels count); each of these
/// but the last is told in the notes. The content decides the format, not the extension.
pub fn load_image(path: &Path) -> Result<LoadedImage, ImageProblem> {
    let file = file_name(path);
    let bytes = read(path, &file)?;
    let format = guess_format(&bytes, &file)?;
    if format == ImageFormat::Jpeg && !jpeg::is_complete(&bytes) {
        return Err(ImageProblem::Truncated { file, bytes: bytes.len() });
    }
    let decoded = ImageReader::with_format(Cursor::new(&bytes), format)
        .decode()
        .map_err(|error| decoding_problem(file, bytes.len(), &error))?;
    let mut notes = notes_on(&decoded);
    if ImageFormat::from_path(path).is_ok_and(|named| named != format) {
        notes.push(ImageNote::OtherFormat);
    }
    Ok(LoadedImage { image: decoded.into_rgb8(), notes })
}

/// Width and height from the head of the file, if it has a readable one.
pub(crate) fn image_size(path: &Path) -> Option<(u32, u32)> {
    files::open_image(path).ok()?.into_dimensions().ok()
}

/// Last part of a path, for messages.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn read(path: &Path, file: &str) -> Result<Vec<u8>, ImageProblem> {
    let refused = |detail: String| ImageProblem::Unreadable { file: file.to_owned(), detail };
    let bytes = files::read(path, Size::IMAGE).map_err(|error| match error {
        error if error.is_absent() => ImageProblem::Missing { file: file.to_owned() },
        FileError::Unreadable { source, .. } => refused(source.to_string()),
        FileError::NotAFile { kind, .. } => refused(format!("it is {kind}")),
        FileError::Dangling { to, .. } => refused(format!("it is a link to {}, which is gone", to.display())),
        other => refused(other.to_string()),
    })?;
    if bytes.is_empty() {
        return Err(ImageProblem::Empty { file: file.to_owned() });
    }
    Ok(bytes)
}

fn guess_format(bytes: &[u8], file: &str) -> Result<ImageFormat, ImageProblem> {
    let not_an_image =
        |looks_like: String| Err(ImageProblem::NotAnImage { file: file.to_owned(), looks_like });
    match image::guess_format(bytes) {
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => Ok(format),
        Ok(format) => not_an_image(format!("is a {} file", format.extensions_str().join(" or "))),
        Err(_) => not_an_image(looks_like(bytes)),
    }
}

/// Says what the first bytes look like, for someone who wonders what was saved there.
fn looks_like(bytes: &[u8]) -> String {
    let head: String = String::from_utf8_lossy(&bytes[..bytes.len().min(24)]).into_owned();
    let first_line = head.lines().next().unwrap_or_default().trim_end_matches('\u{FFFD}').trim();
    let is_text = !first_line.is_empty() && !first_line.contains(|c: char| c.is_control() || c == '\u{FFFD}');
    if is_text {
        format!("begins with the text \"{first_line}\"")
    } else {
        "has an unknown format".to_owned()
    }
}

fn decoding_problem(file: String, bytes: usize, error: &ImageError) -> ImageProblem {
    if let ImageError::IoError(io) = error
        && io.kind() == std::io::ErrorKind::UnexpectedEof
    {
        return ImageProblem::Truncated { file, bytes };
    }
    ImageProblem::Damaged { file, detail: error.to_string() }
}

fn notes_on(image: &DynamicImage) -> Vec<ImageNote> {
    let mut notes = Vec::new();
    let color = image.color();
    if !color.has_color() {
        notes.push(ImageNote::Gray);
    }
    if color.has_alpha() {
        notes.push(ImageNote::Alpha);
    }
    if color.bytes_per_pixel() / color.channel_count() > 1 {
        notes.push(if brightest_16_bit(image) > 4095 {
            ImageNote::SixteenBit
        } else {
            ImageNote::SixteenBitDark
        });
    }
    notes
}

/// Brightest value of any color channel on the 16-bit scale.
fn brightest_16_bit(image: &DynamicImage) -> u16 {
    image.to_rgb16().into_raw().into_iter().max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{GrayImage, ImageBuffer, Luma, Rgb, Rgba, RgbaImage};
    use std::fs;
    use tempfile::TempDir;

    fn folder() -> TempDir {
        tempfile::tempdir().expect("a temporary folder")
    }

    /// A picture whose every pixel differs, so that swapped channels or axes show.
    fn picture() -> RgbImage {
        RgbImage::from_fn(40, 30, |x, y| Rgb([x as u8, y as u8, (x + 2 * y) as u8]))
    }

    #[test]
    fn rgb_comes_back_as_it_was_without_notes() {
        let folder = folder();
        let path = folder.path().join("a.png");
        picture().save(&path).expect("saving");
        let loaded = load_image(&path).expect("a good image");
        assert_eq!(loaded.image, picture());
        assert_eq!(loaded.notes, []);
        assert_eq!(image_size(&path), Some((40, 30)));
    }

    #[test]
    fn gray_alpha_and_16_bit_become_rgb_with_a_note() {
        let folder = folder();
        let path = folder.path().join("a.png");

        GrayImage::from_pixel(4, 3, Luma([77])).save(&path).expect("saving");
        let loaded = load_image(&path).expect("gray");
        assert_eq!(loaded.image.get_pixel(3, 2), &Rgb([77; 3]));
        assert_eq!(loaded.notes, [ImageNote::Gray]);

        RgbaImage::from_pixel(4, 3, Rgba([1, 2, 3, 0])).save(&path).expect("saving");
        let loaded = load_image(&path).expect("rgba");
        assert_eq!(loaded.image.get_pixel(0, 0), &Rgb([1, 2, 3]));
        assert_eq!(loaded.notes, [ImageNote::Alpha]);

        let bright = ImageBuffer::<Luma<u16>, _>::from_pixel(4, 3, Luma([0xABCD_u16]));
        bright.save(&path).expect("saving");
        let loaded = load_image(&path).expect("16-bit gray");
        assert_eq!(loaded.image.get_pixel(0, 0), &Rgb([0xAB; 3]));
        assert_eq!(loaded.notes, [ImageNote::Gray, ImageNote::SixteenBit]);

        let dark = ImageBuffer::<Rgb<u16>, _>::from_pixel(4, 3, Rgb([4095_u16, 100, 7]));
        dark.save(&path).expect("saving");
        let loaded = load_image(&path).expect("12 bits in 16");
        assert_eq!(loaded.notes, [ImageNote::SixteenBitDark]);
    }

    #[test]
    fn the_content_decides_the_format() {
        let folder = folder();
        let path = folder.path().join("really_a_jpeg.png");
        picture().save_with_format(&path, ImageFormat::Jpeg).expect("saving");
        let loaded = load_image(&path).expect("a JPEG under another name");
        assert_eq!(loaded.image.dimensions(), (40, 30));
        assert_eq!(loaded.notes, [ImageNote::OtherFormat]);
    }

    #[test]
    fn every_bad_file_is_told_apart_by_name() {
        let folder = folder();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("note.png"), "chessboard of monday\nsecond line").expect("writing");
        fs::write(at("noise.png"), [0_u8, 159, 3, 200, 1, 1, 1, 1]).expect("writing");
        fs::write(at("empty.png"), "").expect("writing");
        fs::write(at("film.png"), b"GIF89a\x01\x00\x01\x00").expect("writing");
        fs::create_dir(at("folder.png")).expect("a folder");

        let text = load_image(&at("note.png")).expect_err("text is no image");
        assert_eq!(
            text,
            ImageProblem::NotAnImage {
                file: "note.png".into(),
                looks_like: "begins with the text \"chessboard of monday\"".into()
            }
        );
        let noise = load_image(&at("noise.png")).expect_err("noise is no image");
        assert!(noise.to_string().contains("noise.png is not an image, it has an unknown format"), "{noise}");
        let gif = load_image(&at("film.png")).expect_err("a GIF is not read");
        assert!(gif.to_string().contains("is a gif file"), "{gif}");
        assert_eq!(
            load_image(&at("empty.png")).err(),
            Some(ImageProblem::Empty { file: "empty.png".into() })
        );
        assert_eq!(
            load_image(&at("gone.png")).err(),
            Some(ImageProblem::Missing { file: "gone.png".into() })
        );
        assert!(matches!(load_image(&at("folder.png")), Err(ImageProblem::Unreadable { .. })));
    }

    #[test]
    fn a_file_cut_off_anywhere_is_refused() {
        let folder = folder();
        for (name, format) in [("a.jpg", ImageFormat::Jpeg), ("a.png", ImageFormat::Png)] {
            let path = folder.path().join(name);
            picture().save_with_format(&path, format).expect("saving");
            let whole = fs::read(&path).expect("reading");
            for percent in [20, 50, 80, 95] {
                let length = whole.len() * percent / 100;
                fs::write(&path, &whole[..length]).expect("writing");
                let problem = load_image(&path).expect_err("cut off").to_string();
                assert!(problem.contains(&format!("{name} is cut off after {length} bytes")), "{problem}");
            }
        }
    }

    #[test]
    fn a_damaged_png_is_refused() {
        let folder = folder();
        let path = folder.path().join("a.png");
        picture().save(&path).expect("saving");
        let mut bytes = fs::read(&path).expect("reading");
        let middle = bytes.len() / 2;
        bytes[middle] ^= 0xFF;
        fs::write(&path, &bytes).expect("writing");
        assert!(
            matches!(load_image(&path), Err(ImageProblem::Damaged { .. })),
            "a flipped byte must not pass"
        );
    }
}
