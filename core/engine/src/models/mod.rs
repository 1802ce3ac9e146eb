//! Correction models: training, comparing, accepting, undoing, files; and the tables of grasp height
//! and yaw.
//!
//! [`ModelsWorkflow`] is driven by commands and by finished work; it owns no thread.

pub mod command;
mod error;
pub mod files;
pub mod learn;
pub mod losses;
mod map;
pub mod screen;
mod sessions;
mod shown;
pub mod store;
pub mod tables;
#[cfg(test)]
pub(crate) mod tests;
pub mod view;
pub mod work;
mod workflow;

pub use error::ModelError;
pub use learn::options;
pub use plumbline_correction::tables::{HeightPoint, HeightTable, YawPoint, YawTable};
pub use plumbline_correction::train::FEWEST_FOR_A_NETWORK;
pub use plumbline_correction::{
    Comparison, CorrectionModel, Errors, LossPoint, Method, Recipe, Repeats, Touch, TouchData, TrainOptions,
    compare, spread_of_repeats, train,
};
pub use workflow::{ModelsAround, ModelsWorkflow};
