//! The whole experiment: positions × attempts × methods, each attempt a file before the next begins.
//!
//! An attempt depends on the seed and on its number alone, so that shards of an experiment can run
//! anywhere, and merged are the experiment.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use plumbline_engine::trials::{Attempt, Experiment, FORMAT, Summary, Trial, store};
use plumbline_grasp::attempt::{HandFinder, RenderedHand};
use plumbline_grasp::things::Thing;
use plumbline_grasp::{Hand, HandChoice, Method, Order};
use plumbline_model::JobContext;
use plumbline_model::robot::Rig;
use plumbline_twin::{Scenario, Toy};

use super::attempt::{Bench, Task};
use super::lab;
use crate::OfflineError;
use crate::commission::steps;
use crate::table::Table;

/// An experiment, or a part of it.
#[derive(Clone, Debug)]
pub struct TrialsArgs {
    /// Name of a scenario, or a file; `None`: the one that the lab was commissioned on.
    pub twin: Option<String>,
    /// Folder of a commissioned lab.
    pub lab: PathBuf,
    /// Methods to compare.
    pub methods: Vec<Method>,
    /// Attempts per position and method.
    pub attempts: usize,
    /// Positions (`x_m`, `y_m`); `None`: the published ones.
    pub positions: Option<PathBuf>,
    /// With which hand.
    pub hand: HandChoice,
    /// Class of the object.
    pub object: String,
    /// Of all that is drawn by chance.
    pub seed: u64,
    /// Part `.0` of `.1`, from 1.
    pub shard: Option<(usize, usize)>,
    /// Where to.
    pub out: PathBuf,
    /// Whether what both eyes saw is kept beside every attempt.
    pub images: bool,
}

/// Runs an experiment, or goes on where it was interrupted.
///
/// # Errors
/// When the lab is not ready, or files cannot be written; what was done before stays.
pub fn grasp_trials(args: &TrialsArgs, context: &dyn JobContext) -> Result<Summary, OfflineError> {
    let scenario = steps::twin_of(&args.lab, args.twin.as_deref())?;
    let thing = Thing::of_class(&args.object).ok_or_else(|| OfflineError::unknown_thing(&args.object))?;
    let toy = Toy::from_name(&thing.class.to_lowercase())
        .ok_or_else(|| OfflineError::unknown_thing(&args.object))?;
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
        hand: args.hand,
        object: thing.class.to_owned(),
        seed: args.seed,
        lab: Some(steps::identity(&args.lab, &scenario)?),
    };
    store::begin(&args.out, &experiment)?;
    let mut bench = bench(&args.lab, scenario, &args.methods, context)?;
    carry_out(&experiment, &mut bench, (toy, args.shard, args.images), &args.out, context)?;
    conclude(&args.out, &experiment)
}

/// Carries out what is not done yet of a part of an experiment.
pub(super) fn carry_out(
    experiment: &Experiment,
    bench: &mut Bench,
    (toy, shard, images): (Toy, Option<(usize, usize)>, bool),
    out: &Path,
    context: &dyn JobContext,
) -> Result<(), OfflineError> {
    let mine: Vec<Trial> = experiment.trials().filter(|trial| is_mine(trial, shard)).collect();
    for (done, trial) in mine.iter().enumerate() {
        context.checkpoint()?;
        context.report(done as f64 / mine.len().max(1) as f64, "grasping");
        if store::is_made(out, trial) {
            continue;
        }
        if images {
            bench.keep_in(out.join("images").join(format!("{:05}-{}", trial.number, trial.method.name())))?;
        }
        bench.track_in(store::tracks_of(out, trial));
        let task = task(experiment, trial, toy);
        let (record, judged) = bench.attempt(&task)?;
        let attempt = Attempt { trial: *trial, placed_m: task.at_m, record, judged };
        store::keep(out, &attempt)?;
    }
    context.report(1.0, "grasping");
    Ok(())
}

/// Puts shards of one experiment together.
///
/// # Errors
/// When they are not of one experiment, or disagree about an attempt.
pub fn merge_trials(shards: &[PathBuf], out: &Path) -> Result<Summary, OfflineError> {
    let experiment = store::merge(shards, out)?;
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
    let mut found: Vec<(Hand, Box<dyn HandFinder>)> = vec![];
    for hand in Hand::BOTH {
        found.push((hand, Box::new(RenderedHand::of_rig(knowledge.model.rig(), hand.palm())?)));
    }
    let mut finder = |hand: Hand| {
        let at = found.iter().position(|(of, _)| *of == hand)?;
        Some(found.swap_remove(at).1)
    };
    Bench::new(rig, scenario, knowledge, &mut finder)
}

fn is_mine(trial: &Trial, shard: Option<(usize, usize)>) -> bool {
    shard.is_none_or(|(part, parts)| trial.number % parts.max(1) + 1 == part)
}

pub(super) fn conclude(out: &Path, experiment: &Experiment) -> Result<Summary, OfflineError> {
    Ok(store::conclude(out, experiment, &Rig::built_in("nico")?)?)
}

/// An attempt as it is carried out.
fn task(experiment: &Experiment, trial: &Trial, toy: Toy) -> Task {
    let (at_m, seed) = experiment.placed(trial);
    let (method, hand) = (trial.method, experiment.hand);
    let order = Order { method, hand, object: experiment.object.clone(), near_m: None };
    Task { order, toy, at_m, seed }
}

fn read_positions(file: &Path) -> Result<Vec<[f64; 2]>, OfflineError> {
    let needs = "the header x_m,y_m and one position on the table per line, for example 0.3,-0.2";
    let table = Table::read(file, &["x_m", "y_m"], &[], needs)?;
    Ok(table.rows().iter().map(|row| [row[0], row[1]]).collect())
}
