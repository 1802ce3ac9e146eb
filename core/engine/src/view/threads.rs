//! What has failed inside of the program, and what is kept of the operator's work.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use super::{
    BusView, Connection, JobState, JobView, JointView, MotionState, RobotView, SourceStatus, SourceView,
    TwinView, View,
};
use crate::watched::{Trouble, WatchedThread};

/// A thread of the program that does not do its work any more.
#[derive(Clone, Debug, PartialEq)]
pub struct ThreadFault {
    /// Which.
    pub thread: WatchedThread,
    /// What it means and what to do: a sentence.
    pub meaning: Arc<str>,
    /// What the program said when it failed; `None` when it only gives no sign of life.
    pub said: Option<Arc<str>>,
    /// Since when.
    pub since: Instant,
    /// Whether it can be started again now; while it holds on to something it cannot.
    pub can_start_again: bool,
}

impl ThreadFault {
    /// From what is wrong with a thread.
    pub fn new(thread: WatchedThread, trouble: Trouble, has_ended: bool) -> Self {
        match trouble {
            Trouble::Ended { said, since } => Self {
                thread,
                meaning: thread.meaning_of_end().into(),
                said: Some(said.into()),
                since,
                can_start_again: has_ended,
            },
            Trouble::Silent { since } => Self {
                thread,
                meaning: thread.meaning_of_silence().into(),
                said: None,
                since,
                can_start_again: false,
            },
        }
    }

    /// Whether it gives no sign of life but has not ended.
    pub fn is_silent(&self) -> bool {
        self.said.is_none()
    }
}

/// Where data are kept, and whether what is done is written down.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeptView {
    /// Where calibrations, sessions and the journal are kept.
    pub folder: PathBuf,
    /// What is wrong with that folder and what to do, a sentence.
    pub problem: Option<Arc<str>>,
    /// The journal of this start; `None` when none is kept.
    pub journal: Option<PathBuf>,
    /// Why no journal is kept, a sentence.
    pub no_journal_because: Option<Arc<str>>,
    /// Commands that the journal lacks, because the disk did not keep up or did not take them.
    pub journal_lost: u64,
}

/// The robot as nobody knows it any more: no motion, no rate, no angles.
pub(crate) fn robot_without_its_thread(before: &RobotView, reason: &str) -> RobotView {
    let to = match &before.connection {
        Connection::None => "the robot".to_owned(),
        Connection::Connecting { to, .. }
        | Connection::Connected { to, .. }
        | Connection::Lost { to, .. } => to.clone(),
    };
    RobotView {
        connection: Connection::Lost { to, reason: reason.to_owned() },
        motion: MotionState::Unknown,
        // Whoever looks after the threads has pressed it.
        stopped: true,
        joints: before.joints.iter().map(JointView::without_readings).collect(),
        measured: None,
        commanded: None,
        tip_place: None,
        trail: Arc::default(),
        preview: None,
        refusal: Some(reason.to_owned()),
        bus: BusView::default(),
        ..before.clone()
    }
}

/// The twin lives in the robot's thread and goes with it.
pub(crate) fn twin_without_its_thread(before: &TwinView, reason: &str) -> TwinView {
    let failed = before.running.then(|| reason.to_owned());
    TwinView { running: false, failed: failed.or_else(|| before.failed.clone()), ..before.clone() }
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
