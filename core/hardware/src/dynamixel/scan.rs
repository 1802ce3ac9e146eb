//! Which servos are on a bus, and whether they are the expected ones.

use std::fmt;
use std::time::{Duration, Instant};

use super::bus::Bus;
use super::control_table::ControlTable;
use super::error::BusError;
use super::fault::FaultKind;
use super::instruction::{Instruction, LARGEST_ID};

/// A servo or board that answered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundServo {
    /// Id.
    pub id: u8,
    /// Model number, as it tells.
    pub model_number: u16,
    /// Version of its firmware.
    pub firmware: u8,
}

impl FoundServo {
    /// From the first bytes of its memory; shorter ones were refused before.
    fn of(id: u8, identity: &[u8]) -> Self {
        let byte = |i: usize| identity.get(i).copied().unwrap_or(0);
        Self { id, model_number: u16::from_le_bytes([byte(0), byte(1)]), firmware: byte(2) }
    }

    /// Whether it is of a model, as control tables are called.
    pub fn is_model(&self, model: &str) -> bool {
        ControlTable::of_model(model).is_some_and(|table| table.number == self.model_number)
    }

    /// Name of its model, if it is known.
    pub fn model(&self) -> Option<&'static str> {
        ControlTable::of_number(self.model_number).map(|table| table.model.as_str())
    }
}

impl fmt::Display for FoundServo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.model() {
            Some(model) => write!(f, "{} ({model}, firmware {})", self.id, self.firmware),
            None => {
                write!(f, "{} (unknown model {}, firmware {})", self.id, self.model_number, self.firmware)
            }
        }
    }
}

/// A servo that should be there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpectedServo {
    /// Id.
    pub id: u8,
    /// Model, as control tables are called.
    pub model: String,
    /// Its name for people.
    pub title: String,
}

/// A servo of another model than expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrongModel {
    /// What was expected.
    pub expected: ExpectedServo,
    /// What is there.
    pub found: FoundServo,
}

/// What a scan found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BusScan {
    /// All that answered, by id.
    pub found: Vec<FoundServo>,
    /// Expected and silent.
    pub missing: Vec<ExpectedServo>,
    /// Answered and not expected.
    pub unexpected: Vec<FoundServo>,
    /// Expected, but something else has its id.
    pub wrong_model: Vec<WrongModel>,
    /// Ids that answer twice at a time or never without a collision: probably two servos each.
    pub duplicates_suspected: Vec<u8>,
}

impl BusScan {
    /// Whether everything expected is there, once, and of the right model.
    pub fn is_complete(&self) -> bool {
        self.missing.is_empty() && self.wrong_model.is_empty() && self.duplicates_suspected.is_empty()
    }

    /// What is wrong and what to do, a sentence each.
    pub fn problems(&self) -> Vec<String> {
        let mut problems = vec![];
        for id in &self.duplicates_suspected {
            problems.push(format!(
                "two servos seem to have the id {id}: connect one of them alone and give it another id"
            ));
        }
        if !self.missing.is_empty() {
            let names: Vec<String> =
                self.missing.iter().map(|s| format!("{} (id {})", s.title, s.id)).collect();
            problems.push(format!(
                "no answer from {}: check their cables and power, they stay out of use until then",
                names.join(", ")
            ));
        }
        for wrong in &self.wrong_model {
            problems.push(format!(
                "{} (id {}) should be a {} but is {}: correct the rig file or exchange the servo",
                wrong.expected.title, wrong.expected.id, wrong.expected.model, wrong.found
            ));
        }
        for found in &self.unexpected {
            problems.push(format!("servo {found} is not in the rig file: it is left alone"));
        }
        problems
    }
}

/// Which ids are asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScanRange {
    /// Those expected: fast.
    Expected,
    /// All there can be: takes seconds.
    All,
}

/// Registers 0 to 2: model number and firmware.
const IDENTITY_BYTES: u16 = 3;
const ATTEMPTS: u32 = 3;
/// The margin for an answer is shorter than this.
const LONG: Duration = Duration::from_millis(100);

/// What one id answered.
pub(crate) enum Answer {
    /// Nothing.
    Silent,
    /// Who it is.
    Found(FoundServo),
    /// Two at once, it seems.
    Collision,
}

