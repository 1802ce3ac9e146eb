//! How a verb ends: one JSON object or a few lines on standard output, everything else on
//! standard error, and the exit status.

use std::io::{IsTerminal as _, Write as _};
use std::process::ExitCode;
use std::sync::Mutex;

use plumbline_model::files::told;
use plumbline_model::{Cancelled, JobContext};
use serde::Serialize;

/// Where a verb says things.
pub struct Output {
    json: bool,
    progress: Mutex<Progress>,
}

#[derive(Default)]
struct Progress {
    percent: Option<i64>,
    doing: String,
}

impl Output {
    /// `json`: one object on standard output and nothing else.
    pub fn new(json: bool) -> Self {
        Self { json, progress: Mutex::default() }
    }

    /// Prints a result: the object itself, or what people want to know of it.
    pub fn result<R: Serialize>(&self, report: &R, people: impl FnOnce(&R) -> String) -> anyhow::Result<()> {
        let text = if self.json { serde_json::to_string_pretty(report)? } else { people(report) };
        let mut out = std::io::stdout().lock();
        match writeln!(out, "{}", text.trim_end()) {
            // Whoever read the result has what they wanted (`| head`).
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
            result => Ok(result?),
        }
    }

    /// The exit status, after saying what went wrong.
    pub fn finish(&self, result: anyhow::Result<()>) -> ExitCode {
        match result {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                if self.json {
                    let object = serde_json::json!({ "error": words(&error) });
                    let _ = writeln!(std::io::stdout(), "{object}");
                }
                failed(&error)
            }
        }
    }
}

impl JobContext for Output {
    fn checkpoint(&self) -> Result<(), Cancelled> {
        Ok(())
    }

    /// A line that is overwritten on a terminal; elsewhere a line whenever the work changes.
    fn report(&self, fraction: f64, doing: &str) {
        let mut progress = self.progress.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let percent = (fraction * 100.0) as i64;
        let terminal = std::io::stderr().is_terminal();
        let mut err = std::io::stderr().lock();
        // Nobody is harmed when nobody reads the progress.
        if terminal && (progress.percent != Some(percent) || progress.doing != doing) {
            let _ = write!(err, "\r\x1b[K{percent:3} % {doing}");
            if percent >= 100 {
                let _ = write!(err, "\r\x1b[K");
            }
            let _ = err.flush();
        } else if !terminal && progress.percent.is_none_or(|shown| percent >= shown + 25) {
            let _ = writeln!(err, "{percent:3} % {doing}");
        } else {
            return;
        }
        *progress = Progress { percent: Some(percent), doing: doing.to_owned() };
    }
}

/// The window was closed, or could not be opened.
pub fn finish_window(result: anyhow::Result<()>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failed(&error),
    }
}

/// An error and its causes; a cause that is told already is not told again.
fn words(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if !text.contains(&cause) {
            let sep = if text.is_empty() { "" } else { ": " };
            text = format!("{text}{sep}{cause}");
        }
    }
    told(&text)
}

/// Says why the work could not be done.
fn failed(error: &anyhow::Error) -> ExitCode {
    say(&format!("plumbline: {}", words(error)));
    ExitCode::from(1)
}

/// Writes a line to standard error; a closed terminal is no reason to stop.
pub fn say(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_is_told_once() {
        let cause = std::io::Error::other("the disk is full");
        let told = anyhow::Error::new(cause).context("a.csv cannot be written (the disk is full): make room");
        assert_eq!(words(&told), "a.csv cannot be written (the disk is full): make room");
        let not_told = anyhow::Error::new(std::io::Error::other("the disk is full")).context("no file");
        assert_eq!(words(&not_told), "no file: the disk is full");
    }
}
