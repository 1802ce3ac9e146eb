//! The gap between model and measurement: which sessions are compared, the search as a job, what it
//! found, adding effects to the model in use, and comparing findings.
//!
//! [`GapWorkflow`] is driven by commands and by finished work; it owns no thread.

pub mod at_tip;
pub mod command;
mod model;
pub mod search;
pub mod sessions;
mod shown;
mod standing;
pub mod store;
#[cfg(test)]
mod tests;
pub mod view;
pub mod work;
mod workflow;

pub use model::{name as model_name, report_history as history, view as model_view};
pub use plumbline_effects::measurements::{Unit, What};
pub use plumbline_gap::finding::{
    Candidate, Comparison, CoordinateComparison, Experiment, Finding, Knowledge, NamedEffect, NextExperiment,
    Residual, Shown, ShownUnit, Unexplained,
};
pub use plumbline_gap::{Verdict, plan_for, titles};
pub use plumbline_report::sample;
pub use search::same_rig;
pub use workflow::{GapAround, GapWorkflow};
