//! Detection, live: which detector, read in the background; what is shown of what it finds; how
//! reliably it finds it.
//!
//! [`DetectWorkflow`] is driven by commands, by finished work and by the stage of the live pipeline;
//! it owns no thread.

mod attention;
pub mod command;
mod detector;
mod file;
mod objects;
mod stage;
mod store;
pub mod view;
pub mod work;
mod workflow;

pub use detector::{DetectorError, Detects, LoadedDetector, OpenDetector, SHOWN_FROM};
pub(crate) use file::threads as detector_threads;
pub use objects::{Defect, FoundObjects, Objects};
pub use stage::{DetectFailure, DetectInput, DetectOutput, DetectStage};
pub use workflow::{DetectAround, DetectWorkflow};
