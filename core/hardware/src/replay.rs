//! When the next pair of a recording is due.

use std::time::{Duration, Instant};

use plumbline_model::duration;
use serde::{Deserialize, Serialize};

use crate::error::SourceError;

/// Longest time between two pairs.
const LONGEST: Duration = Duration::from_secs(100);

/// How fast a recording is replayed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ReplayRate {
    /// At the distance at which it was recorded; where a recording does not know (a folder),
    /// at 30 pairs per second.
    #[default]
    AsRecorded,
    /// This many pairs per second.
    PairsPerSecond(f64),
    /// As fast as it is asked: for jobs and tests.
    AsAsked,
}

/// How a recording is replayed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Replay {
    /// How fast.
    pub rate: ReplayRate,
    /// Starts again at the end.
    pub looping: bool,
}

impl Default for Replay {
    /// As a live pair of eyes would: at its own rate, without end.
    fn default() -> Self {
        Self { rate: ReplayRate::AsRecorded, looping: true }
    }
}

impl Replay {
    /// Every pair once, as fast as asked.
    pub const ONCE: Self = Self { rate: ReplayRate::AsAsked, looping: false };

    /// Pairs per second of a recording that does not know its own.
    pub(crate) const USUAL_RATE_HZ: f64 = 30.0;

    /// Without end, at this many pairs per second.
    pub fn looping_at(rate_hz: f64) -> Self {
        Self { rate: ReplayRate::PairsPerSecond(rate_hz), looping: true }
    }

    /// Refuses a rate that is no rate.
    pub(crate) fn check(self) -> Result<Self, SourceError> {
        match self.rate {
            ReplayRate::PairsPerSecond(rate_hz) if !(0.01..=1000.0).contains(&rate_hz) => {
                Err(SourceError::ReplayRate { rate_hz })
            }
            _ => Ok(self),
        }
    }

    /// Pairs per second; `None` for as fast as asked.
    pub(crate) fn rate_hz(self, recorded_hz: f64) -> Option<f64> {
        match self.rate {
            ReplayRate::AsRecorded => Some(recorded_hz),
            ReplayRate::PairsPerSecond(rate_hz) => Some(rate_hz),
            ReplayRate::AsAsked => None,
        }
    }

    /// Time between two pairs.
    pub(crate) fn period(self, recorded_hz: f64) -> Duration {
        let usual = || duration::period(Self::USUAL_RATE_HZ).unwrap_or_default();
        // A recording may claim any rate of itself.
        let between =
            |rate_hz| duration::period(rate_hz).filter(|time| *time <= LONGEST).unwrap_or_else(usual);
        self.rate_hz(recorded_hz).map_or(Duration::ZERO, between)
    }
}

/// Keeps the pace. A caller that asks late gets its pair at once and the following ones
/// at their distance; nothing is made up for in a burst.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    due: Instant,
}

impl Pace {
    /// The first pair is due at once.
    pub(crate) fn start() -> Self {
        Self { due: Instant::now() }
    }

    /// Whether a pair is due.
    pub(crate) fn is_due(&self) -> bool {
        Instant::now() >= self.due
    }

    /// Time until the next pair is due.
    pub(crate) fn wait(&self) -> Duration {
        self.due.saturating_duration_since(Instant::now())
    }

    /// A pair was delivered; the next is due `period` after this one was.
    pub(crate) fn advance(&mut self, period: Duration) {
        let now = Instant::now();
        self.due = if now.saturating_duration_since(self.due) > period { now } else { self.due } + period;
    }

    /// Makes the next pair due now.
    pub(crate) fn restart(&mut self) {
        self.due = Instant::now();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rate_that_is_no_rate_is_refused() {
        for rate_hz in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
            assert!(Replay::looping_at(rate_hz).check().is_err(), "{rate_hz} passed");
        }
        assert!(Replay::default().check().is_ok());
        assert!(Replay::ONCE.check().is_ok());
    }

    #[test]
    fn a_recording_that_claims_a_rate_that_is_none_is_played_at_the_usual_one() {
        for recorded_hz in [0.0, -1.0, f64::NAN, 1e-30, f64::NEG_INFINITY] {
            let period = Replay::default().period(recorded_hz);
            assert!((period.as_secs_f64() - 1.0 / 30.0).abs() < 1e-6, "{recorded_hz}: {period:?}");
        }
        assert_eq!(Replay::default().period(4.0), Duration::from_millis(250));
        assert_eq!(Replay::ONCE.period(f64::NAN), Duration::ZERO);
    }

    #[test]
    fn a_late_caller_is_not_flooded() {
        let mut pace = Pace { due: Instant::now() - Duration::from_secs(10) };
        assert!(pace.is_due());
        pace.advance(Duration::from_secs(1));
        assert!(!pace.is_due(), "ten missed seconds must not become ten pairs at once");
        assert!(pace.wait() <= Duration::from_secs(1));
    }

    #[test]
    fn a_punctual_caller_keeps_the_rate_exactly() {
        let start = Instant::now();
        let mut pace = Pace { due: start };
        for _ in 0..3 {
            pace.advance(Duration::from_millis(500));
        }
        assert_eq!(pace.due, start + Duration::from_millis(1500));
    }
}
