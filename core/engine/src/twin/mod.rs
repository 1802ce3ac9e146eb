//! The twin: starting it, what stands on its table, its clock, its faults, and its eyes.

pub mod command;
mod desk;
mod eyes;
mod unable;
pub mod view;

pub use desk::TwinDesk;
pub use eyes::TwinEyesPlug;
pub use unable::TwinUnable;

/// Names of the twin's scenarios that come with the program.
pub fn scenarios() -> impl Iterator<Item = &'static str> {
    plumbline_twin::Scenario::built_in_names()
}
