//! Images, read and written in the same room.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use image::{DynamicImage, ImageFormat, ImageReader};

use super::error::FileError;
use super::read::open;
use super::size::Size;
use super::write::write_with;

/// Opens an image; its kind is told by its contents.
///
/// # Errors
/// As [`open`].
pub fn open_image(file: &Path) -> Result<ImageReader<BufReader<File>>, FileError> {
    let opened = BufReader::new(open(file, Size::IMAGE)?);
    ImageReader::new(opened).with_guessed_format().map_err(FileError::unreadable(file))
}

/// Reads an image.
///
/// # Errors
/// As [`open`], and when it is no image that can be decoded.
pub fn read_image(file: &Path) -> Result<DynamicImage, FileError> {
    open_image(file)?
        .decode()
        .map_err(|error| FileError::NotAnImage { file: file.to_path_buf(), reason: error.to_string() })
}

/// Writes an image as PNG, without loss and in one step.
///
/// # Errors
/// When the target is no file that can be replaced, or the system refuses.
pub fn write_png(file: &Path, image: &DynamicImage) -> Result<(), FileError> {
    write_with(file, |out| image.write_to(out, ImageFormat::Png).map_err(std::io::Error::other))
}
