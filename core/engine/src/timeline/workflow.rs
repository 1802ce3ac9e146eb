//! What was in use, what is, and what is written down of it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use jiff::Timestamp;

use super::around::{Measured, Standing, TimelineAround};
use super::command::TimelineCommand;
use super::kept::FILE;
use super::page;
use super::view::{EntryKind, InUseNow, Subject, TimelineEntry, TimelineView};
use super::work::{Context, TimelineResult, TimelineWork};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::{Moment, Nothing, Workflow};

/// A step back that Undo has asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct StepBack {
    /// Of which kind.
    pub subject: Subject,
    /// What is in use again then; `None`: as it is described.
    pub to: Option<String>,
}

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct TimelineWorkflow {
    file: PathBuf,
    /// Oldest first; `None`: not read yet, or its file cannot be used, so nothing is written over it.
    entries: Option<Arc<[TimelineEntry]>>,
    /// Whether the first look has been taken at a kind since the program began: what differs then was
    /// changed by another program.
    looked_at: Vec<Subject>,
    /// Steps back that were asked for, to be handed to the workflows that take them.
    asked: Vec<StepBack>,
    /// Steps back that are being taken, and the work that takes them.
    taking_back: Vec<(StepBack, JobId)>,
    writing: Option<JobId>,
    /// Whether something came since it was written last.
    is_behind: bool,
}

impl TimelineWorkflow {
    /// Something may have been put in use, taken back, found or checked.
    pub fn look(&mut self, around: &TimelineAround, context: &mut Context<'_>) {
        let Some(known) = &self.entries else { return };
        let mut entries = known.to_vec();
        for standing in &around.in_use {
            let is_first = !self.looked_at.contains(&standing.subject);
            if is_first {
                self.looked_at.push(standing.subject);
            }
            let of_kind = |step: &StepBack| step.subject == standing.subject;
            let by_undo = self.taking_back.iter().find(|(step, _)| of_kind(step)).map(|(step, _)| &step.to);
            let by_undo = by_undo == Some(&standing.id);
            if take_standing(&mut entries, standing, is_first, by_undo, context.time.day) {
                self.taking_back.retain(|(step, _)| !of_kind(step));
            }
        }
        take_findings(&mut entries, around);
        for measured in &around.measured {
            take_measured(&mut entries, measured, context.time.day);
        }
        if entries[..] != known[..] {
            self.entries = Some(entries.into());
            self.is_behind = true;
        }
        self.keep(context);
    }

    /// Steps back for the workflows that take them.
    pub fn take_steps(&mut self) -> Vec<StepBack> {
        std::mem::take(&mut self.asked)
    }

    /// A step back is being taken: what comes into use by it is no step of its own.
    pub fn stepping_back(&mut self, step: StepBack, work: JobId) {
        self.taking_back.retain(|(other, _)| other.subject != step.subject);
        self.taking_back.push((step, work));
    }

    /// Work has ended: a step that it took was noted by now, or it was not taken.
    pub fn stepped_back(&mut self, work: JobId) {
        self.taking_back.retain(|(_, taken_by)| *taken_by != work);
    }

    fn keep(&mut self, context: &mut Context<'_>) {
        let Some(entries) = self.entries.as_ref().filter(|_| self.is_behind && self.writing.is_none()) else {
            return;
        };
        let work = TimelineWork::Keep { file: self.file.clone(), entries: entries.clone() };
        self.writing = Some(context.start(work));
        self.is_behind = false;
    }
}

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
fn take_standing(
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

fn take_findings(entries: &mut Vec<TimelineEntry>, around: &TimelineAround) {
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
fn take_measured(entries: &mut Vec<TimelineEntry>, measured: &Measured, now: Timestamp) {
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
        }
    });
    standings.collect()
}

impl Workflow for TimelineWorkflow {
    type Command = TimelineCommand;
    type Work = TimelineWork;
    type Control = Nothing;
    type Around = TimelineAround;
    type View = TimelineView;

    fn new(folder: &Path) -> Self {
        Self {
            file: folder.join(FILE),
            entries: None,
            looked_at: Vec::new(),
            asked: Vec::new(),
            taking_back: Vec::new(),
            writing: None,
            is_behind: false,
        }
    }

    fn restore(&mut self, _: &TimelineAround, context: &mut Context<'_>) {
        context.start(TimelineWork::Restore { file: self.file.clone() });
    }

    fn view(&mut self, around: &TimelineAround, _: &Moment) -> Arc<TimelineView> {
        let entries = self.entries.clone().unwrap_or_default();
        let in_use = in_use(&entries, around).into();
        Arc::new(TimelineView { is_known: self.entries.is_some(), in_use, entries })
    }

    fn apply(&mut self, command: TimelineCommand, around: &TimelineAround, context: &mut Context<'_>) {
        let (file, format) = match command {
            TimelineCommand::Report { file, format } => (file, format),
            TimelineCommand::TakeBack { subject, to } => return self.asked.push(StepBack { subject, to }),
        };
        let Some(entries) = self.entries.clone() else {
            return context.refuse("The timeline was not read yet, or cannot be: the messages say why.");
        };
        let setup = Box::new(page::setup(&entries, around, context.time.day));
        context.start(TimelineWork::Report { file, format, entries, setup });
    }

    fn work_done(
        &mut self,
        id: JobId,
        result: TimelineResult,
        around: &TimelineAround,
        context: &mut Context<'_>,
    ) {
        self.writing.take_if(|writing| *writing == id);
        if let TimelineResult::Restored(entries) = result {
            self.entries = Some(entries.into());
        }
        self.look(around, context);
    }

    fn work_ended(&mut self, id: JobId, why: Option<&str>, _: &TimelineAround, context: &mut Context<'_>) {
        if self.writing.take_if(|writing| *writing == id).is_some()
            && let Some(why) = why
        {
            // Written with the next entry; tried again at once it would say the same again.
            context.notices.add(NoticeLevel::Warning, format!("{why} The timeline goes on."));
        }
    }
}
