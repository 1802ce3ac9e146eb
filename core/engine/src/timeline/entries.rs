//! Entries of the timeline: what is put on it, where, and what is in use by it.

use jiff::Timestamp;

use super::around::{Measured, Standing, TimelineAround};
use super::view::{EntryKind, InUseNow, Subject, TimelineEntry};

/// The number of the next entry.
fn next_number(entries: &[TimelineEntry]) -> u64 {
    entries.iter().map(|entry| entry.number).max().map_or(1, |largest| largest + 1)
}

/// Puts an entry where its time is: what was done by another program is learned later than it was done, and in any
/// order. Those of one kind stay in the order in which they came, since each begins where the one before ended.
fn put(entries: &mut Vec<TimelineEntry>, entry: TimelineEntry) {
    let before = entries.iter().rposition(|other| other.subject == entry.subject || other.at <= entry.at);
    entries.insert(before.map_or(0, |before| before + 1), entry);
}

/// The last entry that says what is in use of a kind.
fn last_of(entries: &[TimelineEntry], subject: Subject) -> Option<&TimelineEntry> {
    entries.iter().rev().find(|entry| entry.subject == subject)
}

/// What is in use of a kind; whether that is another than before.
pub(super) fn take_standing(
    entries: &mut Vec<TimelineEntry>,
    standing: &Standing,
    is_first: bool,
    by_undo: bool,
    now: Timestamp,
) -> bool {
    let last = last_of(entries, standing.subject);
    let id_before = last.and_then(|last| last.id_after.clone());
    if id_before == standing.id {
        return false;
    }
    let was_in_use = |id: &Option<String>| {
        let of_subject = entries.iter().filter(|entry| entry.subject == standing.subject);
        id.is_none() || of_subject.into_iter().any(|entry| entry.id_after == *id || entry.id_before == *id)
    };
    let kind = match last {
        None if is_first => EntryKind::Found,
        _ if was_in_use(&standing.id) => EntryKind::TakenBack,
        _ => EntryKind::PutInUse,
    };
    // What was known of the one before, unless this one knows better, on its own data.
    let error_before = last.and_then(|last| last.after);
    let before = match kind {
        EntryKind::TakenBack => error_before,
        _ => standing
            .before
            .or(error_before.filter(|before| standing.after.is_some_and(|a| a.is_like(*before)))),
    };
    let accepted = standing.accepted.filter(|_| is_first && kind != EntryKind::TakenBack);
    let entry = TimelineEntry {
        number: next_number(entries),
        at: accepted.unwrap_or(now),
        subject: standing.subject,
        kind,
        title: standing.title.clone(),
        before,
        after: standing.after,
        basis: standing.basis.clone(),
        id_before,
        id_after: standing.id.clone(),
        outside: is_first && kind != EntryKind::Found,
        by_undo,
    };
    put(entries, entry);
    true
}

/// Findings that are not on the line yet.
pub(super) fn take_findings(entries: &mut Vec<TimelineEntry>, around: &TimelineAround) {
    let is_known = |entries: &[TimelineEntry], id: &str| {
        let of = |entry: &&TimelineEntry| entry.subject == Subject::Finding;
        entries.iter().filter(of).any(|entry| entry.id_after.as_deref() == Some(id))
    };
    let mut new: Vec<_> = around.findings.iter().filter(|found| !is_known(entries, &found.id)).collect();
    new.sort_by_key(|found| found.made);
    for found in new {
        let entry = TimelineEntry {
            number: next_number(entries),
            at: found.made,
            subject: Subject::Finding,
            kind: EntryKind::Measured,
            title: found.title.clone(),
            before: Some(found.before),
            after: Some(found.after),
            basis: "mean error on rows that were not used; only found, not in use".to_owned(),
            id_before: None,
            id_after: Some(found.id.clone()),
            outside: false,
            by_undo: false,
        };
        put(entries, entry);
    }
}

/// What is there already is brought up to date: touches may be taken out of it later. What it was called when it was
/// measured it is called still.
pub(super) fn take_measured(entries: &mut Vec<TimelineEntry>, measured: &Measured, now: Timestamp) {
    let is_run = |subject| matches!(subject, Subject::Touches | Subject::Experiment);
    let is_same = |entry: &&mut TimelineEntry| {
        let of_kind = entry.subject == measured.subject || is_run(entry.subject) && is_run(measured.subject);
        of_kind && entry.id_after.as_deref() == Some(&measured.id)
    };
    if let Some(known) = entries.iter_mut().find(is_same) {
        // An evaluation stands as the model in use then had it, whatever it is shown with later.
        if known.subject == Subject::Places {
            return;
        }
        // Touches that a finding suggested are that still when another one is shown.
        if known.subject == measured.subject {
            known.title.clone_from(&measured.title);
        }
        known.after = Some(measured.after);
        // What it was compared with may be in use no more.
        if measured.before.is_some() || known.before.is_none() {
            known.before = measured.before;
            known.basis.clone_from(&measured.basis);
        }
        return;
    }
    let entry = TimelineEntry {
        number: next_number(entries),
        at: measured.at.unwrap_or(now),
        subject: measured.subject,
        kind: EntryKind::Measured,
        title: measured.title.clone(),
        before: measured.before,
        after: Some(measured.after),
        basis: measured.basis.clone(),
        id_before: None,
        id_after: Some(measured.id.clone()),
        outside: false,
        by_undo: false,
    };
    put(entries, entry);
}

/// What is in use, with the entries since which it is.
pub(super) fn in_use(entries: &[TimelineEntry], around: &TimelineAround) -> Vec<InUseNow> {
    let standings = around.in_use.iter().map(|standing| {
        let entry = last_of(entries, standing.subject).filter(|entry| entry.id_after == standing.id);
        InUseNow {
            subject: standing.subject,
            title: standing.title.clone(),
            figure: standing.after,
            since: entry.map(|entry| entry.at),
            entry: entry.map(|entry| entry.number),
            against: against(around, standing.subject),
        }
    });
    standings.collect()
}

fn against(around: &TimelineAround, subject: Subject) -> String {
    let of_it = around.against.iter().filter(|(of, _)| *of == subject);
    of_it.map(|(_, said)| said.as_str()).collect::<Vec<_>>().join(" ")
}
