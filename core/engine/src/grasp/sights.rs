//! Pairs on their way from the source to an attempt.

use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use plumbline_model::StereoFrame;

/// The newest pair, for one that waits for it. Clones share it.
#[derive(Clone, Debug, Default)]
pub struct Sights(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    newest: Mutex<Option<StereoFrame>>,
    changed: Condvar,
}

impl Sights {
    /// A pair has come.
    pub fn put(&self, frame: &StereoFrame) {
        let before = self.0.newest.lock().unwrap_or_else(PoisonError::into_inner).replace(frame.clone());
        self.0.changed.notify_all();
        // Outside of the lock: images may hang on it.
        drop(before);
    }

    /// A pair that was captured after `since`, if one comes within `patience`.
    pub fn after(&self, since: Instant, patience: Duration) -> Option<StereoFrame> {
        let is_newer = |newest: &Option<StereoFrame>| {
            newest.as_ref().is_some_and(|frame| frame.stamp.captured_at > since)
        };
        let newest = self.0.newest.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.0.changed.wait_timeout_while(newest, patience, |newest| !is_newer(newest));
        let (newest, _) = waited.unwrap_or_else(PoisonError::into_inner);
        newest.clone().filter(|_| is_newer(&newest))
    }
}

#[cfg(test)]
mod tests {
    use plumbline_model::Stamp;

    use super::*;

    fn frame(captured_at: Instant) -> StereoFrame {
        let image = Arc::new(image::RgbImage::new(2, 2));
        StereoFrame {
            stamp: Stamp { seq: 1, captured_at },
            left: image.clone(),
            right: image,
            time_difference_s: None,
            name: None,
            beside: Default::default(),
        }
    }

    #[test]
    fn an_older_pair_is_not_taken_for_a_newer_one() {
        let (sights, now) = (Sights::default(), Instant::now());
        sights.put(&frame(now));
        assert!(sights.after(now, Duration::from_millis(5)).is_none());
        let later = now + Duration::from_millis(1);
        sights.put(&frame(later));
        assert_eq!(sights.after(now, Duration::ZERO).map(|frame| frame.stamp.captured_at), Some(later));
    }
}
