//! Messages to the operator, with a bounded history.

use std::collections::VecDeque;
use std::sync::Arc;

use jiff::Timestamp;
use plumbline_model::files::told;
use serde::{Deserialize, Serialize};

use super::time::{Clock, Time};

/// How much a message matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NoticeLevel {
    /// Something happened.
    Info,
    /// Something was done as asked.
    Success,
    /// Something needs attention.
    Warning,
    /// Something could not be done.
    Error,
}

/// One message.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Counts up; tells the window which ones are new.
    pub number: u64,
    /// How much it matters.
    pub level: NoticeLevel,
    /// What happened and, if something is wrong, what to do.
    pub text: String,
    /// When, the last time, UTC.
    pub at: Timestamp,
    /// How often it was said in a row.
    pub times: u32,
}

/// Messages to the operator.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoticeCommand {
    /// Adds a message of the window itself (a screenshot was saved, …).
    Add {
        /// How much it matters.
        level: NoticeLevel,
        /// A sentence.
        text: String,
    },
    /// Empties the history.
    Clear,
}

/// The newest messages, oldest first.
#[derive(Clone, Debug, Default)]
pub struct Notices {
    newest: VecDeque<Notice>,
    count: u64,
    clock: Clock,
    /// What the window shows, until something changes.
    view: Option<Arc<[Notice]>>,
}

impl Notices {
    /// How many messages are kept.
    pub const KEPT: usize = 500;

    /// Adds a message; the oldest one goes when there are too many. What was said last is not
    /// said again, only counted.
    pub fn add(&mut self, level: NoticeLevel, text: impl Into<String>) {
        // What a file holds may be quoted in it.
        let text = told(&text.into());
        self.view = None;
        if let Some(last) = self.newest.back_mut().filter(|last| last.level == level && last.text == text) {
            last.at = self.clock.time().day;
            last.times += 1;
            return;
        }
        match level {
            NoticeLevel::Info | NoticeLevel::Success => log::info!("{text}"),
            NoticeLevel::Warning => log::warn!("{text}"),
            NoticeLevel::Error => log::error!("{text}"),
        }
        if self.newest.len() == Self::KEPT {
            self.newest.pop_front();
        }
        self.count += 1;
        let at = self.clock.time().day;
        self.newest.push_back(Notice { number: self.count, level, text, at, times: 1 });
    }

    /// The clock that tells when something was said stands still; `None`: it goes again.
    pub fn hold_time(&mut self, time: Option<Time>) {
        self.clock.hold(time);
    }

    /// Empties the history; numbers go on counting.
    pub fn clear(&mut self) {
        self.newest.clear();
        self.view = None;
    }

    /// What the window shows, oldest first.
    pub fn view(&mut self) -> Arc<[Notice]> {
        self.view.get_or_insert_with(|| self.newest.iter().cloned().collect()).clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_history_is_bounded_and_keeps_the_newest() {
        let mut notices = Notices::default();
        for i in 0..Notices::KEPT + 3 {
            notices.add(NoticeLevel::Info, format!("message {i}"));
        }
        let view = notices.view();
        assert_eq!(view.len(), Notices::KEPT);
        assert_eq!(view[0].text, "message 3");
        assert_eq!(view[view.len() - 1].number, Notices::KEPT as u64 + 3);
    }

    #[test]
    fn what_is_said_again_and_again_takes_one_line() {
        let mut notices = Notices::default();
        for _ in 0..40 {
            notices.add(NoticeLevel::Error, "the same");
        }
        notices.add(NoticeLevel::Warning, "the same");
        let times: Vec<u32> = notices.view().iter().map(|notice| notice.times).collect();
        assert_eq!(times, [40, 1]);
    }
}
