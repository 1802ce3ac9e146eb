//! The host's side of a servo bus: asks, waits no longer than allowed, and counts what goes wrong.
//!
//! Reading is public. Everything that writes to a servo is private to this crate: what moves a
//! joint goes through [`crate::joints`], which guards it.

mod line;

use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use plumbline_model::duration;

use super::deframer::{Deframer, Found};
use super::error::BusError;
use super::fault::{BusCounts, FaultKind};
use super::instruction::{BROADCAST, Instruction};
use super::packet::{self, Status};
use super::port::ServoPort;
use super::status_error::StatusError;
use super::wire_time::WireTime;

/// Share of the surplus of the margin for answers by which it shrinks again with every answer.
const MARGIN_DECAY: u32 = 512;

/// Margin for an answer when patient.
const PATIENCE: Duration = Duration::from_millis(40);

/// Timing of a bus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BusTiming {
    /// Bits per second.
    pub baud: u32,
    /// How long an answer may take beyond its time on the wire: return delay, USB, other
    /// programs on the machine. Grows by itself while answers come late, up to five times this.
    pub answer_margin: Duration,
    /// Attempts per answer, the first included.
    pub attempts: u32,
}

impl Default for BusTiming {
    fn default() -> Self {
        Self { baud: 1_000_000, answer_margin: Duration::from_millis(8), attempts: 3 }
    }
}

/// A bus with servos on it.
pub struct Bus {
    port: Box<dyn ServoPort>,
    timing: BusTiming,
    pub(super) deframer: Deframer,
    pub(super) wire: WireTime,
    pub(super) counts: BusCounts,
    /// Sent bytes that an echoing adapter may send back.
    echo: Vec<u8>,
    /// Servos whose answers were given up and may still come.
    pub(super) owed: Vec<u8>,
    /// Answers that had come when a conversation was interrupted.
    pub(super) rescued: Vec<Status>,
    stop: Option<std::sync::Arc<AtomicBool>>,
    /// The line was looked at once more after the time of this question was over.
    looked_late: bool,
    patient: bool,
    /// The margin for answers now.
    margin: Duration,
}

/// Why a wait ended without what it waited for.
pub(super) enum Ended {
    TimeOver,
    Bus(BusError),
}

impl Bus {
    /// A bus on an open port.
    pub fn new(port: Box<dyn ServoPort>, timing: BusTiming) -> Self {
        Self {
            port,
            timing,
            deframer: Deframer::default(),
            wire: WireTime::default(),
            counts: BusCounts::default(),
            echo: vec![],
            owed: vec![],
            rescued: vec![],
            stop: None,
            looked_late: false,
            patient: false,
            margin: timing.answer_margin,
        }
    }

    /// Name of its port.
    pub fn port_name(&self) -> String {
        self.port.name()
    }

    /// Its timing.
    pub fn timing(&self) -> &BusTiming {
        &self.timing
    }

    /// What passed over the wire so far.
    pub fn wire(&self) -> WireTime {
        self.wire
    }

    /// What went right and wrong so far.
    pub fn counts(&self) -> &BusCounts {
        &self.counts
    }

    /// While `stop` is set every wait ends early with [`BusError::Interrupted`].
    pub(crate) fn interrupt_on(&mut self, stop: Option<std::sync::Arc<AtomicBool>>) {
        self.stop = stop;
    }

    /// Asks whether a servo is there.
    ///
    /// # Errors
    /// When it does not answer rightly.
    pub fn ping(&mut self, id: u8) -> Result<Status, BusError> {
        self.ask(id, &Instruction::Ping, None, self.far())
    }

    /// Reads `length` bytes from `address` on.
    ///
    /// # Errors
    /// When the servo does not answer rightly in any attempt.
    pub fn read(&mut self, id: u8, address: u16, length: u16) -> Result<Status, BusError> {
        self.read_before(id, address, length, self.far())
    }

    /// The same, giving up at `deadline`.
    pub(crate) fn read_before(
        &mut self,
        id: u8,
        address: u16,
        length: u16,
        deadline: Instant,
    ) -> Result<Status, BusError> {
        self.ask(id, &Instruction::Read { address, length }, Some(usize::from(length)), deadline)
    }

    /// Writes bytes from `address` on and waits for the servo's confirmation.
    pub(crate) fn write(&mut self, id: u8, address: u16, data: &[u8]) -> Result<Status, BusError> {
        let instruction = Instruction::Write { address, data: data.to_vec() };
        // A late answer to a question must not be taken for the confirmation.
        self.ask(id, &instruction, Some(0), self.far())
    }

