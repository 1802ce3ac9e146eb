//! Where the images come from: opening, losing and finding again, and playing recordings.

pub mod command;
mod player;
mod thread;
pub mod view;
pub mod work;
mod workflow;

pub use command::Control;
pub use player::{Note, Player};
pub use thread::{SourceThread, Wires};
pub use workflow::SourceWorkflow;
