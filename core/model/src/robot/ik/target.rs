//! What is asked of the solver, and what it answers.

use std::ops::Deref;

use nalgebra::Vector3;

use super::kernel::{Angles, MAX_JOINTS};
use crate::frame::{Direction, Point, Pose, Robot, Tip};
use crate::robot::{JointIndex, Limits};

/// Where a tip shall go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// The tip's origin to a point; its orientation is free.
    Position(Point<Robot>),
    /// The tip's origin to a point and its heading to an angle.
    ///
    /// The heading is the azimuth of the tip's x axis: the angle about the robot's z from the
    /// robot's x to the horizontal part of the tip's x axis. It is the yaw of
    /// R = Rz(yaw) · Ry(pitch) · Rx(roll), so the published top grasp "Euler (0, 0, yaw)" has this
    /// heading. Pitch and roll are free, see [`Options::tool_z`].
    PositionYaw {
        /// Place of the tip's origin.
        point: Point<Robot>,
        /// Heading, rad.
        yaw_rad: f64,
    },
    /// The whole place of the tip.
    Pose(Pose<Robot, Tip>),
}

impl Target {
    /// The point that the tip's origin shall reach.
    pub fn point(&self) -> Point<Robot> {
        match self {
            Self::Position(point) | Self::PositionYaw { point, .. } => *point,
            Self::Pose(pose) => Point::from(nalgebra::Point3::from(pose.translation_m())),
        }
    }

    /// Whether every number is one.
    pub fn is_finite(&self) -> bool {
        let point = self.point().coords.iter().all(|c| c.is_finite());
        point
            && match self {
                Self::Position(_) => true,
                Self::PositionYaw { yaw_rad, .. } => yaw_rad.is_finite(),
                Self::Pose(pose) => pose.isometry.rotation.coords.iter().all(|c| c.is_finite()),
            }
    }
}

/// Angles of a chain's joints, rad, from the base on. Reads as a slice.
#[derive(Clone, Copy, PartialEq)]
pub struct ChainAngles {
    pub(super) all: Angles,
    pub(super) count: usize,
}

impl ChainAngles {
    pub(super) fn new(all: Angles, count: usize) -> Self {
        debug_assert!(count <= MAX_JOINTS);
        Self { all, count }
    }
}

impl Deref for ChainAngles {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.all[..self.count]
    }
}

impl std::fmt::Debug for ChainAngles {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

/// The best joint angles that were found, and what they leave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// One angle (rad) per joint of the chain, inside the limits, ends included.
    pub joints: ChainAngles,
    /// Distance of the tip's origin to the target, m.
    pub position_error_m: f64,
    /// What is asked of the orientation: the angle of the remaining rotation for a pose, of the
    /// heading for a yaw, zero for a position. 0 to π rad.
    pub orientation_error_rad: f64,
    /// Steps that were computed, over all starts.
    pub iterations: u32,
    /// Starts that were tried: 1 when the given start led there.
    pub starts: u32,
}

/// What became of a target.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// The tip gets there, within the tolerances.
    Reached(Solution),
    /// A joint limit stands in the way: the tip would come nearer if this joint could move on.
    LimitedBy {
        /// The joint; of several, the one whose limit costs most.
        joint: JointIndex,
        /// Its name in the description.
        name: String,
        /// The limit at which it stands, rad.
        limit_rad: f64,
        /// The nearest that was found.
        best: Solution,
    },
    /// The arm is too short, or cannot turn its tip so: no joint limit would help.
    OutOfReach {
        /// How far the tip stays from the target, m.
        by_m: f64,
        /// The nearest that was found.
        best: Solution,
    },
}

impl Answer {
    /// The angles that reach the target, or come nearest.
    pub fn best(&self) -> &Solution {
        match self {
            Self::Reached(best) | Self::LimitedBy { best, .. } | Self::OutOfReach { best, .. } => best,
        }
    }

    /// Whether the target is reached.
    pub fn is_reached(&self) -> bool {
        matches!(self, Self::Reached(_))
    }

    /// In one word, as files have it: `reached`, `limited-by:<joint>` or `out-of-reach`.
    pub fn status(&self) -> String {
        match self {
            Self::Reached(_) => "reached".to_owned(),
            Self::LimitedBy { name, .. } => format!("limited-by:{name}"),
            Self::OutOfReach { .. } => "out-of-reach".to_owned(),
        }
    }
}

/// How to solve. All angles are of the chain's joints, in their order.
#[derive(Clone, Debug)]
pub struct Options {
    /// Limits in force, narrower than or equal to the solver's own; `None`: the solver's own.
    pub limits: Option<Vec<Limits>>,
    /// A posture (rad) toward which the arm is drawn with whatever freedom the target leaves.
    pub rest: Option<Vec<f64>>,
    /// How far it is drawn, 0–1: 0 stays near the start, 1 goes to the solution nearest to `rest`.
    pub pull: f64,
    /// Where the tip's z axis should point as nearly as the arm can, without giving up anything of
    /// the target: the robot's up for a palm that faces down or a fingertip that points down.
    /// Means nothing for a pose, which leaves no choice.
    pub tool_z: Option<Direction<Robot>>,
    /// The position counts as reached within this, m.
    pub position_tolerance_m: f64,
    /// The orientation counts as reached within this, rad.
    pub orientation_tolerance_rad: f64,
    /// Other starts that are tried when the given one does not lead to the target.
    pub other_starts: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            limits: None,
            rest: None,
            pull: 1.0,
            tool_z: None,
            position_tolerance_m: 1e-5,
            orientation_tolerance_rad: 1e-4,
            other_starts: 60,
        }
    }
}

impl Options {
    /// The usual ones, with the tip's z axis as near to the robot's up as the arm can: for a grasp
    /// from above or a fingertip on the table.
    pub fn upright() -> Self {
        Self { tool_z: Direction::new(Vector3::z()), ..Self::default() }
    }
}

/// Why nothing was solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IkError {
    /// No joint, or too many.
    #[error(
        "the chain to {tip} has {joints} joints, but 1 to {MAX_JOINTS} can be solved: choose a tip of an arm or of the head"
    )]
    Joints {
        /// The tip.
        tip: String,
        /// Number of its joints.
        joints: usize,
    },
    /// A value is not a number.
    #[error("the {what} holds a value that is not a number: give finite numbers")]
    NotANumber {
        /// "target", "start posture", "rest posture".
        what: &'static str,
    },
    /// Not one value per joint.
    #[error("{what}: {given} values for the {joints} joints of the chain: give one per joint")]
    Count {
        /// "start posture", "rest posture", "limits".
        what: &'static str,
        /// Values given.
        given: usize,
        /// Joints.
        joints: usize,
    },
    /// The pull toward the rest posture is no share.
    #[error("the pull toward the rest posture is {0}: give a number from 0 (none) to 1 (all the way)")]
    Pull(f64),
    /// Limits that leave a joint no angle.
    #[error(
        "the limits {lower_rad} to {upper_rad} rad given for {joint} leave it no angle inside of its own {own_lower_rad} to {own_upper_rad} rad: widen them"
    )]
    Limits {
        /// The joint.
        joint: String,
        /// As given.
        lower_rad: f64,
        /// As given.
        upper_rad: f64,
        /// The solver's own.
        own_lower_rad: f64,
        /// The solver's own.
        own_upper_rad: f64,
    },
}
