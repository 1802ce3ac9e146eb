//! A sentence and a button.

use crate::operator::Action;
use crate::operator::words::capitalized;

/// The bottom line.
#[derive(Clone, Debug, PartialEq)]
pub struct Guidance {
    /// What is happening and what to do next.
    pub sentence: String,
    /// Whether it needs attention.
    pub warning: bool,
    /// The one button.
    pub next: Option<NextButton>,
}

/// The one button of a screen.
#[derive(Clone, Debug, PartialEq)]
pub struct NextButton {
    /// Named by what it does.
    pub label: String,
    /// What it does.
    pub action: Action,
}

pub(super) fn say(sentence: impl Into<String>) -> Guidance {
    Guidance { sentence: capitalized(&sentence.into()), warning: false, next: None }
}

impl Guidance {
    pub(super) fn then(mut self, label: impl Into<String>, action: Action) -> Self {
        self.next = Some(NextButton { label: label.into(), action });
        self
    }

    pub(super) fn warn(mut self) -> Self {
        self.warning = true;
        self
    }
}
