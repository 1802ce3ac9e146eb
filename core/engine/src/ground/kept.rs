//! For tests: a part of a test as a process of its own, which is killed, or whose disk is full.
//!
//! The process is this test binary with the one test; there [`writing`] gives the folder to write to.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, SystemTime};

const FOLDER: &str = "PLUMBLINE_TEST_WRITES_TO";
/// A writer that is not killed ends by itself.
const LONGEST: Duration = Duration::from_secs(60);

/// In the process that writes: the folder to write to.
pub fn writing() -> Option<PathBuf> {
    std::env::var_os(FOLDER).map(PathBuf::from)
}

/// Numbers that a writer counts through until it is killed.
pub fn until_killed() -> impl Iterator<Item = usize> {
    let began = std::time::Instant::now();
    (0..).take_while(move |_| began.elapsed() < LONGEST)
}

/// Runs the writer of a test and kills it when it has written for a while: `nth` gives another moment
/// each time.
pub fn kill(test: &str, folder: &Path, nth: u64) {
    let before = state(folder);
    let mut child = start(&mut Command::new(program()), test, folder);
    // Not before it has written something.
    while state(folder) == before && child.try_wait().expect("a child").is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    // Writing once takes about a millisecond, so that these fall on all its parts.
    std::thread::sleep(Duration::from_micros(1_000 + 4_937 * nth % 17_000));
    assert!(child.try_wait().expect("a child").is_none(), "the writer of {test} ended by itself");
    child.kill().expect("killed");
    child.wait().expect("gone");
}

/// Runs the writer of a test where no file can grow beyond so many bytes (as on a full disk, a write
/// fails in the middle); its test passes if the writer said so.
pub fn run_on_full_disk(test: &str, folder: &Path, bytes: u64) -> ExitStatus {
    // Blocks of 1024 bytes; without the trap the signal would end the process.
    let script = format!("trap '' XFSZ; ulimit -f {}; exec \"$0\" \"$@\"", bytes / 1024);
    let mut shell = Command::new("bash");
    shell.args(["-c", &script]).arg(program());
    start(&mut shell, test, folder).wait().expect("ended")
}

fn program() -> PathBuf {
    std::env::current_exe().expect("a test has a file")
}

fn start(command: &mut Command, test: &str, folder: &Path) -> Child {
    command.args([test, "--exact", "--nocapture"]).env(FOLDER, folder);
    command.stdin(Stdio::null()).stdout(Stdio::null()).spawn().expect("started")
}

/// What lies in a folder, but what is hidden: sizes and times of its files.
fn state(folder: &Path) -> BTreeMap<PathBuf, (u64, Option<SystemTime>)> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            found.extend(state(&path));
        } else if let Ok(about) = entry.metadata()
            && !plumbline_model::files::is_hidden(&path)
        {
            found.insert(path, (about.len(), about.modified().ok()));
        }
    }
    found
}
