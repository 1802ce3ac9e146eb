//! Servos on a serial bus that speak Dynamixel protocol 1.0: packets, control tables, and
//! the bus master. Who plays a servo (the twin, a test) uses the same packets from the other end:
//! [`Deframer`], [`decode_instruction`], [`encode_status`], [`ControlTable`].
//!
//! The packets are our own. The crates there are (rustypot 1.13, dynamixel2 0.9) keep theirs
//! private behind a blocking call on a serial port: a wait cannot be ended by the stop, faults
//! come back as one kind of error, protocol 1.0 has no bulk read, and there is no servo's side.
//!
//! Only this crate can write to a servo; see [`crate::joints`].
//!
//! Sources: ROBOTIS e-Manual, "DYNAMIXEL Protocol 1.0", and the manuals of MX-64 and
//! MX-28; Seed Robotics' documentation of the EROS hands' registers.

mod bulk;
mod bus;
mod control_table;
mod deframer;
mod error;
mod fault;
mod instruction;
mod packet;
mod port;
mod scan;
mod status_error;
mod wire_time;

#[cfg(test)]
mod tests;

pub use bus::{Bus, BusTiming};
pub use control_table::{Access, Coding, ControlTable, Item, Register, Ticks, Unit};
pub use deframer::{Deframer, Found};
pub use error::BusError;
pub use fault::{BusCounts, FaultCounts, FaultKind};
pub use instruction::{BROADCAST, BulkItem, Instruction, LARGEST_ID};
pub use packet::{
    DecodeError, EncodeError, Frame, Status, decode_instruction, decode_status, encode_instruction,
    encode_status,
};
pub use port::{PortInfo, ServoPort, latency_hint, list_ports, open_port};
pub(crate) use scan::Answer;
pub use scan::{BusScan, ExpectedServo, FoundServo, ScanRange, WrongModel};
pub use status_error::StatusError;
pub use wire_time::WireTime;