    /// The same in a single attempt; returns whether it was confirmed. For what must not be said
    /// once more without looking: between two attempts a servo may have lost its power and sunk.
    pub(crate) fn write_once(&mut self, id: u8, address: u16, data: &[u8]) -> Result<bool, BusError> {
        Ok(self.write_told(id, address, data)?.is_some())
    }

    /// The same, with what the servo complains about; `None`: it was not confirmed.
    pub(crate) fn write_told(
        &mut self,
        id: u8,
        address: u16,
        data: &[u8],
    ) -> Result<Option<StatusError>, BusError> {
        let instruction = Instruction::Write { address, data: data.to_vec() };
        let answered = self.ask_once(id, &instruction, Some(0), self.far())?;
        Ok(answered.ok().map(|status| status.error))
    }

    /// Writes the same registers of many servos at once. Nobody answers.
    pub(crate) fn sync_write(
        &mut self,
        address: u16,
        length: u16,
        data: Vec<(u8, Vec<u8>)>,
    ) -> Result<(), BusError> {
        if data.is_empty() {
            return Ok(());
        }
        self.drain()?;
        self.send(BROADCAST, &Instruction::SyncWrite { address, length, data })
    }

    /// Whether one more answer of `id` arrives though only one was asked for.
    pub(crate) fn another_answer(&mut self, id: u8) -> Result<bool, BusError> {
        let until = Instant::now() + Duration::from_millis(2);
        loop {
            match self.next_found(until) {
                Ok(Found::Frame(frame)) if frame.id == id => return Ok(true),
                Ok(_) => {}
                Err(Ended::TimeOver) => return Ok(false),
                Err(Ended::Bus(error)) => return Err(error),
            }
        }
    }

    pub(crate) fn count_retry(&mut self) {
        self.counts.retries += 1;
    }

    fn far(&self) -> Instant {
        Instant::now() + Duration::from_secs(1)
    }

    /// Time of an answer of `data` bytes on the wire, and the margin.
    pub(super) fn answer_time(&self, data: usize) -> Duration {
        let bytes = packet::status_bytes(data) as f64;
        let margin = self.margin.max(if self.patient { PATIENCE } else { Duration::ZERO });
        margin + duration::seconds(bytes * 10.0 / f64::from(self.timing.baud.max(1))).unwrap_or_default()
    }

    /// Sends, waits, and repeats until the answer is right, attempts are used up or `deadline` is
    /// over.
    fn ask(
        &mut self,
        id: u8,
        instruction: &Instruction,
        length: Option<usize>,
        deadline: Instant,
    ) -> Result<Status, BusError> {
        let mut kind = FaultKind::Missing;
        let mut attempts = 0;
        while attempts < self.timing.attempts.max(1) && (attempts == 0 || Instant::now() < deadline) {
            if attempts > 0 {
                self.counts.retries += 1;
            }
            attempts += 1;
            match self.ask_once(id, instruction, length, deadline)? {
                Ok(status) => return Ok(status),
                Err(fault) => kind = fault,
            }
        }
        Err(BusError::Servo { id, kind, attempts })
    }

    /// One attempt. The inner error is the servo's fault, counted; the outer one the bus's.
    pub(crate) fn ask_once(
        &mut self,
        id: u8,
        instruction: &Instruction,
        length: Option<usize>,
        deadline: Instant,
    ) -> Result<Result<Status, FaultKind>, BusError> {
        self.drain()?;
        self.send(id, instruction)?;
        let until = deadline.min(Instant::now() + self.answer_time(length.unwrap_or(0)));
        let answer = self.await_answer(id, length, until);
        self.wire.turnarounds += 1;
        match answer? {
            Ok(status) => {
                self.count_answer();
                Ok(Ok(status))
            }
            Err(kind) => {
                self.counts.fault(id, kind);
                if kind == FaultKind::Missing {
                    self.owed.push(id);
                }
                Ok(Err(kind))
            }
        }
    }

    pub(super) fn count_answer(&mut self) {
        self.counts.answers += 1;
        let surplus = self.margin.saturating_sub(self.timing.answer_margin);
        self.margin -= surplus / MARGIN_DECAY;
    }

    /// How many times longer than usual answers are waited for just now: 1 while none came late.
    pub(crate) fn patience(&self) -> f64 {
        let usual_s = self.timing.answer_margin.as_secs_f64();
        if usual_s > 0.0 { self.margin.as_secs_f64() / usual_s } else { 1.0 }
    }

    /// What is asked now and then, not in every cycle, may wait longer on a busy machine.
    pub(crate) fn be_patient(&mut self, patient: bool) {
        self.patient = patient;
    }
}

impl std::fmt::Debug for Bus {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bus")
            .field("port", &self.port.name())
            .field("counts", &self.counts)
            .finish_non_exhaustive()
    }
}
