//! Signs of life of one thread.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::WatchedThread;
use super::trial::Trial;
use crate::ground::bell::Bell;

/// Nothing is promised: the thread waits for something that may never come.
const AT_REST: u64 = u64::MAX;

/// Signs of life of one thread; clones speak of the same thread.
#[derive(Clone)]
pub struct Pulse {
    shared: Arc<Shared>,
}

struct Shared {
    thread: WatchedThread,
    bell: Bell,
    trial: Trial,
    born: Instant,
    /// When the thread gave a sign of life last, ms after it was born.
    beat_ms: AtomicU64,
    /// Until when it promised the next.
    due_ms: AtomicU64,
    asked_to_end: AtomicBool,
    has_failed: AtomicBool,
    failure: Mutex<Option<(String, Instant)>>,
}

/// What is wrong with a thread.
#[derive(Clone, Debug, PartialEq)]
pub enum Trouble {
    /// It ended although nobody asked it to.
    Ended {
        /// What the program or the system said.
        said: String,
        /// When.
        since: Instant,
    },
    /// It promised a sign of life and gave none.
    Silent {
        /// Since when.
        since: Instant,
    },
}

impl Pulse {
    /// Of a thread that is about to be started; its end is rung.
    pub fn new(thread: WatchedThread, bell: Bell, trial: Trial) -> Self {
        let shared = Shared {
            thread,
            bell,
            trial,
            born: Instant::now(),
            beat_ms: AtomicU64::new(0),
            due_ms: AtomicU64::new(AT_REST),
            asked_to_end: AtomicBool::new(false),
            has_failed: AtomicBool::new(false),
            failure: Mutex::default(),
        };
        Self { shared: Arc::new(shared) }
    }

    /// Whose.
    pub fn thread(&self) -> WatchedThread {
        self.shared.thread
    }

    /// A sign of life, and until when the next comes at the latest.
    pub fn promise(&self, within: Duration) {
        let now_ms = self.beat();
        let due_ms = now_ms.saturating_add(u64::try_from(within.as_millis()).unwrap_or(AT_REST));
        self.shared.due_ms.store(due_ms, Ordering::Release);
        self.shared.trial.strike_now(self.shared.thread);
    }

    /// A sign of life; the next may take any time, because the thread waits for work.
    pub fn rest(&self) {
        self.beat();
        self.shared.due_ms.store(AT_REST, Ordering::Release);
    }

    fn beat(&self) -> u64 {
        let now_ms = self.ms(Instant::now());
        self.shared.beat_ms.store(now_ms, Ordering::Release);
        now_ms
    }

    fn ms(&self, at: Instant) -> u64 {
        let age = at.saturating_duration_since(self.shared.born);
        u64::try_from(age.as_millis()).unwrap_or(AT_REST - 1)
    }

    /// Whether it ended although nobody asked it to.
    pub fn has_failed(&self) -> bool {
        self.shared.has_failed.load(Ordering::Acquire)
    }

    pub(super) fn ask_to_end(&self) {
        self.shared.asked_to_end.store(true, Ordering::Release);
    }

    /// The thread cannot go on; what is said first counts.
    pub fn fail(&self, said: &str) {
        log::error!("the thread {} has failed: {said}", self.shared.thread.name());
        let mut failure = self.failure();
        if failure.is_none() {
            *failure = Some((said.to_owned(), Instant::now()));
        }
        drop(failure);
        self.shared.has_failed.store(true, Ordering::Release);
        self.wake();
    }

    /// The thread's work has come to its end.
    pub(super) fn returned(&self) {
        let has_failed = self.shared.has_failed.load(Ordering::Acquire);
        if !self.shared.asked_to_end.load(Ordering::Acquire) && !has_failed {
            self.fail("it came to its end although nobody asked it to");
        }
    }

    pub(super) fn wake(&self) {
        self.shared.bell.ring();
    }

    fn failure(&self) -> MutexGuard<'_, Option<(String, Instant)>> {
        self.shared.failure.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What is wrong with the thread, if anything.
    pub fn trouble(&self, now: Instant) -> Option<Trouble> {
        if self.shared.has_failed.load(Ordering::Acquire) {
            let (said, since) = self.failure().clone()?;
            return Some(Trouble::Ended { said, since });
        }
        if self.shared.asked_to_end.load(Ordering::Acquire) {
            return None;
        }
        let due_ms = self.shared.due_ms.load(Ordering::Acquire);
        let beat_ms = self.shared.beat_ms.load(Ordering::Acquire);
        let is_late = due_ms != AT_REST && self.ms(now) > due_ms;
        is_late.then(|| Trouble::Silent { since: self.shared.born + Duration::from_millis(beat_ms) })
    }
}
