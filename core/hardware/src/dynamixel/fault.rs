//! What can go wrong between the host and one servo, counted.

use std::collections::BTreeMap;
use std::fmt;

/// Why an answer is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub enum FaultKind {
    /// Nothing came.
    Missing,
    /// It came after its time was over; it was counted as missing before.
    Late,
    /// It began and did not end.
    Cut,
    /// Bytes that are no packet, or a packet that is not the answer.
    Garbled,
    /// Its check was wrong.
    Checksum,
    /// Another servo answered.
    WrongId,
    /// The servo says that the host's bytes arrived broken.
    Refused,
}

impl FaultKind {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Missing, Self::Late, Self::Cut, Self::Garbled, Self::Checksum, Self::WrongId, Self::Refused];

    fn place(self) -> usize {
        self as usize
    }
}

impl fmt::Display for FaultKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Missing => "no answer",
            Self::Late => "late answer",
            Self::Cut => "answer cut short",
            Self::Garbled => "garbled answer",
            Self::Checksum => "answer with a wrong checksum",
            Self::WrongId => "answer from another servo",
            Self::Refused => "instruction arrived broken",
        })
    }
}

/// How often what went wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaultCounts([u64; FaultKind::ALL.len()]);

impl FaultCounts {
    /// How often one kind.
    pub fn of(&self, kind: FaultKind) -> u64 {
        self.0[kind.place()]
    }

    /// Of all kinds together.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    pub(crate) fn add(&mut self, kind: FaultKind) {
        self.0[kind.place()] += 1;
    }
}

impl fmt::Display for FaultCounts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> = FaultKind::ALL
            .into_iter()
            .filter(|kind| self.of(*kind) > 0)
            .map(|kind| format!("{} × {kind}", self.of(kind)))
            .collect();
        if parts.is_empty() { f.write_str("no faults") } else { f.write_str(&parts.join(", ")) }
    }
}

/// What happened on a bus since it was opened.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BusCounts {
    /// Answers that were right.
    pub answers: u64,
    /// Bytes that belonged to nothing.
    pub stray_bytes: u64,
    /// Times the own bytes came back (an adapter that echoes); they are ignored.
    pub echoes: u64,
    /// Answers that were asked for once more.
    pub retries: u64,
    /// Faults of all servos.
    pub faults: FaultCounts,
    /// Faults by servo.
    pub by_servo: BTreeMap<u8, FaultCounts>,
}

impl BusCounts {
    pub(crate) fn fault(&mut self, id: u8, kind: FaultKind) {
        self.faults.add(kind);
        self.by_servo.entry(id).or_default().add(kind);
    }
}