impl BusScan {
    fn note(&mut self, id: u8, expected: Option<&ExpectedServo>, answer: Answer) {
        match answer {
            Answer::Silent => self.missing.extend(expected.cloned()),
            Answer::Collision => self.duplicates_suspected.push(id),
            Answer::Found(found) => {
                match expected {
                    None => self.unexpected.push(found.clone()),
                    Some(expected) if !found.is_model(&expected.model) => {
                        self.wrong_model
                            .push(WrongModel { expected: expected.clone(), found: found.clone() });
                    }
                    Some(_) => {}
                }
                self.found.push(found);
            }
        }
    }
}

impl Bus {
    /// Asks who is there. Only reads.
    ///
    /// # Errors
    /// When the port is gone.
    pub fn scan(&mut self, expected: &[ExpectedServo], range: ScanRange) -> Result<BusScan, BusError> {
        let mut scan = BusScan::default();
        let ids: Vec<u8> = match range {
            ScanRange::Expected => expected.iter().map(|servo| servo.id).collect(),
            ScanRange::All => (0..=LARGEST_ID).collect(),
        };
        let late = |bus: &Self, id: u8| {
            bus.counts().by_servo.get(&id).map_or(0, |counts| counts.of(FaultKind::Late))
        };
        let before: Vec<u64> = ids.iter().map(|id| late(self, *id)).collect();
        let mut silent = vec![];
        for (id, before) in ids.into_iter().zip(before) {
            let expected = expected.iter().find(|servo| servo.id == id);
            match self.identify(id, expected.is_some())? {
                Answer::Silent if expected.is_none() => silent.push((id, before)),
                answer => scan.note(id, expected, answer),
            }
        }
        // Who was taken for absent, and answered after all, is asked once more.
        for (id, before) in silent {
            if late(self, id) > before {
                let answer = self.identify(id, true)?;
                scan.note(id, None, answer);
            }
        }
        Ok(scan)
    }

    /// Reads the model of an id, in one attempt: the inner error is the servo's fault.
    pub(crate) fn identify_once(
        &mut self,
        id: u8,
        deadline: Instant,
    ) -> Result<Result<FoundServo, FaultKind>, BusError> {
        let instruction = Instruction::Read { address: 0, length: IDENTITY_BYTES };
        let answer = self.ask_once(id, &instruction, Some(usize::from(IDENTITY_BYTES)), deadline)?;
        Ok(answer.map(|status| FoundServo::of(id, &status.data)))
    }

    /// Reads the model of an id. Two servos with one id answer at once: their bytes collide, or
    /// come twice, again and again; once may be noise, or an answer that comes late.
    pub(crate) fn identify(&mut self, id: u8, expected: bool) -> Result<Answer, BusError> {
        let instruction = Instruction::Read { address: 0, length: IDENTITY_BYTES };
        let (mut broken, mut doubled, mut attempt) = (0, 0, 0);
        loop {
            attempt += 1;
            self.be_patient(expected);
            let answer =
                self.ask_once(id, &instruction, Some(usize::from(IDENTITY_BYTES)), Instant::now() + LONG);
            self.be_patient(false);
            match answer? {
                Ok(status) if !self.another_answer(id)? => {
                    return Ok(Answer::Found(FoundServo::of(id, &status.data)));
                }
                Ok(_) => doubled += 1,
                Err(FaultKind::Missing | FaultKind::Late | FaultKind::WrongId) => {}
                Err(FaultKind::Cut | FaultKind::Garbled | FaultKind::Checksum | FaultKind::Refused) => {
                    broken += 1
                }
            }
            if doubled + broken >= ATTEMPTS {
                return Ok(Answer::Collision);
            }
            // Where something was heard it is worth asking again, expected or not.
            let attempts = if expected || doubled + broken > 0 { 2 * ATTEMPTS - 1 } else { 1 };
            let nothing_heard = doubled + broken == 0 && attempt >= ATTEMPTS;
            if attempt >= attempts || nothing_heard {
                return Ok(if doubled + broken >= 2 { Answer::Collision } else { Answer::Silent });
            }
        }
    }
}
