//! What passes over the line: bytes sent, packets found in those that come, echoes, and what nobody waits for.

use std::io::{self, Read as _, Write as _};
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use super::{Bus, Ended};
use crate::dynamixel::deframer::Found;
use crate::dynamixel::error::BusError;
use crate::dynamixel::fault::FaultKind;
use crate::dynamixel::instruction::Instruction;
use crate::dynamixel::packet::{self, Status};

/// Longest single wait for bytes: how late a pressed stop is noticed.
const SLICE: Duration = Duration::from_millis(1);

/// The margin for answers grows to this many times the usual one.
const MOST_MARGINS: u32 = 5;

/// An answer that was given up is waited for no longer than this where it would do harm.
const OWED: Duration = Duration::from_millis(60);

/// What nobody waits for is taken off the line for no longer than this: whoever floods the line
/// must not keep anything from being said, the stop least of all.
const DRAIN: Duration = Duration::from_millis(3);

impl Bus {
    pub(in crate::dynamixel) fn send(&mut self, id: u8, instruction: &Instruction) -> Result<(), BusError> {
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

    pub(super) fn await_answer(
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
    pub(in crate::dynamixel) fn strange(&mut self, id: u8) -> bool {
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
    pub(in crate::dynamixel) fn next_found(&mut self, until: Instant) -> Result<Found, Ended> {
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
    pub(in crate::dynamixel) fn drain(&mut self) -> Result<(), BusError> {
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
