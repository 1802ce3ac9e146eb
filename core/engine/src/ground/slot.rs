//! Between two stages: a place for the newest value only. What comes faster than it is taken
//! is replaced and counted.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Makes a slot: the side that puts and the side that takes.
pub fn newest_value_slot<T>() -> (Putter<T>, Taker<T>) {
    let shared = Arc::new(Shared {
        content: Mutex::new(Content { value: None, skipped: 0, putters: 1, taker_gone: false }),
        changed: Condvar::new(),
    });
    (Putter { shared: shared.clone() }, Taker { shared })
}

struct Content<T> {
    value: Option<T>,
    skipped: u64,
    putters: usize,
    taker_gone: bool,
}

struct Shared<T> {
    content: Mutex<Content<T>>,
    changed: Condvar,
}

impl<T> Shared<T> {
    fn lock(&self) -> MutexGuard<'_, Content<T>> {
        // A value is either there or not, so a thread that died while holding the lock cannot
        // have left anything half done.
        self.content.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Puts values into a slot. When the last one is dropped, the slot is closed.
pub struct Putter<T> {
    shared: Arc<Shared<T>>,
}

/// Takes values out of a slot.
pub struct Taker<T> {
    shared: Arc<Shared<T>>,
}

impl<T> Putter<T> {
    /// Puts a value in place of one that was not taken yet. Returns `false` when nobody takes
    /// any more.
    pub fn put(&self, value: T) -> bool {
        let mut content = self.shared.lock();
        if content.taker_gone {
            return false;
        }
        // Dropped after the lock is released: freeing an image takes a while.
        let replaced = content.value.replace(value);
        content.skipped += u64::from(replaced.is_some());
        drop(content);
        self.shared.changed.notify_one();
        true
    }

    /// How many values were replaced before they were taken.
    pub fn skipped(&self) -> u64 {
        self.shared.lock().skipped
    }
}

impl<T> Taker<T> {
    /// Waits for the next value; `None` once the slot is closed and empty.
    pub fn take(&self) -> Option<T> {
        let mut content = self.shared.lock();
        loop {
            if let Some(value) = content.value.take() {
                return Some(value);
            }
            if content.putters == 0 {
                return None;
            }
            content = self.shared.changed.wait(content).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// The value, if there is one just now.
    pub fn try_take(&self) -> Option<T> {
        self.shared.lock().value.take()
    }
}

impl<T> Clone for Putter<T> {
    fn clone(&self) -> Self {
        self.shared.lock().putters += 1;
        Self { shared: self.shared.clone() }
    }
}

impl<T> Drop for Putter<T> {
    fn drop(&mut self) {
        self.shared.lock().putters -= 1;
        self.shared.changed.notify_one();
    }
}

impl<T> Drop for Taker<T> {
    fn drop(&mut self) {
        let mut content = self.shared.lock();
        content.taker_gone = true;
        let left_over = content.value.take();
        drop(content);
        drop(left_over);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_newest_value_is_kept_and_the_others_are_counted() {
        let (putter, taker) = newest_value_slot();
        for value in 1..=5 {
            assert!(putter.put(value));
        }
        assert_eq!(taker.try_take(), Some(5));
        assert_eq!(taker.try_take(), None);
        assert_eq!(putter.skipped(), 4);
        putter.put(6);
        assert_eq!(taker.take(), Some(6));
        assert_eq!(putter.skipped(), 4, "a value that was taken was not skipped");
    }

    #[test]
    fn a_closed_slot_gives_its_last_value_and_then_ends() {
        let (putter, taker) = newest_value_slot();
        let second = putter.clone();
        drop(putter);
        second.put(1);
        drop(second);
        assert_eq!(taker.take(), Some(1));
        assert_eq!(taker.take(), None);
    }

    #[test]
    fn a_waiting_taker_is_woken_by_a_value_and_by_the_end() {
        let (putter, taker) = newest_value_slot();
        let waiting = std::thread::Builder::new()
            .name("slot test".into())
            .spawn(move || (taker.take(), taker.take()))
            .expect("thread");
        putter.put("value");
        while putter.shared.lock().value.is_some() {
            std::thread::yield_now();
        }
        drop(putter);
        assert_eq!(waiting.join().expect("no panic"), (Some("value"), None));
    }

    #[test]
    fn putting_without_a_taker_says_so() {
        let (putter, taker) = newest_value_slot();
        drop(taker);
        assert!(!putter.put(1));
    }
}
