//! The timeline of results: what came last, and the report.

use plumbline_engine::view::EntryKind;
use plumbline_engine::{TimelineFormat, View};
use plumbline_widgets::format;

use super::sentence::{Guidance, say};
use crate::operator::words::timeline::figure;
use crate::operator::{Action, Screen, TimelineAction};

pub(super) fn timeline(view: &View) -> Guidance {
    let timeline = &view.timeline;
    if !timeline.is_known {
        return say("The timeline of results is being read.");
    }
    let Some(newest) = timeline.entries.last() else {
        return say("Nothing was put in use yet: every calibration, model and check will stand here.")
            .then("Go to Commission", Action::Go(Screen::Commission));
    };
    let what = match newest.kind {
        EntryKind::PutInUse => "put in use",
        EntryKind::TakenBack => "taken back to",
        EntryKind::Found => "in use",
        EntryKind::Measured => "measured",
    };
    let error = match (newest.before, newest.after) {
        (Some(before), Some(after)) if before.is_like(after) => {
            format!(", {} → {}", figure(before), figure(after))
        }
        (_, Some(after)) => format!(", {}", figure(after)),
        _ => String::new(),
    };
    // What was taken back is an entry, too.
    let count = format::count(timeline.entries.len(), "entry");
    say(format!("{count}. The newest, {what}: {}{error}.", newest.title))
        .then("Report of the setup…", TimelineAction::Report(TimelineFormat::Html).into())
}
