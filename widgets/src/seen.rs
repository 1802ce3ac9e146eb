//! Which snapshot something was made from, and what was made from it.
//!
//! A snapshot is told from another by being the same allocation. An address alone does not tell:
//! when a snapshot is gone, the next one may lie where it lay. So what remembers an address keeps
//! the allocation from being given away, and what is in it, a picture's pixels say, may go.

use std::fmt;
use std::sync::{Arc, Weak};

/// A snapshot that was seen, to be told from every other one that ever was or will be.
pub struct Seen<T: ?Sized>(Option<Weak<T>>);

impl<T: ?Sized> Seen<T> {
    /// Of this snapshot.
    pub fn of(snapshot: &Arc<T>) -> Self {
        Self(Some(Arc::downgrade(snapshot)))
    }

    /// Of one that may not be there; that it is not there is remembered too.
    pub fn of_any(snapshot: Option<&Arc<T>>) -> Self {
        Self(snapshot.map(Arc::downgrade))
    }

    /// Whether there was one.
    pub fn is_some(&self) -> bool {
        self.0.is_some()
    }
}

impl<T: ?Sized> PartialEq for Seen<T> {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Some(one), Some(other)) => one.ptr_eq(other),
            (one, other) => one.is_none() && other.is_none(),
        }
    }
}

impl<T: ?Sized> Clone for Seen<T> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<T: ?Sized> Default for Seen<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<T: ?Sized> fmt::Debug for Seen<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.is_some() { "Seen" } else { "Seen nothing" })
    }
}

/// What was made from a snapshot, made again only from another one. `K` is the snapshot as it was
/// seen, with whatever else the making depends on.
#[derive(Debug)]
pub struct Memo<K, T> {
    made: Option<(K, Arc<T>)>,
}

impl<K, T> Default for Memo<K, T> {
    fn default() -> Self {
        Self { made: None }
    }
}

impl<K, T> Memo<K, T> {
    /// What was made last, if anything was.
    pub fn last(&self) -> Option<&T> {
        self.made.as_ref().map(|(_, made)| &**made)
    }
}

impl<K: PartialEq, T> Memo<K, T> {
    /// What was made from `of`; `make` is called only if that was something else.
    pub fn get(&mut self, of: K, make: impl FnOnce() -> T) -> Arc<T> {
        match &self.made {
            Some((from, made)) if *from == of => made.clone(),
            _ => self.made.insert((of, Arc::new(make()))).1.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Snapshots one after the other, each gone before the next one comes: without more ado an
    /// allocator puts the next one where the last one lay.
    fn one_after_the_other() -> impl Iterator<Item = Arc<[u8; 64]>> {
        (0..200).map(|content| Arc::new([content; 64]))
    }

    #[test]
    fn an_address_that_is_used_again_is_another_snapshot() {
        let mut memo = Memo::default();
        for snapshot in one_after_the_other() {
            let answer = memo.get(Seen::of(&snapshot), || snapshot[0]);
            assert_eq!(*answer, snapshot[0]);
        }
    }

    #[test]
    fn addresses_are_used_again() {
        let mut addresses: Vec<usize> =
            one_after_the_other().map(|snapshot| Arc::as_ptr(&snapshot) as usize).collect();
        addresses.sort_unstable();
        addresses.dedup();
        assert!(addresses.len() < 200, "the test beside this one shows nothing on this machine");
    }

    #[test]
    fn the_same_snapshot_is_used_once_and_what_is_in_it_may_go() {
        let snapshot = Arc::new("a picture".to_owned());
        let (mut memo, mut made) = (Memo::default(), 0);
        for _ in 0..3 {
            memo.get((Seen::of(&snapshot), 7), || made += 1);
        }
        memo.get((Seen::of(&snapshot), 8), || made += 1);
        assert_eq!(made, 2);
        assert_eq!(Arc::strong_count(&snapshot), 1);
    }

    #[test]
    fn that_nothing_was_there_is_remembered() {
        let snapshot = Arc::new(1);
        assert_eq!(Seen::<i32>::of_any(None), Seen::default());
        assert_ne!(Seen::of(&snapshot), Seen::default());
        assert_eq!(Seen::of(&snapshot), Seen::of_any(Some(&snapshot.clone())));
    }
}
