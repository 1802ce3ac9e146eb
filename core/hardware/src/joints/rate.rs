//! How often something happened in the last second.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::dynamixel::WireTime;

const WINDOW: Duration = Duration::from_secs(1);

/// Counts complete cycles.
#[derive(Debug, Default)]
pub(super) struct Rate {
    times: VecDeque<Instant>,
    first: Option<Instant>,
    pub last_cycle: WireTime,
    strays: Option<(Instant, u64)>,
    strays_per_s: f64,
}

/// Bytes that belong to nothing are counted over this time.
const STRAYS: Duration = Duration::from_millis(400);

impl Rate {
    pub fn count(&mut self, now: Instant) {
        self.first.get_or_insert(now);
        self.times.push_back(now);
        while self.times.front().is_some_and(|at| now.duration_since(*at) > WINDOW) {
            self.times.pop_front();
        }
    }

    /// Takes the number of bytes so far that belonged to nothing.
    pub fn count_strays(&mut self, now: Instant, bytes: u64) {
        let (since, before) = *self.strays.get_or_insert((now, bytes));
        let passed = now.duration_since(since);
        if passed >= STRAYS {
            self.strays_per_s = bytes.saturating_sub(before) as f64 / passed.as_secs_f64();
            self.strays = Some((now, bytes));
        }
    }

    /// Bytes per second that belong to nothing.
    pub fn strays_per_s(&self) -> f64 {
        self.strays_per_s
    }

    /// Per second over the last second; `None` before a second has passed.
    pub fn per_s(&self, now: Instant) -> Option<f64> {
        self.first.filter(|first| now.duration_since(*first) >= WINDOW)?;
        Some(self.times.iter().filter(|at| now.duration_since(**at) <= WINDOW).count() as f64)
    }
}
