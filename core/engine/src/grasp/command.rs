//! Commands about grasping.

use plumbline_grasp::{HandChoice, Method};
use plumbline_model::Eye;
use serde::{Deserialize, Serialize};

/// Grasping.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GraspCommand {
    /// How the hand is brought to the object.
    Method(Method),
    /// With which hand.
    Arm(HandChoice),
    /// What is grasped.
    Target(GraspTarget),
    /// What an image shows there is grasped: the nearest thing that was detected and can be held.
    Point {
        /// On the image of which eye.
        eye: Eye,
        /// Raw px.
        u_px: f64,
        /// Raw px.
        v_px: f64,
    },
    /// Looks, and shows what would be sent. Moves nothing.
    Plan,
    /// Forgets what is shown.
    Forget,
    /// Grasps. The arm moves.
    Grasp,
    /// Holds wherever it is, also within a step.
    Pause,
    /// Goes on where it was. The arm moves.
    Resume,
    /// Ends what is under way; the arm holds.
    End,
    /// An attempt holds by itself after each of its steps, until it is told to go on; or no longer. Also while one
    /// is under way. Attempts of an experiment do not.
    StopAfterEachStep(bool),
    /// One step of a hand by itself. The arm moves.
    Hand(HandStep),
    /// What the operator saw of an attempt.
    Judge {
        /// Name of the attempt.
        attempt: String,
        /// Whether the object was held.
        held: bool,
    },
}

/// What is grasped.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GraspTarget {
    /// Class of the object; `None`: whatever can be held and is seen best.
    pub class: Option<String>,
    /// The one nearest to this place of the table (robot frame, m); `None`: the one nearest to the
    /// robot.
    pub near_m: Option<[f64; 2]>,
}

/// A step of a hand by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HandStep {
    /// Opens the hand.
    Open,
    /// Closes the hand until the fingers meet something.
    Close,
    /// Straight up by 100 mm.
    Lift,
    /// Straight down to where things stand, opens, and up again.
    Place,
    /// Brings what it holds to in front of the robot, where somebody takes it before the hand is opened.
    Give,
    /// To the pose in which nothing is in the way, the hand as it is.
    Home,
}

impl HandStep {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Open, Self::Close, Self::Lift, Self::Place, Self::Give, Self::Home];

    /// What it is called everywhere.
    pub fn title(self) -> &'static str {
        match self {
            Self::Open => "Open the hand",
            Self::Close => "Close the hand",
            Self::Lift => "Lift",
            Self::Place => "Put down",
            Self::Give => "Hand over",
            Self::Home => "Arm home",
        }
    }
}
