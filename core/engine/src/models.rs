//! Correction models: training, comparing, accepting, undoing, files; and the tables of grasp height
//! and yaw.
//!
//! [`ModelsWorkflow`] is driven by commands and by finished work; it owns no thread.

mod state;
pub mod work;

pub use state::{ModelsWorkflow, Surroundings};
