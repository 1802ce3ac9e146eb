//! The files of a run: written so that a crash leaves the old file or the new one, read again after
//! a restart.
//!
//! `progress.json` holds everything that happened and is written first; `touches.csv` (what counts)
//! and `rejected.csv` (what does not) follow from it and are written anew before a run goes on.

use std::path::{Path, PathBuf};

use jiff::Timestamp;
use plumbline_model::files::{self, Size};
use plumbline_model::session::{Chain, ExtraColumn, Manifest, TouchRow, TouchTable, Touchscreen, names};
use plumbline_model::touch_plan::{Finger, Purpose};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::plan::{self, RunPlan};
use super::record::{self, Progress, Standing, TouchRecord};
use super::refusal::RunError;
use super::view::UnfinishedRun;
use crate::ground::sessions::free_folder;
use crate::ground::shelf::InUse;

/// The plan, in a session's folder.
pub const PLAN: &str = "plan.json";
/// What happened so far.
pub const PROGRESS: &str = "progress.json";
/// Touches that do not count; the same columns as `touches.csv`.
pub const REJECTED: &str = "rejected.csv";

/// A run as it was read.
#[derive(Clone, Debug)]
pub struct Stored {
    /// The plan.
    pub plan: RunPlan,
    /// What happened.
    pub progress: Progress,
    /// The screen where it was taken to lie, without a block.
    pub screen: Touchscreen,
    /// Joints of the chain.
    pub joints: Vec<String>,
}

/// Runs in a folder of sessions.
#[derive(Clone, Debug, Default)]
pub struct Runs {
    /// Not finished, newest first.
    pub unfinished: Vec<UnfinishedRun>,
    /// The newest finished one of the right finger that was made for training.
    pub trained: Option<TrainedRun>,
}

/// A finished run of the right finger for training: M1 to M3 are learned with it, and its arm is tied to the eyes.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainedRun {
    /// Its folder.
    pub session: PathBuf,
    /// The screen where it was taken to lie.
    pub screen: Touchscreen,
    /// When a place of the screen was found from it.
    pub gave_placement: Option<Timestamp>,
}

/// Makes a session's folder with its manifest, its plan, and no progress.
pub fn begin(
    sessions: &Path,
    manifest: &Manifest,
    plan: &RunPlan,
    progress: &Progress,
) -> Result<PathBuf, RunError> {
    let kind = match plan.options.purpose {
        Purpose::Train => "touch",
        Purpose::PlaceScreen => "corners",
        Purpose::Check => "check",
    };
    let name = format!("{}_{kind}", manifest.started.strftime("%Y-%m-%dT%H-%M-%S"));
    let session = free_folder(sessions, &name).map_err(RunError::unwritable(&sessions.join(&name)))?;
    manifest.write(&session.join(names::MANIFEST))?;
    write_json(&session.join(PLAN), plan)?;
    // Last: a folder without it was never begun.
    write_json(&session.join(PROGRESS), progress)?;
    make_durable(&session)?;
    make_durable(sessions)?;
    Ok(session)
}

/// What `session.toml` says of a run.
pub fn manifest(
    rig: &str,
    screen: &Touchscreen,
    joints: &[String],
    plan: &RunPlan,
    started: Timestamp,
) -> Manifest {
    let mut extra = toml::Table::new();
    extra.insert("software".to_owned(), crate::ground::software().into());
    let purpose = match plan.options.purpose {
        Purpose::Train => "train",
        Purpose::PlaceScreen => "place-screen",
        Purpose::Check => "check",
    };
    extra.insert("purpose".to_owned(), purpose.into());
    if let Some(correction) = plan.corrected_with {
        extra.insert("corrected_with".to_owned(), correction.name().into());
    }
    Manifest {
        touchscreen: Some(screen.clone()),
        chain: Some(Chain { tip: plan.options.finger.tip().to_owned(), joints: joints.to_vec() }),
        extra,
        ..Manifest::of_rig(rig, started)
    }
}

/// Writes what happened; everything is on disk when it returns.
pub fn write(session: &Path, joints: &[String], progress: &Progress) -> Result<(), RunError> {
    write_json(&session.join(PROGRESS), progress)?;
    let of = |counts: bool| {
        progress.records.iter().filter(move |record| (record.standing == Standing::Counts) == counts)
    };
    write_table(&session.join(names::TOUCHES), joints, &of(true).collect::<Vec<_>>())?;
    write_table(&session.join(REJECTED), joints, &of(false).collect::<Vec<_>>())?;
    make_durable(session)
}

/// Keeps with a run that a place of the screen came of its touches, which does not make them outdated; its tables
/// stay as they are.
pub fn keep_placement(session: &Path, at: Timestamp) -> Result<(), RunError> {
    let mut progress: Progress = read_json(&session.join(PROGRESS)).map_err(RunError::unread)?;
    progress.gave_placement = Some(at);
    write_json(&session.join(PROGRESS), &progress)
}

/// Times that count from another connection than those before are not told: nobody knows how long the robot was on.
fn forget_times(rows: &mut [TouchRow]) {
    let times: Vec<Option<f64>> = rows.iter().map(|row| row.t_secs).collect();
    let mut newest = f64::NEG_INFINITY;
    let is_back = |time: &Option<f64>| {
        let back = time.is_some_and(|t_secs| t_secs < newest);
        newest = time.map_or(newest, |t_secs| newest.max(t_secs));
        back
    };
    if let Some(first) = times.iter().position(is_back) {
        rows[first..].iter_mut().for_each(|row| row.t_secs = None);
    }
}

