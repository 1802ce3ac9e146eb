//! Calibrating how the eyes sit in the head: plan head poses, turn the head there, see the
//! board at each, solve, compare, accept.
//!
//! [`MountWorkflow`] is driven by commands, by what the chessboard search sees and by what the
//! robot reports; it owns no thread and reads no clock.

pub mod command;
mod shown;
#[cfg(test)]
mod tests;
mod tour;
pub mod view;
pub mod work;
mod workflow;

pub use workflow::{MountAround, MountWorkflow};
