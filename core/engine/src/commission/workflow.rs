//! How far commissioning is.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::touch_plan::Purpose;

use super::around::CommissionAround;
use super::command::CommissionCommand;
use super::kept::{FILE, Kept};
use super::steps::{finished, steps, take_effects};
use super::view::{CommissionSpent, CommissionView, LEAST_CHECKED, LEAST_TOUCHES};
use super::work::{CommissionResult, CommissionWork, Context};
use crate::ground::jobs::JobId;
use crate::ground::notice::NoticeLevel;
use crate::ground::time::Time;
use crate::ground::{Moment, Nothing, Workflow};
use crate::touch::RunStanding;

/// So much time may be lost when the program ends without a word.
const KEPT_EVERY_S: f64 = 20.0;

/// The whole workflow, of one world.
#[derive(Clone, Debug)]
pub struct CommissionWorkflow {
    file: PathBuf,
    /// Whether the file was read, or there is none.
    is_known: bool,
    kept: Option<Kept>,
    /// As it is on disk.
    written: Option<Kept>,
    writing: Option<(JobId, Box<Kept>)>,
    /// Until when the time spent is counted; `None` while it stands still.
    counted_to: Option<Instant>,
    /// Views of the board when they were counted last.
    views_seen: Option<usize>,
}

impl CommissionWorkflow {
    /// Something may have changed around: what was spent is counted, and what was finished is kept.
    pub fn look(&mut self, around: &CommissionAround, context: &mut Context<'_>) {
        if let Some(kept) = self.kept.as_mut().filter(|kept| kept.is_on) {
            take_effects(kept, around, context.time);
        }
        let counts = self.is_counting(around);
        let views_seen = self.views_seen.replace(around.views).unwrap_or(around.views);
        let counted_to = std::mem::replace(&mut self.counted_to, counts.then_some(context.time.instant));
        let Some(kept) = self.kept.as_mut().filter(|_| counts) else {
            return self.keep(context);
        };
        if let Some(counted_to) = counted_to {
            kept.spent_s += context.time.instant.saturating_duration_since(counted_to).as_secs_f64();
        }
        kept.views += around.views.saturating_sub(views_seen);
        if let Some(run) = &around.run {
            take_run(kept, run, context.time);
        }
        take_effects(kept, around, context.time);
        self.keep(context);
    }

    /// Whether the operator is led and something is left to be done.
    fn is_counting(&self, around: &CommissionAround) -> bool {
        let kept = self.kept.as_ref().filter(|kept| kept.is_on);
        kept.is_some() && steps(around, kept).iter().any(|step| step.done().is_none())
    }

    /// Writes what changed; the time alone not each time.
    fn keep(&mut self, context: &mut Context<'_>) {
        let Some(kept) = self.kept.as_ref().filter(|_| self.writing.is_none()) else { return };
        let is_written = self.written.as_ref().is_some_and(|written| {
            let mut aged = written.clone();
            aged.spent_s = kept.spent_s;
            aged == *kept && kept.spent_s - written.spent_s < KEPT_EVERY_S
        });
        if !is_written {
            let kept = Box::new(kept.clone());
            let work = CommissionWork::Keep { file: self.file.clone(), kept: kept.clone() };
            self.writing = Some((context.start_by_itself(work), kept));
        }
    }

    fn start(&mut self, anew: bool, context: &mut Context<'_>) {
        if !self.is_known {
            return context
                .refuse("How far commissioning is was not read yet, or cannot be: the messages say why.");
        }
        match &mut self.kept {
            Some(kept) if !anew => kept.is_on = true,
            _ => self.kept = Some(Kept::begun(context.time.day, anew)),
        }
    }

    fn spent(&self, now: Instant) -> CommissionSpent {
        let Some(kept) = &self.kept else { return CommissionSpent::default() };
        let since = self.counted_to.map_or(Duration::ZERO, |to| now.saturating_duration_since(to));
        let before = plumbline_model::duration::seconds(kept.spent_s).unwrap_or_default();
        // Whole seconds: the window need not be drawn again for less.
        let time = Duration::from_secs((before + since).as_secs());
        CommissionSpent { time, touches: kept.touches, views: kept.views }
    }
}

/// Counts contacts, and keeps a run that is finished.
fn take_run(kept: &mut Kept, run: &RunStanding, time: Time) {
    // What a session had when it was seen first was touched before.
    let before = kept.counted.insert(run.session.clone(), run.contacts).unwrap_or(run.contacts);
    kept.touches += run.contacts.saturating_sub(before);
    let is_of_before = kept.is_anew && run.started < kept.began;
    if !run.is_finished || is_of_before {
        return;
    }
    let newest = |known: &Option<super::kept::KeptRun>| {
        known.as_ref().is_none_or(|known| known.session != run.session || known.touched != run.touched)
    };
    match run.purpose {
        Purpose::Train if run.touched >= LEAST_TOUCHES && newest(&kept.touched) => {
            kept.touched = Some(finished(run, time.day));
            kept.learned = None;
            kept.checked = None;
        }
        Purpose::Check if run.touched >= LEAST_CHECKED && newest(&kept.checked) => {
            kept.checked = Some(finished(run, time.day));
        }
        _ => {}
    }
}

impl Workflow for CommissionWorkflow {
    type Command = CommissionCommand;
    type Work = CommissionWork;
    type Control = Nothing;
    type Around = CommissionAround;
    type View = CommissionView;

    /// Nothing known yet.
    fn new(folder: &Path) -> Self {
        Self {
            file: folder.join(FILE),
            is_known: false,
            kept: None,
            written: None,
            writing: None,
            counted_to: None,
            views_seen: None,
        }
    }

    fn restore(&mut self, _: &CommissionAround, context: &mut Context<'_>) {
        context.start(CommissionWork::Restore { file: self.file.clone() });
    }

    fn view(&mut self, around: &CommissionAround, moment: &Moment) -> Arc<CommissionView> {
        let kept = self.kept.as_ref();
        Arc::new(CommissionView {
            is_known: self.is_known,
            is_on: kept.is_some_and(|kept| kept.is_on),
            began: kept.map(|kept| kept.began),
            steps: Arc::from(steps(around, kept)),
            spent: self.spent(moment.now),
        })
    }

    fn apply(&mut self, command: CommissionCommand, around: &CommissionAround, context: &mut Context<'_>) {
        match command {
            CommissionCommand::Start { anew } => self.start(anew, context),
            CommissionCommand::Leave => {
                // Counted to its end.
                self.look(around, context);
                if let Some(kept) = &mut self.kept {
                    kept.is_on = false;
                }
            }
        }
        self.look(around, context);
    }

    fn work_done(
        &mut self,
        id: JobId,
        result: CommissionResult,
        around: &CommissionAround,
        context: &mut Context<'_>,
    ) {
        match result {
            CommissionResult::Restored(kept) => {
                self.is_known = true;
                self.kept = kept.map(|kept| *kept);
                self.written.clone_from(&self.kept);
            }
            CommissionResult::Kept => {
                if let Some((_, kept)) = self.writing.take_if(|(writing, _)| *writing == id) {
                    self.written = Some(*kept);
                }
            }
        }
        self.look(around, context);
    }

    fn work_ended(&mut self, id: JobId, why: Option<&str>, _: &CommissionAround, context: &mut Context<'_>) {
        if let Some((_, kept)) = self.writing.take_if(|(writing, _)| *writing == id) {
            // Not tried again before something changes, or each attempt would say the same.
            self.written = Some(*kept);
            if let Some(why) = why {
                context.notices.add(NoticeLevel::Warning, format!("{why} Commissioning goes on."));
            }
        }
    }
}
