//! The one thread that owns the state: takes commands and results, hands out work, publishes
//! views.

use std::any::Any;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, select};

use super::Shared;
use super::journal::{Entry, Event, Happened, Journal};
use super::pipeline::{PROBE_EVERY, Pipeline};
use super::settings::EngineSettings;
use crate::command::Command;
use crate::ground::bell::Bell;
use crate::ground::data_folder::{DataFolder, KeptView};
use crate::ground::jobs::{JobHandle, JobId, Outcome, on_job_workers, panic_message};
use crate::ground::notice::NoticeLevel;
use crate::ground::watched::{WatchCommand, WatchedThread};
use crate::ground::{LongWork, Time};
use crate::robot::command::RobotCommand;
use crate::source::command::{Control, SourceCommand};
use crate::state::{Action, State};
use crate::work::WorkResult;

/// Views are published at most this often.
const PUBLISH_EVERY: Duration = Duration::from_millis(30);
/// While jobs run their elapsed time is shown at least this often.
const JOB_TICK: Duration = Duration::from_millis(250);
/// Without anything to do the hub looks this often whether every thread gives signs of life.
const IDLE: Duration = Duration::from_millis(500);
/// Without a sign of life for this long the hub itself is taken to hang.
const SILENT: Duration = Duration::from_secs(5);
/// When closing, jobs get this long to reach their next checkpoint.
const CLOSING: Duration = Duration::from_secs(2);

/// Why the engine has ended by itself.
#[derive(Debug, thiserror::Error)]
pub(super) enum Failure {
    /// It could not begin.
    #[error("the system gives no threads ({0}): close other programs")]
    NoThreads(std::io::Error),
    /// A defect; what the program said.
    #[error("{0}")]
    Panicked(String),
}

impl Failure {
    fn of(panic: &(dyn Any + Send)) -> Self {
        Self::Panicked(panic_message(panic))
    }
}

/// Runs until the window drops its end of the commands. When it fails that is shown, and STOP is
/// pressed, before what it owned is let go.
///
/// # Errors
/// Why it failed; by then that is shown and STOP is pressed.
pub(super) fn run(
    settings: EngineSettings,
    commands: &Receiver<Command>,
    shared: &Shared,
) -> Result<(), Failure> {
    let failed = |failure: Failure| {
        shared.switches.stop.press();
        shared.publish_failure(&failure.to_string());
        failure
    };
    let started = catch_unwind(AssertUnwindSafe(|| Hub::start(settings, shared)));
    let mut hub = match started {
        Ok(Ok(hub)) => hub,
        Ok(Err(error)) => return Err(failed(Failure::NoThreads(error))),
        Err(panic) => return Err(failed(Failure::of(panic.as_ref()))),
    };
    // A hub that failed is only dropped, so nothing half done is used.
    if let Err(panic) = catch_unwind(AssertUnwindSafe(|| hub.work(commands))) {
        let failure = failed(Failure::of(panic.as_ref()));
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| drop(hub))) {
            log::error!("while letting go: {}", panic_message(panic.as_ref()));
        }
        return Err(failure);
    }
    Ok(())
}

/// Owns the state and all threads.
pub(super) struct Hub<'a> {
    pub(super) shared: &'a Shared,
    pub(super) state: State,
    pub(super) folder: DataFolder,
    pub(super) journal: Option<Journal>,
    /// Why there is none, and since when.
    pub(super) no_journal: Option<(String, Instant)>,
    /// Commands that journals before this one lack.
    pub(super) lost_before: u64,
    started: Instant,
    jobs: BTreeMap<JobId, JobHandle<WorkResult>>,
    pub(super) pipeline: Pipeline,
    pub(super) bell: Bell,
    rung: Receiver<()>,
    published: Instant,
    pub(super) changed: bool,
}

impl<'a> Hub<'a> {
    fn start(settings: EngineSettings, shared: &'a Shared) -> std::io::Result<Self> {
        // Built within a second where the machine has nothing else to do.
        shared.pulse.promise(CLOSING + SILENT);
        let (bell, rung) = Bell::new();
        let folder = DataFolder::choose(settings.data_dir.as_deref());
        let mut state = State::new(&folder.path);
        if let Some(problem) = &folder.problem {
            state.notify(NoticeLevel::Warning, problem.as_str());
        }
        let pipeline = Pipeline::start(&bell, &folder.path, shared, state.truth_plug())?;
        let mut hub = Self {
            shared,
            state,
            folder,
            journal: None,
            no_journal: None,
            lost_before: 0,
            pipeline,
            started: Instant::now(),
            jobs: BTreeMap::new(),
            bell,
            rung,
            published: Instant::now(),
            changed: true,
        };
        hub.start_journal();
        if let Some(spec) = settings.source {
            hub.apply(SourceCommand::Open(spec).into());
        }
        if let Some(scenario) = settings.twin {
            hub.apply(RobotCommand::ConnectTwin { scenario }.into());
        }
        Ok(hub)
    }

    fn work(&mut self, commands: &Receiver<Command>) {
        loop {
            self.shared.pulse.promise(SILENT);
            self.look_after();
            self.act();
            self.feed();
            self.publish();
            let timeout = crossbeam_channel::after(self.wait());
            select! {
                recv(commands) -> command => match command {
                    Ok(command) => self.apply(command),
                    Err(_) => break,
                },
                recv(self.rung) -> _ => {}
                recv(timeout) -> _ => {}
            }
            while let Ok(command) = commands.try_recv() {
                self.apply(command);
            }
            self.collect();
        }
        self.close();
    }

