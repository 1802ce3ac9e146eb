//! The whole experiment: positions × attempts × methods, each attempt a file before the next begins.
//!
//! An attempt depends on the seed and on its number alone, so that shards of an experiment can run
//! anywhere, and merged are the experiment.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_grasp::attempt::{HandFinder, RenderedHand};
use plumbline_grasp::things::Thing;
use plumbline_grasp::{Method, Order, Record};
use plumbline_model::JobContext;
use plumbline_model::files::{self, Size};
use plumbline_model::robot::Rig;
use plumbline_twin::{Scenario, Toy};
use serde::{Deserialize, Serialize};

use super::attempt::{Bench, Task};
use super::judge::Judged;
use super::lab;
use super::summary::{Summary, summary};
use super::trial_error::TrialsError;
use crate::OfflineError;
use crate::table::Table;

/// Version of the files.
pub const FORMAT: u32 = 1;
/// What the experiment is.
const PLAN: &str = "experiment.json";
/// Folder of the attempts.
const ATTEMPTS: &str = "attempts";
/// What came of it.
const SUMMARY: &str = "summary.json";
/// A person puts a thing this near to where it belongs, m per axis (standard deviation).
const PLACING_M: f64 = 0.002;

/// An experiment, or a part of it.
#[derive(Clone, Debug)]
pub struct TrialsArgs {
    /// Name of a scenario, or a file.
    pub twin: String,
    /// Folder of a commissioned lab.
    pub lab: PathBuf,
    /// Methods to compare.
    pub methods: Vec<Method>,
    /// Attempts per position and method.
    pub attempts: usize,
    /// Positions (`x_m`, `y_m`); `None`: the published ones.
    pub positions: Option<PathBuf>,
    /// Class of the object.
    pub object: String,
    /// Of all that is drawn by chance.
    pub seed: u64,
    /// Part `.0` of `.1`, from 1.
    pub shard: Option<(usize, usize)>,
    /// Where to.
    pub out: PathBuf,
}

/// What the experiment is; the same in every shard of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Experiment {
    /// Version of the format.
    pub format: u32,
    /// Name of the scenario.
    pub twin: String,
    /// Methods to compare.
    pub methods: Vec<Method>,
    /// Attempts per position and method.
    pub attempts: usize,
    /// x and y, robot frame, m.
    pub positions_m: Vec<[f64; 2]>,
    /// Class of the object.
    pub object: String,
    /// Of all that is drawn by chance.
    pub seed: u64,
}

/// One attempt of an experiment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Its number, from 0.
    pub number: usize,
    /// Place in the list of positions.
    pub position: usize,
    /// Of those at this position, from 0.
    pub attempt: usize,
    /// How.
    pub method: Method,
}

/// An attempt as it is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Attempt {
    /// Which.
    pub trial: Trial,
    /// Where the thing was put, m.
    pub placed_m: [f64; 2],
    /// What the robot keeps of it.
    pub record: Record,
    /// What really happened.
    pub judged: Judged,
}

impl Experiment {
    /// All attempts, in their order: every method at a position before the next attempt there.
    pub fn trials(&self) -> impl Iterator<Item = Trial> + '_ {
        let of_position = move |position: usize| {
            (0..self.attempts).flat_map(move |attempt| {
                self.methods.iter().enumerate().map(move |(k, method)| Trial {
                    number: (position * self.attempts + attempt) * self.methods.len() + k,
                    position,
                    attempt,
                    method: *method,
                })
            })
        };
        (0..self.positions_m.len()).flat_map(of_position)
    }

    fn task(&self, trial: &Trial, toy: Toy) -> Task {
        let number = (trial.position * self.attempts + trial.attempt) as u64;
        let mut dice = Dice(self.seed ^ number.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let [x_m, y_m] = self.positions_m[trial.position];
        let at_m = [x_m + PLACING_M * dice.normal(), y_m + PLACING_M * dice.normal()];
        let order = Order { method: trial.method, object: self.object.clone(), near_m: None };
        Task { order, toy, at_m, seed: dice.next() }
    }
}

/// Runs an experiment, or goes on where it was interrupted.
///
/// # Errors
/// When the lab is not ready, or files cannot be written; what was done before stays.
pub fn grasp_trials(args: &TrialsArgs, context: &dyn JobContext) -> Result<Summary, OfflineError> {
    let scenario = crate::commission::scenario(&args.twin)?;
    let thing = Thing::of_class(&args.object).ok_or_else(|| TrialsError::unknown(&args.object))?;
    let toy =
        Toy::from_name(&thing.class.to_lowercase()).ok_or_else(|| TrialsError::unknown(&args.object))?;
    let positions_m = match &args.positions {
        None => super::PLACES_M.to_vec(),
        Some(file) => read_positions(file)?,
    };
    let experiment = Experiment {
        format: FORMAT,
        twin: scenario.name.clone(),
        methods: args.methods.clone(),
        attempts: args.attempts,
        positions_m,
        object: thing.class.to_owned(),
        seed: args.seed,
    };
    begin(&args.out, &experiment)?;
    let mut bench = bench(&args.lab, scenario, &args.methods, context)?;
    let mine: Vec<Trial> = experiment.trials().filter(|trial| is_mine(trial, args.shard)).collect();
    for (done, trial) in mine.iter().enumerate() {
        context.checkpoint()?;
        context.report(done as f64 / mine.len().max(1) as f64, "grasping");
        let file = file_of(&args.out, trial);
        if file.exists() {
            continue;
        }
        let task = experiment.task(trial, toy);
        let (record, judged) = bench.attempt(&task)?;
        let attempt = Attempt { trial: *trial, placed_m: task.at_m, record, judged };
        write_json(&file, &attempt)?;
    }
    context.report(1.0, "grasping");
    conclude(&args.out, &experiment)
}

