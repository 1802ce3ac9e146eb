//! The jobs that the window shows: what is running, and how the others ended.

use std::sync::Arc;
use std::time::Duration;

use super::{JobId, JobState, JobView};

/// Ended jobs that are kept.
const KEPT: usize = 8;

#[derive(Clone, Debug)]
struct Record {
    view: JobView,
    /// Not worth a line once it is done.
    quiet: bool,
}

/// Jobs in the order in which they were started.
#[derive(Clone, Debug, Default)]
pub struct JobList {
    records: Vec<Record>,
    count: u64,
}

impl JobList {
    /// Adds a job that starts now. That the same one failed before is said no longer.
    pub fn add(&mut self, title: String, quiet: bool) -> JobId {
        self.count += 1;
        self.records.retain(|record| !(record.view.title == title && record.view.state.has_failed()));
        let id = JobId(self.count);
        let state = JobState::Running {
            fraction: 0.0,
            doing: "starting".to_owned(),
            remaining: None,
            cancelling: false,
        };
        let view = JobView { id, title, state, elapsed: Duration::ZERO, by_itself: false };
        self.records.push(Record { view, quiet });
        id
    }

    /// Nobody asked for this job.
    pub fn began_by_itself(&mut self, id: JobId) {
        if let Some(record) = self.records.iter_mut().find(|record| record.view.id == id) {
            record.view.by_itself = true;
        }
    }

    /// Takes over how far a job is.
    pub fn progress(&mut self, view: JobView) {
        if let Some(record) = self.records.iter_mut().find(|record| record.view.id == view.id) {
            // Who does the work does not know who asked for it.
            record.view = JobView { by_itself: record.view.by_itself, ..view };
        }
    }

    /// Takes over how a job ended.
    pub fn ended(&mut self, id: JobId, state: JobState, elapsed: Duration) {
        if let Some(record) = self.records.iter_mut().find(|record| record.view.id == id) {
            record.view.state = state;
            record.view.elapsed = elapsed;
            if record.quiet {
                self.dismiss(id);
            }
        }
        let ended = self.records.iter().filter(|record| !record.view.state.is_running()).count();
        for _ in KEPT..ended {
            if let Some(oldest) = self.records.iter().position(|record| !record.view.state.is_running()) {
                self.records.remove(oldest);
            }
        }
    }

    /// Takes an ended job out of the list.
    pub fn dismiss(&mut self, id: JobId) {
        self.records.retain(|record| record.view.id != id || record.view.state.is_running());
    }

    /// Whether the end of a job is worth a message.
    pub fn is_worth_telling(&self, id: JobId) -> bool {
        self.records.iter().any(|record| record.view.id == id && !record.quiet)
    }

    /// Title of a job.
    pub fn title(&self, id: JobId) -> Option<&str> {
        self.records.iter().find(|record| record.view.id == id).map(|record| record.view.title.as_str())
    }

    /// Whether a job is in the list and has not ended.
    pub fn is_running(&self, id: JobId) -> bool {
        self.records.iter().any(|record| record.view.id == id && record.view.state.is_running())
    }

    /// What the window shows. Quiet jobs are shown only while they run.
    pub fn view(&self) -> Arc<[JobView]> {
        self.records.iter().map(|record| record.view.clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn done() -> JobState {
        JobState::Done { summary: "done".into() }
    }

    #[test]
    fn ended_jobs_stay_until_dismissed_and_running_ones_cannot_be_dismissed() {
        let mut list = JobList::default();
        let (a, b) = (list.add("a".into(), false), list.add("b".into(), false));
        list.ended(a, done(), Duration::from_secs(1));
        list.dismiss(b);
        assert_eq!(list.view().len(), 2);
        assert!(list.is_running(b) && !list.is_running(a));
        list.dismiss(a);
        assert_eq!(list.view().len(), 1);
    }

    #[test]
    fn that_a_job_failed_is_said_until_the_same_one_begins_again() {
        let mut list = JobList::default();
        let failed = || JobState::Failed { reason: "too few".into() };
        for title in ["train", "search"] {
            let id = list.add(title.into(), false);
            list.ended(id, failed(), Duration::from_secs(1));
        }
        list.add("train".into(), false);
        let said: Vec<(String, bool)> =
            list.view().iter().map(|job| (job.title.clone(), job.state.has_failed())).collect();
        assert_eq!(said, [("search".to_owned(), true), ("train".to_owned(), false)]);
    }

    #[test]
    fn that_nobody_asked_for_a_job_is_known_for_as_long_as_it_is_there() {
        let mut list = JobList::default();
        let (own, asked) = (list.add("judge".into(), false), list.add("solve".into(), false));
        list.began_by_itself(own);
        let view = |id| JobView {
            id,
            title: String::new(),
            state: JobState::Cancelled,
            elapsed: Duration::ZERO,
            by_itself: false,
        };
        list.progress(view(own));
        list.progress(view(asked));
        list.ended(own, done(), Duration::ZERO);
        assert_eq!(list.view().iter().map(|job| job.by_itself).collect::<Vec<_>>(), [true, false]);
    }

    #[test]
    fn quiet_jobs_leave_no_line_and_the_others_are_bounded() {
        let mut list = JobList::default();
        let quiet = list.add("quiet".into(), true);
        assert_eq!(list.view().len(), 1);
        list.ended(quiet, done(), Duration::ZERO);
        assert!(list.view().is_empty());
        for i in 0..KEPT + 4 {
            let id = list.add(i.to_string(), false);
            list.ended(id, JobState::Cancelled, Duration::ZERO);
        }
        let titles: Vec<String> = list.view().iter().map(|job| job.title.clone()).collect();
        assert_eq!((titles.len(), titles[0].as_str()), (KEPT, "4"));
    }
}
