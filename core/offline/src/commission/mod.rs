//! `plumbline commission`: a robot just switched on becomes one that is ready to grasp, without a person
//! but for the hands that hold the board.
//!
//! Steps, each on disk before the next begins: the finger touches the screen while the eyes warm up
//! (`touches`); the board calibrates the eyes (`eyes`) and their mount (`mount`); the touches place the
//! screen and the eyes look where it lies, which ties the arm to the eyes (`screen`); what makes the arm
//! miss (`effects`); correction models (`models`); the eyes look at the hand (`hand`); and a judge
//! measures what came of it (`check`). The judge alone knows what the twin hides.

mod effects;
mod error;
mod eyes;
mod hand;
mod hand_heights;
mod judge;
mod judge_touches;
mod judged;
mod known;
pub(crate) mod lab;
mod models;
mod mount;
mod plan;
pub(crate) mod published;
mod robot;
mod see;
pub(crate) mod steps;
#[cfg(test)]
mod tests;
mod touches;
#[cfg(test)]
mod views_tests;

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_engine::gap::store::Store as GapStore;
use plumbline_engine::ground::jobs::Part;
use plumbline_grasp::Hand;
use plumbline_model::JobContext;
use plumbline_model::files::{self, Size};
use plumbline_model::robot::Rig;
use plumbline_twin::eyes::EyeRenderer;
use plumbline_twin::{Scenario, Toy};
use serde::Serialize;

pub use error::CommissionError;
pub use judged::{PalmError, PlaceError, PlaceRow, TouchError};
pub use steps::Step;

use super::OfflineError;
use super::gap::{EffectReport, GapReport};
use lab::Lab;
use robot::Robot;
use steps::Steps;

/// What the judge found, beside the steps.
const JUDGED: &str = "judged.json";

/// Steps in their order and the share of the work at which each begins.
const STEPS: [(&str, f64); 8] = [
    ("touches", 0.0),
    ("eyes", 0.2),
    ("mount", 0.4),
    ("screen", 0.42),
    ("effects", 0.45),
    ("models", 0.7),
    ("hand", 0.8),
    ("check", 0.85),
];

/// Which twin, and where to.
#[derive(Clone, Debug)]
pub struct CommissionArgs {
    /// Name of a scenario, or a file.
    pub twin: String,
    /// Of all that is drawn by chance.
    pub seed: u64,
    /// Folder of the lab: what `--data-dir` takes.
    pub out: PathBuf,
}

/// What came of it, with the keys of the command line's JSON.
#[derive(Clone, Debug, Serialize)]
pub struct CommissionReport {
    /// Time that the robot and the person with the board needed.
    pub robot_minutes: f64,
    /// Contacts, without those of the judge.
    pub touches: usize,
    /// Times that the board was looked at.
    pub board_views: usize,
    /// Effects that the search named.
    pub effects: Vec<EffectReport>,
    /// `id@site` of the effects in use.
    pub in_use: Vec<String>,
    /// Where the tomato was found against where it was, by the judge.
    pub place_error_mm: PlaceError,
    /// Where the palm gets to, by the judge.
    pub palm_error_mm: PalmError,
    /// New touches, by the judge.
    pub touch_error_mm: TouchError,
    /// One after the other.
    pub steps: Vec<Step>,
}

/// A scenario by its name, else from a file.
///
/// # Errors
/// When there is neither.
pub fn scenario(twin: &str) -> Result<Scenario, CommissionError> {
    Ok(Scenario::named_or_file(twin)?)
}

/// Commissions a twin, or goes on where that was interrupted.
///
/// # Errors
/// When a step cannot be done; what was done before stays, and the same call goes on after it.
pub fn commission(args: &CommissionArgs, context: &dyn JobContext) -> Result<CommissionReport, OfflineError> {
    let rig = Arc::new(Rig::built_in("nico")?);
    let lab = Lab { folder: args.out.clone(), rig, scenario: scenario(&args.twin)?, seed: args.seed };
    Ok(carry_out(&lab, context)?)
}

