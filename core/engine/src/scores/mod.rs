//! Scores of detectors on a labeled data set: which detectors, which data set, the evaluation as a
//! job, its table and the images behind the cells of the confusion matrix.
//!
//! [`ScoresWorkflow`] is driven by commands and by finished work; it owns no thread.

mod cells;
pub mod command;
mod evaluation;
mod shown;
pub mod view;
pub mod work;
mod workflow;

pub use evaluation::Evaluation;
pub use workflow::ScoresWorkflow;
