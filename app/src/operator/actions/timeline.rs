//! What can be asked for by name of the timeline of results, and how what is on it is taken back.

use std::borrow::Cow;

use plumbline_engine::view::TimelineEntry;
use plumbline_engine::{Command, TimelineFormat, View};
use serde::Serialize;

use super::undo::{Undo, back_to, of_result};

/// Of the timeline of results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimelineAction {
    /// Takes back what was put in use last, of whatever kind.
    TakeBack,
    /// Writes what is in use and how it came to that (asks where to).
    Report(TimelineFormat),
}

impl TimelineAction {
    /// All of them, in the palette's order.
    pub const ALL: [Self; 4] = [
        Self::TakeBack,
        Self::Report(TimelineFormat::Html),
        Self::Report(TimelineFormat::Pdf),
        Self::Report(TimelineFormat::Csv),
    ];

    /// What it is called everywhere.
    pub fn label(self) -> &'static str {
        match self {
            Self::TakeBack => "Undo what was put in use last",
            Self::Report(TimelineFormat::Html) => "Report of the setup (HTML)…",
            Self::Report(TimelineFormat::Pdf) => "Report of the setup (PDF)…",
            Self::Report(TimelineFormat::Csv) => "Timeline of results (CSV)…",
        }
    }

    /// Why it cannot be done now.
    pub fn refusal(self, view: &View) -> Option<Cow<'static, str>> {
        match self {
            Self::TakeBack if newest(view).is_none() => {
                Some("nothing was put in use since the timeline began".into())
            }
            Self::Report(_) if !view.timeline.is_known => Some("the timeline is not read yet".into()),
            Self::Report(_) if view.timeline.entries.is_empty() => Some("nothing was put in use yet".into()),
            Self::TakeBack | Self::Report(_) => None,
        }
    }
}

/// Takes back the newest change that can be.
pub fn newest(view: &View) -> Option<Undo> {
    view.timeline.entries.iter().rev().find_map(|entry| take_back(view, entry))
}

/// What takes an entry back; `None`: something came after it, it changed nothing, or nothing is known that was
/// before.
pub fn take_back(view: &View, entry: &TimelineEntry) -> Option<Undo> {
    view.timeline.is_newest(entry).then(|| of_result(view, entry.subject))?.ok()
}

/// What puts in use again what an entry put in use; `None`: it is in use, or its workflow keeps only the
/// order in which things were in use, and goes back step by step.
pub fn use_again(view: &View, entry: &TimelineEntry) -> Option<Command> {
    let is_in_use = view.timeline.in_use.iter().any(|now| {
        let since = now.entry.and_then(|number| view.timeline.entry(number));
        now.subject == entry.subject && since.is_some_and(|since| since.id_after == entry.id_after)
    });
    entry.id_after.as_ref().filter(|_| !is_in_use)?;
    back_to(entry.subject, entry.id_after.as_ref())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_results_the_reasons_are_said() {
        let view = View::default();
        let why = TimelineAction::Report(TimelineFormat::Html).refusal(&view);
        assert_eq!(why.as_deref(), Some("the timeline is not read yet"));
        assert!(TimelineAction::TakeBack.refusal(&view).is_some_and(|why| why.contains("nothing was put")));
        assert_eq!(newest(&view), None);
    }
}
