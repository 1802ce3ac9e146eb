//! Work on many cases at a time.

use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};

/// As many threads as the machine runs at a time; one where it does not say.
pub fn all_threads() -> NonZeroUsize {
    std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}

/// What `work` makes of each item, in their order, whatever the number of threads. A panic in it goes on here.
///
/// # Errors
/// When not even one thread can be started.
pub fn in_order<T: Sync, R: Send>(
    items: &[T],
    threads: NonZeroUsize,
    name: &str,
    work: impl Fn(&T) -> R + Sync,
) -> std::io::Result<Vec<R>> {
    let next = AtomicUsize::new(0);
    let some = || {
        let mut own = vec![];
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(number) else { return own };
            own.push((number, work(item)));
        }
    };
    let mut done = std::thread::scope(|scope| {
        let start = |i| std::thread::Builder::new().name(format!("{name}-{i}")).spawn_scoped(scope, some);
        let mut started = vec![];
        for i in 0..threads.get().min(items.len()) {
            match start(i) {
                Ok(thread) => started.push(thread),
                // Fewer threads do the same work.
                Err(_) if !started.is_empty() => break,
                Err(error) => return Err(error),
            }
        }
        let joined = started.into_iter().map(|thread| thread.join().unwrap_or_else(|why| resume_unwind(why)));
        Ok(joined.flatten().collect::<Vec<_>>())
    })?;
    done.sort_by_key(|(number, _)| *number);
    Ok(done.into_iter().map(|(_, made)| made).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_is_that_of_the_items_whatever_the_number_of_threads() {
        let items: Vec<u64> = (0..50).collect();
        // The first ones take longest, so that they are not done in their order.
        let slow = |item: &u64| {
            std::thread::sleep(std::time::Duration::from_micros(2000 / (item + 1)));
            item * item
        };
        let wanted: Vec<u64> = items.iter().map(|item| item * item).collect();
        for threads in [1, 3, 64] {
            let threads = NonZeroUsize::new(threads).expect("not none");
            assert_eq!(in_order(&items, threads, "test", slow).expect("threads"), wanted);
        }
        assert!(in_order(&[], all_threads(), "test", slow).expect("threads").is_empty());
    }

    #[test]
    fn a_panic_is_not_lost() {
        let two = NonZeroUsize::new(2).expect("not none");
        let panics = || in_order(&[1, 2, 3], two, "test", |item| assert!(*item < 3, "three is too many"));
        assert!(std::panic::catch_unwind(panics).is_err());
    }
}
