//! An experiment on disk: a folder with what it is (`experiment.json`), each attempt in a file of its own,
//! and what came of them. An attempt is on disk before the next begins, so that an experiment goes on where
//! it was interrupted, and parts of it that were made elsewhere can be put together.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};

use plumbline_model::files::{self, Size};
use plumbline_model::robot::Rig;
use plumbline_report::experiment::{experiment_html, experiment_pdf};
use serde::Serialize;

use super::error::TrialsError;
use super::judged::Attempt;
use super::plan::{Experiment, FORMAT, Trial};
use super::summary::{Summary, csv, summary};

/// What the experiment is.
const PLAN: &str = "experiment.json";
/// Folder of the attempts.
const ATTEMPTS: &str = "attempts";
/// Ending of the joint tracks of an attempt, which are called as it is.
const TRACKS: &str = "tracks.csv";
/// What came of it.
const SUMMARY: &str = "summary.json";

/// Makes the folder of an experiment, or sees that it is that of the same.
///
/// # Errors
/// When it cannot be made, or holds another experiment.
pub fn begin(out: &Path, experiment: &Experiment) -> Result<(), TrialsError> {
    files::make_folder(&out.join(ATTEMPTS))?;
    let plan = out.join(PLAN);
    if plan.exists() {
        let found = read_experiment(out)?;
        return if found.is_same(experiment) { Ok(()) } else { Err(TrialsError::other(out)) };
    }
    write_json(&plan, experiment)
}

/// What an experiment is.
///
/// # Errors
/// When the folder holds none that this program knows.
pub fn read_experiment(folder: &Path) -> Result<Experiment, TrialsError> {
    let file = folder.join(PLAN);
    let text = files::read_text(&file, Size::TEXT)?;
    let experiment: Experiment =
        serde_json::from_str(&text).map_err(|error| TrialsError::Unreadable { file: file.clone(), error })?;
    if experiment.format != FORMAT {
        return Err(TrialsError::Newer { file, format: experiment.format });
    }
    match experiment.is_wrong() {
        Some(why) => Err(TrialsError::Implausible { file, why }),
        None => Ok(experiment),
    }
}

/// Whether an attempt was made.
pub fn is_made(out: &Path, trial: &Trial) -> bool {
    file_of(out, trial).exists()
}

/// Keeps an attempt.
///
/// # Errors
/// When it cannot be written.
pub fn keep(out: &Path, attempt: &Attempt) -> Result<(), TrialsError> {
    write_json(&file_of(out, &attempt.trial), attempt)
}

/// Where the joint tracks of an attempt are, beside it. They are there before the attempt counts as made.
pub fn tracks_of(out: &Path, trial: &Trial) -> PathBuf {
    file_of(out, trial).with_extension(TRACKS)
}

/// All attempts so far of an experiment, in their order.
///
/// # Errors
/// When one cannot be read, or is of another experiment.
pub fn attempts(out: &Path, experiment: &Experiment) -> Result<Vec<Attempt>, TrialsError> {
    let mut attempts: Vec<Attempt> = vec![];
    let known: HashSet<Trial> = experiment.trials().collect();
    for (file, text) in attempt_files(out)? {
        let file = out.join(ATTEMPTS).join(file);
        let attempt: Attempt = match serde_json::from_str(&text) {
            Ok(attempt) => attempt,
            Err(error) => return Err(TrialsError::Unreadable { file, error }),
        };
        let (trial, is_known) = (attempt.trial, known.contains(&attempt.trial));
        if !is_known || attempts.iter().any(|other| other.trial == trial) {
            let why = format!("attempt {} at position {}, counted from 0", trial.number, trial.position);
            return Err(TrialsError::Implausible { file, why });
        }
        attempts.push(attempt);
    }
    attempts.sort_by_key(|attempt| attempt.trial.number);
    Ok(attempts)
}

/// Adds up what was attempted so far, and writes summary, table and page beside it.
///
/// # Errors
/// When a file cannot be read or written.
pub fn conclude(out: &Path, experiment: &Experiment, rig: &Rig) -> Result<Summary, TrialsError> {
    let attempts = attempts(out, experiment)?;
    let summary = summary(experiment, &attempts);
    write_json(&out.join(SUMMARY), &summary)?;
    files::write(&out.join("attempts.csv"), csv(experiment, &attempts))?;
    let page = super::page::page(experiment, &summary, rig);
    files::write(&out.join("report.html"), experiment_html(&page))?;
    files::write(&out.join("report.pdf"), experiment_pdf(&page)?)?;
    Ok(summary)
}

/// Puts parts of one experiment together; what it is.
///
/// # Errors
/// When they are not of one experiment, or disagree about an attempt.
pub fn merge(parts: &[PathBuf], out: &Path) -> Result<Experiment, TrialsError> {
    let mut experiment: Option<Experiment> = None;
    for part in parts {
        let found = read_experiment(part)?;
        match &experiment {
            None => {
                begin(out, &found)?;
                experiment = Some(found);
            }
            Some(first) if !first.is_same(&found) => return Err(TrialsError::other(part)),
            Some(_) => {}
        }
        for (file, text) in attempt_files(part)? {
            // Attempts of earlier versions have none.
            let tracks = Path::new(&file).with_extension(TRACKS);
            let from = part.join(ATTEMPTS).join(&tracks);
            if files::present(&from)? {
                let name = tracks.to_string_lossy();
                put_together(part, out, &name, &files::read_text(&from, Size::TEXT)?)?;
            }
            put_together(part, out, &file, &text)?;
        }
    }
    experiment.ok_or(TrialsError::NothingToMerge)
}

/// Puts a file of a part beside those of the others, unless it is there already.
fn put_together(part: &Path, out: &Path, file: &str, text: &str) -> Result<(), TrialsError> {
    let target = out.join(ATTEMPTS).join(file);
    match files::read_text(&target, Size::TEXT) {
        Ok(there) if there != text => Err(TrialsError::disagree(part, file)),
        Ok(_) => Ok(()),
        Err(_) => Ok(files::write(&target, text)?),
    }
}

fn file_of(out: &Path, trial: &Trial) -> PathBuf {
    out.join(ATTEMPTS).join(format!("{:05}-{}.json", trial.number, trial.method.name()))
}

/// Names and texts of all attempts of a folder, in their order.
fn attempt_files(folder: &Path) -> Result<BTreeMap<String, String>, TrialsError> {
    let folder = folder.join(ATTEMPTS);
    let list =
        std::fs::read_dir(&folder).map_err(|error| TrialsError::Folder { folder: folder.clone(), error })?;
    let names: BTreeSet<String> = list
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".json") && !name.starts_with('.'))
        .collect();
    names
        .into_iter()
        .map(|name| {
            let text = files::read_text(&folder.join(&name), Size::TEXT)?;
            Ok((name, text))
        })
        .collect()
}

fn write_json(file: &Path, value: &impl Serialize) -> Result<(), TrialsError> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| TrialsError::Unreadable { file: file.to_owned(), error })?;
    Ok(files::write(file, format!("{text}\n"))?)
}
