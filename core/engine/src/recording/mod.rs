//! Recording what works live into `log.mcap` of a session.

pub mod command;
mod export;
mod recorder;
#[cfg(test)]
mod tests;
pub mod view;
pub mod work;
mod workflow;

pub use recorder::Recorder;
pub use workflow::{RecordingAround, RecordingWorkflow};
