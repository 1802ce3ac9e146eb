//! How fast, how old, how much was skipped.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// How one stage is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageStatistics {
    /// Results per second over the last two seconds, of fewer of the last two; `None` before the second result, and where
    /// that was long ago.
    pub per_second: Option<f64>,
    /// Median time spent on one result, of the last ones.
    pub busy: Option<Duration>,
    /// From capture to result, of the newest one.
    pub latency: Option<Duration>,
    /// When the newest result came.
    pub newest_at: Option<Instant>,
    /// Pairs that were skipped because a newer one came first, since the program was started.
    pub skipped: u64,
}

/// Keeps the figures of one stage. Time is handed in, so that tests need not wait.
#[derive(Clone, Debug, Default)]
pub struct StageClock {
    results: VecDeque<Instant>,
    busy: VecDeque<Duration>,
    latency: Option<Duration>,
    skipped: u64,
}

/// The rate is that of the results within this time.
const WINDOW: Duration = Duration::from_secs(2);
/// Where fewer come, it is that of the last two, no older than this.
const SLOW: Duration = Duration::from_secs(10);
/// The median time is that of this many results.
const BUSY_KEPT: usize = 31;

impl StageClock {
    /// Notes a result of an image captured at `captured_at` that took `busy` to compute.
    pub fn note(&mut self, now: Instant, captured_at: Instant, busy: Duration) {
        self.results.push_back(now);
        self.forget_before(now);
        if self.busy.len() == BUSY_KEPT {
            self.busy.pop_front();
        }
        self.busy.push_back(busy);
        self.latency = Some(now.saturating_duration_since(captured_at));
    }

    /// Takes over the count of skipped pairs from the slot in front of the stage.
    pub fn set_skipped(&mut self, skipped: u64) {
        self.skipped = skipped;
    }

    /// When the newest result came.
    pub fn newest_at(&self) -> Option<Instant> {
        self.results.back().copied()
    }

    /// The figures at this moment.
    pub fn figures(&mut self, now: Instant) -> StageStatistics {
        let newest_at = self.newest_at();
        self.forget_before(now);
        StageStatistics {
            per_second: self.per_second(),
            busy: self.median_busy(),
            latency: self.latency,
            newest_at,
            skipped: self.skipped,
        }
    }

    fn forget_before(&mut self, now: Instant) {
        // The newest one stays: it says how old the picture is.
        while self.results.len() > 1 {
            let most = if self.results.len() > 2 { WINDOW } else { SLOW };
            if now.saturating_duration_since(self.results[0]) <= most {
                break;
            }
            self.results.pop_front();
        }
    }

    fn per_second(&self) -> Option<f64> {
        let (first, last) = (*self.results.front()?, *self.results.back()?);
        let span_secs = last.saturating_duration_since(first).as_secs_f64();
        (self.results.len() > 1 && span_secs > 0.0).then(|| (self.results.len() - 1) as f64 / span_secs)
    }

    fn median_busy(&self) -> Option<Duration> {
        let mut sorted: Vec<Duration> = self.busy.iter().copied().collect();
        sorted.sort();
        sorted.get(sorted.len() / 2).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thirty_results_a_second_are_thirty_per_second() {
        let start = Instant::now();
        let mut clock = StageClock::default();
        for i in 0..300u32 {
            let now = start + Duration::from_secs(1) * i / 30;
            clock.note(now + Duration::from_millis(5), now, Duration::from_millis(4));
        }
        let figures = clock.figures(start + Duration::from_secs(10));
        let rate = figures.per_second.expect("many results");
        assert!((rate - 30.0).abs() < 0.01, "{rate}");
        assert_eq!(figures.busy, Some(Duration::from_millis(4)));
        assert_eq!(figures.latency, Some(Duration::from_millis(5)));
    }

    #[test]
    fn what_comes_seldom_has_a_rate_too() {
        let start = Instant::now();
        let mut clock = StageClock::default();
        for i in 0..5u32 {
            let now = start + Duration::from_secs(3) * i;
            clock.note(now, now, Duration::ZERO);
            let later = clock.figures(now + Duration::from_millis(2900));
            assert_eq!(later.per_second.is_some(), i > 0, "{i}");
            assert!(later.per_second.is_none_or(|rate| (rate - 1.0 / 3.0).abs() < 1e-9), "{later:?}");
        }
    }

    #[test]
    fn a_rate_is_not_claimed_before_the_second_result_nor_after_the_last() {
        let start = Instant::now();
        let mut clock = StageClock::default();
        assert_eq!(clock.figures(start), StageStatistics::default());
        clock.note(start, start, Duration::ZERO);
        assert_eq!(clock.figures(start).per_second, None);
        clock.note(start + Duration::from_millis(100), start, Duration::ZERO);
        assert!(clock.figures(start + Duration::from_millis(100)).per_second.is_some());
        let later = clock.figures(start + Duration::from_secs(60));
        assert_eq!(later.per_second, None);
        assert_eq!(later.newest_at, Some(start + Duration::from_millis(100)));
    }
}
