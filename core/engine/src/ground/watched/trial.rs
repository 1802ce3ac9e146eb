//! Faults that tests put into threads, to see that they are noticed. The program itself never holds
//! an armed one. And eyes that tests make up.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use plumbline_hardware::StereoSource;

use super::WatchedThread;

/// What is done to a thread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strike {
    /// It panics.
    Panic,
    /// It gives no sign of life for so long.
    Hang(Duration),
}

/// Makes eyes up, each time that they are opened.
pub type MadeUpEyes = Arc<dyn Fn() -> Box<dyn StereoSource> + Send + Sync>;

/// Handed to [`crate::Engine::start_on_trial`] by tests; the usual one does nothing.
#[derive(Clone, Default)]
pub struct Trial {
    strikes: Option<Arc<Mutex<BTreeMap<WatchedThread, Strike>>>>,
    eyes: Option<MadeUpEyes>,
}

impl fmt::Debug for Trial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let has_eyes = self.eyes.is_some();
        f.debug_struct("Trial").field("strikes", &self.strikes).field("has_eyes", &has_eyes).finish()
    }
}

impl Trial {
    /// One that can strike.
    pub fn armed() -> Self {
        Self { strikes: Some(Arc::default()), eyes: None }
    }

    /// One with eyes in place of the twin's, which need no twin.
    pub fn with_eyes(eyes: MadeUpEyes) -> Self {
        Self { strikes: None, eyes: Some(eyes) }
    }

    /// The eyes in place of the twin's.
    pub fn eyes(&self) -> Option<&MadeUpEyes> {
        self.eyes.as_ref()
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
