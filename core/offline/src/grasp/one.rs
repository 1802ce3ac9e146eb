//! `plumbline grasp`: one grasp on the twin.

use std::path::PathBuf;

use plumbline_engine::trials::Judged;
use plumbline_grasp::things::Thing;
use plumbline_grasp::{Hand, HandChoice, Method, Order, Outcome};
use plumbline_model::JobContext;
use plumbline_twin::Toy;
use serde::Serialize;

use super::attempt::Task;
use super::trials::bench;
use crate::OfflineError;

/// One grasp.
#[derive(Clone, Debug)]
pub struct GraspArgs {
    /// Name of a scenario, or a file.
    pub twin: String,
    /// Folder of a commissioned lab.
    pub lab: PathBuf,
    /// How.
    pub method: Method,
    /// With which hand.
    pub hand: HandChoice,
    /// Class of the object.
    pub object: String,
    /// Where it is put, robot frame, m.
    pub at_m: [f64; 2],
    /// Of all that is drawn by chance.
    pub seed: u64,
}

/// What came of it, with the keys of the command line's JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GraspReport {
    /// As it took itself: `success`, `failed` or `refused`.
    pub result: &'static str,
    /// Class of the failure.
    pub failure: Option<String>,
    /// Why, and what to do.
    pub why: Option<String>,
    /// With which hand.
    pub hand: Hand,
    /// Looks at the hand.
    pub iterations: usize,
    /// Distance of the hand from where it belongs, at the last look, as the eyes had it.
    pub alignment_mm: Option<f64>,
    /// From the beginning to the end of the lift.
    pub seconds: Option<f64>,
    /// What really happened.
    pub judged: Judged,
}

/// Grasps once.
///
/// # Errors
/// When the lab is not ready.
pub fn grasp(args: &GraspArgs, context: &dyn JobContext) -> Result<GraspReport, OfflineError> {
    let scenario = crate::commission::scenario(&args.twin)?;
    let unknown = || OfflineError::unknown_thing(&args.object);
    let thing = Thing::of_class(&args.object).ok_or_else(unknown)?;
    let toy = Toy::from_name(&thing.class.to_lowercase()).ok_or_else(unknown)?;
    let mut bench = bench(&args.lab, scenario, &[args.method], context)?;
    context.report(0.5, "grasping");
    let (method, hand) = (args.method, args.hand);
    let order = Order { method, hand, object: thing.class.to_owned(), near_m: None };
    let (record, judged) = bench.attempt(&Task { order, toy, at_m: args.at_m, seed: args.seed })?;
    let (result, failure, why) = match record.outcome.clone() {
        Some(Outcome::Success) => ("success", None, None),
        Some(Outcome::Refused { why }) => ("refused", None, Some(why)),
        Some(Outcome::Failed { failure, why }) => (
            "failed",
            serde_json::to_value(failure).ok().and_then(|name| Some(name.as_str()?.to_owned())),
            Some(why),
        ),
        None => ("failed", None, None),
    };
    Ok(GraspReport {
        result,
        failure,
        why,
        hand: record.hand,
        iterations: record.iterations.len(),
        alignment_mm: record.alignment_m().map(|m| m * 1e3),
        seconds: record.seconds,
        judged,
    })
}
