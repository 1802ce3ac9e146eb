//! What is computed live, for whom, and what came of it last.

pub mod command;
mod no_reading;
mod probe;
mod rectify;
mod setup;
pub mod view;
mod wide;
mod workflow;

pub use no_reading::NoReading;
pub use probe::{ProbeInput, ProbeOutput, ProbeStage};
pub use rectify::{RectifyInput, RectifyOutput, RectifyStage};
pub use setup::{LiveSetup, NoPlace, NoSetup, OtherSize, aimed, fitting};
pub use wide::wide_because;
pub use workflow::LiveWorkflow;
