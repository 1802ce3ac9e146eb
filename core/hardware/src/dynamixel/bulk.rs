//! Many servos asked in one conversation.

use std::time::Instant;

use super::bus::{Bus, Ended};
use super::deframer::Found;
use super::error::BusError;
use super::fault::FaultKind;
use super::instruction::{BROADCAST, BulkItem, Instruction};
use super::packet::{self, Status};

impl Bus {
    /// Reads registers of many servos in one conversation. What did not come is a fault, counted;
    /// nothing is repeated.
    pub(crate) fn bulk_read(
        &mut self,
        items: &[BulkItem],
        deadline: Instant,
    ) -> Result<Vec<Result<Status, FaultKind>>, BusError> {
        let mut answers: Vec<Result<Status, FaultKind>> =
            items.iter().map(|_| Err(FaultKind::Missing)).collect();
        if items.is_empty() {
            return Ok(answers);
        }
        self.drain()?;
        self.send(BROADCAST, &Instruction::BulkRead { items: items.to_vec() })?;
        let mut open = items.len();
        // What is known of the one whose turn it was when nothing came any more.
        let mut told = None;
        while open > 0 {
            let longest = items.iter().map(|item| usize::from(item.length)).max().unwrap_or(0);
            let until = deadline.min(Instant::now() + self.answer_time(longest));
            let found = match self.next_found(until) {
                Ok(found) => found,
                Err(Ended::Bus(error)) => {
                    self.rescued = answers.into_iter().filter_map(Result::ok).collect();
                    return Err(error);
                }
                Err(Ended::TimeOver) => {
                    // The one whose turn it was is at fault; those behind it wait for it.
                    if self.deframer.clear() > 0 {
                        told = told.or(Some(FaultKind::Cut));
                    }
                    let first = answers.iter_mut().find(|answer| matches!(answer, Err(FaultKind::Missing)));
                    if let (Some(kind), Some(first)) = (told, first) {
                        *first = Err(kind);
                    }
                    break;
                }
            };
            let place = |id: u8| items.iter().position(|item| item.id == id);
            match found {
                Found::Garbage(bytes) => {
                    self.counts.stray_bytes += bytes as u64;
                    told = told.or(Some(FaultKind::Garbled));
                }
                Found::WrongCheck { id } => {
                    if let Some(i) = place(id).filter(|i| answers[*i].is_err()) {
                        answers[i] = Err(FaultKind::Checksum);
                    }
                }
                Found::Frame(frame) => {
                    let status = packet::decode_status(&frame);
                    let Some(i) = place(status.id).filter(|i| answers[*i].is_err()) else {
                        if !self.strange(status.id) {
                            told = Some(FaultKind::WrongId);
                        }
                        continue;
                    };
                    self.wire.answers += 1;
                    answers[i] = match status {
                        status if status.error.is_transmission() => Err(FaultKind::Refused),
                        status if status.data.len() == usize::from(items[i].length) => Ok(status),
                        _ => Err(FaultKind::Garbled),
                    };
                    open -= 1;
                }
            }
        }
        self.wire.turnarounds += 1;
        for (item, answer) in items.iter().zip(&answers) {
            match answer {
                Ok(_) => self.count_answer(),
                Err(kind) => {
                    self.counts.fault(item.id, *kind);
                    self.owed.push(item.id);
                }
            }
        }
        Ok(answers)
    }
}
