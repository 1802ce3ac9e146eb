//! The one thread that owns the state: takes commands and results, hands out work, publishes
//! views.

use std::collections::BTreeMap;
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, select};
use plumbline_model::{Chessboard, StereoFrame};

use super::Shared;
use crate::bell::Bell;
use crate::command::{Command, JobId, ProbePoint, RobotCommand, SourceCommand};
use crate::context::Action;
use crate::eyes::Look;
use crate::jobs::{JobHandle, on_job_workers, panic_message};
use crate::journal::{Entry, Journal};
use crate::live::{Skipped, default_rig};
use crate::notice::{Notice, NoticeLevel};
use crate::robot::{News, RobotThread, RobotWires, TouchNews, TwinDesk, TwinEyesPlug, Worker};
use crate::settings::EngineSettings;
use crate::slot::{Putter, Taker, newest_value_slot};
use crate::source::{Note, Player, SourceThread, Wires};
use crate::stages::{
    CornersInput, CornersStage, DetectInput, DetectOutput, DetectStage, ProbeInput, ProbeOutput, ProbeStage,
    RectifyInput, RectifyOutput, RectifyStage, StageThread, run_stage,
};
use crate::state::State;
use crate::view::{DetectionSettings, SourceView, View};
use crate::work::WorkResult;

/// Views are published at most this often.
const PUBLISH_EVERY: Duration = Duration::from_millis(30);
/// While jobs run their elapsed time is shown at least this often.
const JOB_TICK: Duration = Duration::from_millis(250);
/// A point that stays is measured anew at most this often; a new one at once.
const PROBE_EVERY: Duration = Duration::from_millis(100);
/// Without anything to do the hub looks around this often.
const IDLE: Duration = Duration::from_secs(5);
/// Messages of the source that may wait.
const NOTES_WAITING: usize = 256;
/// When closing, jobs get this long to reach their next checkpoint.
const CLOSING: Duration = Duration::from_secs(2);

/// Runs until the window drops its end of the commands.
pub fn run(settings: EngineSettings, commands: &Receiver<Command>, shared: &Shared) {
    let result = std::panic::catch_unwind(AssertUnwindSafe(|| {
        Hub::start(settings, shared).map(|hub| hub.run(commands))
    }));
    let message = match result {
        Ok(Ok(())) => return,
        Ok(Err(error)) => format!(
            "The program could not start its threads ({error}). Close other programs and start it again."
        ),
        Err(panic) => format!(
            "The program made a mistake ({}). What was accepted is safe. Start it again, and report it with the journal.",
            panic_message(panic.as_ref())
        ),
    };
    log::error!("{message}");
    let last = shared.view();
    let number = last.notices.last().map_or(1, |notice| notice.number + 1);
    let notice =
        Notice { number, level: NoticeLevel::Error, text: message, at: jiff::Timestamp::now(), times: 1 };
    let notices: Arc<[Notice]> = last.notices.iter().cloned().chain([notice]).collect();
    shared.publish(View { revision: last.revision + 1, notices, ..(*last).clone() });
}

struct Hub<'a> {
    shared: &'a Shared,
    state: State,
    journal: Option<Journal>,
    started: Instant,
    jobs: BTreeMap<JobId, JobHandle<WorkResult>>,
    pipeline: Pipeline,
    bell: Bell,
    rung: Receiver<()>,
    published: Instant,
    changed: bool,
}

/// The threads of the live side.
struct Pipeline {
    source: SourceThread,
    frames: Taker<(u64, StereoFrame)>,
    frames_in: Putter<(u64, StereoFrame)>,
    views: Taker<SourceView>,
    notes: Receiver<Note>,
    robot: RobotThread,
    news: Taker<News>,
    touches: Receiver<TouchNews>,
    rectify: StageThread<RectifyInput, RectifyOutput>,
    corners: StageThread<CornersInput, Look>,
    probe: StageThread<ProbeInput, ProbeOutput>,
    detect: StageThread<DetectInput, DetectOutput>,
    fed: Fed,
}

/// What each stage was given last: seq, and what else decides its result.
#[derive(Default)]
struct Fed {
    rectify: Option<(u64, u64, bool)>,
    corners: Option<(u64, Chessboard)>,
    probe: Option<(u64, u64, ProbePoint)>,
    /// Pair, source, detector, setup; settings are told apart by themselves.
    detect: Option<(u64, u64, u64, Option<u64>)>,
    detect_settings: Option<Arc<DetectionSettings>>,
    probed_at: Option<Instant>,
    /// A newer pair waits for its time.
    probe_waits: bool,
}

