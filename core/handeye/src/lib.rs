//! Ties the arm to the eyes.
//!
//! Touches say how the arm errs, a board says how the eyes sit in the head; what neither says is how the arm
//! stands to what the eyes see. Four things that both know tell it: the frame of the touchscreen, which the
//! finger has placed ([`screen`]); the robot's own body, which does not turn with the head ([`body`]); the
//! table around the screen ([`table`]); and the hand itself, held open over the table where it will grasp
//! ([`hands`]).
//!
//! - [`Tie`]: what was seen of body, screen and table, and what is known by it.
//! - [`Start`]: the robot as it is known before.
//! - [`Sizing`]: the model of effects that both arms get from all of it.
//! - [`tie()`]: all of it, one after the other, on a robot or its twin.

pub mod body;
mod edges;
mod error;
pub mod hands;
pub mod model;
mod picture;
pub mod screen;
pub mod table;
#[cfg(test)]
mod tests;
mod tie;
#[cfg(test)]
mod twin;
mod whole;

pub use error::HandEyeError;
pub use model::Sizing;
pub use tie::{Held, Start, Tie};
pub use whole::{Figures, Outcome, Part, SENTENCE, Seen, Tied, Watch, of_other, of_touched, tie};
