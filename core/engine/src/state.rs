//! Everything the engine knows, driven by commands and events; owns no thread.

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::StereoFrame;

use crate::command::{Command, JobCommand, JobId, NoticeCommand};
use crate::context::{Action, Context};
use crate::eyes::store::Store;
use crate::eyes::work::{EyesWork, Restore};
use crate::eyes::{EyesState, Look};
use crate::job_list::JobList;
use crate::jobs::Outcome;
use crate::live::{LiveState, Skipped};
use crate::notice::{NoticeLevel, Notices};
use crate::source::{Note, SourceState};
use crate::stages::{CornersInput, ProbeInput, ProbeOutput, RectifyInput, RectifyOutput, StagePanic, Timed};
use crate::view::{JobState, JobView, RobotView, SourceView, TwinView, View};
use crate::work::WorkResult;

/// Everything the engine knows.
#[derive(Clone, Debug)]
pub struct State {
    source: SourceState,
    live: LiveState,
    eyes: EyesState,
    robot: Arc<RobotView>,
    twin: Arc<TwinView>,
    jobs: JobList,
    notices: Notices,
    actions: Vec<Action>,
    /// Which source, counted, the newest pair is of.
    shown_of: u64,
    revision: u64,
}

impl State {
    /// Nothing opened; what was accepted before is read as the first job.
    pub fn new(data_dir: &Path) -> Self {
        let live = LiveState::default();
        let store = Store::new(data_dir.join("calibrations"));
        let mut state = Self {
            eyes: EyesState::new(store.clone(), data_dir.join("sessions"), live.workspace()),
            live,
            source: SourceState::default(),
            robot: Arc::default(),
            twin: Arc::default(),
            jobs: JobList::default(),
            notices: Notices::default(),
            actions: Vec::new(),
            shown_of: 0,
            revision: 0,
        };
        let workspace = state.live.workspace();
        state.with_eyes(|_, context| {
            context.start(EyesWork::Restore(Restore { store, workspace }));
        });
        state
    }

    /// Applies a command of the operator.
    pub fn apply(&mut self, command: Command) {
        match command {
            Command::Source(command) => {
                let Self { source, live, jobs, notices, actions, .. } = self;
                let view = source.view().clone();
                source.apply(
                    command,
                    &mut Context { notices, newest: live.newest(), source: &view, jobs, actions },
                );
            }
            Command::Live(command) => self.apply_live(command),
            Command::Eyes(command) => self.with_eyes(|eyes, context| eyes.apply(command, context)),
            Command::Robot(command) => self.actions.push(Action::Robot(command.into())),
            Command::Twin(command) => self.actions.push(Action::Robot(command.into())),
            Command::Mount(_) => {}
            Command::Job(JobCommand::Cancel(id)) if self.jobs.is_running(id) => {
                self.actions.push(Action::Cancel(id));
            }
            Command::Job(JobCommand::Cancel(id) | JobCommand::Dismiss(id)) => self.jobs.dismiss(id),
            Command::Notice(NoticeCommand::Add { level, text }) => self.notices.add(level, text),
            Command::Notice(NoticeCommand::Clear) => self.notices.clear(),
        }
    }

    fn apply_live(&mut self, command: crate::command::LiveCommand) {
        let Self { source, live, jobs, notices, actions, .. } = self;
        let mut context = Context { notices, newest: None, source: source.view(), jobs, actions };
        live.apply(command, &mut context);
        self.eyes.set_workspace(self.live.workspace());
    }

