//! Where measured data of the real robot lies, for tests and benchmarks. None of it is part of
//! the project: whoever has it points to it, everybody else's tests say that they were skipped.
//!
//! What is skipped is counted: with `PLUMBLINE_LEFT_OUT=FILE` each is a line of that file, and with
//! `PLUMBLINE_REQUIRE_DATA=1` it is a failure.

use std::fmt::Display;
use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// The data are not on this machine.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "skipped: measured data \"{name}\" are not at hand (looked in {looked_in}); set PLUMBLINE_DATA to their folder"
)]
pub struct NotAtHand {
    /// What was asked for.
    pub name: String,
    /// Folder that was searched.
    pub looked_in: String,
}

/// Folder `name` (for example `nico-chessboard`) of the measured data: in the folder named by the
/// environment variable `PLUMBLINE_DATA`, else in `shared/data` beside the checkout.
pub fn folder(name: &str) -> Result<PathBuf, NotAtHand> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let root = std::env::var_os("PLUMBLINE_DATA").map_or_else(beside, PathBuf::from);
    let folder = root.join(name);
    if folder.is_dir() {
        return Ok(folder);
    }
    let why = NotAtHand { name: name.to_owned(), looked_in: root.display().to_string() };
    count(&why);
    Err(why)
}

/// Says that a test is left out because this machine lacks what it needs: a device, a library.
///
/// # Panics
/// Where nothing may be left out (`PLUMBLINE_REQUIRE_DATA=1`).
#[allow(clippy::print_stderr, reason = "a skipped test says why")]
pub fn left_out(why: impl Display) {
    eprintln!("skipped: {why}");
    count(&why);
}

/// Adds a line with the test's name (that of its thread) and the reason.
fn count(why: &dyn Display) {
    let required = std::env::var_os("PLUMBLINE_REQUIRE_DATA").is_some_and(|value| value == "1");
    assert!(!required, "PLUMBLINE_REQUIRE_DATA=1, and {why}");
    let Some(file) = std::env::var_os("PLUMBLINE_LEFT_OUT") else { return };
    let thread = std::thread::current();
    let line = format!("{}\t{why}\n", thread.name().unwrap_or("a benchmark"));
    let opened = OpenOptions::new().create(true).append(true).open(&file);
    if let Err(error) = opened.and_then(|mut file| file.write_all(line.as_bytes())) {
        log_lost(&file, &error);
    }
}

#[allow(clippy::print_stderr, reason = "who counts must know that a line is missing")]
fn log_lost(file: &std::ffi::OsStr, error: &std::io::Error) {
    eprintln!("{}: what was skipped is not counted ({error})", Path::new(file).display());
}
