//! What the timeline is handed by the state: what is in use, and what was measured.

use jiff::Timestamp;

use super::view::{Figure, Subject};

/// What the timeline can see of the rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimelineAround {
    /// Name of the robot.
    pub rig: String,
    /// Whether it is the twin.
    pub is_twin: bool,
    /// What is in use, of those kinds of which that is known already.
    pub in_use: Vec<Standing>,
    /// What was seen of something in use since, and speaks against it; a sentence each.
    pub against: Vec<(Subject, String)>,
    /// Findings that were kept, in any order.
    pub findings: Vec<Finding>,
    /// What else was measured and is shown in its workflow, oldest first.
    pub measured: Vec<Measured>,
}

/// What is in use of a kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Standing {
    /// Which kind.
    pub subject: Subject,
    /// Tells it from every other one; `None`: nothing is, as the description has it.
    pub id: Option<String>,
    /// What it is, for people.
    pub title: String,
    /// The error without it on the same data, where that is known.
    pub before: Option<Figure>,
    /// Its error.
    pub after: Option<Figure>,
    /// What these are errors of.
    pub basis: String,
    /// When it was accepted, where its workflow keeps that.
    pub accepted: Option<Timestamp>,
}

/// What a search for effects found.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Its id.
    pub id: String,
    /// When it was made.
    pub made: Timestamp,
    /// What was named, for people.
    pub title: String,
    /// Error before.
    pub before: Figure,
    /// Error after, with what was named.
    pub after: Figure,
}

/// What was measured without anything being put in use.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Of which kind.
    pub subject: Subject,
    /// Tells it from every other one of its kind: the name of its session.
    pub id: String,
    /// When, where its workflow keeps that.
    pub at: Option<Timestamp>,
    /// What it is, for people.
    pub title: String,
    /// The error before, on the same data.
    pub before: Option<Figure>,
    /// The error.
    pub after: Figure,
    /// What these are errors of, and on what.
    pub basis: String,
}
