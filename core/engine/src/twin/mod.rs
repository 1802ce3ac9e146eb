//! The twin: starting it, what stands on its table, its clock, its faults, and its eyes.

mod board_tour;
pub mod command;
mod desk;
mod eyes;
mod unable;
pub mod view;

pub use board_tour::BoardLook;
pub use desk::TwinDesk;
pub use eyes::TwinEyesPlug;
pub use unable::TwinUnable;

/// How a scenario that was given by name or by file is called for short.
pub fn short_name(scenario: &str) -> &str {
    plumbline_twin::Scenario::short_name(scenario)
}

/// Whether there is such a scenario, by name or in a file; else why not.
///
/// # Errors
/// What is wrong with it.
pub fn check_scenario(scenario: &str) -> Result<(), TwinUnable> {
    Ok(plumbline_twin::Scenario::named_or_file(scenario).map(drop)?)
}

/// Names of the twin's scenarios that come with the program.
pub fn scenarios() -> impl Iterator<Item = &'static str> {
    plumbline_twin::Scenario::built_in_names()
}
