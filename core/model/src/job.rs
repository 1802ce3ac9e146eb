//! What a long computation needs from whoever runs it: a way to be cancelled and a place to
//! report progress. The computation knows neither thread nor window.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

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

/// Cancels from a moment on, and knows what was being done: to measure how soon work stops.
#[derive(Debug)]
pub struct CancelledFrom {
    from: Instant,
    doing: Mutex<String>,
}

impl CancelledFrom {
    /// Cancels from so long after now on.
    pub fn after(wait: Duration) -> Self {
        Self { from: Instant::now() + wait, doing: Mutex::default() }
    }

    /// How long it has been cancelled.
    pub fn late(&self) -> Duration {
        Instant::now().saturating_duration_since(self.from)
    }

    /// What was reported last.
    pub fn doing(&self) -> String {
        self.doing.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl JobContext for CancelledFrom {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        if Instant::now() >= self.from { Err(Cancelled) } else { Ok(()) }
    }
    fn report(&self, _fraction: f64, doing: &str) {
        doing.clone_into(&mut self.doing.lock().unwrap_or_else(PoisonError::into_inner));
    }
}