/// Puts shards of one experiment together.
///
/// # Errors
/// When they are not of one experiment, or disagree about an attempt.
pub fn merge_trials(shards: &[PathBuf], out: &Path) -> Result<Summary, OfflineError> {
    let mut experiment: Option<Experiment> = None;
    for shard in shards {
        let found = read_experiment(shard)?;
        match &experiment {
            None => {
                begin(out, &found)?;
                experiment = Some(found);
            }
            Some(first) if *first != found => return Err(TrialsError::other(shard).into()),
            Some(_) => {}
        }
        for (file, text) in attempt_files(shard)? {
            let target = out.join(ATTEMPTS).join(&file);
            match files::read_text(&target, Size::TEXT) {
                Ok(there) if there != text => return Err(TrialsError::disagree(shard, &file).into()),
                Ok(_) => {}
                Err(_) => files::write(&target, text).map_err(TrialsError::from)?,
            }
        }
    }
    let experiment = experiment.ok_or(TrialsError::NothingToMerge)?;
    conclude(out, &experiment)
}

/// What attempts share: the robot as the lab knows it, and what finds its hand.
pub(super) fn bench(
    lab: &Path,
    scenario: Scenario,
    methods: &[Method],
    context: &dyn JobContext,
) -> Result<Bench, OfflineError> {
    let rig = Arc::new(Rig::built_in("nico")?);
    let knowledge = lab::knowledge(lab, &rig, &scenario, methods, context)?;
    let finder =
        RenderedHand::of_rig(knowledge.model.rig(), "right_palm_center").map_err(TrialsError::from)?;
    let finder: Box<dyn HandFinder> = Box::new(finder);
    Bench::new(rig, scenario, knowledge, Some(finder))
}

fn is_mine(trial: &Trial, shard: Option<(usize, usize)>) -> bool {
    shard.is_none_or(|(part, parts)| trial.number % parts.max(1) + 1 == part)
}

fn begin(out: &Path, experiment: &Experiment) -> Result<(), TrialsError> {
    std::fs::create_dir_all(out.join(ATTEMPTS))
        .map_err(|error| TrialsError::Folder { folder: out.to_owned(), error })?;
    let plan = out.join(PLAN);
    if plan.exists() {
        let found = read_experiment(out)?;
        return if found == *experiment { Ok(()) } else { Err(TrialsError::other(out)) };
    }
    write_json(&plan, experiment)
}

fn conclude(out: &Path, experiment: &Experiment) -> Result<Summary, OfflineError> {
    let mut attempts: Vec<Attempt> = vec![];
    for (file, text) in attempt_files(out)? {
        let attempt = serde_json::from_str(&text)
            .map_err(|error| TrialsError::Unreadable { file: out.join(ATTEMPTS).join(file), error })?;
        attempts.push(attempt);
    }
    attempts.sort_by_key(|attempt| attempt.trial.number);
    let summary = summary(experiment, &attempts);
    write_json(&out.join(SUMMARY), &summary)?;
    files::write(&out.join("attempts.csv"), super::summary::csv(experiment, &attempts))
        .map_err(TrialsError::from)?;
    Ok(summary)
}

fn file_of(out: &Path, trial: &Trial) -> PathBuf {
    out.join(ATTEMPTS).join(format!("{:05}-{}.json", trial.number, trial.method.name()))
}

fn read_experiment(folder: &Path) -> Result<Experiment, TrialsError> {
    let file = folder.join(PLAN);
    let text = files::read_text(&file, Size::TEXT)?;
    serde_json::from_str(&text).map_err(|error| TrialsError::Unreadable { file, error })
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

fn read_positions(file: &Path) -> Result<Vec<[f64; 2]>, OfflineError> {
    let needs = "the header x_m,y_m and one position on the table per line, for example 0.3,-0.2";
    let table = Table::read(file, &["x_m", "y_m"], &[], needs)?;
    Ok(table.rows().iter().map(|row| [row[0], row[1]]).collect())
}

/// Numbers from a seed (SplitMix64), the same on every machine.
struct Dice(u64);

impl Dice {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Of mean 0 and standard deviation 1: twelve even numbers added up, so never beyond 6.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| (self.next() >> 11) as f64 / (1u64 << 53) as f64).sum::<f64>() - 6.0
    }
}
