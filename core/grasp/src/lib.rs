//! Grasps: from a pair of images to a lifted object, by the published methods and by ours.
//!
//! Nothing here knows whether a robot or a twin moves: a [`Body`] carries out what is asked.

mod body;
pub mod hand;

pub use body::{Body, Halt, ServoState, Sight};
