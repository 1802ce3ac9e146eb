//! What commissioning can see of the rest.

use std::path::PathBuf;

use super::view::CommissionDone;
use crate::touch::RunStanding;

/// Something that was made, and is in use.
pub type Made = Option<CommissionDone>;

/// What the workflow can see of the rest.
#[derive(Clone, Debug, Default)]
pub struct CommissionAround {
    /// The calibration of the eyes.
    pub eyes: Made,
    /// How they sit in the head.
    pub mount: Made,
    /// Where the screen lies.
    pub screen: Made,
    /// The run of touches that is under way or shown.
    pub run: Option<RunStanding>,
    /// The finding that is shown.
    pub found: Option<Found>,
    /// Named effects in the model in use.
    pub effects: InUse,
    /// What the arms were tied to the eyes by.
    pub hands: Made,
    /// The newest grasp that the operator saw to be good.
    pub held: Made,
    /// Views of the board that were kept: pairs of the eyes, and views of the head.
    pub views: usize,
}

/// Named effects in the model in use.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InUse {
    /// Their names, for keeping.
    pub names: Vec<String>,
    /// The same for people.
    pub told: Vec<String>,
}

/// How the search for effects stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Folders of the sessions that were looked at.
    pub sessions: Vec<PathBuf>,
    /// Whether something was found that the model in use has not.
    pub is_open: bool,
    /// What came of it, once nothing is open.
    pub done: CommissionDone,
}