    fn apply(&mut self, command: Command) {
        let time = Time::now();
        let entry = Entry {
            at_secs: self.seconds_at(time),
            day: Some(time.day),
            newest_seq: self.state.newest_seq(),
            command: command.clone(),
        };
        if let Some(journal) = &mut self.journal {
            journal.note(entry);
        }
        self.changed = true;
        match command {
            Command::Watch(WatchCommand::StartAgain(thread)) => self.start_again(thread),
            command => self.state.apply_at(command, time),
        }
    }

    fn seconds_at(&self, time: Time) -> f64 {
        time.instant.saturating_duration_since(self.started).as_secs_f64()
    }

    /// Takes in what threads and jobs have brought.
    fn collect(&mut self) {
        let time = Time::now();
        let now = time.instant;
        self.state.hold_time(Some(time));
        let mut happened = Vec::new();
        self.changed |= self.pipeline.collect(&mut self.state, now, &mut happened);
        self.changed |= !self.jobs.is_empty();
        self.changed |= self.state.time_passes();
        let Self { jobs, state, .. } = self;
        jobs.retain(|id, job| match job.take_outcome() {
            Some(outcome) => {
                let cancelled = matches!(outcome, Outcome::Cancelled);
                let took = job.elapsed(now);
                happened.push(Happened::WorkEnded { job: id.0, took_s: took.as_secs_f64(), cancelled });
                state.work_ended(*id, outcome, took);
                false
            }
            None => {
                state.work_progress(job.view(now));
                true
            }
        });
        state.hold_time(None);
        let at_secs = self.seconds_at(time);
        if let Some(journal) = &mut self.journal {
            for happened in happened {
                journal.note_event(Event { at_secs, day: time.day, happened });
            }
        }
    }

    /// Does what the state asks of the outer world.
    fn act(&mut self) {
        for action in self.state.take_actions() {
            self.changed = true;
            match action {
                Action::Robot(control) if self.state.is_down(WatchedThread::Robot) => {
                    self.answer_for_the_robot(&control);
                }
                // The button that tries a lost source again does what helps here.
                Action::Source(Control::Retry) if self.state.is_down(WatchedThread::Source) => {
                    self.start_again(WatchedThread::Source);
                }
                Action::Source(_) if self.state.is_down(WatchedThread::Source) => {
                    let why = self.state.meaning(WatchedThread::Source);
                    self.state.notify(NoticeLevel::Warning, &*why);
                }
                Action::Robot(control) => {
                    if !self.pipeline.control_robot(control) {
                        let text = "The robot's side does not keep up; wait until it is connected.";
                        self.state.notify(NoticeLevel::Warning, text);
                    }
                }
                Action::Source(control) => {
                    if !self.pipeline.control_source(control) {
                        let text = "The source does not answer yet; wait until it is open.";
                        self.state.notify(NoticeLevel::Warning, text);
                    }
                }
                Action::Start(id, work) => {
                    let bell = self.bell.clone();
                    let title = work.title();
                    let job = JobHandle::start(
                        id,
                        title,
                        move || bell.ring(),
                        move |context| {
                            // Its own workers: the live stages must not wait behind a search of all pairs.
                            on_job_workers(move || work.run(context))
                        },
                    );
                    self.jobs.insert(id, job);
                }
                Action::Cancel(id) => {
                    if let Some(job) = self.jobs.get(&id) {
                        job.cancel();
                    }
                }
            }
        }
    }

    fn feed(&mut self) {
        self.pipeline.feed(&self.state);
    }

    fn publish(&mut self) {
        let now = Instant::now();
        if !self.changed || now.duration_since(self.published) < PUBLISH_EVERY {
            return;
        }
        let skipped = self.pipeline.skipped();
        self.state.set_kept(self.kept());
        let lost = self.shared.lost_commands.load(Ordering::Relaxed);
        self.shared.publish(self.state.view(skipped, lost, now));
        (self.published, self.changed) = (now, false);
    }

    fn kept(&self) -> KeptView {
        KeptView {
            folder: self.folder.path.clone(),
            problem: self.folder.problem.as_deref().map(Arc::from),
            journal: self.journal.as_ref().map(|journal| journal.file().to_owned()),
            no_journal_because: self.no_journal.as_ref().map(|(why, _)| why.as_str().into()),
            journal_lost: self.lost_before + self.journal.as_ref().map_or(0, Journal::lost),
        }
    }

    fn wait(&self) -> Duration {
        if self.changed {
            PUBLISH_EVERY.saturating_sub(self.published.elapsed())
        } else if self.pipeline.probe_waits() {
            PROBE_EVERY
        } else if self.jobs.is_empty() {
            IDLE
        } else {
            JOB_TICK
        }
    }

    /// Lets jobs come to an end; one that writes a file is not torn away from it.
    fn close(&mut self) {
        self.shared.pulse.promise(CLOSING + SILENT);
        for job in self.jobs.values() {
            job.cancel();
        }
        let deadline = Instant::now() + CLOSING;
        for job in self.jobs.values() {
            if job.wait_at_most(deadline.saturating_duration_since(Instant::now())).is_none() {
                log::warn!("{} did not end in time", job.title);
            }
        }
        if let Some(recorder) = self.state.last_recording()
            && let Err(error) = recorder.finish()
        {
            log::error!("{error}");
        }
        if let Some(work) = self.state.last_write()
            && let Err(error) = work.run(&plumbline_model::Unattended)
        {
            log::error!("{error}");
        }
    }
}
