//! What the handler of a command may reach besides its own workflow.

use super::jobs::JobId;
use super::jobs::list::JobList;
use super::notice::{NoticeLevel, Notices};
use super::time::Time;
use super::work::{LongWork, Nothing};

/// What a workflow asks of the outer world: `W` is its work, `C` what it tells a thread.
#[derive(Clone, Debug)]
pub enum Asked<W, C = Nothing> {
    /// Start this work.
    Start(JobId, W),
    /// Ask this work to stop.
    Cancel(JobId),
    /// Hand this to its thread.
    Control(C),
}

/// What the handler of a command may reach besides its own workflow: messages for the operator,
/// work beside the window, and a thread that it may tell something.
pub struct Context<'a, W, C = Nothing> {
    /// Messages for the operator.
    pub notices: &'a mut Notices,
    /// When it happens. Workflows read no clock.
    pub time: Time,
    jobs: &'a mut JobList,
    asked: &'a mut Vec<Asked<W, C>>,
}

impl<'a, W: LongWork, C> Context<'a, W, C> {
    /// What is asked for is added to `asked`.
    pub fn new(
        notices: &'a mut Notices,
        jobs: &'a mut JobList,
        time: Time,
        asked: &'a mut Vec<Asked<W, C>>,
    ) -> Self {
        Self { notices, time, jobs, asked }
    }

    /// Starts work beside the window.
    pub fn start(&mut self, work: W) -> JobId {
        let id = self.jobs.add(work.title(), work.is_quiet());
        self.asked.push(Asked::Start(id, work));
        id
    }

    /// Starts work that nobody asked for: the window goes on saying what the operator asked for.
    pub fn start_by_itself(&mut self, work: W) -> JobId {
        let id = self.start(work);
        self.jobs.began_by_itself(id);
        id
    }

    /// Asks work to stop.
    pub fn cancel(&mut self, id: JobId) {
        self.asked.push(Asked::Cancel(id));
    }

    /// Hands something to the thread that this workflow may tell.
    pub fn control(&mut self, control: C) {
        self.asked.push(Asked::Control(control));
    }

    /// Tells the operator why something is not done.
    pub fn refuse(&mut self, why: impl std::fmt::Display) {
        self.notices.add(NoticeLevel::Error, why.to_string());
    }
}
