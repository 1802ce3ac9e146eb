//! The twin's truth beside what is measured: shown on request, marked, and read by nobody else.
//!
//! The way is one-sided. `judge.rs` alone asks the twin what is really so. It hands that in through a
//! [`TruthPlug`], which can only be written to and is held by whoever owns the twin; what is inside can be
//! seen in this room only. It leaves as differences for the window (`TruthView`), which no workflow
//! sees: nothing that calibrates, searches, touches or grasps may use this room, and the test of the
//! structure holds it to that.

pub mod command;
mod compare;
mod judge;
pub mod view;
mod workflow;

pub use judge::TruthPlug;
pub use workflow::{Seen, TruthAround, TruthWorkflow};
