//! `plumbline grasp`: one grasp on the twin.

use std::path::PathBuf;

use plumbline_engine::trials::Judged;
use plumbline_grasp::things::Thing;
use plumbline_grasp::{Failure, Hand, HandChoice, Method, Order, Outcome, Record, tracks};
use plumbline_model::JobContext;
use plumbline_twin::Toy;
use serde::Serialize;

use super::attempt::Task;
use super::trials::bench;
use crate::OfflineError;
use crate::commission::steps::twin_of;

/// One grasp.
#[derive(Clone, Debug)]
pub struct GraspArgs {
    /// Name of a scenario, or a file; `None`: the one that the lab was commissioned on.
    pub twin: Option<String>,
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
    /// Where the record, the joint tracks and the images go; `None`: they are not kept.
    pub out: Option<PathBuf>,
}

/// What came of it, with the keys of the command line's JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GraspReport {
    /// As it took itself: `success`, `failed` or `refused`. What slips out within ten seconds is no success.
    pub result: &'static str,
    /// Class of the failure.
    pub failure: Option<String>,
    /// Why, and what to do.
    pub why: Option<String>,
    /// The model of the robot that was used.
    pub model: String,
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
    let scenario = twin_of(&args.lab, args.twin.as_deref())?;
    let unknown = || OfflineError::unknown_thing(&args.object);
    let thing = Thing::of_class(&args.object).ok_or_else(unknown)?;
    let toy = Toy::from_name(&thing.class.to_lowercase()).ok_or_else(unknown)?;
    let mut bench = bench(&args.lab, scenario, &[args.method], context)?;
    if let Some(out) = &args.out {
        if plumbline_model::files::present(&out.join("record.json"))? {
            return Err(OfflineError::KeptAlready(out.clone()));
        }
        bench.keep_in(out.clone())?;
        bench.track_in(out.join(tracks::FILE));
    }
    context.report(0.5, "grasping");
    let (method, hand) = (args.method, args.hand);
    let order = Order { method, hand, object: thing.class.to_owned(), near_m: None };
    let (record, judged) = bench.attempt(&Task { order, toy, at_m: args.at_m, seed: args.seed })?;
    Ok(told(&record, judged))
}

/// A record as the command line tells it.
fn told(record: &Record, judged: Judged) -> GraspReport {
    let named = |failure: Failure| {
        serde_json::to_value(failure).ok().and_then(|name| Some(name.as_str()?.to_owned()))
    };
    let (result, failure, why) = match (record.outcome.clone(), record.slipped_after_s) {
        (Some(Outcome::Success), None) => ("success", None, None),
        (Some(Outcome::Success), Some(after_s)) => {
            let why = format!("it was held, and slipped out of the hand {after_s:.1} s later");
            ("failed", named(Failure::Slipped), Some(why))
        }
        (Some(Outcome::Refused { why }), _) => ("refused", None, Some(why)),
        (Some(Outcome::Failed { failure, why }), _) => ("failed", named(failure), Some(why)),
        (None, _) => ("failed", None, None),
    };
    GraspReport {
        result,
        failure,
        why,
        model: record.model.clone(),
        hand: record.hand,
        iterations: record.iterations.len(),
        alignment_mm: record.alignment_m().map(|m| m * 1e3),
        seconds: record.seconds,
        judged,
    }
}

#[cfg(test)]
mod tests {
    use jiff::Timestamp;

    use super::*;

    fn after(outcome: Outcome, slipped_after_s: Option<f64>) -> GraspReport {
        let new = Record::new(Method::M5, "Tomato", Timestamp::UNIX_EPOCH, "nominal".to_owned());
        told(&Record { outcome: Some(outcome), slipped_after_s, ..new }, Judged::default())
    }

    #[test]
    fn what_slipped_out_after_the_lift_is_no_success() {
        assert_eq!(after(Outcome::Success, None).result, "success");
        let slipped = after(Outcome::Success, Some(3.2));
        assert_eq!((slipped.result, slipped.failure.as_deref()), ("failed", Some("slipped")));
        assert!(slipped.why.expect("a reason").contains("3.2 s later"));
        let refused = after(Outcome::Refused { why: "out of reach".to_owned() }, None);
        assert_eq!((refused.result, refused.why.as_deref()), ("refused", Some("out of reach")));
    }

    #[test]
    fn the_keys_of_one_grasp_are_those_of_the_contract() {
        let report = serde_json::to_value(after(Outcome::Success, None)).expect("plain data");
        for key in ["result", "failure", "iterations", "alignment_mm", "seconds"] {
            assert!(report.get(key).is_some(), "{key} of {report}");
        }
    }
}
