//! What the window draws: an immutable snapshot of everything the engine knows.
//!
//! A view is cheap to take and to keep: images and long lists are shared, not copied.

use std::sync::Arc;

pub use crate::eyes::map::TableMap;
pub use crate::ground::data_folder::KeptView;
pub use crate::ground::jobs::{JobState, JobView};
use crate::ground::notice::Notice;
pub use crate::ground::statistics::StageStatistics;
pub use crate::ground::step::StepState;
pub use crate::ground::watched::ThreadFault;
use crate::ground::watched::WatchedThread;

macro_rules! views {
    ($($(#[$about:meta])* $field:ident: $room:ident / $view:ident;)+) => {
        $(pub use crate::$room::view::*;)+

        /// Everything that can be shown, at one moment.
        #[derive(Clone, Debug, Default)]
        pub struct View {
            /// Counts up with every change.
            pub revision: u64,
            $($(#[$about])* pub $field: Arc<$view>,)+
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
    };
}

views! {
    /// Where the images come from.
    source: source / SourceView;
    /// Recording what works live.
    recording: recording / RecordingView;
    /// The newest images and what was computed from them.
    live: live / LiveView;
    /// What the detector sees live.
    detect: detect / DetectView;
    /// Whether places stay where they are.
    drift: drift / DriftView;
    /// Calibrating the eyes.
    eyes: eyes / EyesView;
    /// The robot.
    robot: robot / RobotView;
    /// The twin.
    twin: twin / TwinView;
    /// The twin's truth beside what is measured, for the window alone.
    truth: truth / TruthView;
    /// Calibrating how the eyes sit in the head.
    mount: mount / MountView;
    /// Touching the screen.
    touch: touch / TouchView;
    /// Correction models, and the tables of grasp height and yaw.
    models: models / ModelsView;
    /// The gap between model and measurement.
    gap: gap / GapView;
    /// Grasping.
    grasp: grasp / GraspView;
    /// Tying the arms to the eyes.
    handeye: handeye / HandEyeView;
    /// The experiment with grasps.
    trials: trials / TrialsView;
    /// The way to the first good grasp.
    commission: commission / CommissionView;
    /// Everything that was put in use, taken back, found and checked.
    timeline: timeline / TimelineView;
    /// The lab's own data sets.
    labels: labels / LabelsView;
    /// Scores of detectors.
    scores: scores / ScoresView;
}

impl View {
    /// What is wrong with a thread; `None` when it does its work.
    pub fn fault(&self, thread: WatchedThread) -> Option<&ThreadFault> {
        self.threads.iter().find(|fault| fault.thread == thread)
    }

    /// The oldest job that is still running and that did not begin by itself.
    pub fn running_job(&self) -> Option<&JobView> {
        self.jobs.iter().find(|job| job.state.is_running() && !job.by_itself)
    }
}

/// The last view of an engine whose heart has failed: nothing in it is true any more.
pub(crate) fn view_without_its_engine(before: &View, fault: ThreadFault) -> View {
    let reason = fault.meaning.to_string();
    let ended = |job: &JobView| {
        let state = match &job.state {
            JobState::Running { .. } => JobState::Panicked { message: reason.clone() },
            ended => ended.clone(),
        };
        JobView { state, ..job.clone() }
    };
    let lost = SourceStatus::Lost { reason: reason.clone(), since: fault.since, attempts: 0 };
    let source = match before.source.status {
        SourceStatus::None => before.source.clone(),
        _ => Arc::new(SourceView { status: lost, ..SourceView::clone(&before.source) }),
    };
    View {
        revision: before.revision + 1,
        robot: Arc::new(robot_without_its_thread(&before.robot, &reason)),
        twin: Arc::new(twin_without_its_thread(&before.twin, &reason)),
        source,
        jobs: before.jobs.iter().map(ended).collect(),
        threads: Arc::from([fault]),
        ..before.clone()
    }
}
