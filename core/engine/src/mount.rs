//! Calibrating how the eyes sit in the head: plan head poses, turn the head there, see the
//! board at each, solve, compare, accept.
//!
//! [`MountState`] is driven by commands, by what the chessboard search sees and by what the
//! robot reports; it owns no thread and reads no clock.

mod state;
mod tour;
mod view;
pub mod work;

pub use state::{MountState, Surroundings};
