//! Keeps a source open: when it disappears it is reported as lost, tried again with growing
//! pauses, and comes back by itself.

use std::collections::HashSet;
use std::time::{Duration, Instant};

use crate::error::SourceError;
use crate::source::{Counters, FiniteSource, Next, Report, SourceDescription, StereoSource};

/// Pauses between attempts to bring a lost source back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RetryPolicy {
    /// Before the first attempt; each further pause is twice as long.
    pub first_pause: Duration,
    /// Pauses grow no longer than this.
    pub longest_pause: Duration,
}

impl Default for RetryPolicy {
    fn default() -> Self {
        Self { first_pause: Duration::from_millis(500), longest_pause: Duration::from_secs(8) }
    }
}

/// A source that is gone for the moment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lost {
    /// Why, and what to do. Follows what the attempts find.
    pub reason: String,
    /// Since when.
    pub since: Instant,
    /// Attempts to bring it back so far.
    pub attempts: u32,
    /// When it is tried again.
    pub retry_at: Instant,
}

/// Whether a source is there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SourceStatus {
    /// It is.
    Running,
    /// It is gone and is retried.
    Lost(Lost),
}

type Reopen = Box<dyn FnMut() -> Result<Box<dyn StereoSource>, SourceError> + Send>;

/// Wraps a source and the way to open it again. Never fails: while the source is lost it
/// answers [`Next::NotYet`], and [`status`](Self::status) tells why.
///
/// Sequence numbers and counters go on over a loss; a folder goes on where it was.
pub struct Retrying {
    reopen: Reopen,
    policy: RetryPolicy,
    source: Option<Box<dyn StereoSource>>,
    lost: Option<Lost>,
    description: SourceDescription,
    /// Of sources that were lost.
    past: Counters,
    position: Option<usize>,
    reports: Vec<Report>,
    /// Reports of files are told once, though a reopened folder tells them again.
    told: HashSet<String>,
}

impl Retrying {
    /// Opens the source; a source that cannot be opened the first time is an error, so that
    /// a mistyped path is answered at once.
    pub fn open(
        reopen: impl FnMut() -> Result<Box<dyn StereoSource>, SourceError> + Send + 'static,
        policy: RetryPolicy,
    ) -> Result<Self, SourceError> {
        let mut reopen: Reopen = Box::new(reopen);
        let source = reopen()?;
        Ok(Self {
            reopen,
            policy,
            description: source.describe(),
            source: Some(source),
            lost: None,
            past: Counters::default(),
            position: None,
            reports: Vec::new(),
            told: HashSet::new(),
        })
    }

    /// Whether the source is there, and if not, why.
    pub fn status(&self) -> SourceStatus {
        self.lost.clone().map_or(SourceStatus::Running, SourceStatus::Lost)
    }

    /// Tries a lost source again in the next call instead of when its pause is over.
    pub fn retry_now(&mut self) {
        if let Some(lost) = &mut self.lost {
            lost.retry_at = Instant::now();
        }
    }

    fn collect_reports(&mut self) {
        let Some(source) = &mut self.source else { return };
        for report in source.take_reports() {
            if self.told.insert(report.to_string()) {
                self.reports.push(report);
            }
        }
    }

    fn lose(&mut self, error: &SourceError) {
        self.collect_reports();
        if let Some(source) = self.source.take() {
            self.past = add(self.past, source.counters());
        }
        let now = Instant::now();
        let reason = error.to_string();
        self.reports.push(Report::Lost { reason: reason.clone() });
        let retry_at = now + self.policy.first_pause;
        self.lost = Some(Lost { reason, since: now, attempts: 0, retry_at });
    }

    /// Tries to bring a lost source back when its time has come.
    fn try_again(&mut self) {
        let Some(lost) = &mut self.lost else { return };
        if Instant::now() < lost.retry_at {
            return;
        }
        match (self.reopen)() {
            Ok(mut source) => {
                if let (Some(position), Some(finite)) = (self.position, source.as_finite())
                    && position < finite.pair_count()
                    && let Err(error) = finite.seek(position)
                {
                    log::warn!("the source came back but starts over: {error}");
                }
                self.reports.push(Report::Returned { after: lost.since.elapsed() });
                self.description = source.describe();
                self.source = Some(source);
                self.lost = None;
            }
            Err(error) => {
                lost.attempts += 1;
                lost.reason = error.to_string();
                let doublings = lost.attempts.min(16);
                let pause = self.policy.first_pause.saturating_mul(1 << doublings);
                lost.retry_at = Instant::now() + pause.min(self.policy.longest_pause);
            }
        }
    }
}

impl StereoSource for Retrying {
    fn next_pair(&mut self) -> Result<Next, SourceError> {
        self.try_again();
        let Some(source) = &mut self.source else { return Ok(Next::NotYet) };
        let next = source.next_pair();
        self.position = source.as_finite().map(|finite| finite.position());
        match next {
            Ok(Next::Pair(mut frame)) => {
                frame.stamp.seq += self.past.delivered;
                Ok(Next::Pair(frame))
            }
            Ok(other) => Ok(other),
            Err(error) => {
                self.lose(&error);
                Ok(Next::NotYet)
            }
        }
    }

    fn describe(&self) -> SourceDescription {
        self.source.as_ref().map_or_else(|| self.description.clone(), |source| source.describe())
    }

    fn counters(&self) -> Counters {
        self.source.as_ref().map_or(self.past, |source| add(self.past, source.counters()))
    }

    fn take_reports(&mut self) -> Vec<Report> {
        self.collect_reports();
        std::mem::take(&mut self.reports)
    }

    fn wait_hint(&self) -> Duration {
        match (&self.source, &self.lost) {
            (Some(source), _) => source.wait_hint(),
            (None, Some(lost)) => lost.retry_at.saturating_duration_since(Instant::now()),
            (None, None) => self.policy.first_pause,
        }
    }

    fn as_finite(&mut self) -> Option<&mut dyn FiniteSource> {
        self.source.as_mut()?.as_finite()
    }
}

fn add(a: Counters, b: Counters) -> Counters {
    Counters {
        delivered: a.delivered + b.delivered,
        skipped: a.skipped + b.skipped,
        superseded: a.superseded + b.superseded,
        unpaired_left: a.unpaired_left + b.unpaired_left,
        unpaired_right: a.unpaired_right + b.unpaired_right,
    }
}
