//! Results of the timeline in words.

use plumbline_engine::view::{EntryKind, Figure, TimelineEntry};
use plumbline_widgets::format;

/// "0.93 mm", "0.082 px" or "84 %".
pub fn figure(figure: Figure) -> String {
    match figure {
        Figure::Meters(length_m) => format::mm(length_m),
        Figure::Pixels(px) => format::px(px),
        Figure::Share(share) => format::percent(share),
    }
}

/// "5.88 → 0.93 mm"; empty where no error is known.
pub fn errors(entry: &TimelineEntry) -> String {
    match (entry.before, entry.after) {
        (Some(before), Some(after)) => short(&figure(before), &figure(after)),
        (None, Some(after)) => figure(after),
        (_, None) => String::new(),
    }
}

/// The unit stands once where both have the same.
fn short(before: &str, after: &str) -> String {
    let unit = |text: &str| text.split_once(' ').map(|(_, unit)| unit.to_owned());
    match before.split_once(' ') {
        Some((number, of)) if unit(after).as_deref() == Some(of) => format!("{number} → {after}"),
        _ => format!("{before} → {after}"),
    }
}

/// What happened, for people: "M3 from 245 touches", "back to: …".
pub fn title(entry: &TimelineEntry) -> String {
    match entry.kind {
        EntryKind::TakenBack => format!("back to: {}", entry.title),
        EntryKind::PutInUse | EntryKind::Found | EntryKind::Measured => entry.title.clone(),
    }
}

/// More of it, a sentence each, where a row is pointed at.
pub fn about(entry: &TimelineEntry) -> String {
    let kind = match entry.kind {
        EntryKind::PutInUse => "Put in use.",
        EntryKind::TakenBack => "What was in use before is in use again.",
        EntryKind::Found => "In use already when the timeline began.",
        EntryKind::Measured => "Only measured: it changed nothing that is in use.",
    };
    let outside = if entry.outside {
        "\nDone while this program was closed, by the command line or another program."
    } else {
        ""
    };
    let basis = if entry.basis.is_empty() { String::new() } else { format!("\nErrors: {}.", entry.basis) };
    format!("{kind}{outside}{basis}")
}

#[cfg(test)]
mod tests {
    use plumbline_engine::view::Subject;

    use super::*;

    #[test]
    fn an_error_says_its_unit_and_nothing_where_there_is_none() {
        let mut entry = TimelineEntry {
            number: 1,
            at: jiff::Timestamp::UNIX_EPOCH,
            subject: Subject::Check,
            kind: EntryKind::Measured,
            title: "25 touches".to_owned(),
            before: Some(Figure::Meters(5.88e-3)),
            after: Some(Figure::Meters(0.93e-3)),
            basis: String::new(),
            id_before: None,
            id_after: None,
            outside: true,
            by_undo: false,
        };
        assert_eq!(errors(&entry), "5.88 → 0.93 mm");
        assert!(about(&entry).contains("while this program was closed"));
        (entry.before, entry.after) = (None, Some(Figure::Pixels(0.0824)));
        assert!(errors(&entry).ends_with(" px"), "{}", errors(&entry));
        (entry.before, entry.after) = (Some(Figure::Share(0.3)), Some(Figure::Share(0.9)));
        assert_eq!(errors(&entry), format!("30 → {}", figure(Figure::Share(0.9))));
        (entry.before, entry.after) = (None, None);
        assert_eq!(errors(&entry), "");
    }
}
