//! What the window draws: an immutable snapshot of everything the engine knows.
//!
//! A view is cheap to take and to keep: images and long lists are shared, not copied.

mod detect;
mod eyes;
mod gap;
mod labels;
mod live;
mod map;
mod models;
mod mount;
mod robot;
mod scores;
mod threads;
mod touch;
mod twin;

use std::sync::Arc;
use std::time::Duration;

pub use detect::{
    ClassRates, DetectView, DetectionSettings, DetectionTiming, DetectionsView, DetectorFacts, DetectorState,
    ObjectPlaceView, ObjectView, SeenBox,
};
pub use eyes::{
    AcceptedCalibration, BoardPlace, BoardSeen, CaptureHint, CollectedPair, Coverage, CoverageGrid,
    EarlierCalibration, EyesView, GhostBoard, Origin, Proposal,
};
pub use gap::{AddedEffect, FindingEntry, GapModelView, GapSession, GapView, ModelStep, ShownFinding};
pub use labels::{
    ImportView, LabelBox, LabelCounts, LabelImage, LabelProblem, LabelSetView, LabelState, LabelsView,
    ProposedBox, ShownLabels,
};
pub use live::{
    AimView, CornersView, DisparityView, LiveView, ProbeReading, ProbeView, RectifiedView, ReplayView,
    SourceCounters, SourceStatus, SourceView, StageStatistics, Statistics,
};
pub use map::TableMap;
pub use models::{EarlierModel, Field, MapTouch, ModelMap, ModelsView, TablesView, TouchSession};
pub use mount::{HeadViewSummary, MountSummary, MountView};
pub use robot::{
    BusView, Connection, JointSample, JointView, MotionState, PathCheck, PortView, PoseView, Preview,
    RobotView, TipPlace,
};
pub use scores::{
    CellPicture, ModelScores, OpenedCell, Score, ScoreRow, ScoreTable, ScoredModelFile, ScoresView,
};
pub use threads::{KeptView, ThreadFault};
pub(crate) use threads::{robot_without_its_thread, twin_without_its_thread, view_without_its_engine};
pub use touch::{
    ContactSource, ContactView, PlanView, TouchCounts, TouchFigures, TouchOutcome, TouchPhase, TouchState,
    TouchView, UnfinishedRun,
};
pub use twin::{FaultView, ToyView, TwinView};

use crate::command::JobId;
use crate::notice::Notice;
use crate::watched::WatchedThread;

/// Everything that can be shown, at one moment.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// Counts up with every change.
    pub revision: u64,
    /// Where the images come from.
    pub source: Arc<SourceView>,
    /// The newest images and what was computed from them.
    pub live: Arc<LiveView>,
    /// What the detector sees live.
    pub detect: Arc<DetectView>,
    /// Calibrating the eyes.
    pub eyes: Arc<EyesView>,
    /// The robot.
    pub robot: Arc<RobotView>,
    /// The twin.
    pub twin: Arc<TwinView>,
    /// Calibrating how the eyes sit in the head.
    pub mount: Arc<MountView>,
    /// Touching the screen.
    pub touch: Arc<TouchView>,
    /// Correction models, and the tables of grasp height and yaw.
    pub models: Arc<ModelsView>,
    /// The gap between model and measurement.
    pub gap: Arc<GapView>,
    /// The lab's own data sets.
    pub labels: Arc<LabelsView>,
    /// Scores of detectors.
    pub scores: Arc<ScoresView>,
    /// Long work, oldest first: what is running and what has ended and was not dismissed.
    pub jobs: Arc<[JobView]>,
    /// Messages, oldest first.
    pub notices: Arc<[Notice]>,
    /// Threads of the program that do not do their work any more; usually none.
    pub threads: Arc<[ThreadFault]>,
    /// Where data are kept, and whether the journal is.
    pub kept: Arc<KeptView>,
    /// Commands that were lost because too many came at once; zero unless something hangs.
    pub lost_commands: u64,
}

impl View {
    /// What is wrong with a thread; `None` when it does its work.
    pub fn fault(&self, thread: WatchedThread) -> Option<&ThreadFault> {
        self.threads.iter().find(|fault| fault.thread == thread)
    }

    /// The oldest job that is still running.
    pub fn running_job(&self) -> Option<&JobView> {
        self.jobs.iter().find(|job| job.state.is_running())
    }
}

/// How far a step of the rail is.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum StepState {
    /// Nothing has been done yet.
    #[default]
    NotDone,
    /// Work is under way.
    Running,
    /// Done, and what it depends on has not changed.
    Done,
    /// Done, but something it depends on changed since.
    Stale {
        /// What changed, as a sentence.
        why: String,
    },
}

/// A job, running or ended.
#[derive(Clone, Debug, PartialEq)]
pub struct JobView {
    /// Its number, for [`crate::command::JobCommand`].
    pub id: JobId,
    /// What it does, for people: "Solve 30 pairs".
    pub title: String,
    /// How far it is or how it ended.
    pub state: JobState,
    /// Time since it started, or that it took.
    pub elapsed: Duration,
}

/// How far a job is or how it ended. Every way to end looks different.
#[derive(Clone, Debug, PartialEq)]
pub enum JobState {
    /// At work.
    Running {
        /// 0 to 1.
        fraction: f64,
        /// What it is doing just now.
        doing: String,
        /// Estimated from the time that the fraction took; `None` too early to say.
        remaining: Option<Duration>,
        /// Was asked to stop and will at its next checkpoint.
        cancelling: bool,
    },
    /// Ended with a result.
    Done {
        /// The result in a sentence.
        summary: String,
    },
    /// Stopped on request; nothing was changed.
    Cancelled,
    /// Could not be done.
    Failed {
        /// What is wrong and what to do.
        reason: String,
    },
    /// A defect of this program; nothing was changed.
    Panicked {
        /// What the program said when it stopped.
        message: String,
    },
}

impl JobState {
    /// Whether it has not ended.
    pub fn is_running(&self) -> bool {
        matches!(self, Self::Running { .. })
    }
}
