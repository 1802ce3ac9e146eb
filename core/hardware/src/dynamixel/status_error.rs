//! What a servo complains about in its answer.

use std::fmt;

use super::packet::Protocol;

/// The error byte of a status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StatusError {
    protocol: Protocol,
    byte: u8,
}

const BITS_1: [&str; 7] = [
    "the supply voltage is out of range",
    "a goal lies outside of the angle limits",
    "it is too hot",
    "a value is out of range",
    "an instruction arrived with a wrong checksum",
    "it is overloaded",
    "an instruction was not understood",
];

const NUMBERS_2: [&str; 7] = [
    "an instruction could not be carried out",
    "an instruction was not understood",
    "an instruction arrived with a wrong CRC",
    "a value is out of range",
    "data are too short for their register",
    "a value exceeds its limit",
    "a register cannot be read or written now",
];

impl StatusError {
    /// From the byte as the protocol codes it.
    pub fn new(protocol: Protocol, byte: u8) -> Self {
        Self { protocol, byte }
    }

    /// The byte.
    pub fn byte(self) -> u8 {
        self.byte
    }

    /// Whether there is nothing to complain about.
    pub fn is_none(self) -> bool {
        self.byte == 0
    }

    /// Whether the host's bytes arrived broken, so that repeating helps.
    pub fn is_transmission(self) -> bool {
        match self.protocol {
            Protocol::V1 => self.byte & 0x10 != 0,
            Protocol::V2 => self.byte & 0x7F == 3,
        }
    }

    /// Whether the servo may have switched its torque off (overload, overheating), or, in
    /// protocol 2.0, raises its alert.
    pub fn is_alarm(self) -> bool {
        match self.protocol {
            Protocol::V1 => self.byte & 0x24 != 0,
            Protocol::V2 => self.byte & 0x80 != 0,
        }
    }

    /// Every complaint, in words.
    pub fn words(self) -> Vec<&'static str> {
        match self.protocol {
            Protocol::V1 => (0..7).filter(|bit| self.byte & (1 << bit) != 0).map(|bit| BITS_1[bit]).collect(),
            Protocol::V2 => {
                let number = usize::from(self.byte & 0x7F);
                let told =
                    number.checked_sub(1).map(|i| NUMBERS_2.get(i).copied().unwrap_or("an unknown error"));
                let alert =
                    (self.byte & 0x80 != 0).then_some("it raises an alert (see its hardware error status)");
                told.into_iter().chain(alert).collect()
            }
        }
    }
}

impl fmt::Display for StatusError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_none() {
            return f.write_str("nothing");
        }
        f.write_str(&self.words().join(", "))
    }
}
