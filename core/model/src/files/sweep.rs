//! Names of files that are just being written, and what a killed process left of them.

use std::collections::HashSet;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

const MARK: &str = ".part-";
/// Longest end of the target's name that the temporary one repeats; a name has 255 bytes at most.
const LONGEST_END: usize = 100;
/// A writer on another machine, whose processes cannot be seen from here, is done by then.
const STALE: Duration = Duration::from_secs(600);

/// A name beside the target that nobody else uses: `.<process>-<time>-<count>.part-<name>`. Its
/// extension is the target's, by which libraries choose what they write.
pub(super) fn temporary(target: &Path) -> PathBuf {
    // Two writers, of this process or another, must not share a temporary file; nor may it be one
    // that was left by a killed process whose number came again.
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_micros());
    let name = target.file_name().map(OsStr::to_string_lossy).unwrap_or_default();
    let start = (0..=name.len()).find(|&at| name.is_char_boundary(at) && name.len() - at <= LONGEST_END);
    let end = &name[start.unwrap_or(name.len())..];
    target.with_file_name(format!(".{}-{now:x}-{count}{MARK}{end}", std::process::id()))
}

/// Removes what killed processes left in the folder; looks at every folder once in the life of
/// this process, for a folder may hold thousands of images.
pub(super) fn once(folder: &Path) {
    static SEEN: Mutex<Option<HashSet<PathBuf>>> = Mutex::new(None);
    let new = match SEEN.lock() {
        Ok(mut seen) => seen.get_or_insert_default().insert(folder.to_path_buf()),
        Err(_) => false,
    };
    if new {
        sweep(folder, SystemTime::now());
    }
}

/// Removes temporary files of processes that are gone. What cannot be removed stays: its name
/// begins with a dot, and nobody reads it.
pub(super) fn sweep(folder: &Path, now: SystemTime) {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(listing) = fs::read_dir(folder) else { return };
    for entry in listing.flatten() {
        let Some(process) = entry.file_name().to_str().and_then(writer) else { continue };
        let Ok(about) = entry.metadata() else { continue };
        let age = about.modified().ok().and_then(|written| now.duration_since(written).ok());
        if about.is_file() && age.is_some_and(|age| age > STALE) && !is_running(process) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// The process that a temporary name tells; `None` for names of any other form.
fn writer(name: &str) -> Option<u32> {
    let (head, _) = name.strip_prefix('.')?.split_once(MARK)?;
    let mut parts = head.split('-');
    let process = parts.next()?.parse().ok()?;
    let rest: Vec<&str> = parts.collect();
    // Older versions of the program wrote no time.
    let numbers = rest.iter().all(|part| !part.is_empty() && part.bytes().all(|b| b.is_ascii_hexdigit()));
    (numbers && matches!(rest.len(), 1 | 2)).then_some(process)
}

fn is_running(process: u32) -> bool {
    if cfg!(target_os = "linux") {
        Path::new("/proc").join(process.to_string()).exists()
    } else {
        process == std::process::id()
    }
}
