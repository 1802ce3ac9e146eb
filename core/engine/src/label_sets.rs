//! The lab's own data sets for training: images of the eyes with boxes, as a YOLO data set on disk.
//!
//! [`LabelsWorkflow`] is driven by commands and by finished work; it owns no thread.

mod checks;
mod history;
mod images;
mod state;
mod store;
#[cfg(test)]
mod tests;
mod transfer;
mod view;
pub mod work;

pub use state::{LabelsWorkflow, Surroundings};
pub(crate) use store::{data_yaml_of, failed as set_failed, write as write_text};
pub(crate) use work::read_image;
