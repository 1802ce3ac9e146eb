//! Sizes all usual effects of an arm together, from touches and from what the eyes saw of it.
//!
//! A name is for people: the few effects that data can tell apart. An arm is corrected best by all that
//! usually is wrong with arms, each drawn to zero as far as robots usually have it (the posterior mean under
//! normal priors): what touches can name gets its size, what they cannot name gets small shares, and
//! what is not known stands in the covariance.
//!
//! - [`fit()`]: least squares with priors, of one arm and one screen, with hands that the eyes saw beside it.
//! - [`choose()`]: whether nothing, the named effects or all of them err least on touches held out.
//! - [`lag()`]: how far servos stop from where they are sent.
//! - [`ArmTouches`], [`sized_by_hands`]: both for touches of one session, with the names that a search gave, and
//!   for an arm that touched nothing.
//! - [`neck_effect`]: the zero of the neck's turn, as a model takes it.

mod added;
mod choose;
mod fit;
mod lag;
#[cfg(test)]
mod made_up;
mod seen;
mod size;
mod usual;

pub use added::neck_effect;
pub use choose::{Chosen, HeldOut, Which};
pub use fit::{Fit, Known, NECK_SD_RAD, SeenScreen, pose};
pub use seen::{Looked, SeenHand, SeenHands};
pub use size::{ArmTouches, LEAST_TOUCHES, Name, SizedArm, sized_by_hands};
pub use usual::{NOISE_M, SCREEN_SD, is_first_zero, measurements, moves_palm, row, usual};
