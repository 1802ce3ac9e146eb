//! What can be asked of an arm, and how it ended.

use std::time::Duration;

use plumbline_model::robot::JointIndex;

use super::refusal::{HoldReason, Refusal};

/// Names a move, counting up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MoveId(pub u64);

/// How fast a move runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pace {
    /// All joints arrive together after this time; refused when a joint would be too fast.
    Duration(Duration),
    /// The fastest joint's peak speed as a share (0 to 1) of the limit.
    SpeedFraction(f64),
    /// The fastest joint's peak speed, rad/s; refused above the limit.
    PeakSpeed(f64),
}

/// Joints to angles, all starting and arriving together, along a straight line in joint space
/// with minimal jerk.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Joints and their goals, rad; other joints stay.
    pub goals: Vec<(JointIndex, f64)>,
    /// How fast.
    pub pace: Pace,
}

/// What a jog key or a stream of goals asks for at this moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Setpoint {
    /// What.
    pub kind: SetpointKind,
    /// Joints and velocities (rad/s) or angles (rad).
    pub joints: Vec<(JointIndex, f64)>,
    /// Without a newer one the arm holds after this time.
    pub valid_for: Duration,
}

/// What the numbers of a setpoint are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetpointKind {
    /// rad/s.
    Velocity,
    /// rad; approached at no more than the usual speed.
    Position,
}

/// How a move ended.
#[derive(Clone, Debug, PartialEq)]
pub enum MoveOutcome {
    /// Its goals were sent and the joints came to rest.
    Arrived {
        /// Largest difference goal − present among its joints, rad.
        residual_rad: f64,
    },
    /// It did not begin.
    Refused(Refusal),
    /// It was ended on the way.
    Held(HoldReason),
    /// Another move, a jog or a relaxed joint took its place.
    Replaced,
}

/// What the arm does.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// No servo answers: whether anything holds is not known.
    Unknown,
    /// No servo that answers has torque.
    Limp,
    /// Stands where it is.
    Holding(HoldReason),
    /// Runs a move.
    Moving {
        /// Which.
        id: MoveId,
        /// 0 to 1 of its time.
        fraction: f64,
        /// Planned time left; longer when a joint has to be waited for.
        remaining: Duration,
    },
    /// Follows setpoints.
    Following,
}
