//! What the handler of a command may reach besides its own workflow.

use plumbline_model::StereoFrame;

use crate::command::JobId;
use crate::job_list::JobList;
use crate::notice::{NoticeLevel, Notices};
use crate::robot::RobotControl;
use crate::source::Control;
use crate::view::SourceView;
use crate::work::Work;

/// What the state asks the outer world to do.
#[derive(Clone, Debug)]
pub enum Action {
    /// Hand this to the source thread.
    Source(Control),
    /// Hand this to the robot's thread.
    Robot(RobotControl),
    /// Start this work; it ends with [`crate::state::State::work_ended`].
    Start(JobId, Work),
    /// Ask this work to stop.
    Cancel(JobId),
}

/// What the handler of a command may reach besides its own workflow.
pub struct Context<'a> {
    /// Messages for the operator.
    pub notices: &'a mut Notices,
    /// Newest pair.
    pub newest: Option<&'a StereoFrame>,
    /// How the source is doing.
    pub source: &'a SourceView,
    pub(crate) jobs: &'a mut JobList,
    pub(crate) actions: &'a mut Vec<Action>,
}

impl Context<'_> {
    /// Starts work beside the window.
    pub fn start(&mut self, work: impl Into<Work>) -> JobId {
        let work = work.into();
        let id = self.jobs.add(work.title(), work.is_quiet());
        self.actions.push(Action::Start(id, work));
        id
    }

    /// Asks work to stop.
    pub fn cancel(&mut self, id: JobId) {
        self.actions.push(Action::Cancel(id));
    }

    /// Hands a command to the source thread.
    pub fn control_source(&mut self, control: Control) {
        self.actions.push(Action::Source(control));
    }

    /// Tells the operator why something is not done.
    pub fn refuse(&mut self, why: impl std::fmt::Display) {
        self.notices.add(NoticeLevel::Error, why.to_string());
    }
}
