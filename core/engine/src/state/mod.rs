//! Everything the engine knows, driven by commands and events; owns no thread.

mod actions;
mod commissioned;
mod dispatch;
mod heard;
mod looked;
mod measured;
mod models;
mod neighbors;
mod recorded;
mod results;
mod rooms;
mod stages;
mod threads;
mod tried;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_effects::robot_model::Unmeasured;
use plumbline_effects::{RigModel, RobotModel};
use plumbline_model::EyesThen;
use plumbline_model::robot::{Rig, default_rig};

pub use actions::Action;
use rooms::{Keeps, Neighbors, Rooms};
pub use stages::Serves;

use crate::command::Command;
use crate::detect::OpenDetector;
use crate::eyes::EyesWorkflow;
use crate::ground::data_folder::KeptView;
use crate::ground::jobs::list::JobList;
use crate::ground::jobs::{JobId, JobState, JobView, Outcome};
use crate::ground::notice::{NoticeLevel, Notices};
use crate::ground::stage::StagePanic;
use crate::ground::watched::{ThreadFault, WatchedThread};
use crate::ground::{Asked, Clock, Context, Moment, PerWorld, Time, Workflow, World};
use crate::labels::work::LabelsWork;
use crate::recording::{Recorder, RecordingWorkflow};
use crate::robot::view::RobotView;
use crate::source::view::SourceView;
use crate::truth::TruthPlug;
use crate::twin::view::TwinView;
use crate::work::{Work, WorkResult};

/// Everything the engine knows.
#[derive(Clone, Debug)]
pub struct State {
    rooms: Rooms,
    robot: Arc<RobotView>,
    /// When its thread told of it last; ages of readings are those of then.
    robot_told_at: Option<Instant>,
    twin: Arc<TwinView>,
    twins_started: u64,
    /// The robot as its description has it.
    rig: Arc<Rig>,
    /// The robot as it is known in each world.
    models: PerWorld<Arc<RobotModel>>,
    /// Effects that do not fit to this robot, told once.
    refused: Option<Arc<RigModel>>,
    /// What the robot's thread was told of it last.
    told_the_arm: Arc<RobotModel>,
    /// Whose eyes the source shows.
    shown: World,
    /// Whose arm: that of the connected robot, else that of the world whose eyes are shown.
    arm_of: World,
    /// The finished session of touches that models were told of last, with its revision.
    learned_from: BTreeMap<World, (PathBuf, u64)>,
    /// Work belongs to the world it was started for, whatever is shown when it ends.
    started_by: BTreeMap<JobId, World>,
    jobs: JobList,
    notices: Notices,
    clock: Clock,
    actions: Vec<Action>,
    /// Which source, counted, the newest pair is of.
    shown_of: u64,
    /// How the eyes were when the newest pair was taken, where it was recorded.
    then: Option<EyesThen>,
    revision: u64,
    faults: BTreeMap<WatchedThread, ThreadFault>,
    /// What was known of robot and twin before their thread fell silent.
    before_silence: Option<(Arc<RobotView>, Arc<TwinView>)>,
    /// The same of the source.
    source_before_silence: Option<Arc<SourceView>>,
    kept: Arc<KeptView>,
    /// What was in use when the timelines looked last.
    results: PerWorld<results::Results>,
}

impl State {
    /// Nothing opened; what was accepted before is read as the first job.
    pub fn new(data_dir: &Path) -> Self {
        let nominal = RobotModel::nominal(default_rig()).with_not_calibrated(Unmeasured::ALL);
        let nominal = Arc::new(nominal);
        let mut state = Self {
            rooms: Rooms::new(data_dir),
            robot: Arc::default(),
            robot_told_at: None,
            twin: Arc::default(),
            twins_started: 0,
            rig: nominal.rig().clone(),
            models: PerWorld::new(|_| nominal.clone()),
            refused: None,
            told_the_arm: nominal,
            shown: World::default(),
            arm_of: World::default(),
            learned_from: BTreeMap::new(),
            started_by: BTreeMap::new(),
            jobs: JobList::default(),
            notices: Notices::default(),
            clock: Clock::default(),
            actions: Vec::new(),
            shown_of: 0,
            then: None,
            revision: 0,
            faults: BTreeMap::new(),
            before_silence: None,
            source_before_silence: None,
            kept: Arc::default(),
            results: PerWorld::default(),
        };
        state.restore();
        state
    }