    fn with_eyes(&mut self, act: impl FnOnce(&mut EyesState, &mut Context<'_>)) {
        let Self { source, live, eyes, jobs, notices, actions, .. } = self;
        act(eyes, &mut Context { notices, newest: live.newest(), source: source.view(), jobs, actions });
        self.live.set_calibration(self.eyes.in_use());
    }

    /// A pair has come from the source.
    ///
    /// `opened` counts the sources opened; a pair of an earlier source comes too late.
    pub fn frame(&mut self, opened: u64, frame: StereoFrame, now: Instant) {
        if opened < self.source.view().opened {
            return;
        }
        self.shown_of = opened;
        self.eyes.set_image_size(frame.left.dimensions());
        self.live.frame(frame, now);
    }

    /// The source says how it is doing.
    pub fn source_changed(&mut self, view: SourceView) {
        if view.opened != self.source.view().opened && view.opened != self.shown_of {
            self.live.clear();
        }
        self.source.update(view);
    }

    /// The source has a message for the operator.
    pub fn source_note(&mut self, (level, text): Note) {
        self.notices.add(level, text);
    }

    /// Rectification has something.
    pub fn rectified(&mut self, output: Timed<RectifyOutput>, now: Instant) {
        self.live.rectified(output, now);
    }

    /// Measuring has something.
    pub fn probed(&mut self, output: Timed<ProbeOutput>, now: Instant) {
        self.live.probed(output, now);
    }

    /// The chessboard search has something.
    pub fn looked(&mut self, output: Timed<Look>, now: Instant) {
        self.live.corners(&output, now);
        self.with_eyes(|eyes, context| eyes.look(output.result, context));
    }

    /// A stage met a defect of this program and goes on with the next pair.
    pub fn stage_panicked(&mut self, panic: &StagePanic) {
        let StagePanic { stage, message } = panic;
        let text = format!(
            "Live {stage}: this program made a mistake ({message}). It goes on; please report it with the journal."
        );
        self.notices.add(NoticeLevel::Error, text);
    }

    /// What rectification is to do with the newest pair, if anything.
    pub fn rectify_input(&self) -> Option<RectifyInput> {
        self.live.rectify_input()
    }

    /// What measuring is to do with the newest pair, if anything.
    pub fn probe_input(&self) -> Option<ProbeInput> {
        self.live.probe_input()
    }

    /// What the chessboard search is to do with the newest pair, if anything.
    pub fn corners_input(&self) -> Option<CornersInput> {
        let wanted = self.live.wants_corners() || self.eyes.auto_capture();
        let frame = self.live.newest().filter(|_| wanted)?.clone();
        Some(CornersInput { frame, board: *self.eyes.board() })
    }

    /// A job says how far it is.
    pub fn work_progress(&mut self, view: JobView) {
        self.jobs.progress(view);
    }

    /// A job has ended.
    pub fn work_ended(&mut self, id: JobId, outcome: Outcome<WorkResult>, elapsed: Duration) {
        let title = self.jobs.title(id).unwrap_or_default().to_owned();
        let state = match outcome {
            Outcome::Done(result) => {
                let summary = result.summary();
                if self.jobs.is_worth_telling(id) {
                    self.notices.add(NoticeLevel::Success, &*summary);
                }
                self.work_done(id, result);
                JobState::Done { summary }
            }
            Outcome::Cancelled => {
                self.notices.add(NoticeLevel::Info, format!("{title}: cancelled, nothing was changed."));
                self.eyes.work_ended(id);
                JobState::Cancelled
            }
            Outcome::Failed(reason) => {
                self.notices.add(NoticeLevel::Error, &*reason);
                self.eyes.work_ended(id);
                JobState::Failed { reason }
            }
            Outcome::Panicked(message) => {
                let text = format!(
                    "{title}: this program made a mistake ({message}). Nothing was changed. Please report it with the journal."
                );
                self.notices.add(NoticeLevel::Error, text);
                self.eyes.work_ended(id);
                JobState::Panicked { message }
            }
        };
        self.jobs.ended(id, state, elapsed);
    }

    fn work_done(&mut self, id: JobId, result: WorkResult) {
        match result {
            WorkResult::Cameras(cameras) => self.source.set_cameras(cameras),
            WorkResult::Eyes(result) => self.with_eyes(|eyes, context| eyes.work_done(id, *result, context)),
        }
    }

    /// Adds a message.
    pub fn notify(&mut self, level: NoticeLevel, text: impl Into<String>) {
        self.notices.add(level, text);
    }

    /// What the outer world is asked to do, since the last call.
    pub fn take_actions(&mut self) -> Vec<Action> {
        std::mem::take(&mut self.actions)
    }

    /// Number of the newest pair.
    pub fn newest_seq(&self) -> Option<u64> {
        self.live.newest().map(|frame| frame.stamp.seq)
    }

    /// What the window shows.
    pub fn view(&mut self, skipped: Skipped, lost_commands: u64, now: Instant) -> View {
        self.revision += 1;
        View {
            revision: self.revision,
            source: self.source.view().clone(),
            live: Arc::new(self.live.view(skipped, now)),
            eyes: Arc::new(self.eyes.view()),
            robot: self.robot.clone(),
            twin: self.twin.clone(),
            mount: Arc::default(),
            jobs: self.jobs.view(),
            notices: self.notices.view(),
            lost_commands,
        }
    }
}
