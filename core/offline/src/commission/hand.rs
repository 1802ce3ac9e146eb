//! Step hand: the eyes look at the hands, where the grasp will happen.

use plumbline_engine::handeye::{FILE, Kept};
use plumbline_grasp::Hand;
use plumbline_handeye::hands::Looks;
use plumbline_handeye::{
    Figures, HandEyeError, Outcome, SENTENCE, Sizing, Start, Tied, of_other, of_touched,
};
use plumbline_model::JobContext;

use super::effects::{in_use, place_for_others, put_in_use};
use super::error::CommissionError;
use super::lab::Lab;
use super::robot::Robot;
use super::steps::Step;

/// Looks at both hands from the home posture of the head, and sizes the arms' effects anew.
pub(super) fn run(lab: &Lab, robot: &mut Robot, context: &dyn JobContext) -> Result<Step, CommissionError> {
    let mut step = Step::new("hand", "hands that were not used, seen against where the arm has them, rms");
    let (start, tie, at) = (lab.start()?, lab.tie()?, jiff::Timestamp::now());
    lab.with_touches(|touches| {
        let (names, chosen) = in_use(lab, &start, touches)?;
        let sizing = Sizing::chosen(&start, touches, &tie, names, chosen)?;
        let looks = look(robot, &start, Hand::Right, 0.0, context)?;
        let (arm, figures) = of_touched(&sizing, [&start, &start], &looks, at, context)?;
        (step.before_mm, step.after_mm) =
            (figures.before_m.map(|m| 1e3 * m), figures.after_m.map(|m| 1e3 * m));
        step.notes.push(format!("{} of {} hands were found.", figures.found, figures.looked));
        let model = sizing.model(&arm, None, SENTENCE, at)?;
        put_in_use(lab, &model)?;
        place_for_others(lab, touches, &arm)?;
        let mut tied =
            Tied { tie: tie.clone(), model: model.clone(), touched: (Hand::Right, figures), other: None };
        if lab.rig.arm(Hand::Left.name()).is_none() {
            return keep(lab, &tied, at);
        }
        let known = start.with(model)?;
        let looks = look(robot, &known, Hand::Left, 0.5, context)?;
        match of_other(&sizing, &arm, [&known, &known], &looks, at, context) {
            Ok((left, figures)) => {
                step.notes.push(told(&figures));
                tied.model = sizing.model(&arm, Some((Hand::Left, &left)), SENTENCE, at)?;
                put_in_use(lab, &tied.model)?;
                tied.other = Some((Hand::Left, Outcome::Sized(figures)));
            }
            // The right hand grasps without it.
            Err(why @ HandEyeError::FewHands { .. }) => {
                step.notes.push(format!("The left arm is taken as described: {why}."));
                tied.other = Some((Hand::Left, Outcome::Stays(why.to_string())));
            }
            Err(error) => return Err(error.into()),
        }
        keep(lab, &tied, at)
    })?;
    Ok(step)
}

/// The window, too, knows that the arms are tied to the eyes.
fn keep(lab: &Lab, tied: &Tied, at: jiff::Timestamp) -> Result<(), CommissionError> {
    Kept::of(tied, at).write(&lab.world().join(FILE)).map_err(CommissionError::room)
}

fn look(
    robot: &mut Robot,
    known: &Start,
    hand: Hand,
    begin: f64,
    context: &dyn JobContext,
) -> Result<Looks, CommissionError> {
    let report = |number: usize| {
        context.report(begin + 0.4 * number as f64 / Looks::MOST as f64, "looking at the hand");
    };
    Ok(Looks::take(robot.body(), &known.model, hand, &mut { report }, context)?)
}

fn told(figures: &Figures) -> String {
    let mm = |m: Option<f64>| m.map_or("not known".to_owned(), |m| format!("{:.1} mm", 1e3 * m));
    format!(
        "Left hand: {} looks; on those that were not used it is seen beside where its arm has it by {} before \
         and {} after, rms.",
        figures.looked,
        mm(figures.before_m),
        mm(figures.after_m)
    )
}