fn carry_out(lab: &Lab, context: &dyn JobContext) -> Result<CommissionReport, CommissionError> {
    let mut steps = Steps::read(&lab.folder, &lab.scenario, lab.seed)?;
    let mut renderer: Option<EyeRenderer> = None;
    for (k, (name, begin)) in STEPS.into_iter().enumerate() {
        if steps.of(name).is_some() {
            continue;
        }
        let end = STEPS.get(k + 1).map_or(1.0, |(_, begin)| *begin);
        let part = Part { whole: context, begin, end };
        context.checkpoint()?;
        let step = one(lab, name, &steps, &mut renderer, &part)?;
        steps.add(&lab.folder, step)?;
    }
    report(lab, steps)
}

/// Does one step.
fn one(
    lab: &Lab,
    name: &str,
    steps: &Steps,
    renderer: &mut Option<EyeRenderer>,
    context: &dyn JobContext,
) -> Result<Step, CommissionError> {
    let mut with_robot = |work: &dyn Fn(&mut Robot) -> Result<Step, CommissionError>| {
        let mut robot = Robot::new(lab, steps.elapsed_s(), renderer.take())?;
        let step = work(&mut robot).map(|step| Step { minutes: robot.spent_s() / 60.0, ..step });
        *renderer = robot.into_eyes();
        step
    };
    match name {
        "touches" => with_robot(&|robot| touches::run(lab, robot, context)),
        "screen" => with_robot(&|robot| touches::place(lab, robot, context)),
        "effects" => effects::run(lab, context),
        "models" => models::run(lab, steps.of("touches").map_or(0, |step| step.touches), context),
        "eyes" => with_robot(&|robot| eyes::run(lab, robot, context)),
        "mount" => mount::run(lab, context),
        "hand" => with_robot(&|robot| hand::run(lab, robot, context)),
        // The judge's time is not the robot's.
        _ => with_robot(&|robot| check(lab, robot, context)).map(|step| Step { minutes: 0.0, ..step }),
    }
}

fn check(lab: &Lab, robot: &mut Robot, context: &dyn JobContext) -> Result<Step, CommissionError> {
    let mut step = Step::new("check", "new touches inside of the touched area, along the glass, rms");
    let (places, found) = judge::places(Toy::Tomato, lab, robot, context)?;
    let palm = judge::palm(Hand::Right, lab, robot, &found, context)?;
    if lab.rig.arm(Hand::Left.name()).is_some() {
        let left = judge::palm(Hand::Left, lab, robot, &found, context)?;
        let mm = |mm: Option<f64>| mm.map_or("–".to_owned(), |mm| format!("{mm:.1}"));
        step.notes.push(format!(
            "The left palm gets to within {} mm (median) and {} mm (95 %) of where it is sent, {} places.",
            mm(left.median),
            mm(left.p95),
            left.places
        ));
        robot.go(&lab.rig.home());
    }
    let touched = judge_touches::touches(lab, robot, context)?;
    step.before_mm = touched.uncorrected;
    step.after_mm = touched.inside;
    let file = lab.folder.join(JUDGED);
    let text = serde_json::to_string_pretty(&(places, palm, touched))
        .map_err(|error| CommissionError::Steps { file: file.clone(), reason: error.to_string() })?;
    files::write(&file, text)?;
    Ok(step)
}

fn report(lab: &Lab, steps: Steps) -> Result<CommissionReport, CommissionError> {
    let file = lab.folder.join(JUDGED);
    let text = files::read_text(&file, Size::SHORT)?;
    let (place_error_mm, palm_error_mm, touch_error_mm) = serde_json::from_str(&text)
        .map_err(|error| CommissionError::Steps { file: file.clone(), reason: error.to_string() })?;
    let (findings, _) = GapStore::new(lab.world().join("gap")).read(&lab.rig.name);
    let effects =
        findings.first().map_or_else(Vec::new, |named| GapReport::of(named.kept.finding.clone()).effects);
    Ok(CommissionReport {
        robot_minutes: steps.done.iter().map(|step| step.minutes).sum(),
        touches: steps.done.iter().map(|step| step.touches).sum(),
        board_views: steps.done.iter().map(|step| step.board_views).sum(),
        effects,
        in_use: lab.model()?.effects().iter().map(plumbline_effects::rig_model::ModelEffect::name).collect(),
        place_error_mm,
        palm_error_mm,
        touch_error_mm,
        steps: steps.done,
    })
}
