//! The gap between model and measurement: which sessions are compared, the search as a job, what it
//! found, adding effects to the model in use, and comparing findings.
//!
//! [`GapWorkflow`] is driven by commands and by finished work; it owns no thread.

mod model;
mod sessions;
mod state;
mod store;
#[cfg(test)]
mod tests;
mod view;
pub mod work;

pub(crate) use model::{name as model_name, report_history as history};
pub use state::{GapWorkflow, Surroundings};
