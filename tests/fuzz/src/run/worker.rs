//! The process that runs cases.
//!
//! It tells on standard output, a JSON array a line: `["begin", index]` before a case, and
//! `["end", index, verdict, microseconds, change, said]` after it.

use std::io::Write as _;
use std::ops::Range;
use std::path::Path;
use std::time::Instant;

use rustix::process::{Resource, Rlimit, setrlimit};
use serde_json::json;

use super::{Verdict, find, stage};
use crate::readers::of_name;
use crate::seeds::{Problem, Seeds};

/// What a refusal says is kept up to this length.
const KEPT: usize = 700;

/// Runs cases of a reader in this process, under a limit of memory (bytes).
///
/// # Errors
/// When there is no such reader, or its files cannot be written.
pub fn work(
    name: &str,
    seeds: &Path,
    scratch: &Path,
    seed: u64,
    cases: Range<u64>,
    memory: u64,
) -> Result<(), Problem> {
    let reader = of_name(name).ok_or_else(|| format!("there is no reader {name}"))?;
    let seeds = Seeds::read(seeds)?;
    limit(memory)?;
    find::watch_panics();
    for index in cases {
        let folder = scratch.join(index.to_string());
        std::fs::create_dir_all(&folder)?;
        let staged = stage(&reader, &seeds, seed, Some(index), &folder)?;
        tell(&json!(["begin", index]))?;
        let begun = Instant::now();
        let (verdict, mut said) = find::outcome(&reader, &folder);
        let took = begun.elapsed().as_micros() as u64;
        said = said.chars().take(KEPT).collect();
        tell(&json!(["end", index, verdict.name(), took, staged.change, said]))?;
        std::fs::remove_dir_all(&folder)?;
    }
    Ok(())
}

/// Runs a reader on the files of a folder as they are.
///
/// # Errors
/// When there is no such reader.
pub fn once(name: &str, folder: &Path, memory: u64) -> Result<(Verdict, String), Problem> {
    let reader = of_name(name).ok_or_else(|| format!("there is no reader {name}"))?;
    limit(memory)?;
    find::watch_panics();
    Ok(find::outcome(&reader, folder))
}

fn limit(memory: u64) -> Result<(), Problem> {
    setrlimit(Resource::Data, Rlimit { current: Some(memory), maximum: Some(memory) })?;
    // What was in memory when it ended is of no use and large.
    setrlimit(Resource::Core, Rlimit { current: Some(0), maximum: Some(0) })?;
    Ok(())
}

fn tell(value: &serde_json::Value) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{value}")?;
    out.flush()
}
