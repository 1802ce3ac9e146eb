//! Correction models: training, comparing, accepting, undoing, files; and the tables of grasp height
//! and yaw.
//!
//! [`ModelsWorkflow`] is driven by commands and by finished work; it owns no thread.

pub(crate) mod files;
mod learn;
mod losses;
mod map;
mod screen;
mod sessions;
mod state;
mod store;
pub mod tables;
#[cfg(test)]
pub(crate) mod tests;
mod view;
pub mod work;

pub(crate) use learn::options;
pub use state::{ModelsWorkflow, Surroundings};
