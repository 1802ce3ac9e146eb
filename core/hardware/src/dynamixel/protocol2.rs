//! Protocol 2.0: `FF FF FD 00 id length code parameters… CRC`, numbers little-endian. The length
//! counts code, parameters and CRC. Where code and parameters hold `FF FF FD`, another `FD` is
//! put behind it, so that they never look like a header; length and CRC count that byte.

use super::instruction::{BulkItem, Instruction};
use super::packet::{DecodeError, EncodeError, Frame};

pub(super) const HEADER: [u8; 4] = [0xFF, 0xFF, 0xFD, 0x00];

/// Code of every status.
pub(super) const STATUS: u8 = 0x55;

/// Longer packets are taken for garbage, so that a broken length does not swallow what follows.
pub(super) const LONGEST: usize = 1024;

const CRC_TABLE: [u16; 256] = {
    let mut table = [0; 256];
    let mut i = 0;
    while i < 256 {
        let mut crc = (i as u16) << 8;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 0x8000 != 0 { (crc << 1) ^ 0x8005 } else { crc << 1 };
            bit += 1;
        }
        table[i] = crc;
        i += 1;
    }
    table
};

/// CRC-16 with the polynomial 0x8005, most significant bit first, from 0.
pub(super) fn crc(bytes: &[u8]) -> u16 {
    bytes.iter().fold(0, |crc, byte| (crc << 8) ^ CRC_TABLE[usize::from((crc >> 8) as u8 ^ byte)])
}

fn stuffed(code: u8, parameters: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(parameters.len() + 3);
    for byte in std::iter::once(&code).chain(parameters) {
        bytes.push(*byte);
        if bytes.ends_with(&HEADER[..3]) {
            bytes.push(0xFD);
        }
    }
    bytes
}

pub(super) fn without_stuffing(bytes: &[u8]) -> Vec<u8> {
    let mut plain: Vec<u8> = Vec::with_capacity(bytes.len());
    let mut skip = false;
    for (i, byte) in bytes.iter().enumerate() {
        if skip && *byte == 0xFD {
            skip = false;
            continue;
        }
        plain.push(*byte);
        skip = i >= 2 && bytes[..=i].ends_with(&HEADER[..3]);
    }
    plain
}

/// A packet; `None` when it is too long.
pub(super) fn encode(id: u8, code: u8, parameters: &[u8]) -> Option<Vec<u8>> {
    let content = stuffed(code, parameters);
    if content.len() + 9 > LONGEST {
        return None;
    }
    let length = u16::try_from(content.len() + 2).ok()?;
    let mut bytes = Vec::with_capacity(content.len() + 9);
    bytes.extend_from_slice(&HEADER);
    bytes.push(id);
    bytes.extend_from_slice(&length.to_le_bytes());
    bytes.extend_from_slice(&content);
    bytes.extend_from_slice(&crc(&bytes).to_le_bytes());
    Some(bytes)
}

