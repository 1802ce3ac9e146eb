//! Watching drift: whether places stay where they are, looked at again and again in the background.

mod around;
mod cold;
pub mod command;
mod explained;
mod figures;
mod grid;
mod grid_room;
#[cfg(test)]
mod grid_tests;
mod stage;
mod stated;
#[cfg(test)]
mod tests;
mod told;
mod unjudged;
pub mod view;
mod watch;
pub mod work;
mod workflow;

pub use around::{BoardAt, DriftAround};
pub use grid_room::PlacesResult;
pub use stage::{DriftInput, DriftOutput, DriftStage};
pub use told::Told;
pub use unjudged::Unjudged;
pub use workflow::DriftWorkflow;
