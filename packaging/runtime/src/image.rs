//! The file that was started: this runtime, a squashfs behind it, and a line at the end that says what
//! all bytes before it must be.
//!
//! Where the squashfs starts follows from the headers of the runtime's own ELF, as the specification of
//! AppImages of type 2 has it. The line at the end is Plumbline's own: with it a file that was not copied
//! to its end is told at once, and its sum names the folder that the image is unpacked into.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::error::Error;

/// How the last line starts; the sum as 64 hexadecimal digits and the end of the line follow.
const SEAL: &str = "\nplumbline-image sha256 ";
/// The whole line.
const SEAL_BYTES: u64 = SEAL.len() as u64 + 64 + 1;
/// How a squashfs starts.
const SQUASHFS: &[u8; 4] = b"hsqs";

/// An image whose parts were found; its bytes were not looked at yet.
#[derive(Debug)]
pub struct Image {
    /// Where it lies.
    pub path: PathBuf,
    /// Where its squashfs starts, in bytes.
    pub offset: u64,
    /// What its sum must be, in hexadecimal digits.
    sum: String,
    /// Bytes that the sum is of.
    sealed_bytes: u64,
}

impl Image {
    /// Finds the parts of an image.
    ///
    /// # Errors
    /// [`Error::NoImage`] when the squashfs or the line behind it is missing.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let none = |why: String| Error::NoImage { image: path.to_owned(), why };
        let unreadable = |error: std::io::Error| none(format!("it cannot be read ({error})"));
        let mut file = File::open(path).map_err(unreadable)?;
        let bytes = file.seek(SeekFrom::End(0)).map_err(unreadable)?;
        let offset =
            end_of_elf(&mut file).ok_or_else(|| none("its own headers cannot be read".to_owned()))?;
        let sealed_bytes = bytes.checked_sub(SEAL_BYTES).filter(|sealed| *sealed > offset);
        let sealed_bytes = sealed_bytes.ok_or_else(|| none("nothing follows the runtime".to_owned()))?;
        if read_at::<4>(&mut file, offset).as_ref() != Some(SQUASHFS) {
            return Err(none("no squashfs follows the runtime".to_owned()));
        }
        let seal = read_at::<{ SEAL_BYTES as usize }>(&mut file, sealed_bytes);
        let sum = seal.as_ref().and_then(|seal| sum_of_seal(seal));
        let sum = sum.ok_or_else(|| none("its end is missing".to_owned()))?.to_owned();
        Ok(Self { path: path.to_owned(), offset, sum, sealed_bytes })
    }

    /// What the folder of this image is called: half of its sum.
    pub fn id(&self) -> &str {
        &self.sum[..ID_DIGITS]
    }

    /// Reads every byte and compares.
    ///
    /// # Errors
    /// [`Error::Damaged`] when they are not those that were packed.
    pub fn verify(&self) -> Result<(), Error> {
        let damaged = |why: String| Error::Damaged { image: self.path.clone(), why };
        let unreadable = |error: std::io::Error| damaged(format!("it cannot be read ({error})"));
        let mut rest = File::open(&self.path).map_err(unreadable)?.take(self.sealed_bytes);
        let (mut sum, mut buffer) = (Sha256::new(), vec![0; 1 << 18]);
        loop {
            let read = match rest.read(&mut buffer) {
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
                read => read.map_err(unreadable)?,
            };
            if read == 0 {
                break;
            }
            sum.update(&buffer[..read]);
        }
        let found: String = sum.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        match found == self.sum {
            true => Ok(()),
            false => Err(damaged("its bytes are not those that were packed".to_owned())),
        }
    }
}

/// Digits of an image's id.
pub const ID_DIGITS: usize = 32;

/// Whether this can be the id of an image.
pub fn is_id(text: &str) -> bool {
    text.len() == ID_DIGITS && is_hexadecimal(text)
}

fn is_hexadecimal(text: &str) -> bool {
    text.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'))
}

fn sum_of_seal(seal: &[u8]) -> Option<&str> {
    let sum = std::str::from_utf8(seal).ok()?.strip_prefix(SEAL)?.strip_suffix('\n')?;
    is_hexadecimal(sum).then_some(sum)
}

