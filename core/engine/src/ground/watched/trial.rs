//! Faults that tests put into threads, to see that they are noticed. The program itself never holds
//! an armed one.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::WatchedThread;

/// What is done to a thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strike {
    /// It panics.
    Panic,
    /// It gives no sign of life for so long.
    Hang(Duration),
}

/// Handed to [`crate::Engine::start_on_trial`] by tests; the usual one does nothing.
#[derive(Clone, Debug, Default)]
pub struct Trial {
    strikes: Option<Arc<Mutex<BTreeMap<WatchedThread, Strike>>>>,
}

impl Trial {
    /// One that can strike.
    pub fn armed() -> Self {
        Self { strikes: Some(Arc::default()) }
    }

    /// Strikes a thread once, at its next sign of life.
    pub fn strike(&self, thread: WatchedThread, strike: Strike) {
        if let Some(strikes) = &self.strikes {
            strikes.lock().unwrap_or_else(PoisonError::into_inner).insert(thread, strike);
        }
    }

    pub(super) fn strike_now(&self, thread: WatchedThread) {
        let Some(strikes) = &self.strikes else { return };
        // The lock is let go before the strike.
        let strike = strikes.lock().unwrap_or_else(PoisonError::into_inner).remove(&thread);
        match strike {
            None => {}
            Some(Strike::Panic) => panic!("struck by a test"),
            Some(Strike::Hang(time)) => std::thread::sleep(time),
        }
    }
}
