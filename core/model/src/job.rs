//! What a long computation needs from whoever runs it: a way to be cancelled and a place to
//! report progress. The computation knows neither thread nor window.

/// The work was cancelled on request; nothing was changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// Handed to every long computation.
pub trait JobContext: Sync {
    /// Call at least every 100 ms; returns `Err` as soon as the work should stop.
    fn checkpoint(&self) -> Result<(), Cancelled>;
    /// `fraction` in 0..=1, `doing` a short phrase ("solving, iteration 4").
    fn report(&self, fraction: f64, doing: &str);
}

/// Never cancels, reports nowhere.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unattended;

impl JobContext for Unattended {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        Ok(())
    }
    fn report(&self, _fraction: f64, _doing: &str) {}
}
