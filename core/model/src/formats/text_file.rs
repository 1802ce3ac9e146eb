//! Reading text whole, telling what else it is, and writing it.

use std::path::Path;

use super::error::FormatError;
use crate::files::{self, Size};

/// Reads a text file; says what else it is when it is none.
pub(crate) fn read(file: &Path) -> Result<String, FormatError> {
    let bytes = files::read(file, Size::TEXT)?;
    if let Some(kind) = picture_kind(&bytes) {
        return Err(FormatError::Picture { file: file.to_path_buf(), kind });
    }
    let text = String::from_utf8(bytes).map_err(|_| FormatError::NotText { file: file.to_path_buf() })?;
    if text.contains('\0') {
        return Err(FormatError::NotText { file: file.to_path_buf() });
    }
    let text = text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text);
    if text.trim().is_empty() {
        return Err(FormatError::Empty { file: file.to_path_buf() });
    }
    Ok(text)
}

fn picture_kind(bytes: &[u8]) -> Option<&'static str> {
    const KINDS: [(&[u8], &str); 7] = [
        (b"\x89PNG\r\n", "PNG"),
        (b"\xff\xd8\xff", "JPEG"),
        (b"GIF8", "GIF"),
        (b"II*\0", "TIFF"),
        (b"MM\0*", "TIFF"),
        (b"RIFF", "WebP"),
        (b"BM", "BMP"),
    ];
    // "BM" alone could begin a text; a bitmap's header holds zeros.
    KINDS
        .iter()
        .find(|(magic, kind)| bytes.starts_with(magic) && (*kind != "BMP" || bytes.contains(&0)))
        .map(|&(_, kind)| kind)
}

/// Writes a text file in one step.
pub(crate) fn write(file: &Path, text: &str) -> Result<(), FormatError> {
    Ok(files::write(file, text)?)
}
