//! What time it is for the workflows: they read no clock themselves, so that the same commands at the
//! same times give the same again.

use std::time::{Duration, Instant};

use jiff::Timestamp;

/// A moment, as the clock that never goes back tells it and as the time of day.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Time {
    /// On the clock that never goes back.
    pub instant: Instant,
    /// The time of day, UTC.
    pub day: Timestamp,
}

impl Time {
    /// Now.
    pub fn now() -> Self {
        Self { instant: Instant::now(), day: Timestamp::now() }
    }

    /// So much later.
    pub fn after(self, time: Duration) -> Self {
        let day = self.day.checked_add(time).unwrap_or(self.day);
        Self { instant: self.instant + time, day }
    }

    /// The time of day at an earlier instant.
    pub fn day_at(self, instant: Instant) -> Timestamp {
        let ago = self.instant.saturating_duration_since(instant);
        self.day.checked_sub(ago).unwrap_or(self.day)
    }
}

/// Tells the time: that of the system, or the one at which it is held.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clock {
    held: Option<Time>,
}

impl Clock {
    /// Stands still at this time; `None`: goes with the system's.
    pub fn hold(&mut self, time: Option<Time>) {
        self.held = time;
    }

    /// What time it is.
    pub fn time(&self) -> Time {
        self.held.unwrap_or_else(Time::now)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_that_is_held_stands_still() {
        let mut clock = Clock::default();
        let time = clock.time().after(Duration::from_secs(3600));
        clock.hold(Some(time));
        assert_eq!(clock.time(), time);
        clock.hold(None);
        assert!(clock.time().instant < time.instant);
    }

    #[test]
    fn the_time_of_day_goes_with_the_instant() {
        let time = Time::now();
        let later = time.after(Duration::from_millis(1500));
        assert_eq!(later.day_at(time.instant), time.day);
        assert_eq!(time.day_at(later.instant), time.day, "what is to come has not been");
    }
}
