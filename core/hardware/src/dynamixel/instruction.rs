//! What a host can tell servos to do.

/// Id that every servo listens to and none answers (but to ping of protocol 2.0, bulk and sync
/// read).
pub const BROADCAST: u8 = 0xFE;

/// Largest id a servo may have.
pub const LARGEST_ID: u8 = 252;

/// An instruction, the same for both protocols. What a protocol does not have is refused when it
/// is encoded.
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
    /// Back to the factory's values; protocol 2.0 says which are spared.
    FactoryReset {
        /// Empty for protocol 1.0.
        data: Vec<u8>,
    },
    /// Start anew (2.0).
    Reboot,
    /// Forget turns or errors (2.0).
    Clear {
        /// What, with its key.
        data: Vec<u8>,
    },
    /// Several servos answer one after the other with the same registers (2.0).
    SyncRead {
        /// First register.
        address: u16,
        /// Bytes.
        length: u16,
        /// Who, in the order of their answers.
        ids: Vec<u8>,
    },
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
    /// Several servos store different registers at once (2.0).
    BulkWrite {
        /// Servo, first register, bytes.
        items: Vec<(u8, u16, Vec<u8>)>,
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
            Self::FactoryReset { .. } => 0x06,
            Self::Reboot => 0x08,
            Self::Clear { .. } => 0x10,
            Self::SyncRead { .. } => 0x82,
            Self::SyncWrite { .. } => 0x83,
            Self::BulkRead { .. } => 0x92,
            Self::BulkWrite { .. } => 0x93,
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
            Self::FactoryReset { .. } => "factory reset",
            Self::Reboot => "reboot",
            Self::Clear { .. } => "clear",
            Self::SyncRead { .. } => "sync read",
            Self::SyncWrite { .. } => "sync write",
            Self::BulkRead { .. } => "bulk read",
            Self::BulkWrite { .. } => "bulk write",
        }
    }
}
