//! Why something is not done with the arm: sentences that say what to do.

use plumbline_hardware::dynamixel::BusError;
use plumbline_hardware::joints::{HoldReason, Refusal, ScreenGone};
use plumbline_model::counted;
use plumbline_model::robot::collision::CollisionError;
use plumbline_model::robot::{DescriptionError, ReachError, Refusal as OutOfReach};

use super::poses::PoseError;
use crate::ground::text::sentence;
use crate::twin::TwinUnable;

/// What can be asked of a jog along each axis (m/s) and about the vertical (rad/s); the joints' own
/// limits are far below.
pub const FASTEST_JOG: [f64; 2] = [1.0, 6.0];
/// Shares of the usual speed that can be set: a slower move would take hours.
pub const SPEEDS: (f64, f64) = (0.01, 2.0);

/// Why something is not done with the arm.
#[derive(Debug, thiserror::Error)]
pub enum Unable {
    /// There is no arm.
    #[error("Nothing is connected, so nothing can move. Connect first.")]
    NotConnected,
    /// There is no bus.
    #[error("Nothing is connected. Connect first.")]
    NothingToScan,
    /// What was connected is gone.
    #[error(
        "The twin has ended, so its servos cannot be looked for. Connect the twin: a new one is started."
    )]
    TwinEnded,
    /// Nobody knows where the arm is.
    #[error("The joints have not been read yet.")]
    NotRead,
    /// Nobody knows from where it would move.
    #[error("The joints have not been read yet. Connect, and wait for the first reading.")]
    NotReadToShow,
    /// Nobody knows the pose.
    #[error("The joints have not been read yet, so there is nothing to save.")]
    NotReadToSave,
    /// Only what is shown is run.
    #[error("No move is shown. Choose where to go first.")]
    NoPreview,
    /// A share of the usual speed.
    #[error(
        "A speed of {asked} cannot be set: it goes from {} to {} times the usual one.",
        SPEEDS.0,
        SPEEDS.1
    )]
    Speed {
        /// What was asked for.
        asked: f64,
    },
    /// A hand that jumps.
    #[error(
        "A tip is jogged by up to {} m/s along each axis and {} rad/s; what was asked for is more, or no number.",
        FASTEST_JOG[0],
        FASTEST_JOG[1]
    )]
    TooFast,
    /// A joint of it ends.
    #[error("{joint} is at its end that way ({why}). Jog it back, or to a side.")]
    JogEnds {
        /// Which.
        joint: String,
        /// What limits it.
        why: String,
    },
    /// It would meet something.
    #[error("{a} would run into {b} that way. Jog it back, or to a side.")]
    JogMeets {
        /// What, as the beginning of a sentence.
        a: String,
        /// Into what.
        b: String,
    },
    /// The arm is stretched, or as good as.
    #[error("The arm reaches no farther that way. Jog it back, or to a side.")]
    NoFarther,
    /// A touch is under way.
    #[error("The arm is busy ({0}). Pause the run of touches first.")]
    Busy(String),
    /// Somebody leads it.
    #[error("The arm is busy ({0}). End that first.")]
    Led(String),
    /// The arm itself says no.
    #[error("{}", sentence(&.0.to_string()))]
    Arm(#[from] Refusal),
    /// The bus cannot be opened.
    #[error("{}", sentence(&.0.to_string()))]
    Bus(#[from] BusError),
    /// The robot has no such tip.
    #[error("{}", sentence(&.0.to_string()))]
    Description(#[from] DescriptionError),
    /// There is no such place to go to.
    #[error(transparent)]
    Destination(#[from] NoDestination),
    /// Something is in the way.
    #[error(transparent)]
    Way(#[from] InTheWay),
    /// A pose cannot be kept.
    #[error(transparent)]
    Pose(#[from] PoseError),
    /// The twin says no.
    #[error(transparent)]
    Twin(#[from] TwinUnable),
}

/// Why a destination means no posture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoDestination {
    /// Nothing turns it.
    #[error("This joint has no servo, so it cannot be moved.")]
    NoServo,
    /// It was deleted.
    #[error("There is no pose called {0} any more.")]
    NoPose(String),
    /// A posture of another robot.
    #[error("This posture has {}, the robot {robot}. It is of another robot.", counted(*.posture, "joint"))]
    OtherRobot {
        /// Joints of the posture.
        posture: usize,
        /// Joints of the robot.
        robot: usize,
    },
    /// An angle that is none.
    #[error("The destination holds a value that is not a number.")]
    NotANumber,
    /// A place that is none.
    #[error("The point holds a value that is not a number.")]
    NoPoint,
    /// Not every link can be sent somewhere.
    #[error("Choose a tip that the arm can move.")]
    NoTip,
    /// Effects jump there.
    #[error(
        "The effects of the model leave no command that leads there: the nearest one ends {:.1} mm beside it. Choose \
         another place.",
        .by_m * 1e3
    )]
    Unsettled {
        /// What is left, m.
        by_m: f64,
    },
    /// It cannot be asked so.
    #[error("{}", sentence(&.0.to_string()))]
    Reach(#[from] ReachError),
    /// The arm does not get there.
    #[error("{}", sentence(&.0.to_string()))]
    OutOfReach(#[from] OutOfReach),
    /// A joint ends before.
    #[error(
        "{joint} would have to go to {:.1}°, its limits there are {:.1}° to {:.1}°{why}.",
        .angle_rad.to_degrees(),
        .limits_rad[0].to_degrees(),
        .limits_rad[1].to_degrees()
    )]
    BeyondLimits {
        /// Which, for people.
        joint: String,
        /// Where it would have to go.
        angle_rad: f64,
        /// Lower and upper.
        limits_rad: [f64; 2],
        /// What limits it, in brackets; empty when it is the joint itself.
        why: String,
    },
}

/// Why a way cannot be gone.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InTheWay {
    /// Nobody can say.
    #[error("{}", sentence(&.0.to_string()))]
    Unknown(#[from] CollisionError),
    /// Something is in the way.
    #[error("{a} would run into {b} {}. Choose another pose, or go there by way of Home.", at(*.at_fraction))]
    Collides {
        /// What would run, as the beginning of a sentence.
        a: String,
        /// Into what.
        b: String,
        /// Where on the way, 0–1.
        at_fraction: f64,
    },
    /// A joint ends.
    #[error("{joint} would turn {} {} ({why}). Choose another pose.", too_far(*.by_rad), at(*.at_fraction))]
    BeyondLimit {
        /// Which.
        joint: String,
        /// By how much.
        by_rad: f64,
        /// What limits it.
        why: String,
        /// Where on the way, 0–1.
        at_fraction: f64,
    },
}

/// Why a touch cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum Interrupted {
    /// Something else is done with the arm, or cannot be.
    #[error(transparent)]
    Unable(#[from] Unable),
    /// The robot has no such finger.
    #[error("The robot has no arm with the tip {0}. Plan anew.")]
    NoArm(String),
    /// The way ends above the glass.
    #[error("The planned touch does not lead down. Plan anew.")]
    NotDown,
    /// The plan holds no way.
    #[error("The planned touch has no way that could be gone. Plan anew.")]
    NoWay,
    /// Not begun, because the operator said so.
    #[error("STOP is pressed. Release it, then go on.")]
    StopIsPressed,
    /// The operator said so.
    #[error("STOP was pressed.")]
    Stopped,
    /// The arm goes elsewhere.
    #[error("Something else moves the arm. Wait until it stands, then go on.")]
    Moves,
    /// The arm went elsewhere.
    #[error("Something else moved the arm.")]
    Moved,
    /// Nobody knows where the arm is.
    #[error("The joints have not been read yet. Wait a moment, then go on.")]
    NotRead,
    /// Nobody knows any more where the arm is.
    #[error(
        "Not all joints have been read. Wait a moment; if it stays so, close other programs, then look at cables and power."
    )]
    Unknown,
    /// Nobody knows where it was sent.
    #[error("The goals of the joints are not known. Connect again.")]
    NoGoals,
    /// No state comes.
    #[error("The arm does not answer. Look at its cable and power.")]
    NoAnswer,
    /// It would fall.
    #[error("{0} has no torque. Switch its torque on.")]
    Limp(String),
    /// The arm itself says no.
    #[error("{}", sentence(&.0.to_string()))]
    Arm(#[from] Refusal),
    /// The arm holds, although it was told to follow.
    #[error("{}", sentence(&.0.to_string()))]
    Holds(#[from] HoldReason),
    /// Nothing is felt any more.
    #[error("{}", sentence(&.0.to_string()))]
    Screen(#[from] ScreenGone),
    /// Whoever was asked says why.
    #[error("{}", sentence(.0))]
    Told(String),
}

impl Interrupted {
    /// Whether joints were merely not heard, so that the arm holds and nothing of what it was to do was
    /// refused.
    pub fn is_unheard(&self) -> bool {
        match self {
            Self::NotRead | Self::Unknown => true,
            Self::Arm(refusal) | Self::Unable(Unable::Arm(refusal)) => is_unheard(refusal),
            Self::Holds(reason) => holds_unheard(reason),
            _ => false,
        }
    }
}

impl Unable {
    /// Whether joints were merely not heard.
    pub fn is_unheard(&self) -> bool {
        match self {
            Self::NotRead => true,
            Self::Arm(refusal) => is_unheard(refusal),
            _ => false,
        }
    }
}

/// Whether something is refused merely because joints were not heard.
pub(super) fn is_unheard(refusal: &Refusal) -> bool {
    matches!(refusal, Refusal::Unknown { .. } | Refusal::UnknownInChain { .. })
}

/// Whether the arm holds merely because joints were not heard.
pub(super) fn holds_unheard(reason: &HoldReason) -> bool {
    match reason {
        HoldReason::Refused(refusal) => is_unheard(refusal),
        HoldReason::Slow { .. } | HoldReason::NoAnswer { .. } => true,
        _ => false,
    }
}

impl InTheWay {
    /// The same of a jog, which goes nowhere in particular: no share of a way, and no other pose to choose.
    pub fn of_jog(self) -> Unable {
        match self {
            Self::Collides { a, b, .. } => Unable::JogMeets { a, b },
            Self::BeyondLimit { joint, why, .. } => Unable::JogEnds { joint, why },
            Self::Unknown(_) => self.into(),
        }
    }
}

impl From<InTheWay> for Interrupted {
    fn from(way: InTheWay) -> Self {
        Self::Unable(way.into())
    }
}

/// "2.4° too far"; what would be written as nothing is no number.
fn too_far(by_rad: f64) -> String {
    match by_rad.to_degrees() {
        by_deg if by_deg < 0.05 => "just past its end".to_owned(),
        by_deg => format!("{by_deg:.1}° too far"),
    }
}

fn at(fraction: f64) -> String {
    match fraction {
        fraction if fraction <= 0.0 => "at once".to_owned(),
        fraction => format!("after {:.0} % of the way", 100.0 * fraction),
    }
}

#[cfg(test)]
mod tests {
    use plumbline_hardware::joints::Unheard;
    use plumbline_model::robot::JointIndex;

    use super::*;

    #[test]
    fn what_would_be_written_as_nothing_is_no_number() {
        let beyond = |by_deg: f64, at_fraction: f64| {
            let (joint, why) = ("Right elbow".to_owned(), "its end".to_owned());
            InTheWay::BeyondLimit { joint, by_rad: by_deg.to_radians(), why, at_fraction }.to_string()
        };
        let end = "(its end). Choose another pose.";
        assert_eq!(
            beyond(0.01, 0.0),
            format!("Right elbow would turn just past its end at once {end}"),
            "never 0.0° too far after 0 %"
        );
        assert_eq!(
            beyond(2.44, 0.5),
            format!("Right elbow would turn 2.4° too far after 50 % of the way {end}")
        );
    }

    #[test]
    fn a_joint_that_was_not_heard_is_told_from_one_that_cannot_go_there() {
        let why = Unheard::TooBusy;
        let unheard = Refusal::Unknown { joint: JointIndex(0), name: "Head turn".to_owned(), why };
        assert!(Unable::from(unheard.clone()).is_unheard() && Unable::NotRead.is_unheard());
        assert!(holds_unheard(&HoldReason::Refused(unheard)));
        // Nobody was at the window: that is no silence of a joint, and only a person goes on after it.
        let nobody = HoldReason::NoHeartbeat(std::time::Duration::from_secs(2));
        assert!(!holds_unheard(&nobody) && !Unable::from(Refusal::NoHeartbeat).is_unheard());
        let said = Interrupted::from(nobody).to_string();
        assert!(
            said.starts_with("The window did not answer for 2.0 s") && said.contains("then go on"),
            "{said}"
        );
        assert!(!Unable::from(Refusal::Stopped).is_unheard() && !Unable::NoPreview.is_unheard());
        assert!(!holds_unheard(&HoldReason::Refused(Refusal::Stopped)) && !holds_unheard(&HoldReason::Stop));
    }
}
