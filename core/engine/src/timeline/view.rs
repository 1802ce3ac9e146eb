//! The timeline of results, for the window.

use std::sync::Arc;

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

/// Everything that was put in use, taken back, found or checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimelineView {
    /// Whether what was kept has been read.
    pub is_known: bool,
    /// Oldest first.
    pub entries: Arc<[TimelineEntry]>,
    /// What is in use now, one per kind of result, in the order of work.
    pub in_use: Arc<[InUseNow]>,
}

/// A kind of result of which one is in use at a time, or of which there are many.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Subject {
    /// Lenses, and how the eyes sit to each other.
    Eyes,
    /// How the eyes sit in the head.
    Mount,
    /// Where the touchscreen lies.
    Screen,
    /// The correction model.
    Correction,
    /// Effects in the model of the robot.
    Effects,
    /// What a search for effects found, whether it was added or not.
    Finding,
    /// Touches at new targets.
    Check,
    /// Touches to learn from.
    Touches,
    /// Touches that a finding suggested.
    Experiment,
    /// Whether the calibration of the eyes still holds.
    Health,
    /// A thing at known places of the table, as the eyes see it.
    Places,
    /// An experiment with grasps.
    Grasps,
    /// Detectors that were judged.
    Detectors,
}

impl Subject {
    /// Those of which one is in use at a time, in the order of work.
    pub const IN_USE: [Self; 5] = [Self::Eyes, Self::Mount, Self::Screen, Self::Correction, Self::Effects];

    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Eyes => "Eyes",
            Self::Mount => "Mount",
            Self::Screen => "Screen",
            Self::Correction => "Correction model",
            Self::Effects => "Robot model",
            Self::Finding => "Finding",
            Self::Check => "Check",
            Self::Touches => "Touches",
            Self::Experiment => "Experiment",
            Self::Health => "Health of the eyes",
            Self::Places => "Places on the table",
            Self::Grasps => "Grasps",
            Self::Detectors => "Detectors",
        }
    }
}

/// What happened to a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EntryKind {
    /// It was put in use.
    PutInUse,
    /// What was in use before is in use again.
    TakenBack,
    /// It was in use already when the timeline began.
    Found,
    /// Something was measured; nothing was put in use.
    Measured,
}

/// An error with its unit, or what came out well of all.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Figure {
    /// A length, m.
    Meters(f64),
    /// Pixels.
    Pixels(f64),
    /// The share that came out well, 0 to 1: no error, more of it is better.
    Share(f64),
}

impl Figure {
    /// The number, m, px or a share of 1.
    pub fn value(self) -> f64 {
        match self {
            Self::Meters(value) | Self::Pixels(value) | Self::Share(value) => value,
        }
    }

    /// Whether two can be compared.
    pub fn is_like(self, other: Self) -> bool {
        std::mem::discriminant(&self) == std::mem::discriminant(&other)
    }

    /// Whether it is a smaller error, or a larger share, than one that it can be compared with.
    pub fn is_better_than(self, other: Self) -> bool {
        let (mine, others) = (self.value(), other.value());
        self.is_like(other) && if matches!(self, Self::Share(_)) { mine > others } else { mine < others }
    }
}

/// Something on the line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimelineEntry {
    /// Counts up; no two have the same.
    pub number: u64,
    /// When.
    pub at: Timestamp,
    /// Of which kind.
    pub subject: Subject,
    /// What happened.
    pub kind: EntryKind,
    /// What it is, for people: "calibration of 31 pairs".
    pub title: String,
    /// The error before; `None`: not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub before: Option<Figure>,
    /// The error after.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after: Option<Figure>,
    /// What these are errors of, and on what: a sentence without its period.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub basis: String,
    /// What was in use before: its id in its workflow; `None`: nothing, as the description has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id_before: Option<String>,
    /// What is in use since, or the id of what was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id_after: Option<String>,
    /// Whether this program was closed when it happened: another one, or the command line, did it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub outside: bool,
    /// Whether it was a step back by Undo: what it took back counts as if it had never been in use.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub by_undo: bool,
}

/// What is in use of a kind.
#[derive(Clone, Debug, PartialEq)]
pub struct InUseNow {
    /// Which kind.
    pub subject: Subject,
    /// What it is, for people.
    pub title: String,
    /// Its error.
    pub figure: Option<Figure>,
    /// Since when, if that is on the line.
    pub since: Option<Timestamp>,
    /// Number of the entry since which it is in use.
    pub entry: Option<u64>,
    /// What speaks against it, whole sentences; empty where nothing does.
    pub against: String,
}

impl TimelineView {
    /// An entry by its number.
    pub fn entry(&self, number: u64) -> Option<&TimelineEntry> {
        self.entries.iter().find(|entry| entry.number == number)
    }

    /// Whether an entry is the last change of what is in use of its kind, so that it can be taken back.
    pub fn is_newest(&self, entry: &TimelineEntry) -> bool {
        self.in_use.iter().any(|now| now.subject == entry.subject && now.entry == Some(entry.number))
    }
}