/// Where an ELF of 64 bits ends: behind its headers, its segments and its sections, whichever is last.
fn end_of_elf(file: &mut (impl Read + Seek)) -> Option<u64> {
    let head = read_at::<64>(file, 0)?;
    // 64 bits, little-endian.
    if !head.starts_with(b"\x7fELF\x02\x01") {
        return None;
    }
    let mut end = 64;
    // Each table: where it starts, the bytes of an entry, how many, and where an entry has its extent.
    let segments = (long(&head, 32)?, short(&head, 54)?, short(&head, 56)?);
    let sections = (long(&head, 40)?, short(&head, 58)?, short(&head, 60)?);
    for ((start, entry_bytes, count), is_section) in [(segments, false), (sections, true)] {
        end = end.max(start.checked_add(u64::from(entry_bytes).checked_mul(u64::from(count))?)?);
        for index in 0..u64::from(count) {
            let at = start.checked_add(index * u64::from(entry_bytes))?;
            end = end.max(end_of_part(file, at, is_section)?);
        }
    }
    Some(end)
}

/// Where the segment or section ends whose header lies here.
fn end_of_part(file: &mut (impl Read + Seek), at: u64, is_section: bool) -> Option<u64> {
    /// Takes no bytes in the file.
    const NOBITS: u32 = 8;
    let header = read_at::<56>(file, at)?;
    let (kind_at, start_at, bytes_at) = if is_section { (4, 24, 32) } else { (0, 8, 32) };
    let kind = u32::from_le_bytes(header.get(kind_at..kind_at + 4)?.try_into().ok()?);
    match is_section && kind == NOBITS {
        true => Some(0),
        false => long(&header, start_at)?.checked_add(long(&header, bytes_at)?),
    }
}

fn read_at<const N: usize>(file: &mut (impl Read + Seek), at: u64) -> Option<[u8; N]> {
    let mut bytes = [0; N];
    file.seek(SeekFrom::Start(at)).ok()?;
    file.read_exact(&mut bytes).ok()?;
    Some(bytes)
}

fn short(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn long(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(bytes.get(at..at + 8)?.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;

    /// Headers of an ELF with one section of this kind, start and size, its table right behind the head.
    fn elf(kind: u32, start: u64, bytes: u64) -> Vec<u8> {
        let mut elf = vec![0; 128];
        elf[..6].copy_from_slice(b"\x7fELF\x02\x01");
        elf[40..48].copy_from_slice(&64_u64.to_le_bytes());
        elf[58..60].copy_from_slice(&64_u16.to_le_bytes());
        elf[60..62].copy_from_slice(&1_u16.to_le_bytes());
        elf[68..72].copy_from_slice(&kind.to_le_bytes());
        elf[88..96].copy_from_slice(&start.to_le_bytes());
        elf[96..104].copy_from_slice(&bytes.to_le_bytes());
        elf
    }

    #[test]
    fn the_end_is_behind_whatever_is_last() {
        let end = |elf| end_of_elf(&mut Cursor::new(elf));
        assert_eq!(end(elf(1, 500, 20)), Some(520), "a section behind its table");
        assert_eq!(end(elf(1, 10, 20)), Some(128), "the table behind its section");
        assert_eq!(end(elf(8, 500, 20)), Some(128), "what takes no bytes in the file");
    }

    #[test]
    fn headers_that_make_no_sense_have_no_end() {
        let end = |elf: &[u8]| end_of_elf(&mut Cursor::new(elf));
        assert_eq!(end(b""), None);
        assert_eq!(end(b"#!/bin/sh\n"), None);
        assert_eq!(end(&elf(1, u64::MAX, 20)), None, "it overflows");
        assert_eq!(end(&elf(1, 500, 20)[..100]), None, "its table is cut off");
        let mut large = elf(1, 500, 20);
        large[4] = 1;
        assert_eq!(end(&large), None, "32 bits");
    }

    #[test]
    fn this_program_ends_where_its_file_ends_or_before() {
        let path = std::env::current_exe().expect("a program");
        let mut file = File::open(&path).expect("readable");
        let end = end_of_elf(&mut file).expect("headers");
        let bytes = file.metadata().expect("metadata").len();
        assert!(end <= bytes && end > bytes / 2, "{end} of {bytes}");
        let refused = Image::open(&path).expect_err("no image follows");
        assert!(matches!(refused, Error::NoImage { .. }), "{refused}");
    }

    #[test]
    fn the_last_line_is_taken_only_as_it_was_written() {
        let sum = "0123456789abcdef".repeat(4);
        let line = |start: &str, sum: &str, end: &str| format!("{start}{sum}{end}").into_bytes();
        assert_eq!(sum_of_seal(&line(SEAL, &sum, "\n")), Some(sum.as_str()));
        assert_eq!(sum_of_seal(&line(SEAL, &sum, " ")), None);
        assert_eq!(sum_of_seal(&line(&SEAL.to_uppercase(), &sum, "\n")), None);
        assert_eq!(
            sum_of_seal(&line(SEAL, &"../".repeat(21), "\n")),
            None,
            "it becomes the name of a folder"
        );
    }
}
