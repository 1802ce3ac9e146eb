//! What a servo complains about in its answer.

use std::fmt;

/// The error byte of a status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StatusError {
    byte: u8,
}

const BITS: [&str; 7] = [
    "the supply voltage is out of range",
    "a goal lies outside of the angle limits",
    "it is too hot",
    "a value is out of range",
    "an instruction arrived with a wrong checksum",
    "it is overloaded",
    "an instruction was not understood",
];

impl StatusError {
    /// From the byte.
    pub fn new(byte: u8) -> Self {
        Self { byte }
    }

    /// The byte.
    pub fn byte(self) -> u8 {
        self.byte
    }

    /// Whether there is nothing to complain about.
    pub fn is_none(self) -> bool {
        self.byte == 0
    }

    /// Whether a goal lies outside of its angle limits, and was not taken (MX-64 manual, "Error": bit 1).
    pub fn is_outside(self) -> bool {
        self.byte & 0x02 != 0
    }

    /// Whether the host's bytes arrived broken, so that repeating helps.
    pub fn is_transmission(self) -> bool {
        self.byte & 0x10 != 0
    }

    /// Whether the servo may have switched its torque off (overload, overheating).
    pub fn is_alarm(self) -> bool {
        self.byte & 0x24 != 0
    }

    /// Every complaint, in words.
    pub fn words(self) -> Vec<&'static str> {
        (0..7).filter(|bit| self.byte & (1 << bit) != 0).map(|bit| BITS[bit]).collect()
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
