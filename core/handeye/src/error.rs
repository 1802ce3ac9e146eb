//! Why the arm is not tied to the eyes.

use plumbline_effects::RigModelError;
use plumbline_grasp::attempt::NoHand;
use plumbline_grasp::plan::NoPlan;
use plumbline_grasp::{Halt, NoArm};
use plumbline_model::Cancelled;
use plumbline_model::robot::DescriptionError;
use plumbline_vision::locate::NoBaseline;

/// Why the arm is not tied to the eyes, and what to do. Reads as a sentence.
#[derive(Debug, thiserror::Error)]
pub enum HandEyeError {
    /// Stopped on request.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The robot did not carry it out.
    #[error(transparent)]
    Halted(#[from] Halt),
    /// Nobody knows how the eyes sit in the head.
    #[error("how the eyes sit in the head was not measured: calibrate the mount first")]
    NoMount,
    /// Hands are not found.
    #[error(
        "the {hand} hand was found at {found} of {of} places only: take away what lies on the table, and see that \
         light falls on it"
    )]
    FewHands {
        /// "right" or "left".
        hand: &'static str,
        /// Places at which it was found.
        found: usize,
        /// Places at which it was looked for.
        of: usize,
    },
    /// The touches are of another arm than the model's.
    #[error("the touches cannot be predicted with this robot: touch the screen again")]
    Touches,
    /// The robot has no such arm.
    #[error(transparent)]
    Arm(#[from] NoArm),
    /// The hand has no shape.
    #[error(transparent)]
    Hand(#[from] NoHand),
    /// There is no free way.
    #[error(transparent)]
    Plan(#[from] NoPlan),
    /// The description has no such part.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// The effects do not fit to the robot.
    #[error(transparent)]
    Model(#[from] RigModelError),
    /// Places cannot be matched.
    #[error(transparent)]
    Locate(#[from] NoBaseline),
}
