//! What was in use, what is, and what is written down of it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::around::TimelineAround;
use super::command::TimelineCommand;
use super::entries::{in_use, take_findings, take_measured, take_standing};
use super::kept::FILE;
use super::page;
use super::view::{Subject, TimelineEntry, TimelineView};
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
        self.writing = Some(context.start_by_itself(work));
        self.is_behind = false;
    }
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
