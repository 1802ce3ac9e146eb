//! Finds packets in a stream of bytes that may be cut, garbled, or begin in the middle.

use super::packet::{self, Frame, HEADER};

/// Collects bytes and hands out packets.
#[derive(Clone, Debug, Default)]
pub struct Deframer {
    buffer: Vec<u8>,
}

/// What was found in the stream.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// A packet with a right check.
    Frame(Frame),
    /// Bytes that belong to no packet.
    Garbage(usize),
    /// A packet with a wrong check; the id may be wrong too. Its bytes after the header are looked
    /// at again, in case the length was what broke.
    WrongCheck {
        /// Id as read.
        id: u8,
    },
}

/// What the beginning of the buffer is.
enum Start {
    NotYet,
    Junk(usize),
    Frame { length: usize, frame: Frame },
    WrongCheck { id: u8 },
}

impl Deframer {
    /// Takes bytes as they arrive.
    pub fn push(&mut self, bytes: &[u8]) {
        self.buffer.extend_from_slice(bytes);
    }

    /// Bytes that wait for the rest of their packet.
    pub fn pending(&self) -> usize {
        self.buffer.len()
    }

    /// Forgets what is not complete; returns how many bytes that were.
    pub fn clear(&mut self) -> usize {
        let forgotten = self.buffer.len();
        self.buffer.clear();
        forgotten
    }

    /// The next thing in the stream; `None` when more bytes are needed.
    pub fn pop(&mut self) -> Option<Found> {
        let (used, found) = match start(&self.buffer) {
            Start::NotYet => return None,
            Start::Junk(bytes) => (bytes, Found::Garbage(bytes)),
            Start::Frame { length, frame } => (length, Found::Frame(frame)),
            Start::WrongCheck { id } => (HEADER.len(), Found::WrongCheck { id }),
        };
        self.buffer.drain(..used);
        Some(found)
    }
}

/// Where the header, or its beginning at the end of the buffer, first stands.
fn find_header(buffer: &[u8]) -> usize {
    (0..buffer.len())
        .find(|i| {
            let rest = &buffer[*i..];
            let n = rest.len().min(HEADER.len());
            rest[..n] == HEADER[..n]
        })
        .unwrap_or(buffer.len())
}

fn start(buffer: &[u8]) -> Start {
    let junk = find_header(buffer);
    if junk > 0 {
        return Start::Junk(junk);
    }
    let [_, _, id, rest @ ..] = buffer else { return Start::NotYet };
    if *id == 0xFF {
        // FF FF FF: the header starts one byte later.
        return Start::Junk(1);
    }
    let Some(length) = rest.first().map(|length| usize::from(*length)) else { return Start::NotYet };
    if length < 2 {
        return Start::Junk(2);
    }
    let Some(bytes) = buffer.get(..length + 4) else { return Start::NotYet };
    if packet::checksum(&bytes[2..length + 3]) != bytes[length + 3] {
        return Start::WrongCheck { id: *id };
    }
    let frame = Frame { id: *id, code: bytes[4], data: bytes[5..length + 3].to_vec() };
    Start::Frame { length: length + 4, frame }
}

impl Deframer {
    /// Takes the own bytes out of the beginning of the stream, where an adapter echoes them.
    /// `expected` is emptied as soon as it is decided; returns whether it was an echo.
    ///
    /// Only whole echoes count. The one answer that equals its question is that to a ping of
    /// protocol 1.0 with the first error bit set; it is told apart by nothing, so presence is
    /// asked by reading the model.
    pub(crate) fn strip_echo(&mut self, expected: &mut Vec<u8>) -> bool {
        let compared = self.buffer.len().min(expected.len());
        if self.buffer[..compared] != expected[..compared] {
            expected.clear();
            return false;
        }
        if compared < expected.len() {
            return false;
        }
        self.buffer.drain(..compared);
        expected.clear();
        true
    }
}
