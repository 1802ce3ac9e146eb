//! What has failed inside of the program.

use std::sync::Arc;
use std::time::Instant;

use super::{Trouble, WatchedThread};

/// A thread of the program that does not do its work any more.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreadFault {
    /// Which.
    pub thread: WatchedThread,
    /// What it means and what to do: a sentence.
    pub meaning: Arc<str>,
    /// What the program said when it failed; `None` when it only gives no sign of life.
    pub said: Option<Arc<str>>,
    /// Since when.
    pub since: Instant,
    /// Whether it can be started again now; while it holds on to something it cannot.
    pub can_start_again: bool,
}

impl ThreadFault {
    /// From what is wrong with a thread.
    pub fn new(thread: WatchedThread, trouble: Trouble, has_ended: bool) -> Self {
        match trouble {
            Trouble::Ended { said, since } => Self {
                thread,
                meaning: thread.meaning_of_end().into(),
                said: Some(said.into()),
                since,
                can_start_again: has_ended,
            },
            Trouble::Silent { since } => Self {
                thread,
                meaning: thread.meaning_of_silence().into(),
                said: None,
                since,
                can_start_again: false,
            },
        }
    }

    /// Whether it gives no sign of life but has not ended.
    pub fn is_silent(&self) -> bool {
        self.said.is_none()
    }
}
