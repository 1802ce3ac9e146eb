//! Readers with every defect that is looked for, so that a test can tell whether it would be found.

use std::path::Path;
use std::time::Duration;

use super::{Reader, one};
use crate::check::Heard;

const FILES: &[&str] = &["arm/pixels.csv"];

/// One for each defect; not among those that are run usually.
pub fn readers() -> Vec<Reader> {
    vec![
        one("broken-panic", FILES, 1, |_| panic!("on purpose")),
        one("broken-thread", FILES, 1, |_| {
            let thread = std::thread::Builder::new().name("broken".to_owned());
            let thread = thread.spawn(|| panic!("in a thread, on purpose"));
            Heard::accepted(thread.map(|thread| thread.join().is_err()).is_ok())
        }),
        one("broken-abort", FILES, 1, |folder| Heard::accepted(deep(folder, 1))),
        one("broken-hang", FILES, 1, |_| {
            std::thread::sleep(Duration::from_secs(1000));
            Heard::accepted(())
        }),
        one("broken-memory", FILES, 1, |_| {
            Heard::accepted(std::hint::black_box(vec![1_u8; 3_000_000_000]).len())
        }),
        one("broken-fault", FILES, 1, |_| Heard::accepted(f64::NAN)),
    ]
}

/// Overflows the stack.
fn deep(folder: &Path, depth: u64) -> u64 {
    let kept = [depth; 64];
    if folder.exists() { deep(folder, depth + 1) + std::hint::black_box(kept)[3] } else { depth }
}
