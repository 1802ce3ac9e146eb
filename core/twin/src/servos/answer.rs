//! Who answers what to an instruction.

use plumbline_hardware::dynamixel::{BROADCAST, Frame, Instruction, Item, decode_instruction, encode_status};

use super::bank::{Bank, Unit};
use super::fault::Fault;
use super::memory::error_bit;

/// An answer and how long its servo waits before it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Answer {
    /// As on the wire.
    pub bytes: Vec<u8>,
    /// Return delay of the servo, s.
    pub delay_s: f64,
}

/// A servo needs this long to understand an instruction, s.
const UNDERSTANDING_S: f64 = 30e-6;
/// From this status return level on reads, or everything, is answered.
const LEVEL_READ: u16 = 1;
const LEVEL_ALL: u16 = 2;

impl Bank {
    /// Carries an instruction out; gives the answers in the order in which they come.
    pub(crate) fn answer(&mut self, frame: &Frame) -> Vec<Answer> {
        let missing = self.missing();
        match decode_instruction(frame) {
            Ok(Instruction::SyncWrite { address, data, .. }) => {
                for (id, bytes) in data {
                    self.each(id, missing, |unit| {
                        // Nobody answers; a servo that refuses keeps its value.
                        let _ = unit.write(address, &bytes);
                    });
                }
                vec![]
            }
            Ok(Instruction::BulkRead { items }) => {
                let mut answers = vec![];
                for item in items {
                    let before = answers.len();
                    self.each(item.id, missing, |unit| {
                        if unit.memory.table().bulk_read {
                            answers.push(unit.read(item.address, item.length));
                        }
                    });
                    // Each servo waits for the one before it: after a silent one nobody speaks.
                    if answers.len() == before {
                        break;
                    }
                }
                answers
            }
            Ok(instruction) => {
                let mut answers = vec![];
                let broadcast = frame.id == BROADCAST;
                self.each(frame.id, missing, |unit| {
                    let answer = unit.single(&instruction);
                    let heard = !broadcast || instruction == Instruction::Ping;
                    answers.extend(answer.filter(|_| heard));
                });
                answers
            }
            // Also a factory reset, which would change the id and leave the bus in a state that only
            // a screwdriver mends: these servos refuse it.
            Err(_) if frame.id == BROADCAST => vec![],
            Err(_) => self.complain(frame.id, error_bit::INSTRUCTION),
        }
    }

    /// An instruction arrived with a wrong checksum, perhaps for this servo.
    pub(crate) fn broken(&mut self, id: u8) -> Vec<Answer> {
        if id == BROADCAST { vec![] } else { self.complain(id, error_bit::CHECKSUM) }
    }

    fn complain(&mut self, id: u8, error: u8) -> Vec<Answer> {
        let missing = self.missing();
        let mut answers = vec![];
        self.each(id, missing, |unit| answers.push(unit.status(error, &[])));
        answers
    }

    /// The servo that a fault took off the bus.
    fn missing(&self) -> Option<usize> {
        self.suspect().filter(|_| self.faults.contains(&Fault::MissingServo))
    }

    /// Everyone who listens to an id.
    fn each(&mut self, id: u8, missing: Option<usize>, mut act: impl FnMut(&mut Unit)) {
        let suspect = self.suspect();
        let doubled = self.faults.contains(&Fault::TwoWithOneId);
        for (i, unit) in self.units.iter_mut().enumerate() {
            if Some(i) == missing || !unit.powered || (unit.id() != id && id != BROADCAST) {
                continue;
            }
            act(unit);
            if doubled && Some(i) == suspect {
                act(unit);
            }
        }
    }
}

impl Unit {
    /// An instruction for one servo; `None` when it stays silent.
    fn single(&mut self, instruction: &Instruction) -> Option<Answer> {
        let level = self.memory.get(Item::StatusReturnLevel).unwrap_or(LEVEL_ALL);
        match instruction {
            Instruction::Ping => Some(self.status(0, &[])),
            Instruction::Read { address, length } => {
                (level >= LEVEL_READ).then(|| self.read(*address, *length))
            }
            Instruction::Write { address, data } => {
                let error = self.write(*address, data);
                (level >= LEVEL_ALL).then(|| self.status(error, &[]))
            }
            Instruction::RegWrite { address, data } => {
                let error = self.memory.keep(*address, data).err().unwrap_or(0);
                (level >= LEVEL_ALL).then(|| self.status(error, &[]))
            }
            Instruction::Action => {
                self.memory.act();
                self.written();
                (level >= LEVEL_ALL).then(|| self.status(0, &[]))
            }
            // For many at once; see [`Bank::answer`].
            Instruction::SyncWrite { .. } | Instruction::BulkRead { .. } => {
                Some(self.status(error_bit::INSTRUCTION, &[]))
            }
        }
    }

    fn read(&self, address: u16, length: u16) -> Answer {
        match self.memory.read(address, length) {
            Ok(data) => self.status(0, &data),
            Err(error) => self.status(error, &[]),
        }
    }

    fn write(&mut self, address: u16, data: &[u8]) -> u8 {
        let error = self.memory.write(address, data).err().unwrap_or(0);
        self.written();
        error
    }

    fn status(&self, error: u8, data: &[u8]) -> Answer {
        let delay_s = self.memory.si(Item::ReturnDelayTime).unwrap_or(0.0) + UNDERSTANDING_S;
        // Registers are few enough that an answer always fits.
        let bytes = encode_status(self.id(), error | self.alarm, data).unwrap_or_default();
        Answer { bytes, delay_s }
    }
}
