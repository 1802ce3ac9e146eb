//! Whoever watches the processes that run cases.

use std::io::{BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::{Duration, Instant};

use serde_json::Value;

use super::{Finding, Options, Summary, Verdict, shares, stage, worker};
use crate::readers::{Reader, all, broken, of_name};
use crate::seeds::{self, Problem, Seeds};

/// Cases of one process, so that what one leaves behind does not add up.
const CASES_OF_PROCESS: u64 = 400;
/// Findings that are kept of a reader.
const KEPT: usize = 100;
/// What a process needs to start, beside the time for a case.
const START: Duration = Duration::from_secs(30);

/// Cases for one process.
struct Piece {
    reader: &'static str,
    from: u64,
    to: u64,
}

struct Shared {
    pieces: Mutex<Vec<Piece>>,
    summary: Mutex<Summary>,
    seeds: PathBuf,
    scratch: PathBuf,
    cases: u64,
    begun: Instant,
}

/// Runs cases over all readers.
///
/// # Errors
/// When the seeds cannot be made or no process be started; not for findings.
#[allow(clippy::print_stderr, reason = "how far it is")]
pub fn run(options: &Options) -> Result<Summary, Problem> {
    let begun = Instant::now();
    let folder = tempfile::tempdir()?;
    let seeds = folder.path().join("seeds");
    // Readers whose seeds can be made run all the same.
    let mut not_run: Vec<String> =
        seeds::make(&seeds).err().map(|problem| problem.to_string()).into_iter().collect();
    let made = Seeds::read(&seeds)?;
    if options.tell {
        eprintln!("seeds made in {:.1} s", begun.elapsed().as_secs_f64());
    }
    // Broken ones only when they are asked for.
    let of = if options.only.starts_with("broken") { broken() } else { all() };
    let readers: Vec<_> = of.into_iter().filter(|reader| reader.name.contains(&options.only)).collect();
    let (readers, without): (Vec<_>, Vec<_>) =
        readers.into_iter().partition(|reader| has_seeds(reader, &made));
    not_run.extend(without.iter().map(|reader| format!("{} has no seeds", reader.name)));
    let mut pieces = vec![];
    let mut cases = 0;
    for (reader, share) in readers.iter().zip(shares(&readers, options.cases)) {
        cases += share;
        let mut from = 0;
        while from < share {
            let to = (from + CASES_OF_PROCESS).min(share);
            pieces.push(Piece { reader: reader.name, from, to });
            from = to;
        }
    }
    // Readers take turns, and the verbs, which are the last and slowest, come first.
    pieces.sort_by_key(|piece| piece.from);
    pieces.reverse();
    let shared = Shared {
        pieces: Mutex::new(pieces),
        summary: Mutex::new(Summary::default()),
        seeds,
        scratch: folder.path().join("work"),
        cases,
        begun,
    };
    let problems: Vec<Problem> = std::thread::scope(|scope| {
        let watchers: Vec<_> = (0..options.workers.max(1))
            .map(|slot| {
                let shared = &shared;
                scope.spawn(move || watch_all(shared, options, slot))
            })
            .collect();
        watchers.into_iter().filter_map(|watcher| watcher.join().ok()?.err()).collect()
    });
    if let Some(problem) = problems.into_iter().next() {
        return Err(problem);
    }
    let mut summary = lock(&shared.summary).clone();
    summary.not_run = not_run;
    summary.time = begun.elapsed();
    summary.findings.sort_by(|a, b| (&a.reader, a.index).cmp(&(&b.reader, b.index)));
    Ok(summary)
}

fn has_seeds(reader: &Reader, seeds: &Seeds) -> bool {
    let found = |prefix: &&str| seeds.below(&[*prefix]).next().is_some();
    reader.files.iter().all(found) && seeds.below(reader.files).any(|(path, _)| reader.changes(path))
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

fn watch_all(shared: &Shared, options: &Options, slot: usize) -> Result<(), Problem> {
    while let Some(piece) = { lock(&shared.pieces).pop() } {
        let mut from = piece.from;
        while from < piece.to {
            let scratch = shared.scratch.join(slot.to_string());
            let _ = std::fs::remove_dir_all(&scratch);
            std::fs::create_dir_all(&scratch)?;
            from = watch(shared, options, &Piece { from, ..piece }, &scratch)?;
        }
    }
    Ok(())
}

/// Watches one process until it has ended; returns the case to go on with.
fn watch(shared: &Shared, options: &Options, piece: &Piece, scratch: &Path) -> Result<u64, Problem> {
    let errors = scratch.join("errors.txt");
    let mut child = Command::new(&options.program)
        .args(["--worker", piece.reader])
        .args([&shared.seeds, &scratch.to_path_buf()])
        .args([options.seed, piece.from, piece.to, options.memory].map(|number| number.to_string()))
        .env("RUST_BACKTRACE", "0")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(std::fs::File::create(&errors)?)
        .spawn()?;
    let lines = lines_of(&mut child)?;
    let mut next = piece.from;
    let mut running: Option<u64> = None;
    let verdict = loop {
        let patience = if running.is_some() { options.patience } else { options.patience + START };
        match lines.recv_timeout(patience) {
            Ok(line) => match serde_json::from_str::<Vec<Value>>(&line).unwrap_or_default().as_slice() {
                [Value::String(word), index] if word == "begin" => running = index.as_u64(),
                [Value::String(word), index, verdict, took, change, said] if word == "end" => {
                    running = None;
                    next = index.as_u64().unwrap_or(next) + 1;
                    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
                    let verdict = Verdict::of_name(&text(verdict)).unwrap_or(Verdict::Fault);
                    let took = Duration::from_micros(took.as_u64().unwrap_or_default());
                    let finding = Finding {
                        reader: piece.reader.to_owned(),
                        index: next - 1,
                        verdict,
                        change: text(change),
                        said: text(said),
                    };
                    count(shared, options, finding, took)?;
                }
                // A library that prints.
                _ => {}
            },
            Err(RecvTimeoutError::Timeout) => {
                let _ = child.kill();
                break Some(Verdict::Hang);
            }
            Err(RecvTimeoutError::Disconnected) => break None,
        }
    };
    let status = child.wait()?;
    let said = tail(&errors);
    match (verdict, running) {
        (None, None) if status.success() => return Ok(piece.to),
        (_, None) => {
            return Err(
                format!("a process for {} ended outside of a case: {status}, {said}", piece.reader).into()
            );
        }
        _ => {}
    }
    let index = running.unwrap_or(next);
    let verdict = verdict.unwrap_or(if said.contains("memory allocation of") {
        Verdict::Memory
    } else {
        Verdict::Abort
    });
    let reader = of_name(piece.reader).ok_or("a reader")?;
    // What was done to the file died with the process: it is made again.
    let again = scratch.join("again");
    std::fs::create_dir_all(&again)?;
    let change = stage(&reader, &Seeds::read(&shared.seeds)?, options.seed, Some(index), &again)?.change;
    let said = format!("{status}: {said}");
    let finding = Finding { reader: piece.reader.to_owned(), index, verdict, change, said };
    let took = if verdict == Verdict::Hang { options.patience } else { Duration::ZERO };
    count(shared, options, finding, took)?;
    Ok(index + 1)
}

fn lines_of(child: &mut Child) -> Result<Receiver<String>, Problem> {
    let out = child.stdout.take().ok_or("a process without output")?;
    let (send, lines) = sync_channel(64);
    std::thread::Builder::new().name("worker-output".to_owned()).spawn(move || {
        for line in BufReader::new(out).lines().map_while(Result::ok) {
            if send.send(line).is_err() {
                break;
            }
        }
    })?;
    Ok(lines)
}

/// The end of what a process said on standard error.
fn tail(file: &Path) -> String {
    let mut text = vec![];
    let _ = std::fs::File::open(file).and_then(|file| file.take(100_000).read_to_end(&mut text));
    let text = String::from_utf8_lossy(&text);
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    lines[lines.len().saturating_sub(3)..].join(" | ").chars().take(500).collect()
}

#[allow(clippy::print_stderr, reason = "how far it is")]
fn count(shared: &Shared, options: &Options, finding: Finding, took: Duration) -> Result<(), Problem> {
    let mut summary = lock(&shared.summary);
    let tally = summary.tallies.entry(finding.reader.clone()).or_default();
    *tally.counts.entry(finding.verdict).or_default() += 1;
    tally.time += took;
    if took >= tally.slowest {
        (tally.slowest, tally.slowest_index) = (took, finding.index);
    }
    let known = summary.findings.iter().filter(|known| known.reader == finding.reader).count();
    let is_kept = finding.verdict.is_finding() && known < KEPT;
    let cases = summary.cases();
    if options.tell && cases.is_multiple_of(1000) {
        let (defects, seconds) = (summary.defects(), shared.begun.elapsed().as_secs_f64());
        eprintln!("{cases} of {} cases, {defects} findings, {seconds:.0} s", shared.cases);
    }
    if !is_kept {
        return Ok(());
    }
    if options.tell {
        eprintln!(
            "{} {}: {} ({}) {}",
            finding.reader,
            finding.index,
            finding.verdict.name(),
            finding.change,
            finding.said
        );
    }
    summary.findings.push(finding.clone());
    drop(summary);
    keep(shared, options, &finding)
}

/// Puts the files of a finding aside, with what is needed to run it again.
fn keep(shared: &Shared, options: &Options, finding: &Finding) -> Result<(), Problem> {
    let (Some(keep), Some(reader)) = (&options.keep, of_name(&finding.reader)) else { return Ok(()) };
    let folder = keep.join(format!("{}-{}-{}", finding.reader, options.seed, finding.index));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(folder.join("input"))?;
    stage(&reader, &Seeds::read(&shared.seeds)?, options.seed, Some(finding.index), &folder.join("input"))?;
    let about = serde_json::json!({
        "reader": finding.reader, "seed": options.seed, "index": finding.index,
        "verdict": finding.verdict.name(), "change": finding.change, "said": finding.said,
    });
    Ok(std::fs::write(folder.join("case.json"), serde_json::to_string_pretty(&about)?)?)
}

/// Runs a finding again, in this process, on a copy of its files.
///
/// # Errors
/// When the folder is none of a finding.
pub fn replay(folder: &Path, memory: u64) -> Result<(Verdict, String), Problem> {
    let about: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("case.json"))?)?;
    let name = about.get("reader").and_then(Value::as_str).ok_or("case.json names no reader")?;
    worker::once(name, &folder.join("input"), memory)
}
