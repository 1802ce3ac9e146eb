//! Runs a reader on a folder and says what came of it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Mutex;

use super::Verdict;
use crate::check::{Heard, fault};
use crate::readers::Reader;

/// What panics said since the last case, also those that somebody caught.
static PANICS: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Writes down panics instead of printing them.
pub fn watch_panics() {
    std::panic::set_hook(Box::new(|about| {
        let said = about.payload_as_str().unwrap_or("without words");
        let place = about.location().map(ToString::to_string).unwrap_or_default();
        let mut panics = PANICS.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        panics.push(format!("{said} at {place}"));
    }));
}

/// Runs a reader.
pub fn outcome(reader: &Reader, folder: &Path) -> (Verdict, String) {
    let result = catch_unwind(AssertUnwindSafe(|| (reader.read)(folder)));
    let panics = std::mem::take(&mut *PANICS.lock().unwrap_or_else(std::sync::PoisonError::into_inner));
    if let Some(first) = panics.first() {
        return (Verdict::Panic, first.clone());
    }
    match result {
        Err(_) => (Verdict::Panic, "without words".to_owned()),
        Ok(heard) => judged(reader, &heard),
    }
}

fn judged(reader: &Reader, heard: &Heard) -> (Verdict, String) {
    match fault(heard, reader.finite) {
        Some(fault) => (Verdict::Fault, fault),
        None if heard.accepted => (Verdict::Accepted, String::new()),
        None => (Verdict::Refused, heard.messages.first().cloned().unwrap_or_default()),
    }
}
