//! Packets of both protocols: from meaning to bytes and back.

use super::instruction::Instruction;
use super::status_error::StatusError;
use super::{protocol1, protocol2};

/// Which language a bus speaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Protocol {
    /// Sum as check, lengths and addresses of one byte.
    #[default]
    V1,
    /// CRC-16, byte stuffing, lengths and addresses of two bytes.
    V2,
}

/// A packet whose check was right, not yet interpreted: host and servo read it differently.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Sender of a status, addressee of an instruction.
    pub id: u8,
    /// Instruction, or (protocol 1.0) errors of a status, or 0x55 (status of protocol 2.0).
    pub code: u8,
    /// The rest, without stuffing.
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
    /// Not part of the protocol.
    #[error("protocol 1.0 has no {0}: use a servo that speaks protocol 2.0, or another instruction")]
    NotInProtocol1(&'static str),
    /// An address or a length above 255 in protocol 1.0, or a packet that is too long.
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
    /// An instruction where a status was expected (an echo), protocol 2.0 only.
    #[error("an instruction came back where a status was expected")]
    NotAStatus,
}

impl Protocol {
    /// Bytes of an instruction.
    ///
    /// # Errors
    /// When the protocol does not have it or it is too long.
    pub fn encode_instruction(self, id: u8, instruction: &Instruction) -> Result<Vec<u8>, EncodeError> {
        match self {
            Self::V1 => protocol1::encode(id, instruction.code(), &protocol1::parameters(instruction)?),
            Self::V2 => protocol2::encode(id, instruction.code(), &protocol2::parameters(instruction)?),
        }
        .ok_or(EncodeError::TooLong(instruction.name()))
    }

    /// Bytes of a servo's answer; `error` as the protocol codes it.
    ///
    /// # Errors
    /// When it is too long.
    pub fn encode_status(self, id: u8, error: u8, data: &[u8]) -> Result<Vec<u8>, EncodeError> {
        match self {
            Self::V1 => protocol1::encode(id, error, data),
            Self::V2 => {
                let mut parameters = vec![error];
                parameters.extend_from_slice(data);
                protocol2::encode(id, protocol2::STATUS, &parameters)
            }
        }
        .ok_or(EncodeError::TooLong("status"))
    }

    /// The instruction in a packet, for whoever plays a servo.
    ///
    /// # Errors
    /// When it is none.
    pub fn instruction(self, frame: &Frame) -> Result<Instruction, DecodeError> {
        match self {
            Self::V1 => protocol1::instruction(frame),
            Self::V2 => protocol2::instruction(frame),
        }
    }

    /// The status in a packet.
    ///
    /// # Errors
    /// When it is an instruction (protocol 2.0 can tell).
    pub fn status(self, frame: &Frame) -> Result<Status, DecodeError> {
        let (error, data) = match self {
            Self::V1 => (frame.code, frame.data.clone()),
            Self::V2 if frame.code != protocol2::STATUS => return Err(DecodeError::NotAStatus),
            Self::V2 => match frame.data.split_first() {
                Some((error, data)) => (*error, data.to_vec()),
                None => return Err(DecodeError::Parameters("status", 0)),
            },
        };
        Ok(Status { id: frame.id, error: StatusError::new(self, error), data })
    }

    /// Bytes of a status that carries `data` bytes, before stuffing.
    pub fn status_bytes(self, data: usize) -> usize {
        match self {
            Self::V1 => 6 + data,
            Self::V2 => 11 + data,
        }
    }
}
