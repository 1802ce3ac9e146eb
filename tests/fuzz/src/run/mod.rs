//! Running cases: which there are, how they are watched, what comes of them.

mod case;
mod find;
mod parent;
mod table;
mod worker;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Duration;

pub use case::{Staged, stage};
pub use parent::{replay, run};
use strum::{EnumString, IntoStaticStr, VariantArray};
pub use worker::work;

use crate::readers::Reader;

/// What came of a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "lowercase")]
pub enum Verdict {
    /// The input was taken.
    Accepted,
    /// It was refused with a message.
    Refused,
    /// An answer or a message that must not be given.
    Fault,
    /// A panic, wherever it was caught.
    Panic,
    /// The process ended: an overflow of the stack, an abort, a signal.
    Abort,
    /// No answer in time.
    Hang,
    /// More memory was asked for than allowed.
    Memory,
}

impl Verdict {
    /// In the order of the table.
    pub const ALL: &'static [Self] = Self::VARIANTS;

    /// Whether it is a defect.
    pub fn is_finding(self) -> bool {
        !matches!(self, Self::Accepted | Self::Refused)
    }

    /// Name in the table and between the processes.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The one of this name.
    pub fn of_name(name: &str) -> Option<Self> {
        name.parse().ok()
    }
}

/// A run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Program that runs cases when it is started as a worker: this one.
    pub program: PathBuf,
    /// Cases over all readers.
    pub cases: u64,
    /// Another seed, other cases.
    pub seed: u64,
    /// Processes at once.
    pub workers: usize,
    /// Longest time for one input.
    pub patience: Duration,
    /// Memory that a worker may take, bytes.
    pub memory: u64,
    /// Only readers whose name holds this.
    pub only: String,
    /// Receives findings, a folder each; they are forgotten where there is none.
    pub keep: Option<PathBuf>,
    /// Whether to say how far it is, on standard error.
    pub tell: bool,
}

impl Options {
    /// The usual limits: 10 s and 2 GB.
    pub fn new(program: PathBuf, cases: u64, seed: u64) -> Self {
        Self {
            program,
            cases,
            seed,
            workers: std::thread::available_parallelism().map_or(2, usize::from),
            patience: Duration::from_secs(10),
            memory: 2_000_000_000,
            only: String::new(),
            keep: None,
            tell: false,
        }
    }
}

/// A case that is a defect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// Name of the reader.
    pub reader: String,
    /// Number of the case.
    pub index: u64,
    /// What came of it.
    pub verdict: Verdict,
    /// What was done to which file.
    pub change: String,
    /// What was said.
    pub said: String,
}

/// What came of the cases of a reader.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// How often.
    pub counts: BTreeMap<Verdict, u64>,
    /// The longest case.
    pub slowest: Duration,
    /// Its number.
    pub slowest_index: u64,
    /// All of them together.
    pub time: Duration,
}

/// What came of a run.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    /// By reader.
    pub tallies: BTreeMap<String, Tally>,
    /// The defects, the first hundred of each reader.
    pub findings: Vec<Finding>,
    /// Why readers were not run, and what is wrong with the seeds.
    pub not_run: Vec<String>,
    /// How long it took.
    pub time: Duration,
}

impl Summary {
    /// Cases with this outcome.
    pub fn count(&self, verdict: Verdict) -> u64 {
        self.tallies.values().filter_map(|tally| tally.counts.get(&verdict)).sum()
    }

    /// All cases.
    pub fn cases(&self) -> u64 {
        Verdict::ALL.iter().map(|verdict| self.count(*verdict)).sum()
    }

    /// Cases that are defects.
    pub fn defects(&self) -> u64 {
        Verdict::ALL.iter().filter(|verdict| verdict.is_finding()).map(|verdict| self.count(*verdict)).sum()
    }
}

/// How many cases each reader gets, by its weight; every one gets one.
pub fn shares(readers: &[Reader], cases: u64) -> Vec<u64> {
    let total: u64 = readers.iter().map(|reader| u64::from(reader.weight)).sum();
    readers.iter().map(|reader| (cases * u64::from(reader.weight)).div_ceil(total.max(1)).max(1)).collect()
}
