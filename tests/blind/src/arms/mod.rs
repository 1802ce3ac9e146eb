//! Arms drawn by chance, measured from outside.
//!
//! Four to seven revolute joints with random lengths, twists and orders of axes; a tracker in a frame of its own sees
//! a marker at the end, in half of the cases with its orientation, in half at a place that nobody knows. Places of
//! bodies, springs under gravity and what an encoder sees are followed by geometry and virtual work; the formulas of
//! the library are out of reach.

mod again;
mod body;
mod cases;
mod robot;
mod run;
mod secret;

pub use again::{Arm, Ask};
pub use cases::{make, recipes};
pub use secret::Kind;
