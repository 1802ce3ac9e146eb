//! Why no search was made.

use plumbline_effects::MeasurementsError;
use plumbline_model::Cancelled;

/// Why no search was made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GapError {
    /// Too little to look at.
    #[error("{rows} rows are too few to find anything: measure at least {needed}")]
    TooFew {
        /// There are.
        rows: usize,
        /// Needed.
        needed: usize,
    },
    /// The sessions cannot be looked at.
    #[error(transparent)]
    Measurements(#[from] MeasurementsError),
    /// Cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