fn write_table(file: &Path, joints: &[String], records: &[&TouchRecord]) -> Result<(), RunError> {
    if records.is_empty() {
        return InUse::new(file.to_owned()).forget().map_err(RunError::unwritable(file));
    }
    let mut rows: Vec<_> = records.iter().map(|record| record.row()).collect();
    forget_times(&mut rows);
    let of_joint = |i: usize| {
        let later = move |row: usize| records[row].later_encoder_rad.get(i).copied().flatten();
        let direction = move |row: usize| records[row].direction.get(i).copied().map(f64::from);
        (later, direction)
    };
    let columns: Vec<_> = (0..joints.len()).map(of_joint).collect();
    let (planned, target_u, target_v) = (
        |row: usize| Some(records[row].number as f64),
        |row: usize| Some(records[row].target.u_px),
        |row: usize| Some(records[row].target.v_px),
    );
    let mut extra: Vec<ExtraColumn<'_>> = vec![
        ("planned".to_owned(), &planned),
        ("target_u_px".to_owned(), &target_u),
        ("target_v_px".to_owned(), &target_v),
    ];
    for (joint, (later, _)) in joints.iter().zip(&columns) {
        extra.push((format!("later_{joint}_rad"), later));
    }
    for (joint, (_, direction)) in joints.iter().zip(&columns) {
        extra.push((format!("dir_{joint}"), direction));
    }
    let table = TouchTable::from_rows_with(joints.to_vec(), &rows, &extra);
    Ok(table.write(file)?)
}

/// Reads a run.
///
/// # Errors
/// A sentence: which file, what is wrong with it, and what can still be done.
pub fn read(session: &Path) -> Result<Stored, RunError> {
    let manifest = Manifest::read(&session.join(names::MANIFEST)).map_err(RunError::unread)?;
    let plan: RunPlan = read_json(&session.join(PLAN)).map_err(RunError::unread)?;
    let progress: Progress = read_json(&session.join(PROGRESS)).map_err(RunError::unread)?;
    if plan.format != plan::FORMAT || progress.format != record::FORMAT {
        return Err(RunError::OtherVersion(session.to_owned()));
    }
    let numbered = plan.touches.iter().enumerate().all(|(i, aim)| aim.touch.number == i + 1);
    let known = progress.records.iter().all(|record| plan.aim(record.number).is_some());
    if !(numbered && known) {
        return Err(RunError::Mixed(session.to_owned()));
    }
    let (Some(screen), Some(chain)) = (manifest.touchscreen, manifest.chain) else {
        return Err(RunError::NoScreen(session.to_owned()));
    };
    Ok(Stored { plan, progress, screen, joints: chain.joints })
}

/// Looks which runs there are. Folders without a run, or with one that cannot be read, are passed
/// over: opening them says why.
pub fn list(sessions: &Path) -> Runs {
    let mut runs = Runs::default();
    let Ok(folders) = std::fs::read_dir(sessions) else { return runs };
    let mut found: Vec<(PathBuf, Progress)> = folders
        .flatten()
        .map(|entry| entry.path())
        .filter_map(|session| Some((session.clone(), read_json(&session.join(PROGRESS)).ok()?)))
        .collect();
    found.sort_by_key(|(session, progress)| std::cmp::Reverse((progress.started, session.clone())));
    for (session, progress) in found {
        if !progress.finished {
            runs.unfinished.push(unfinished(&session, &progress));
        } else if runs.trained.is_none() && progress.purpose == Purpose::Train {
            runs.trained = trained(&session, &progress);
        }
    }
    runs
}

/// A run as it stands in the list of those that were not finished.
pub fn unfinished(session: &Path, progress: &Progress) -> UnfinishedRun {
    UnfinishedRun {
        session: session.to_owned(),
        started: progress.started,
        purpose: progress.purpose,
        touched: progress.counted().count(),
        planned: progress.planned,
    }
}

fn trained(session: &Path, progress: &Progress) -> Option<TrainedRun> {
    let manifest = Manifest::read(&session.join(names::MANIFEST)).ok()?;
    let is_right = manifest.chain.as_ref().is_some_and(|chain| chain.tip == Finger::Right.tip());
    (is_right && progress.counted().count() > 0).then_some(TrainedRun {
        session: session.to_owned(),
        screen: manifest.touchscreen?,
        gave_placement: progress.gave_placement,
    })
}

fn write_json(file: &Path, value: &impl Serialize) -> Result<(), RunError> {
    let text = serde_json::to_string(value)
        .map_err(|error| RunError::Unspeakable { file: file.to_owned(), error })?;
    Ok(files::write(file, text)?)
}

fn read_json<T: DeserializeOwned>(file: &Path) -> Result<T, RunError> {
    let text = files::read_text(file, Size::MODEL)?;
    serde_json::from_str(&text).map_err(|error| RunError::Damaged { file: file.to_owned(), error })
}

/// New names in a folder survive a loss of power only when the folder was written, too.
fn make_durable(folder: &Path) -> Result<(), RunError> {
    #[cfg(unix)]
    std::fs::File::open(folder).and_then(|file| file.sync_all()).map_err(RunError::unwritable(folder))?;
    #[cfg(not(unix))]
    let _ = folder;
    Ok(())
}
