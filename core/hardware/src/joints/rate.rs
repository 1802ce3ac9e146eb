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
}

impl Rate {
    pub fn count(&mut self, now: Instant) {
        self.first.get_or_insert(now);
        self.times.push_back(now);
        while self.times.front().is_some_and(|at| now.duration_since(*at) > WINDOW) {
            self.times.pop_front();
        }
    }

    /// Per second over the last second; `None` before a second has passed.
    pub fn per_s(&self, now: Instant) -> Option<f64> {
        self.first.filter(|first| now.duration_since(*first) >= WINDOW)?;
        Some(self.times.iter().filter(|at| now.duration_since(**at) <= WINDOW).count() as f64)
    }
}
