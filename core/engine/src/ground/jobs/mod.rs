//! Long work beside the window: progress, cancel, and four ways to end that look different.

pub mod list;
mod view;

use std::panic::AssertUnwindSafe;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use crossbeam_channel::{Receiver, RecvTimeoutError, TryRecvError};
use plumbline_model::files::FileError;
use plumbline_model::priority::step_back;
use plumbline_model::{Cancelled, JobContext, duration};

use super::text::sentence;

pub use view::{JobCommand, JobId, JobState, JobView};

/// How a job ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome<T> {
    /// With a result, which is a proposal until the operator accepts it.
    Done(T),
    /// On request; nothing was changed.
    Cancelled,
    /// It could not be done; says what is wrong and what to do.
    Failed(String),
    /// A defect of this program.
    Panicked(String),
}

/// Why a job gave no result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JobError {
    /// It was asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// What is wrong and what to do.
    #[error("{0}")]
    Failed(String),
}

impl JobError {
    /// From any error that speaks for itself.
    pub fn failed(error: impl std::fmt::Display) -> Self {
        Self::Failed(error.to_string())
    }

    /// From an error whose words can stand inside of a sentence.
    pub fn told(error: impl std::fmt::Display) -> Self {
        Self::Failed(sentence(&error.to_string()))
    }

    /// A file cannot be removed.
    pub fn not_removed(file: &Path, error: &std::io::Error) -> Self {
        Self::Failed(format!("{} cannot be removed: {error}. Remove it by hand.", file.display()))
    }
}

impl From<FileError> for JobError {
    fn from(error: FileError) -> Self {
        Self::told(error)
    }
}

/// A job at work or just ended.
pub struct JobHandle<T> {
    /// Its number.
    pub id: JobId,
    /// What it does.
    pub title: String,
    started: Instant,
    shared: Arc<Shared>,
    outcome: Receiver<Outcome<T>>,
    told: AtomicBool,
}

struct Shared {
    cancel: AtomicBool,
    progress: Mutex<Progress>,
    changed: Box<dyn Fn() + Send + Sync>,
}

struct Progress {
    fraction: f64,
    doing: String,
    announced: Instant,
}

/// Progress is announced at most this often.
const ANNOUNCE_EVERY: Duration = Duration::from_millis(50);
/// Before this time or [`TELLING_FRACTION`], how long a job has taken says nothing about its end.
const TELLING_TIME: Duration = Duration::from_millis(500);
const TELLING_FRACTION: f64 = 0.03;

impl JobContext for Shared {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        if self.cancel.load(Ordering::Relaxed) { Err(Cancelled) } else { Ok(()) }
    }

    fn report(&self, fraction: f64, doing: &str) {
        let mut progress = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.fraction = if fraction.is_finite() { fraction.clamp(0.0, 1.0) } else { progress.fraction };
        if progress.doing != doing {
            progress.doing = doing.to_owned();
        }
        let now = Instant::now();
        if now.duration_since(progress.announced) >= ANNOUNCE_EVERY {
            progress.announced = now;
            drop(progress);
            (self.changed)();
        }
    }
}

impl<T: Send + 'static> JobHandle<T> {
    /// Starts `work` on a thread of its own, which steps back behind the joint bus and the window; so do
    /// threads that it starts, those of a detector among them. `changed` is called from there when there is
    /// progress to show and when the job has ended.
    pub fn start(
        id: JobId,
        title: impl Into<String>,
        changed: impl Fn() + Send + Sync + 'static,
        work: impl FnOnce(&dyn JobContext) -> Result<T, JobError> + Send + 'static,
    ) -> Self {
        let (title, started) = (title.into(), Instant::now());
        let shared = Arc::new(Shared {
            cancel: AtomicBool::new(false),
            progress: Mutex::new(Progress {
                fraction: 0.0,
                doing: "starting".to_owned(),
                announced: started,
            }),
            changed: Box::new(changed),
        });
        let (ended, outcome) = crossbeam_channel::bounded(1);
        let (for_thread, in_thread) = (ended.clone(), shared.clone());
        let thread = std::thread::Builder::new().name(format!("job {}", id.0)).spawn(move || {
            step_back();
            // Work owns its snapshot, so nothing that it leaves half done is seen by anybody.
            let result = std::panic::catch_unwind(AssertUnwindSafe(|| work(in_thread.as_ref())));
            // The receiver is gone when the program is closing; then nobody wants the outcome.
            let _ = for_thread.try_send(outcome_of(result));
            (in_thread.changed)();
        });
        if let Err(error) = thread {
            let _ = ended.try_send(Outcome::Failed(format!(
                "The system gave no thread for this work ({error}). Close other programs and try again."
            )));
        }
        Self { id, title, started, shared, outcome, told: AtomicBool::new(false) }
    }
}

