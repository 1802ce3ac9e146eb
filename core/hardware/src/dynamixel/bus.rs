//! The host's side of a servo bus: asks, waits no longer than allowed, and counts what goes wrong.
//!
//! Reading is public. Everything that writes to a servo is private to this crate: what moves a
//! joint goes through [`crate::joints`], which guards it.

use std::io::{self, Read as _, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use plumbline_model::duration;

use super::deframer::{Deframer, Found};
use super::error::BusError;
use super::fault::{BusCounts, FaultKind};
use super::instruction::{BROADCAST, Instruction};
use super::packet::{self, Status};
use super::port::ServoPort;
use super::wire_time::WireTime;

/// Longest single wait for bytes: how late a pressed stop is noticed.
const SLICE: Duration = Duration::from_millis(1);

/// The margin for answers grows to this many times the usual one.
const MOST_MARGINS: u32 = 5;
/// Share of the surplus by which it shrinks again with every answer.
const MARGIN_DECAY: u32 = 512;

/// Margin for an answer when patient.
const PATIENCE: Duration = Duration::from_millis(40);

/// An answer that was given up is waited for no longer than this where it would do harm.
const OWED: Duration = Duration::from_millis(60);

/// What nobody waits for is taken off the line for no longer than this: whoever floods the line
/// must not keep anything from being said, the stop least of all.
const DRAIN: Duration = Duration::from_millis(3);

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
        let instruction = Instruction::Write { address, data: data.to_vec() };
        Ok(self.ask_once(id, &instruction, Some(0), self.far())?.is_ok())
    }

    /// Waits for answers of a servo that were given up and may still come, so that they are not
    /// taken for newer ones.
    pub(crate) fn await_owed(&mut self, id: u8) -> Result<(), BusError> {
        let end = Instant::now() + OWED;
        while self.owed.contains(&id) && Instant::now() < end {
            self.drain()?;
            if self.owed.contains(&id) {
                self.receive(SLICE)?;
                self.take_strays();
            }
        }
        self.owed.retain(|owed| *owed != id);
        Ok(())
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

    /// What is asked now and then, not in every cycle, may wait longer on a busy machine.
    pub(crate) fn be_patient(&mut self, patient: bool) {
        self.patient = patient;
    }

    fn await_answer(
        &mut self,
        id: u8,
        length: Option<usize>,
        until: Instant,
    ) -> Result<Result<Status, FaultKind>, BusError> {
        let mut worst = None;
        loop {
            let found = match self.next_found(until) {
                Ok(found) => found,
                Err(Ended::Bus(error)) => return Err(error),
                Err(Ended::TimeOver) => {
                    let cut = self.deframer.clear() > 0;
                    let silent = if cut { FaultKind::Cut } else { FaultKind::Missing };
                    return Ok(Err(worst.unwrap_or(silent)));
                }
            };
            match found {
                Found::Garbage(bytes) => {
                    self.counts.stray_bytes += bytes as u64;
                    worst = worst.or(Some(FaultKind::Garbled));
                }
                Found::WrongCheck { .. } => return Ok(Err(FaultKind::Checksum)),
                Found::Frame(frame) => {
                    let status = packet::decode_status(&frame);
                    if status.id != id {
                        if !self.strange(status.id) {
                            worst = Some(FaultKind::WrongId);
                        }
                        continue;
                    }
                    self.wire.answers += 1;
                    if status.error.is_transmission() {
                        return Ok(Err(FaultKind::Refused));
                    }
                    // Every question of a cycle has its own length, so that a late answer to
                    // another one is never taken for this one.
                    if length.is_some_and(|length| length != status.data.len()) {
                        worst = Some(FaultKind::Garbled);
                        continue;
                    }
                    return Ok(Ok(status));
                }
            }
        }
    }

    /// An answer of `id` that nobody waits for: late when it had been given up. Returns whether.
    pub(super) fn strange(&mut self, id: u8) -> bool {
        let late = self.owed.iter().position(|owed| *owed == id);
        if let Some(i) = late {
            self.owed.swap_remove(i);
            self.counts.fault(id, FaultKind::Late);
            // A machine that is busy now is busy for a while.
            self.margin = (self.margin * 2).min(self.timing.answer_margin * MOST_MARGINS);
        }
        late.is_some()
    }

    /// Next packet or garbage, until `until`.
    pub(super) fn next_found(&mut self, until: Instant) -> Result<Found, Ended> {
        loop {
            if self.echo.is_empty()
                && let Some(found) = self.deframer.pop()
            {
                return Ok(found);
            }
            if self.stop.as_ref().is_some_and(|stop| stop.load(Ordering::Acquire)) {
                return Err(Ended::Bus(BusError::Interrupted));
            }
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                // Who got no processor for a while finds the answer there that came meanwhile.
                if !std::mem::replace(&mut self.looked_late, true)
                    && self.receive(Duration::ZERO).map_err(Ended::Bus)? > 0
                {
                    continue;
                }
                // Bytes that looked like the beginning of an echo were none.
                if self.echo.is_empty() || self.deframer.pending() == 0 {
                    return Err(Ended::TimeOver);
                }
                self.echo.clear();
                continue;
            }
            self.receive(left.min(SLICE)).map_err(Ended::Bus)?;
        }
    }

    /// Takes what is there within `wait` into the deframer, without echoes. Returns how much.
    fn receive(&mut self, wait: Duration) -> Result<usize, BusError> {
        let mut buffer = [0; 512];
        let gone = |name, detail: String| BusError::PortGone { port: name, detail };
        self.port.set_read_timeout(wait).map_err(|error| gone(self.port.name(), error.to_string()))?;
        let bytes = match self.port.read(&mut buffer) {
            Ok(0) => return Err(gone(self.port.name(), "the other end closed it".to_owned())),
            Ok(bytes) => bytes,
            Err(error) if matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock) => 0,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => 0,
            Err(error) => return Err(gone(self.port.name(), error.to_string())),
        };
        self.wire.bytes_in += bytes as u64;
        self.deframer.push(&buffer[..bytes]);
        if !self.echo.is_empty() && bytes > 0 && self.deframer.strip_echo(&mut self.echo) {
            self.counts.echoes += 1;
        }
        Ok(bytes)
    }

    /// Takes what nobody waits for any more: late answers, echoes of what has no answer.
    pub(super) fn drain(&mut self) -> Result<(), BusError> {
        let end = Instant::now() + DRAIN;
        while self.receive(Duration::ZERO)? > 0 && Instant::now() < end {}
        self.echo.clear();
        self.take_strays();
        self.counts.stray_bytes += self.deframer.clear() as u64;
        Ok(())
    }

    /// Packets that nobody waits for.
    fn take_strays(&mut self) {
        while let Some(found) = self.deframer.pop() {
            match found {
                Found::Garbage(bytes) => self.counts.stray_bytes += bytes as u64,
                Found::WrongCheck { .. } => {}
                Found::Frame(frame) => {
                    if !self.strange(frame.id) {
                        self.counts.stray_bytes += packet::status_bytes(frame.data.len()) as u64;
                    }
                }
            }
        }
    }

    pub(super) fn send(&mut self, id: u8, instruction: &Instruction) -> Result<(), BusError> {
        let bytes = packet::encode_instruction(id, instruction)?;
        let sent = self.port.write_all(&bytes).and_then(|()| self.port.flush());
        sent.map_err(|error| BusError::PortGone { port: self.port.name(), detail: error.to_string() })?;
        self.wire.bytes_out += bytes.len() as u64;
        self.looked_late = false;
        self.echo = bytes;
        if self.owed.len() > 64 {
            self.owed.clear();
        }
        Ok(())
    }

    /// Lets answers that are on their way come in, so that what is sent next does not collide with
    /// them: until the line is quiet for 1 ms, at most `longest`. Returns them, with those that had
    /// come when the conversation was interrupted: they tell where the joints are now.
    pub(crate) fn let_come(&mut self, longest: Duration) -> Result<Vec<Status>, BusError> {
        let end = Instant::now() + longest;
        while self.receive(SLICE)? > 0 && Instant::now() < end {}
        let mut answers = std::mem::take(&mut self.rescued);
        while let Some(found) = self.deframer.pop() {
            if let Found::Frame(frame) = found {
                answers.extend(Some(packet::decode_status(&frame)).filter(|it| !it.error.is_transmission()));
            }
        }
        self.deframer.clear();
        self.echo.clear();
        Ok(answers)
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
