//! What is refused again and again while a button is held is told once.

use std::time::{Duration, Instant};

/// The same that comes back within this time is no news.
const SAME_WITHIN: Duration = Duration::from_secs(3);

/// What was told last.
#[derive(Clone, Debug, Default)]
pub struct Said(Option<(String, Instant)>);

impl Said {
    /// Whether this is told: not if the same, whatever its numbers, was said a moment ago.
    pub fn is_news(&mut self, text: &str, now: Instant) -> bool {
        let words: String = text.chars().filter(|letter| !letter.is_ascii_digit()).collect();
        let is_news = match &self.0 {
            Some((before, at)) => *before != words || now.saturating_duration_since(*at) > SAME_WITHIN,
            None => true,
        };
        self.0 = Some((words, now));
        is_news
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_refused_while_a_button_is_held_is_told_once() {
        let (mut said, start) = (Said::default(), Instant::now());
        let at = |tenths: u64| start + Duration::from_millis(100 * tenths);
        let limit = |by: f64| format!("Right elbow would turn {by:.1}° too far.");
        assert!(said.is_news(&limit(2.4), at(0)));
        // However long it is held.
        for tenths in 1..100 {
            assert!(!said.is_news(&limit(2.5), at(tenths)));
        }
        assert!(said.is_news("Left elbow would turn 2.5° too far.", at(101)), "something else");
        assert!(said.is_news(&limit(2.4), at(102)));
        assert!(said.is_news(&limit(2.4), at(200)), "asked anew");
    }
}
