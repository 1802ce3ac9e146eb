//! Grasping: what is grasped and how, the attempt as it goes on, single steps of a hand, and what
//! became of attempts.
//!
//! An attempt is work on a thread of its own. Its body leads the arm order by order
//! ([`crate::robot::Leader`]) and waits for pairs of the source; everything that moves passes the limits
//! of the bus.

mod area;
mod around;
mod attempt;
pub(crate) mod body;
pub mod command;
pub(crate) mod gates;
mod heard;
mod held;
mod keeping;
mod leg;
mod method;
mod pointing;
mod progress;
mod refusal;
mod rest;
mod rests_on;
mod shown;
pub(crate) mod sights;
mod standing;
mod steps;
mod stepwise;
#[cfg(test)]
mod tests;
mod tracks;
pub mod view;
mod waits;
mod warmth;
pub mod work;
mod workflow;

pub use around::GraspAround;
pub(crate) use body::{EyesOn, LedBody, Ropes};
pub use keeping::{Keeping, KeepingError, image_name};
pub(crate) use sights::Sights;
pub use standing::{read_record, read_tracks};
pub use workflow::GraspWorkflow;
