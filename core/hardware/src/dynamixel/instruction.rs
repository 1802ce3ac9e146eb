//! What a host can tell servos to do.

/// Id that every servo listens to and none answers (but to a bulk read).
pub const BROADCAST: u8 = 0xFE;

/// Largest id a servo may have.
pub const LARGEST_ID: u8 = 252;

/// An instruction. What would leave a servo as from the factory cannot be said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Instruction {
    /// Answer, whoever you are.
    Ping,
    /// Answer with `length` bytes from `address` on.
    Read {
        /// First register.
        address: u16,
        /// Bytes.
        length: u16,
    },
    /// Store bytes from `address` on.
    Write {
        /// First register.
        address: u16,
        /// Bytes.
        data: Vec<u8>,
    },
    /// Keep bytes until [`Instruction::Action`].
    RegWrite {
        /// First register.
        address: u16,
        /// Bytes.
        data: Vec<u8>,
    },
    /// Store what was kept.
    Action,
    /// Several servos store the same registers at once; nobody answers.
    SyncWrite {
        /// First register.
        address: u16,
        /// Bytes per servo.
        length: u16,
        /// Servo and its bytes.
        data: Vec<(u8, Vec<u8>)>,
    },
    /// Several servos answer one after the other, each with its own registers.
    BulkRead {
        /// In the order of the answers.
        items: Vec<BulkItem>,
    },
}

/// One servo's part of a bulk read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BulkItem {
    /// Servo.
    pub id: u8,
    /// First register.
    pub address: u16,
    /// Bytes.
    pub length: u16,
}

impl Instruction {
    /// The byte that stands for it in a packet.
    pub fn code(&self) -> u8 {
        match self {
            Self::Ping => 0x01,
            Self::Read { .. } => 0x02,
            Self::Write { .. } => 0x03,
            Self::RegWrite { .. } => 0x04,
            Self::Action => 0x05,
            Self::SyncWrite { .. } => 0x83,
            Self::BulkRead { .. } => 0x92,
        }
    }

    /// Its name in messages.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ping => "ping",
            Self::Read { .. } => "read",
            Self::Write { .. } => "write",
            Self::RegWrite { .. } => "reg write",
            Self::Action => "action",
            Self::SyncWrite { .. } => "sync write",
            Self::BulkRead { .. } => "bulk read",
        }
    }
}
