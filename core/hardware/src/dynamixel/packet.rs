//! Packets of protocol 1.0, from meaning to bytes and back: `FF FF id length code parameters… sum`.
//! The length counts code, parameters and sum; the sum is the complement of the sum of all bytes from
//! the id on.

use super::instruction::{BROADCAST, BulkItem, Instruction};
use super::status_error::StatusError;

pub(super) const HEADER: [u8; 2] = [0xFF, 0xFF];

/// A packet whose check was right, not yet interpreted: host and servo read it differently.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Sender of a status, addressee of an instruction.
    pub id: u8,
    /// Instruction, or errors of a status.
    pub code: u8,
    /// The rest.
    pub data: Vec<u8>,
}

/// A servo's answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Status {
    /// Who answers.
    pub id: u8,
    /// What the servo complains about.
    pub error: StatusError,
    /// What was asked for.
    pub data: Vec<u8>,
}

/// An instruction or status that does not fit a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EncodeError {
    /// An address or a length above 255, or a packet that is too long.
    #[error("a {0} of this size does not fit into one packet: ask for fewer servos or registers at once")]
    TooLong(&'static str),
    /// A servo's bytes are not as many as announced.
    #[error("servo {id} was given {given} bytes where the {name} announces {announced}")]
    WrongLength {
        /// Servo.
        id: u8,
        /// Instruction.
        name: &'static str,
        /// Its bytes.
        given: usize,
        /// Bytes per servo.
        announced: u16,
    },
}

/// A packet with a right check whose content makes no sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// Unknown instruction.
    #[error("0x{0:02x} is not a known instruction")]
    UnknownInstruction(u8),
    /// Too few or too many bytes for it.
    #[error("a {0} with {1} bytes of parameters is not complete")]
    Parameters(&'static str, usize),
}

/// Bytes of an instruction.
///
/// # Errors
/// When it is too long.
pub fn encode_instruction(id: u8, instruction: &Instruction) -> Result<Vec<u8>, EncodeError> {
    encode(id, instruction.code(), &parameters(instruction)?).ok_or(EncodeError::TooLong(instruction.name()))
}

/// Bytes of a servo's answer with its error byte.
///
/// # Errors
/// When it is too long.
pub fn encode_status(id: u8, error: u8, data: &[u8]) -> Result<Vec<u8>, EncodeError> {
    encode(id, error, data).ok_or(EncodeError::TooLong("status"))
}

/// The status in a packet.
pub fn decode_status(frame: &Frame) -> Status {
    Status { id: frame.id, error: StatusError::new(frame.code), data: frame.data.clone() }
}

/// Bytes of a status that carries `data` bytes.
pub(super) fn status_bytes(data: usize) -> usize {
    6 + data
}

/// The instruction in a packet, for whoever plays a servo.
///
/// # Errors
/// When it is none.
pub fn decode_instruction(frame: &Frame) -> Result<Instruction, DecodeError> {
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
        (0x83, _) => return bad("sync write"),
        (0x92, _) => return bad("bulk read"),
        (code, _) => return Err(DecodeError::UnknownInstruction(code)),
    })
}

/// The check over id, length, code and parameters.
pub(super) fn checksum(bytes: &[u8]) -> u8 {
    !bytes.iter().fold(0u8, |sum, byte| sum.wrapping_add(*byte))
}

/// Bytes of a packet; `None` when it is too long.
fn encode(id: u8, code: u8, parameters: &[u8]) -> Option<Vec<u8>> {
    let length = u8::try_from(parameters.len() + 2).ok()?;
    let mut bytes = Vec::with_capacity(6 + parameters.len());
    bytes.extend_from_slice(&HEADER);
    bytes.extend_from_slice(&[id, length, code]);
    bytes.extend_from_slice(parameters);
    bytes.push(checksum(&bytes[2..]));
    Some(bytes)
}

fn parameters(instruction: &Instruction) -> Result<Vec<u8>, EncodeError> {
    let byte = |value: u16| u8::try_from(value).map_err(|_| EncodeError::TooLong(instruction.name()));
    Ok(match instruction {
        Instruction::Ping | Instruction::Action => vec![],
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
    })
}
