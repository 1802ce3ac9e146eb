//! Reading text whole, and writing it so that a crash leaves the old file or the new one.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::error::FormatError;

/// Reads a text file; says what else it is when it is none.
pub(crate) fn read(file: &Path) -> Result<String, FormatError> {
    let bytes =
        fs::read(file).map_err(|source| FormatError::Unreadable { file: file.to_path_buf(), source })?;
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

/// A file written under a temporary name beside its place, and moved there when all is well.
///
/// Dropped without [`Self::commit`], it is removed and the place is as it was.
#[derive(Debug)]
pub struct Replacement {
    target: PathBuf,
    temporary: PathBuf,
    committed: bool,
}

impl Replacement {
    /// Chooses a temporary name in the folder of `target`, with the same extension.
    pub fn of(target: &Path) -> Self {
        let name = target.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
        // Two writers, of this process or another, must not share a temporary file.
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let unique = (std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let temporary = target.with_file_name(format!(".{}-{}.part-{name}", unique.0, unique.1));
        Self { target: target.to_path_buf(), temporary, committed: false }
    }

    /// Where to write.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Writes the text to the temporary name.
    pub fn fill(&self, text: &str) -> Result<(), FormatError> {
        fs::File::create(&self.temporary)
            .and_then(|mut file| file.write_all(text.as_bytes()).and_then(|()| file.sync_all()))
            .map_err(|source| self.refused(source))
    }

    /// Moves the file to its place.
    pub fn commit(mut self) -> Result<(), FormatError> {
        fs::rename(&self.temporary, &self.target).map_err(|source| self.refused(source))?;
        self.committed = true;
        Ok(())
    }

    fn refused(&self, source: std::io::Error) -> FormatError {
        FormatError::Unwritable { file: self.target.clone(), source }
    }
}

impl Drop for Replacement {
    fn drop(&mut self) {
        if !self.committed {
            // It may never have been created; there is nothing else to do about it here.
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

/// Writes a text file in one step.
pub(crate) fn write(file: &Path, text: &str) -> Result<(), FormatError> {
    let replacement = Replacement::of(file);
    replacement.fill(text)?;
    replacement.commit()
}
