//! What the robot's thread needs of a connected arm, so that tests can bring their own.

use std::sync::Arc;
use std::time::Instant;

use plumbline_hardware::joints::{Grip, JointState, Move, MoveId, Refusal, Setpoint};
use plumbline_model::robot::{JointIndex, Posture};

/// Who is on the bus.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// Ids that the rig has and the bus has not.
    pub missing: Vec<u8>,
    /// Ids on the bus that the rig does not know, with their model.
    pub unexpected: Vec<(u8, String)>,
    /// What the operator should know.
    pub warnings: Vec<String>,
}

/// A connected arm. Everything that moves goes through its limits.
pub trait Arm: Send {
    /// The newest state; `None` before the first cycle.
    fn state(&self) -> Option<Arc<JointState>>;

    /// Angles commanded, and angles measured, at a moment of the last seconds, interpolated; `None`
    /// when that moment is not, or not yet, covered.
    fn at(&self, when: Instant) -> (Option<Posture>, Option<Posture>);

    /// Begins a move in place of whatever runs.
    fn begin(&self, motion: Move) -> Result<MoveId, Refusal>;

    /// Follows a setpoint until it expires.
    fn follow(&self, setpoint: Setpoint) -> Result<(), Refusal>;

    /// Fingers close and go on pressing, until they are moved otherwise.
    fn grip(&self, grip: Grip) -> Result<(), Refusal>;

    /// Ends whatever runs; the arm stands.
    fn hold(&self) -> Result<(), Refusal>;

    /// Switches torque; joints that get it hold where they are, others sink.
    fn torque(&self, joints: &[JointIndex], on: bool) -> Result<(), Refusal>;

    /// Lets servos that are limp answer sooner, which they keep for good.
    fn shorten_answers(&self) -> Result<(), Refusal>;

    /// Who was found when it was connected.
    fn census(&self) -> Census;
}
