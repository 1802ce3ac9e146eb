//! Scores of detectors on a labeled data set: which detectors, which data set, the evaluation as a
//! job, its table and the images behind the cells of the confusion matrix.
//!
//! [`ScoresWorkflow`] is driven by commands and by finished work; it owns no thread.

mod cells;
mod evaluation;
mod state;
mod view;
pub mod work;

pub use state::ScoresWorkflow;
