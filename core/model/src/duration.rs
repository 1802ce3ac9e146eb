//! Spans of time from numbers that come from outside.
//!
//! The standard library's `Duration::from_secs_f64` panics on what is negative, not a number, or too
//! large, and an `Instant` panics when too much is added to it. What passes here does neither.

use std::time::Duration;

/// Longer than anything this program waits for or shows: a year, s.
pub const LONGEST_S: f64 = 366.0 * 24.0 * 3600.0;

/// So many seconds; `None` when that is negative, not a number, or longer than [`LONGEST_S`].
pub fn seconds(seconds: f64) -> Option<Duration> {
    if !(0.0..=LONGEST_S).contains(&seconds) {
        return None;
    }
    Duration::try_from_secs_f64(seconds).ok()
}

/// Time between two of so many events per second; `None` when the rate is not positive, not a
/// number, or so small that the time is longer than [`LONGEST_S`].
pub fn period(rate_hz: f64) -> Option<Duration> {
    if rate_hz > 0.0 { seconds(1.0 / rate_hz) } else { None }
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use super::*;

    #[test]
    fn what_is_no_span_of_time_is_none_and_nothing_panics() {
        for bad in
            [-1.0, -1e-300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e30, f64::MAX, LONGEST_S * 1.01]
        {
            assert_eq!(seconds(bad), None, "{bad}");
        }
        for bad in [0.0, -0.0, -5.0, f64::NAN, f64::NEG_INFINITY, 1e-30, 1e-308, 5e-324] {
            assert_eq!(period(bad), None, "{bad}");
        }
    }

    #[test]
    fn what_is_one_can_be_added_to_any_moment() {
        for good in [0.0, -0.0, 5e-324, 1e-9, 0.5, 3600.0, LONGEST_S] {
            let span = seconds(good).expect("a span of time");
            assert!((span.as_secs_f64() - good).abs() < 1e-6, "{good}");
            assert!(Instant::now().checked_add(span).is_some());
        }
        assert_eq!(period(4.0), Some(Duration::from_millis(250)));
        assert_eq!(period(f64::INFINITY), Some(Duration::ZERO));
    }
}
