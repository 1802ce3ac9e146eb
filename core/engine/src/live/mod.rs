//! What is computed live, for whom, and what came of it last.

pub mod command;
mod no_reading;
mod probe;
mod rectify;
mod setup;
pub mod view;
mod workflow;

pub use probe::{ProbeInput, ProbeOutput, ProbeStage};
pub use rectify::{RectifyInput, RectifyOutput, RectifyStage};
pub use setup::{LiveSetup, NoPlace, OtherSize, aimed, fitting};
pub use workflow::LiveWorkflow;