impl<'a> Hub<'a> {
    fn start(settings: EngineSettings, shared: &'a Shared) -> std::io::Result<Self> {
        let (bell, rung) = Bell::new();
        let (data_dir, problem) = data_dir(settings.data_dir);
        let mut state = State::new(&data_dir);
        if let Some(problem) = problem {
            state.notify(NoticeLevel::Warning, problem);
        }
        let journal = match Journal::start(&data_dir.join("journal")) {
            Ok(journal) => Some(journal),
            Err(error) => {
                state.notify(NoticeLevel::Warning, format!("No journal is kept: {error}"));
                None
            }
        };
        let mut hub = Self {
            shared,
            state,
            journal,
            started: Instant::now(),
            jobs: BTreeMap::new(),
            pipeline: Pipeline::start(&bell, &data_dir, shared)?,
            bell,
            rung,
            published: Instant::now(),
            changed: true,
        };
        if let Some(spec) = settings.source {
            hub.apply(SourceCommand::Open(spec).into());
        }
        if let Some(scenario) = settings.twin {
            hub.apply(RobotCommand::ConnectTwin { scenario }.into());
        }
        Ok(hub)
    }

    fn run(mut self, commands: &Receiver<Command>) {
        loop {
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
        let entry = Entry {
            at_secs: self.started.elapsed().as_secs_f64(),
            newest_seq: self.state.newest_seq(),
            command: command.clone(),
        };
        if let Some(journal) = &mut self.journal {
            journal.note(entry);
        }
        self.state.apply(command);
        self.changed = true;
    }

    /// Takes in what threads and jobs have brought.
    fn collect(&mut self) {
        let now = Instant::now();
        self.changed |= self.pipeline.collect(&mut self.state, now);
        self.changed |= !self.jobs.is_empty();
        let Self { jobs, state, .. } = self;
        jobs.retain(|id, job| match job.take_outcome() {
            Some(outcome) => {
                state.work_ended(*id, outcome, job.elapsed(now));
                false
            }
            None => {
                state.work_progress(job.view(now));
                true
            }
        });
    }

    /// Does what the state asks of the outer world.
    fn act(&mut self) {
        for action in self.state.take_actions() {
            self.changed = true;
            match action {
                Action::Robot(control) => {
                    if !self.pipeline.robot.control(control) {
                        let text = "The robot's side does not keep up; wait until it is connected.";
                        self.state.notify(NoticeLevel::Warning, text);
                    }
                }
                Action::Source(control) => {
                    if !self.pipeline.source.control(control) {
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
        let lost = self.shared.lost_commands.load(Ordering::Relaxed);
        self.shared.publish(self.state.view(skipped, lost, now));
        (self.published, self.changed) = (now, false);
    }

    fn wait(&self) -> Duration {
        if self.changed {
            PUBLISH_EVERY.saturating_sub(self.published.elapsed())
        } else if self.pipeline.fed.probe_waits {
            PROBE_EVERY
        } else if self.jobs.is_empty() {
            IDLE
        } else {
            JOB_TICK
        }
    }

    /// Lets jobs come to an end; one that writes a file is not torn away from it.
    fn close(self) {
        for job in self.jobs.values() {
            job.cancel();
        }
        let deadline = Instant::now() + CLOSING;
        for job in self.jobs.values() {
            if job.wait_at_most(deadline.saturating_duration_since(Instant::now())).is_none() {
                log::warn!("{} did not end in time", job.title);
            }
        }
        if let Some(work) = self.state.last_write()
            && let Err(error) = work.run(&plumbline_model::Unattended)
        {
            log::error!("{error}");
        }
    }
}

impl Pipeline {
    fn start(bell: &Bell, data_dir: &Path, shared: &Shared) -> std::io::Result<Self> {
        let (frames_in, frames) = newest_value_slot();
        let (views_in, views) = newest_value_slot();
        let (notes_in, notes) = crossbeam_channel::bounded(NOTES_WAITING);
        let wires =
            Wires { frames: frames_in.clone(), views: views_in, notes: notes_in.clone(), bell: bell.clone() };
        let (news_in, news) = newest_value_slot();
        let eyes = TwinEyesPlug::default();
        let worker =
            Worker::new(default_rig(), data_dir, shared.switches.clone(), TwinDesk::new(eyes.clone()));
        let (touches_in, touches) = crossbeam_channel::bounded(NOTES_WAITING);
        let robot_wires =
            RobotWires { news: news_in, touches: touches_in, notes: notes_in, bell: bell.clone() };
        let rectify = || {
            let mut stage = RectifyStage::default();
            move |input| stage.process(input)
        };
        let corners = || {
            let mut stage = CornersStage::default();
            move |input| stage.process(input)
        };
        let probe = || {
            let mut stage = ProbeStage::default();
            move |input| stage.process(input)
        };
        let detect = || {
            let mut stage = DetectStage::default();
            move |input| stage.process(input)
        };
        Ok(Self {
            source: SourceThread::start(Player::with_opener(eyes.opener()), wires)?,
            robot: RobotThread::start(worker, robot_wires)?,
            news,
            touches,
            frames,
            frames_in,
            views,
            notes,
            rectify: run_stage("rectify", bell.clone(), |i: &RectifyInput| i.frame.stamp, rectify)?,
            corners: run_stage("corners", bell.clone(), |i: &CornersInput| i.frame.stamp, corners)?,
            probe: run_stage("probe", bell.clone(), |i: &ProbeInput| i.frame.stamp, probe)?,
            detect: run_stage("detect", bell.clone(), |i: &DetectInput| i.frame.stamp, detect)?,
            fed: Fed::default(),
        })
    }

    /// Gives the state what has come; whether there was anything.
    fn collect(&self, state: &mut State, now: Instant) -> bool {
        let mut any = false;
        if let Some(view) = self.views.try_take() {
            state.source_changed(view);
            any = true;
        }
        for note in self.notes.try_iter() {
            state.source_note(note);
            any = true;
        }
        if let Some(news) = self.news.try_take() {
            state.robot_changed(news);
            any = true;
        }
        for news in self.touches.try_iter() {
            state.touch_news(news);
            any = true;
        }
        if let Some((opened, frame)) = self.frames.try_take() {
            state.frame(opened, frame, now);
            any = true;
        }
        if let Some(output) = self.rectify.take() {
            any = true;
            match output {
                Ok(output) => state.rectified(output, now),
                Err(panic) => state.stage_panicked(&panic),
            }
        }
        if let Some(output) = self.corners.take() {
            any = true;
            match output {
                Ok(output) => state.looked(output, now),
                Err(panic) => state.stage_panicked(&panic),
            }
        }
        if let Some(output) = self.detect.take() {
            any = true;
            match output {
                Ok(output) => state.detected(output, now),
                Err(panic) => state.stage_panicked(&panic),
            }
        }
        if let Some(output) = self.probe.take() {
            any = true;
            match output {
                Ok(output) => state.probed(output, now),
                Err(panic) => state.stage_panicked(&panic),
            }
        }
        any
    }

    /// Gives each stage what it was not given yet: a new pair, or the same one anew when what
    /// is wanted of it changed.
    fn feed(&mut self, state: &State) {
        if let Some(input) = state.rectify_input() {
            let key = (input.frame.stamp.seq, input.setup.generation, input.disparity);
            if self.fed.rectify.replace(key) != Some(key) {
                self.rectify.put(input);
            }
        }
        if let Some(input) = state.corners_input() {
            let key = (input.frame.stamp.seq, input.board);
            if self.fed.corners.replace(key) != Some(key) {
                self.corners.put(input);
            }
        }
        if let Some(input) = state.detect_input() {
            let generation = input.setup.as_ref().ok().map(|setup| setup.generation);
            let key = (input.frame.stamp.seq, input.opened, input.detector.id, generation);
            let settings = Some(input.settings.clone());
            if self.fed.detect.replace(key) != Some(key) || self.fed.detect_settings != settings {
                self.fed.detect_settings = settings;
                self.detect.put(input);
            }
        }
        if let Some(input) = state.probe_input() {
            let key = (input.frame.stamp.seq, input.setup.generation, input.point);
            let fed = &mut self.fed;
            let same_point =
                fed.probe.is_some_and(|(_, generation, point)| (generation, point) == (key.1, key.2));
            let lately = fed.probed_at.is_some_and(|at| at.elapsed() < PROBE_EVERY);
            let is_new = fed.probe != Some(key);
            fed.probe_waits = is_new && same_point && lately;
            if is_new && !fed.probe_waits {
                (fed.probe, fed.probed_at) = (Some(key), Some(Instant::now()));
                self.probe.put(input);
            }
        }
    }

    fn skipped(&self) -> Skipped {
        Skipped {
            source: self.frames_in.skipped(),
            rectify: self.rectify.skipped(),
            corners: self.corners.skipped(),
            probe: self.probe.skipped(),
            detect: self.detect.skipped(),
        }
    }
}

/// Where results are kept, and what is wrong with that.
fn data_dir(wished: Option<PathBuf>) -> (PathBuf, Option<String>) {
    if let Some(wished) = wished {
        return (wished, None);
    }
    match directories::ProjectDirs::from("", "", "plumbline") {
        Some(dirs) => (dirs.data_dir().to_path_buf(), None),
        None => {
            let temporary: &Path = &std::env::temp_dir();
            let text = format!(
                "You have no home folder, so calibrations are kept in {} only until the next restart of the machine. Start the program with a data folder of your choice.",
                temporary.display()
            );
            (temporary.join("plumbline"), Some(text))
        }
    }
}
