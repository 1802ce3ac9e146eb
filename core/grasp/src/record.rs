//! What became of a grasp, as it is kept on disk.

use jiff::Timestamp;
use serde::{Deserialize, Serialize};

use crate::hands::Hand;
use crate::method::Method;
use crate::see::Seen;

/// Version of the record's file.
pub const FORMAT: u32 = 1;

/// A step of a grasp, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Step {
    /// Whether the robot is fit to move.
    Ready,
    /// Looking for the object.
    Look,
    /// Postures and ways.
    Plan,
    /// To above the object.
    Approach,
    /// The hand is brought over the object by what the eyes see.
    Align,
    /// Straight down.
    Lower,
    /// Thumb and fingers.
    Close,
    /// Up.
    Lift,
    /// Whether it is held.
    Check,
    /// Back to where the arm was at first, to try once more.
    Again,
}

impl Step {
    /// All of a try, in their order.
    pub const ALL: [Self; 9] = [
        Self::Ready,
        Self::Look,
        Self::Plan,
        Self::Approach,
        Self::Align,
        Self::Lower,
        Self::Close,
        Self::Lift,
        Self::Check,
    ];

    /// Its name for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Ready => "Ready",
            Self::Look => "Look",
            Self::Plan => "Plan",
            Self::Approach => "Approach",
            Self::Align => "Align",
            Self::Lower => "Lower",
            Self::Close => "Close",
            Self::Lift => "Lift",
            Self::Check => "Check",
            Self::Again => "Again",
        }
    }
}

/// Why a grasp failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Failure {
    /// The object was not seen.
    NotSeen,
    /// The object was taken to be elsewhere.
    PlaceWrong,
    /// The hand was not found, or taken to be elsewhere.
    HandWrong,
    /// The hand did not come to where it was sent.
    ReachWrong,
    /// It was in the hand, or nearly, and was lost.
    Slipped,
    /// Something ended it on the way.
    Halted,
    /// The eyes gave no pairs any more: of the object, and of what the arm did with it, this says nothing.
    EyesLost,
}

/// What became of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "result", rename_all = "kebab-case")]
pub enum Outcome {
    /// It was lifted.
    Success,
    /// It was not.
    Failed {
        /// Why.
        failure: Failure,
        /// A sentence.
        why: String,
    },
    /// Nothing was risked.
    Refused {
        /// Why, and what to do.
        why: String,
    },
}

/// One look at the hand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Iteration {
    /// When both eyes saw it, clock of the robot, s; `None`: written before that was kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_s: Option<f64>,
    /// Where the palm was sent, m.
    pub sent_m: [f64; 3],
    /// Where the hand was found to be, m; `None`: it was not found.
    pub hand_m: Option<[f64; 3]>,
    /// Why it was not found.
    pub not_found: Option<String>,
    /// Horizontal distance from where it belongs, m.
    pub distance_m: Option<f64>,
    /// Standard deviation of the hand's place over the table, m, where it is known.
    pub sigma_m: Option<f64>,
}

/// A moment of the arm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// What had just been done.
    pub after: Step,
    /// Clock of the robot, s.
    pub at_s: f64,
    /// Commanded, all joints, rad.
    pub commanded_rad: Vec<f64>,
    /// By the encoders, in the order of the servos, rad.
    pub encoder_rad: Vec<f64>,
    /// Share of the full torque, in the order of the servos.
    pub load: Vec<Option<f64>>,
}

/// A try of the same grasp before the last one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Earlier {
    /// With which hand.
    #[serde(default)]
    pub hand: Hand,
    /// What became of it.
    pub outcome: Outcome,
    /// From the beginning to the end of its lift, s of the robot's clock.
    pub seconds: Option<f64>,
    /// Its looks at the hand.
    pub iterations: Vec<Iteration>,
    /// How far the fingers were kept from where they were sent after its lift, rad.
    pub fingers_open_rad: Option<f64>,
}

/// A grasp as it is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Version of the format.
    pub format: u32,
    /// How.
    pub method: Method,
    /// With which hand; before one was chosen, the one that is usual.
    #[serde(default)]
    pub hand: Hand,
    /// Class of the object.
    pub object: String,
    /// When it began.
    pub began: Timestamp,
    /// With which model, for people.
    pub model: String,
    /// The step that was begun last: where it came to, if there is no outcome.
    #[serde(default)]
    pub step: Option<Step>,
    /// Tries before the last one, of which all the rest is; the moments are of all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub earlier: Vec<Earlier>,
    /// When both eyes saw the table at first, clock of the robot, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seen_at_s: Option<f64>,
    /// What was seen at first.
    pub seen: Vec<Seen>,
    /// The object that was chosen, by its place in `seen`.
    pub chosen: Option<usize>,
    /// Where the object stands, over the table, m.
    pub standing_m: Option<[f64; 2]>,
    /// Where the palm belongs when the hand closes, m.
    pub wanted_m: Option<[f64; 3]>,
    /// So high the palm belongs over the middle of the object, m.
    pub over_middle_m: Option<f64>,
    /// Azimuth of the fingers, rad.
    pub heading_rad: Option<f64>,
    /// Looks at the hand.
    pub iterations: Vec<Iteration>,
    /// The arm after each step.
    pub moments: Vec<Moment>,
    /// When both eyes looked at last whether it is held, clock of the robot, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seen_after_at_s: Option<f64>,
    /// What was seen at last.
    pub seen_after: Vec<Seen>,
    /// How far the fingers were kept from where they were sent after the lift, rad.
    pub fingers_open_rad: Option<f64>,
    /// From the beginning to the end of the lift, s of the robot's clock; holds between steps are left out.
    pub seconds: Option<f64>,
    /// What it took itself for.
    pub outcome: Option<Outcome>,
    /// What the operator said.
    pub told_by_operator: Option<bool>,
    /// It was held, and slipped out of the hand so long after the grasp had ended, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slipped_after_s: Option<f64>,
}

impl Record {
    /// Of a grasp that begins.
    pub fn new(method: Method, object: &str, began: Timestamp, model: String) -> Self {
        Self {
            format: FORMAT,
            method,
            hand: Hand::default(),
            object: object.to_owned(),
            began,
            model,
            step: None,
            earlier: vec![],
            seen_at_s: None,
            seen: vec![],
            chosen: None,
            standing_m: None,
            wanted_m: None,
            over_middle_m: None,
            heading_rad: None,
            iterations: vec![],
            moments: vec![],
            seen_after_at_s: None,
            seen_after: vec![],
            fingers_open_rad: None,
            seconds: None,
            outcome: None,
            told_by_operator: None,
            slipped_after_s: None,
        }
    }

    /// Whether it was lifted and stayed: as the operator said, else as it took itself.
    pub fn is_success(&self) -> bool {
        let took = self.outcome == Some(Outcome::Success) && self.slipped_after_s.is_none();
        self.told_by_operator.unwrap_or(took)
    }

    /// Distance of the hand from where it belongs, at the last look, m.
    pub fn alignment_m(&self) -> Option<f64> {
        self.iterations.iter().rev().find_map(|iteration| iteration.distance_m)
    }
}
