//! Whether a posture or a way between two postures runs the robot into itself, the table, the
//! touchscreen, or below the height that the rig allows.
//!
//! Bodies are the simple shapes of the description. Links that are joined to each other are not
//! compared, nor the fingers of one hand, nor pairs that already touch in the home pose (the
//! shapes are larger than the parts): those are computed, see
//! [`CollisionModel::always_in_contact`].

mod beside;
mod bodies;
mod model;
mod path;
mod solid;
#[cfg(test)]
mod tests;

pub use beside::BesideModel;
pub use model::{Allowance, Body, CollisionError, CollisionModel, Contact, PostureCheck};
pub use path::PathCheck;