    /// Lets a workflow act, hands on what it asks for, and tells its neighbors.
    fn with<W: Workflow>(
        &mut self,
        world: World,
        act: impl FnOnce(&mut W, &W::Around, &mut Context<'_, W::Work, W::Control>),
    ) where
        Self: Neighbors<W>,
        Rooms: Keeps<W>,
        Work: From<W::Work>,
        Action: From<W::Control>,
    {
        let around = Neighbors::<W>::around(self, world);
        let mut asked = Vec::new();
        let Self { rooms, jobs, notices, clock, .. } = self;
        act(rooms.room(world), &around, &mut Context::new(notices, jobs, clock.time(), &mut asked));
        for asked in asked {
            self.actions.push(match asked {
                Asked::Start(id, work) => {
                    self.started_by.insert(id, world);
                    Action::Start(id, work.into())
                }
                Asked::Cancel(id) => Action::Cancel(id),
                Asked::Control(control) => control.into(),
            });
        }
        Neighbors::<W>::after(self, world);
        // What of no world was measured stands on the line of both.
        World::ALL.into_iter().for_each(|world| self.watch_results(world));
    }

    /// Takes it to be this time, until told otherwise; `None`: the time of the system. What happens at
    /// the same times, in the same order, gives the same again.
    pub fn hold_time(&mut self, time: Option<Time>) {
        self.clock.hold(time);
        self.notices.hold_time(time);
    }

    /// Applies a command of the operator that was given at this time.
    pub fn apply_at(&mut self, command: Command, time: Time) {
        self.hold_time(Some(time));
        self.rooms.recording.asked(&command, time);
        self.apply(command);
        self.hold_time(None);
    }

    /// What the window shows of a workflow.
    fn view_of<W: Workflow>(&mut self, world: World, moment: &Moment) -> Arc<W::View>
    where
        Self: Neighbors<W>,
        Rooms: Keeps<W>,
    {
        let around = Neighbors::<W>::around(self, world);
        Workflow::view(Keeps::<W>::room(&mut self.rooms, world), &around, moment)
    }

    /// Opens detectors in another way (tests, fake detectors).
    pub fn set_detector_opener(&mut self, open: OpenDetector) {
        self.rooms.detect.set_opener(open);
    }

    /// Hands something to the recording, with the messages that came before it.
    fn record(&mut self, what: impl FnOnce(&mut RecordingWorkflow, Time)) {
        if !self.rooms.recording.is_on() {
            return;
        }
        let time = self.clock.time();
        self.rooms.recording.told(&self.notices.view());
        what(&mut self.rooms.recording, time);
        self.with::<RecordingWorkflow>(World::default(), |recording, _, context| {
            recording.look_after(context);
        });
    }

    /// What the owner of the twin shows it with, for truth mode.
    pub fn truth_plug(&self) -> TruthPlug {
        self.rooms.truth.plug()
    }

    /// The recording under way, to be finished before the program ends.
    pub fn last_recording(&mut self) -> Option<Recorder> {
        self.rooms.recording.take()
    }

    /// What the operator drew and is not on disk yet, to be written before the program ends.
    pub fn last_write(&self) -> Option<LabelsWork> {
        self.rooms.labels.last_write()
    }

    /// The eyes that the source shows.
    fn shown_eyes(&self) -> &EyesWorkflow {
        self.rooms.eyes.of(self.shown)
    }

    /// A stage met a defect of this program and goes on with the next pair.
    pub fn stage_panicked(&mut self, panic: &StagePanic) {
        let StagePanic { stage, message } = panic;
        let text = format!(
            "Live {}: this program made a mistake ({message}). It goes on; please report it with the journal.",
            stage.name()
        );
        self.stage_gave_nothing(*stage, &text);
        self.notices.add(NoticeLevel::Error, text);
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
                    self.notices.add(result.level(), &*summary);
                }
                self.work_done(id, result);
                JobState::Done { summary }
            }
            Outcome::Cancelled => {
                self.notices.add(NoticeLevel::Info, format!("{title}: cancelled, nothing was changed."));
                self.work_gave_nothing(id, None);
                JobState::Cancelled
            }
            Outcome::Failed(reason) => {
                self.notices.add(NoticeLevel::Error, &*reason);
                self.work_gave_nothing(id, Some(&reason));
                JobState::Failed { reason }
            }
            Outcome::Panicked(message) => {
                let text = format!(
                    "{title}: this program made a mistake ({message}). Nothing was changed. Please report it with the journal."
                );
                self.work_gave_nothing(id, Some(&text));
                self.notices.add(NoticeLevel::Error, text);
                JobState::Panicked { message }
            }
        };
        // A step back was noted by now, or it was not taken.
        World::ALL.into_iter().for_each(|world| self.rooms.timeline.of_mut(world).stepped_back(id));
        self.jobs.ended(id, state, elapsed);
    }

    fn world_of(&mut self, id: JobId) -> World {
        self.started_by.remove(&id).unwrap_or(self.shown)
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
        self.rooms.live.newest().map(|frame| frame.stamp.seq)
    }
}
