//! The robot: its description (links, joints, shapes), where everything is at given joint
//! angles, and the rig file that ties it to servos, eyes, table and touchscreen.
//!
//! - [`Description`] is read from URDF and checked; [`Posture`] holds one angle per movable joint.
//! - [`Description::forward`] places every link; [`Chain`] places one tip and differentiates it.
//! - [`ik`] finds joint angles for a place of a tip, [`collision`] says what a posture or a way runs
//!   into, [`Reach`] joins the two: from a posture and a target to a move that can be made.
//! - [`servo`] says what a count of a servo's register means.
//! - [`Rig`] is a robot on its table: servo ids and ratios, eye mounts, poses, touchscreen. All
//!   numbers of a robot live in `assets/robots`, none in code.

mod chain;
mod check;
pub mod collision;
mod description;
mod error;
pub mod ik;
mod measured;
mod mjcf;
mod outlines;
mod posture;
mod reach;
mod rig;
mod rig_file;
pub mod servo;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_measured;
mod urdf;

pub use crate::session::CalibratedAt;
pub use chain::Chain;
pub use check::Problem;
pub use description::{
    Description, Inertia, Joint, JointIndex, JointKind, Limits, Link, LinkIndex, LinkPoses, Mimic, Shape,
    Visual,
};
pub use error::{DescriptionError, RigError};
pub use outlines::{BodyEdges, Outlines, ScreenFrame};
pub use posture::Posture;
pub use reach::{Plan, Reach, ReachError, ReachOptions, Refusal};
pub use rig::{
    Arm, Board, Bus, CoupledLimit, Direction as ServoDirection, EyeMount, Gate, NamedPose, Rig, RigPart,
    Servo, TableTop, TipName, WorkPatch,
};
pub use rig_file::default_rig;