impl<T> JobHandle<T> {
    /// Asks the job to stop at its next checkpoint.
    pub fn cancel(&self) {
        self.shared.cancel.store(true, Ordering::Relaxed);
    }

    /// How it ended, once it has; gives the outcome only once.
    pub fn take_outcome(&self) -> Option<Outcome<T>> {
        match self.outcome.try_recv() {
            Ok(outcome) => self.told(outcome),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => self.told(without_a_word()),
        }
    }

    /// Waits for the end, but not longer than this.
    pub fn wait_at_most(&self, time: Duration) -> Option<Outcome<T>> {
        match self.outcome.recv_timeout(time) {
            Ok(outcome) => self.told(outcome),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => self.told(without_a_word()),
        }
    }

    /// Waits for the end (tests and the command line).
    pub fn wait(&self) -> Outcome<T> {
        let outcome = self.outcome.recv().unwrap_or_else(|_| without_a_word());
        self.told.store(true, Ordering::Relaxed);
        outcome
    }

    /// The outcome, if it was not given before.
    fn told(&self, outcome: Outcome<T>) -> Option<Outcome<T>> {
        (!self.told.swap(true, Ordering::Relaxed)).then_some(outcome)
    }

    /// What the window shows while it is at work.
    pub fn view(&self, now: Instant) -> JobView {
        let progress = self.shared.progress.lock().unwrap_or_else(PoisonError::into_inner);
        let elapsed = now.saturating_duration_since(self.started);
        JobView {
            id: self.id,
            title: self.title.clone(),
            state: JobState::Running {
                fraction: progress.fraction,
                doing: progress.doing.clone(),
                remaining: remaining(elapsed, progress.fraction),
                cancelling: self.shared.cancel.load(Ordering::Relaxed),
            },
            elapsed,
            by_itself: false,
        }
    }

    /// Time since it started.
    pub fn elapsed(&self, now: Instant) -> Duration {
        now.saturating_duration_since(self.started)
    }
}

/// Does parallel work on workers that only jobs use.
pub fn on_job_workers<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    static WORKERS: OnceLock<Option<rayon::ThreadPool>> = OnceLock::new();
    let workers = WORKERS.get_or_init(|| {
        let named = rayon::ThreadPoolBuilder::new().thread_name(|i| format!("job worker {i}"));
        // Whoever asks for them first need not be a job.
        named
            .start_handler(|_| step_back())
            .build()
            .map_err(|error| log::warn!("jobs share the workers of the live view: {error}"))
            .ok()
    });
    match workers {
        Some(workers) => workers.install(work),
        None => work(),
    }
}

/// A part of a longer job: its progress from 0 to 1 is that of the whole from `begin` to `end`.
pub struct Part<'a> {
    /// The longer job.
    pub whole: &'a dyn JobContext,
    /// Where the part begins.
    pub begin: f64,
    /// Where it ends.
    pub end: f64,
}

impl JobContext for Part<'_> {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        self.whole.checkpoint()
    }

    fn report(&self, fraction: f64, doing: &str) {
        self.whole.report(self.begin + fraction * (self.end - self.begin), doing);
    }
}

impl<T> From<Result<T, JobError>> for Outcome<T> {
    fn from(result: Result<T, JobError>) -> Self {
        match result {
            Ok(result) => Self::Done(result),
            Err(JobError::Cancelled(_)) => Self::Cancelled,
            Err(JobError::Failed(reason)) => Self::Failed(reason),
        }
    }
}

fn outcome_of<T>(result: std::thread::Result<Result<T, JobError>>) -> Outcome<T> {
    match result {
        Ok(result) => result.into(),
        Err(panic) => Outcome::Panicked(panic_message(panic.as_ref())),
    }
}

/// A job whose thread is gone and that said nothing would be shown at work for ever.
fn without_a_word<T>() -> Outcome<T> {
    Outcome::Panicked("its thread ended without a word".to_owned())
}

