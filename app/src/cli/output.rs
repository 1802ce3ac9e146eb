//! How a verb ends: one JSON object or a few lines on standard output, everything else on
//! standard error, and the exit status.

use std::io::Write as _;
use std::process::ExitCode;

/// The window was closed, or could not be opened.
pub fn finish_window(result: anyhow::Result<()>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failed(&error),
    }
}

/// Says why the work could not be done.
pub fn failed(error: &anyhow::Error) -> ExitCode {
    say(&format!("plumbline: {error:#}"));
    ExitCode::from(1)
}

/// Writes a line to standard error; a closed terminal is no reason to stop.
pub fn say(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}
