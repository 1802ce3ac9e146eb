//! The lab's own data sets for training: images of the eyes with boxes, as a YOLO data set on disk.
//!
//! [`LabelsWorkflow`] is driven by commands and by finished work; it owns no thread.

mod checks;
pub mod command;
mod history;
mod images;
mod seen;
mod shown;
mod store;
#[cfg(test)]
mod tests;
mod transfer;
pub mod view;
pub mod work;
mod workflow;

pub use images::{Pixels, Unreadable};

pub(crate) use images::read_image;
pub(crate) use store::{data_yaml_of, failed as set_failed, write as write_text};
pub use workflow::{LabelsAround, LabelsWorkflow};