/// What a panic said.
pub(crate) fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_owned())
}

fn remaining(elapsed: Duration, fraction: f64) -> Option<Duration> {
    (elapsed >= TELLING_TIME && fraction >= TELLING_FRACTION)
        .then(|| duration::seconds(elapsed.as_secs_f64() * (1.0 - fraction) / fraction))
        .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start<T: Send + 'static>(
        work: impl FnOnce(&dyn JobContext) -> Result<T, JobError> + Send + 'static,
    ) -> JobHandle<T> {
        JobHandle::start(JobId(1), "test", || {}, work)
    }

    #[test]
    fn a_job_gives_its_result_once() {
        let job = start(|_| Ok(7));
        assert_eq!(job.wait(), Outcome::Done(7));
        assert_eq!(job.take_outcome(), None);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_job_and_its_workers_step_back_behind_whoever_started_them() {
        let nice = || rustix::process::getpriority_process(None).expect("a thread has a priority");
        let before = nice();
        let job = start(move |_| Ok((nice(), on_job_workers(nice))));
        // Run with `nice`, the tests stand far back already.
        let stands_back = |now: i32| now > before || before >= 10;
        let Outcome::Done((job, worker)) = job.wait() else { panic!("it ends well") };
        assert!(stands_back(job) && stands_back(worker), "{before}: the job {job}, its worker {worker}");
        assert_eq!(nice(), before, "whoever started it goes on as before");
    }

    #[test]
    fn a_cancelled_job_stops_at_its_next_checkpoint() {
        let job: JobHandle<()> = start(|context| {
            loop {
                context.checkpoint()?;
                std::thread::sleep(Duration::from_millis(1));
            }
        });
        assert_eq!(job.take_outcome(), None, "it does not end by itself");
        job.cancel();
        let cancelling = matches!(job.view(Instant::now()).state, JobState::Running { cancelling: true, .. });
        assert!(cancelling);
        assert_eq!(job.wait(), Outcome::Cancelled);
    }

    #[test]
    fn failing_and_panicking_look_different() {
        let failed: JobHandle<()> = start(|_| Err(JobError::failed("no pairs: open a folder first")));
        assert_eq!(failed.wait(), Outcome::Failed("no pairs: open a folder first".into()));
        let panicked: JobHandle<()> = start(|_| panic!("index {} out of range", 3));
        assert_eq!(panicked.wait(), Outcome::Panicked("index 3 out of range".into()));
    }

    #[test]
    fn a_job_that_dies_without_a_word_is_not_at_work_for_ever() {
        /// A panic whose message cannot even be dropped.
        struct Vicious;
        impl Drop for Vicious {
            fn drop(&mut self) {
                panic!("not even that");
            }
        }
        let job: JobHandle<()> = start(|_| std::panic::panic_any(Vicious));
        let outcome = job.wait_at_most(Duration::from_secs(10)).expect("it ended");
        assert!(matches!(outcome, Outcome::Panicked(_)), "{outcome:?}");
        assert_eq!(job.take_outcome(), None, "told once");
    }

    #[test]
    fn progress_is_seen_and_announced() {
        let (announce, announced) = crossbeam_channel::bounded(16);
        let (go, wait) = crossbeam_channel::bounded::<()>(0);
        let job = JobHandle::start(
            JobId(2),
            "test",
            move || {
                let _ = announce.try_send(());
            },
            move |context| {
                std::thread::sleep(ANNOUNCE_EVERY);
                context.report(0.25, "solving, iteration 4");
                let _ = wait.recv();
                Ok(())
            },
        );
        announced.recv_timeout(Duration::from_secs(10)).expect("announced");
        let JobState::Running { fraction, doing, .. } = job.view(Instant::now()).state else {
            panic!("running")
        };
        assert_eq!((fraction, doing.as_str()), (0.25, "solving, iteration 4"));
        drop(go);
        assert_eq!(job.wait(), Outcome::Done(()));
    }

    #[test]
    fn the_remaining_time_is_estimated_only_when_it_can_be() {
        assert_eq!(remaining(Duration::from_millis(100), 0.5), None);
        assert_eq!(remaining(Duration::from_secs(10), 0.0), None);
        assert_eq!(remaining(Duration::from_secs(3), 0.75), Some(Duration::from_secs(1)));
    }
}