pub(super) fn parameters(instruction: &Instruction) -> Result<Vec<u8>, EncodeError> {
    let mut bytes = vec![];
    match instruction {
        Instruction::Ping | Instruction::Action | Instruction::Reboot => {}
        Instruction::FactoryReset { data } | Instruction::Clear { data } => bytes.extend_from_slice(data),
        Instruction::Read { address, length } => {
            bytes.extend_from_slice(&address.to_le_bytes());
            bytes.extend_from_slice(&length.to_le_bytes());
        }
        Instruction::Write { address, data } | Instruction::RegWrite { address, data } => {
            bytes.extend_from_slice(&address.to_le_bytes());
            bytes.extend_from_slice(data);
        }
        Instruction::SyncRead { address, length, ids } => {
            bytes.extend_from_slice(&address.to_le_bytes());
            bytes.extend_from_slice(&length.to_le_bytes());
            bytes.extend_from_slice(ids);
        }
        Instruction::SyncWrite { address, length, data } => {
            bytes.extend_from_slice(&address.to_le_bytes());
            bytes.extend_from_slice(&length.to_le_bytes());
            for (id, part) in data {
                if part.len() != usize::from(*length) {
                    let (name, given, announced) = (instruction.name(), part.len(), *length);
                    return Err(EncodeError::WrongLength { id: *id, name, given, announced });
                }
                bytes.push(*id);
                bytes.extend_from_slice(part);
            }
        }
        Instruction::BulkRead { items } => {
            for item in items {
                bytes.push(item.id);
                bytes.extend_from_slice(&item.address.to_le_bytes());
                bytes.extend_from_slice(&item.length.to_le_bytes());
            }
        }
        Instruction::BulkWrite { items } => {
            for (id, address, data) in items {
                let length =
                    u16::try_from(data.len()).map_err(|_| EncodeError::TooLong(instruction.name()))?;
                bytes.push(*id);
                bytes.extend_from_slice(&address.to_le_bytes());
                bytes.extend_from_slice(&length.to_le_bytes());
                bytes.extend_from_slice(data);
            }
        }
    }
    Ok(bytes)
}

pub(super) fn instruction(frame: &Frame) -> Result<Instruction, DecodeError> {
    let data = &frame.data[..];
    let bad = |name| Err(DecodeError::Parameters(name, data.len()));
    let word = |low: &u8, high: &u8| u16::from_le_bytes([*low, *high]);
    Ok(match (frame.code, data) {
        (0x01, []) => Instruction::Ping,
        (0x02, [a, b, c, d]) => Instruction::Read { address: word(a, b), length: word(c, d) },
        (0x03, [a, b, data @ ..]) => Instruction::Write { address: word(a, b), data: data.to_vec() },
        (0x04, [a, b, data @ ..]) => Instruction::RegWrite { address: word(a, b), data: data.to_vec() },
        (0x05, []) => Instruction::Action,
        (0x06, data) => Instruction::FactoryReset { data: data.to_vec() },
        (0x08, []) => Instruction::Reboot,
        (0x10, data) => Instruction::Clear { data: data.to_vec() },
        (0x82, [a, b, c, d, ids @ ..]) => {
            Instruction::SyncRead { address: word(a, b), length: word(c, d), ids: ids.to_vec() }
        }
        (0x83, [a, b, c, d, data @ ..]) if data.len() % (usize::from(word(c, d)) + 1) == 0 => {
            let part = |part: &[u8]| (part[0], part[1..].to_vec());
            let data = data.chunks_exact(usize::from(word(c, d)) + 1).map(part).collect();
            Instruction::SyncWrite { address: word(a, b), length: word(c, d), data }
        }
        (0x92, items) if items.len() % 5 == 0 => {
            let item =
                |i: &[u8]| BulkItem { id: i[0], address: word(&i[1], &i[2]), length: word(&i[3], &i[4]) };
            Instruction::BulkRead { items: items.chunks_exact(5).map(item).collect() }
        }
        (0x93, mut rest) => {
            let mut items = vec![];
            while !rest.is_empty() {
                let [id, a, b, c, d, tail @ ..] = rest else { return bad("bulk write") };
                let length = usize::from(word(c, d));
                if tail.len() < length {
                    return bad("bulk write");
                }
                items.push((*id, word(a, b), tail[..length].to_vec()));
                rest = &tail[length..];
            }
            Instruction::BulkWrite { items }
        }
        (0x01, _) => return bad("ping"),
        (0x02, _) => return bad("read"),
        (0x03, _) => return bad("write"),
        (0x04, _) => return bad("reg write"),
        (0x05, _) => return bad("action"),
        (0x08, _) => return bad("reboot"),
        (0x82, _) => return bad("sync read"),
        (0x83, _) => return bad("sync write"),
        (0x92, _) => return bad("bulk read"),
        (code, _) => return Err(DecodeError::UnknownInstruction(code)),
    })
}
