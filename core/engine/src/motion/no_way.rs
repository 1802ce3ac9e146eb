//! Why there is no way of the hand.

use plumbline_model::Pixel;
use plumbline_model::robot::DescriptionError;
use plumbline_model::robot::collision::CollisionError;
use plumbline_model::robot::ik::{IkError, SolverError};
use plumbline_model::session::Screen;

use crate::ground::text::sentence;

/// Why a target cannot be touched, and what to do: a sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoWay {
    /// Nothing of the arm can touch with it.
    #[error("{tip} is no tip of an arm of this robot. Choose the tip of an index finger.")]
    NoTip {
        /// What was asked for.
        tip: String,
    },
    /// The rig file lacks a pose.
    #[error("The rig has no pose \"touch-ready\", from which the screen is touched. Add it to the rig file.")]
    NoReadyPose,
    /// The tip cannot be moved.
    #[error("{}", sentence(&.0.to_string()))]
    Solver(#[from] SolverError),
    /// The description of the robot lacks it.
    #[error("{}", sentence(&.0.to_string()))]
    Description(#[from] DescriptionError),
    /// The inverse kinematics cannot be asked so.
    #[error("{}", sentence(&.0.to_string()))]
    Kinematics(#[from] IkError),
    /// Nobody can say what would meet.
    #[error("{}", sentence(&.0.to_string()))]
    Collision(#[from] CollisionError),
    /// Numbers that are none.
    #[error("The target or the present posture is not a number. Plan anew.")]
    NotANumber,
    /// Too far away for the finger as it has to be held.
    #[error("{} is out of reach. Choose a smaller area.", place(.target))]
    OutOfReach {
        /// Which.
        target: Pixel<Screen>,
    },
    /// Too far away.
    #[error("{} is out of reach by {:.0} mm. Choose a smaller area.", place(.target), .by_m * 1e3)]
    OutOfReachBy {
        /// Which.
        target: Pixel<Screen>,
        /// How far, m.
        by_m: f64,
    },
    /// The finger would touch with its side.
    #[error(
        "Over {} the finger cannot point down: it is inclined by {:.0}°. Choose a smaller area.",
        place(.target),
        .inclined_rad.to_degrees()
    )]
    Inclined {
        /// Which.
        target: Pixel<Screen>,
        /// By how much.
        inclined_rad: f64,
    },
    /// There is no room to wait above it.
    #[error("Above {} the arm gets only {:.0} mm high. Choose a smaller area.", place(.target), .high_m * 1e3)]
    TooLow {
        /// Which.
        target: Pixel<Screen>,
        /// How high, m.
        high_m: f64,
    },
    /// What corrects it sends it too far from its place.
    #[error(
        "For {} the tip would be sent {:.0} mm beside the place where it is wanted: no arm is believed to be so far off (60 mm, 40 mm of them in height). \
         Measure the place of the screen and search the gap anew.",
        place(.target),
        .by_m * 1e3
    )]
    TooFarBeside {
        /// Which.
        target: Pixel<Screen>,
        /// How far, m.
        by_m: f64,
    },
    /// Its floor ends the arm above the glass.
    #[error(
        "At {} the arm may not go low enough: it ends {:.0} mm above its floor. Raise the screen, or lower floor_m in the rig file.",
        place(.target),
        .above_floor_m * 1e3
    )]
    TooHigh {
        /// Which.
        target: Pixel<Screen>,
        /// How far above, m.
        above_floor_m: f64,
    },
    /// Something else than the finger would touch, or something else than the screen.
    #[error("At {} the {a} would meet the {b}. Choose a smaller area.", place(.target))]
    Meets {
        /// Which.
        target: Pixel<Screen>,
        /// What would meet it.
        a: String,
        /// What.
        b: String,
    },
    /// What this arm does not move meets something where it stands.
    #[error(
        "The {a} meets the {b} where it stands, and no way is planned beside that. Bring it away first: Show the way home, in Robot."
    )]
    InTheWay {
        /// What.
        a: String,
        /// What it meets.
        b: String,
    },
    /// Everything on the way home is barred.
    #[error("There is no free way home: {leg}.")]
    NotAway {
        /// What bars the shortest one.
        leg: Barred,
    },
    /// Everything on the way there is barred.
    #[error("There is no free way to {}: {leg}. Go to \"Ready to touch\" first.", place(.target))]
    NotFree {
        /// Which.
        target: Pixel<Screen>,
        /// What bars the shortest one.
        leg: Barred,
    },
}

/// Why a part of a way cannot be gone; stands inside a sentence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Barred {
    /// No way was tried.
    #[error("no way was found")]
    NoWay,
    /// It leads too low.
    #[error("the fingertip would come too near to the glass")]
    NearGlass,
    /// Something is in the way.
    #[error("the {a} would meet the {b}")]
    Meets {
        /// What would meet it.
        a: String,
        /// What.
        b: String,
    },
    /// A joint ends.
    #[error("{joint} would turn too far ({why})")]
    TooFar {
        /// Which.
        joint: String,
        /// What limits it.
        why: String,
    },
    /// Nobody can say what would meet.
    #[error(transparent)]
    Unknown(#[from] CollisionError),
}

fn place(target: &Pixel<Screen>) -> String {
    format!("pixel ({:.0}, {:.0})", target.u_px, target.v_px)
}
