//! Protocol 1.0: `FF FF id length code parameters… sum`. The length counts code, parameters and
//! sum; the sum is the complement of the sum of all bytes from the id on.

use super::instruction::{BROADCAST, BulkItem, Instruction};
use super::packet::{DecodeError, EncodeError, Frame};

pub(super) const HEADER: [u8; 2] = [0xFF, 0xFF];

/// The check over id, length, code and parameters.
pub(super) fn checksum(bytes: &[u8]) -> u8 {
    !bytes.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte))
}

/// A packet; `None` when it is too long.
pub(super) fn encode(id: u8, code: u8, parameters: &[u8]) -> Option<Vec<u8>> {
    let length = u8::try_from(parameters.len() + 2).ok()?;
    let mut bytes = Vec::with_capacity(6 + parameters.len());
    bytes.extend_from_slice(&HEADER);
    bytes.extend_from_slice(&[id, length, code]);
    bytes.extend_from_slice(parameters);
    bytes.push(checksum(&bytes[2..]));
    Some(bytes)
}

pub(super) fn parameters(instruction: &Instruction) -> Result<Vec<u8>, EncodeError> {
    let byte = |value: u16| u8::try_from(value).map_err(|_| EncodeError::TooLong(instruction.name()));
    Ok(match instruction {
        Instruction::Ping | Instruction::Action => vec![],
        Instruction::FactoryReset { data } if data.is_empty() => vec![],
        Instruction::Read { address, length } => vec![byte(*address)?, byte(*length)?],
        Instruction::Write { address, data } | Instruction::RegWrite { address, data } => {
            let mut bytes = vec![byte(*address)?];
            bytes.extend_from_slice(data);
            bytes
        }
        Instruction::SyncWrite { address, length, data } => {
            let mut bytes = vec![byte(*address)?, byte(*length)?];
            for (id, part) in data {
                if part.len() != usize::from(*length) {
                    let (name, given, announced) = (instruction.name(), part.len(), *length);
                    return Err(EncodeError::WrongLength { id: *id, name, given, announced });
                }
                bytes.push(*id);
                bytes.extend_from_slice(part);
            }
            bytes
        }
        Instruction::BulkRead { items } => {
            let mut bytes = vec![0];
            for item in items {
                bytes.extend_from_slice(&[byte(item.length)?, item.id, byte(item.address)?]);
            }
            bytes
        }
        Instruction::FactoryReset { .. }
        | Instruction::Reboot
        | Instruction::Clear { .. }
        | Instruction::SyncRead { .. }
        | Instruction::BulkWrite { .. } => return Err(EncodeError::NotInProtocol1(instruction.name())),
    })
}

pub(super) fn instruction(frame: &Frame) -> Result<Instruction, DecodeError> {
    let data = &frame.data[..];
    let bad = |name| Err(DecodeError::Parameters(name, data.len()));
    Ok(match (frame.code, data) {
        (0x01, []) => Instruction::Ping,
        (0x02, [address, length]) => {
            Instruction::Read { address: u16::from(*address), length: u16::from(*length) }
        }
        (0x03, [address, data @ ..]) => {
            Instruction::Write { address: u16::from(*address), data: data.to_vec() }
        }
        (0x04, [address, data @ ..]) => {
            Instruction::RegWrite { address: u16::from(*address), data: data.to_vec() }
        }
        (0x05, []) => Instruction::Action,
        (0x06, []) => Instruction::FactoryReset { data: vec![] },
        (0x83, [address, length, data @ ..])
            if *length > 0 && data.len() % (usize::from(*length) + 1) == 0 =>
        {
            let part = |part: &[u8]| (part[0], part[1..].to_vec());
            let data = data.chunks_exact(usize::from(*length) + 1).map(part).collect();
            Instruction::SyncWrite { address: u16::from(*address), length: u16::from(*length), data }
        }
        (0x92, [0, items @ ..]) if items.len() % 3 == 0 && frame.id == BROADCAST => {
            let item = |i: &[u8]| BulkItem { id: i[1], address: u16::from(i[2]), length: u16::from(i[0]) };
            Instruction::BulkRead { items: items.chunks_exact(3).map(item).collect() }
        }
        (0x01, _) => return bad("ping"),
        (0x02, _) => return bad("read"),
        (0x03, _) => return bad("write"),
        (0x04, _) => return bad("reg write"),
        (0x05, _) => return bad("action"),
        (0x06, _) => return bad("factory reset"),
        (0x83, _) => return bad("sync write"),
        (0x92, _) => return bad("bulk read"),
        (code, _) => return Err(DecodeError::UnknownInstruction(code)),
    })
}
