//! Finds packets in a stream of bytes that may be cut, garbled, or begin in the middle.

use super::packet::{Frame, Protocol};
use super::{protocol1, protocol2};

/// Collects bytes and hands out packets.
#[derive(Clone, Debug)]
pub struct Deframer {
    protocol: Protocol,
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
    WrongCheck { id: u8, header: usize },
}

impl Deframer {
    /// For a protocol.
    pub fn new(protocol: Protocol) -> Self {
        Self { protocol, buffer: vec![] }
    }

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
        let start = match self.protocol {
            Protocol::V1 => start_1(&self.buffer),
            Protocol::V2 => start_2(&self.buffer),
        };
        let (used, found) = match start {
            Start::NotYet => return None,
            Start::Junk(bytes) => (bytes, Found::Garbage(bytes)),
            Start::Frame { length, frame } => (length, Found::Frame(frame)),
            Start::WrongCheck { id, header } => (header, Found::WrongCheck { id }),
        };
        self.buffer.drain(..used);
        Some(found)
    }
}

/// Where `header`, or its beginning at the end of the buffer, first stands.
fn find_header(buffer: &[u8], header: &[u8]) -> usize {
    (0..buffer.len())
        .find(|i| {
            let rest = &buffer[*i..];
            let n = rest.len().min(header.len());
            rest[..n] == header[..n]
        })
        .unwrap_or(buffer.len())
}

fn start_1(buffer: &[u8]) -> Start {
    let junk = find_header(buffer, &protocol1::HEADER);
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
    let Some(packet) = buffer.get(..length + 4) else { return Start::NotYet };
    if protocol1::checksum(&packet[2..length + 3]) != packet[length + 3] {
        return Start::WrongCheck { id: *id, header: 2 };
    }
    let frame = Frame { id: *id, code: packet[4], data: packet[5..length + 3].to_vec() };
    Start::Frame { length: length + 4, frame }
}

fn start_2(buffer: &[u8]) -> Start {
    let junk = find_header(buffer, &protocol2::HEADER);
    if junk > 0 {
        return Start::Junk(junk);
    }
    let [_, _, _, _, id, low, high, ..] = buffer else { return Start::NotYet };
    let length = usize::from(u16::from_le_bytes([*low, *high]));
    if length < 3 || length + 7 > protocol2::LONGEST {
        return Start::Junk(4);
    }
    let Some(packet) = buffer.get(..length + 7) else { return Start::NotYet };
    let (content, check) = packet.split_at(length + 5);
    if protocol2::crc(content).to_le_bytes() != check {
        return Start::WrongCheck { id: *id, header: 4 };
    }
    let plain = protocol2::without_stuffing(&content[7..]);
    let Some((code, data)) = plain.split_first() else { return Start::Junk(4) };
    Start::Frame { length: length + 7, frame: Frame { id: *id, code: *code, data: data.to_vec() } }
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
