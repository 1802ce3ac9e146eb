//! What really happened in an attempt, as its file has it. On the twin a judge looks; on the robot a person.

use plumbline_grasp::{Failure, Outcome, Record};
use serde::{Deserialize, Serialize};

use super::plan::Trial;

/// What really happened.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// Whether it was lifted.
    pub lifted: bool,
    /// Whether it was lifted by the first try.
    #[serde(default)]
    pub at_first: bool,
    /// Seen place less true place of the object over the table, m.
    pub camera_error_m: Option<f64>,
    /// Distance of the palm from where it was meant to be over the table, before the hand closed, by
    /// the place of the object that was seen, m.
    pub reach_error_m: Option<f64>,
    /// Distance of the palm from where it belongs, by the true place of the object, m.
    pub alignment_m: Option<f64>,
    /// The palm before the hand closed, less where it belongs by the true place of the object, robot
    /// axes, m.
    pub palm_off_m: Option<[f64; 3]>,
    /// Distance of the hand that was seen at last from where it truly was, over the table, seen from the
    /// object, m.
    pub hand_error_m: Option<f64>,
    /// Why it failed, by what really happened; `None`: it did not.
    pub failure: Option<Failure>,
    /// Refused, nothing moved at last.
    pub refused: bool,
}

impl Judged {
    /// By who saw nothing but whether it was lifted: why it was not is what the robot took it for.
    pub fn by_eye(record: &Record, lifted: bool) -> Self {
        let failure = match &record.outcome {
            _ if lifted => None,
            Some(Outcome::Failed { failure, .. }) => Some(*failure),
            // It took itself for good.
            Some(Outcome::Success) => Some(Failure::Slipped),
            Some(Outcome::Refused { .. }) | None => None,
        };
        let refused = matches!(record.outcome, Some(Outcome::Refused { .. }));
        let at_first = lifted && record.earlier.is_empty();
        Self { lifted, at_first, failure, refused, ..Self::default() }
    }
}

/// An attempt as it is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Attempt {
    /// Which.
    pub trial: Trial,
    /// Where the thing was put, m.
    pub placed_m: [f64; 2],
    /// What the robot keeps of it.
    pub record: Record,
    /// What really happened.
    pub judged: Judged,
}
