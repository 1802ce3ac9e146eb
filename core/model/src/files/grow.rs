//! A file that grows while something goes on: what was added is in it, also after a kill.

use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::error::FileError;
use super::write::write;

/// A file to whose end whole pieces are added.
#[derive(Debug)]
pub struct Growing {
    file: PathBuf,
    out: File,
    /// Bytes of all pieces that are whole.
    whole: u64,
}

impl Growing {
    /// Begins it with these bytes, in place of what was there.
    ///
    /// # Errors
    /// As [`write`].
    pub fn begin(file: &Path, head: impl AsRef<[u8]>) -> Result<Self, FileError> {
        let head = head.as_ref();
        write(file, head)?;
        let out = OpenOptions::new().append(true).open(file).map_err(FileError::unwritable(file))?;
        Ok(Self { file: file.to_owned(), out, whole: head.len() as u64 })
    }

    /// Adds a piece. A process that is killed afterwards leaves it there; a power cut may not.
    ///
    /// # Errors
    /// When the system refuses, for example because the disk is full; then nothing of the piece is in the file.
    pub fn add(&mut self, piece: impl AsRef<[u8]>) -> Result<(), FileError> {
        let piece = piece.as_ref();
        if let Err(error) = self.out.write_all(piece) {
            // Half a piece would be read as something else. That this fails, too, is no news.
            let _ = self.out.set_len(self.whole);
            return Err(FileError::unwritable(&self.file)(error));
        }
        self.whole += piece.len() as u64;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_piece_is_in_the_file_at_once_and_what_was_there_before_is_gone() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("tracks.csv");
        std::fs::write(&file, "older, and longer than what comes").expect("written");
        let text = || std::fs::read_to_string(&file).expect("there");
        let mut growing = Growing::begin(&file, "t_s\n").expect("begun");
        assert_eq!(text(), "t_s\n");
        growing.add("0.1\n").expect("added");
        assert_eq!(text(), "t_s\n0.1\n");
        growing.add("0.2\n0.3\n").expect("added");
        // Never dropped, as by a kill.
        std::mem::forget(growing);
        assert_eq!(text(), "t_s\n0.1\n0.2\n0.3\n");
    }

    #[test]
    fn where_nothing_can_be_written_nothing_is_begun() {
        let folder = tempfile::tempdir().expect("temporary folder");
        for file in [folder.path().to_owned(), folder.path().join("no/such/folder/tracks.csv")] {
            let why = Growing::begin(&file, "t_s\n").expect_err("no place").to_string();
            assert!(why.contains(&file.display().to_string()), "{why}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_disk_that_is_full_is_told() {
        let out = OpenOptions::new().append(true).open("/dev/full").expect("a device of this system");
        let mut growing = Growing { file: "tracks.csv".into(), out, whole: 0 };
        let why = growing.add("0.1\n").expect_err("full").to_string();
        assert!(why.contains("tracks.csv") && why.contains("free space"), "{why}");
    }
}
