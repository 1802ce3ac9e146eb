//! Why something is not done with the twin: sentences.

use plumbline_model::counted;
use plumbline_twin::TwinError;

use crate::ground::text::sentence;

/// Why something is not done with the twin.
#[derive(Debug, thiserror::Error)]
pub enum TwinUnable {
    /// There is none.
    #[error("The twin is not running. Connect to it first.")]
    NotRunning,
    /// It could not be started.
    #[error("{}", sentence(&.0.to_string()))]
    Twin(#[from] TwinError),
    /// The twin has no such toy.
    #[error("There is no toy called {0}.")]
    NoToy(String),
    /// It would fall.
    #[error("That place is not on the table.")]
    BesideTable,
    /// The board is held at places that were chosen.
    #[error("The board has {}.", counted(*.0, "place"))]
    NoPlace(usize),
    /// A place that is none.
    #[error("The place of the board must be numbers.")]
    NotNumbers,
    /// Too far.
    #[error("The clock can be advanced by up to 600 minutes.")]
    TooLong,
    /// The twin has no such fault.
    #[error("There is no fault called {0}.")]
    NoFault(String),
}
