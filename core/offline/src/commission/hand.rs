//! Step hand: the eyes look at the hand, where the grasp will happen.
//!
//! Touches tell of the right arm only where the fingertip meets the glass. Held open over the table at places all
//! around, the hand is rendered where the arm's model has it and found in both eyes; what it is beside sizes
//! the arm's effects anew, together with the touches. The left arm touches nothing: what the eyes see of its
//! hand, and where its servos stop, is all that sizes its effects.

use std::sync::Arc;

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::{Observation, What};
use plumbline_effects::{Kind, Measurements, RobotModel};
use plumbline_fit::{Looked, SeenHand, SeenHands, measurements, row};
use plumbline_grasp::attempt::{HandFinder as _, RenderedHand};
use plumbline_grasp::plan::{GraspPlanner, Standing};
use plumbline_grasp::{Corrections, Hand, Knowledge, PalmArm, Sight};
use plumbline_model::robot::{JointIndex, Posture};
use plumbline_model::{JobContext, StereoCalibration};

use super::effects;
use super::error::CommissionError;
use super::lab::Lab;
use super::robot::Robot;
use super::steps::Step;

/// Where the right hand is held open over the table, the left one at their mirror images: x, y, m.
const OVER_M: [[f64; 2]; 12] = [
    [0.22, -0.35],
    [0.32, -0.33],
    [0.38, -0.25],
    [0.25, -0.2],
    [0.33, -0.12],
    [0.4, -0.08],
    [0.24, -0.05],
    [0.32, 0.03],
    [0.4, 0.1],
    [0.25, 0.14],
    [0.32, 0.2],
    [0.38, 0.18],
];
/// As if something so high stood there, m.
const HEIGHT_M: f64 = 0.04;
/// What is found of a hand is off by so much besides what its picture says, standard deviation per axis, m.
const FOUND_SD_M: f64 = 0.0015;
/// The hand is looked for this far around, first and in later rounds, m.
const AROUND_M: [f64; 2] = [0.02, 0.01];
/// A hand whose arm has touched nothing is looked for this far around at first, m.
const LEFT_AROUND_M: f64 = 0.03;
/// Fewer hands tell nothing.
const FEWEST: usize = 5;

/// A hand that was looked at.
struct Look {
    sight: Sight,
    commanded: Posture,
    /// The posture before, which says from which side each joint came.
    before: Posture,
}

impl Look {
    /// From which side each joint came: 1 or −1.
    fn direction(&self, joints: &[JointIndex]) -> Vec<f64> {
        let came = self.before.of(joints).into_iter().zip(self.commanded.of(joints));
        came.map(|(from, to)| if to >= from { 1.0 } else { -1.0 }).collect()
    }
}

/// Looks at the hand from the home posture of the head, and sizes the arm's effects anew.
pub(super) fn run(lab: &Lab, robot: &mut Robot, context: &dyn JobContext) -> Result<Step, CommissionError> {
    let mut step = Step::new("hand", "hands that were not used, seen against where the arm has them, rms");
    let calibration = Arc::new(lab.calibration()?);
    let model = lab.known()?;
    let hand = Hand::Right;
    let planner = planner(&model, hand)?;
    let (before, looks) = look(robot, &planner, &model, context)?;
    let mut eyes = Eyes { hand, finder: finder(&model, hand)?, calibration, before };
    let every: Vec<usize> = (0..looks.len()).collect();
    let (used, back): (Vec<usize>, Vec<usize>) = every.iter().partition(|i| *i % 4 != 1);
    step.before_mm = eyes.miss_mm(lab, &looks, &back)?;
    for (k, around_m) in AROUND_M.into_iter().enumerate() {
        context.checkpoint()?;
        context.report(0.4 + 0.05 * k as f64, "sizing the arm's errors anew");
        let seen = eyes.seen(lab, &looks, &used, around_m)?;
        effects::again(lab, &seen)?;
    }
    step.after_mm = eyes.miss_mm(lab, &looks, &back)?;
    let seen = eyes.seen(lab, &looks, &every, AROUND_M[1])?;
    effects::again(lab, &seen)?;
    step.notes.push(format!("{} of {} hands were found.", seen.seen.len(), looks.len()));
    if lab.rig.arm(Hand::Left.name()).is_some() {
        step.notes.push(left(lab, robot, context)?);
    }
    Ok(step)
}

/// Looks at the left hand, and sizes the effects of its arm; says what came of it.
fn left(lab: &Lab, robot: &mut Robot, context: &dyn JobContext) -> Result<String, CommissionError> {
    let (base, model, hand) = (lab.model()?, lab.known()?, Hand::Left);
    let planner = planner(&model, hand)?;
    let (before, looks) = look(robot, &planner, &model, context)?;
    let calibration = Arc::new(lab.calibration()?);
    let mut eyes = Eyes { hand, finder: finder(&model, hand)?, calibration, before };
    let every: Vec<usize> = (0..looks.len()).collect();
    let (used, back): (Vec<usize>, Vec<usize>) = every.iter().partition(|i| *i % 4 != 1);
    let before_mm = eyes.miss_mm(lab, &looks, &back)?;
    let lags = lags(lab, hand, &looks)?;
    let mut after_mm = None;
    for (which, around_m) in [(&used, LEFT_AROUND_M), (&used, AROUND_M[1]), (&every, AROUND_M[1])] {
        context.checkpoint()?;
        context.report(0.9, "sizing the left arm's errors");
        let seen = match eyes.seen(lab, &looks, which, around_m) {
            Ok(seen) => seen,
            // The right hand grasps without it.
            Err(why) => return Ok(format!("The left arm is taken as described: {why}.")),
        };
        if which.len() == every.len() {
            after_mm = eyes.miss_mm(lab, &looks, &back)?;
        }
        effects::by_eyes(lab, &base, hand.index_tip(), &seen, &lags)?;
    }
    let mm = |mm: Option<f64>| mm.map_or("not known".to_owned(), |mm| format!("{mm:.1} mm"));
    Ok(format!(
        "Left hand: {} looks; on those that were not used it is seen beside where its arm has it by {} before \
         and {} after, rms.",
        looks.len(),
        mm(before_mm),
        mm(after_mm)
    ))
}

/// How far servos of an arm stop from where they are sent, at every look.
fn lags(lab: &Lab, hand: Hand, looks: &[Look]) -> Result<Measurements, CommissionError> {
    let arm = Arm::of_rig(&lab.rig, hand.index_tip())?;
    let joints: Vec<_> = arm.parts.iter().map(|part| part.index).collect();
    let rows = looks.iter().map(|look| Observation {
        commanded_rad: Some(look.commanded.of(&joints)),
        ..row(What::Pose, look.sight.posture.of(&joints), look.direction(&joints))
    });
    let rows = rows.collect();
    Ok(measurements(&lab.rig, arm, None, rows))
}

fn planner(model: &RobotModel, hand: Hand) -> Result<GraspPlanner, CommissionError> {
    Ok(GraspPlanner::new(PalmArm::new(model, hand.name()).map_err(CommissionError::room)?))
}

fn finder(model: &RobotModel, hand: Hand) -> Result<RenderedHand, CommissionError> {
    RenderedHand::of_rig(model.rig(), hand.palm()).map_err(CommissionError::room)
}

/// Holds the open hand over the table at one place after another.
fn look(
    robot: &mut Robot,
    planner: &GraspPlanner,
    model: &RobotModel,
    context: &dyn JobContext,
) -> Result<(Sight, Vec<Look>), CommissionError> {
    let home = model.rig().home();
    robot.go(&home);
    let before = sight(robot)?;
    let mut looks = vec![];
    for (i, xy_m) in OVER_M.into_iter().enumerate() {
        context.checkpoint()?;
        let begin = if planner.arm().is_left() { 0.5 } else { 0.0 };
        context.report(begin + 0.4 * i as f64 / OVER_M.len() as f64, "looking at the hand");
        let xy_m = if planner.arm().is_left() { [xy_m[0], -xy_m[1]] } else { xy_m };
        let support_m = model.rig().table.height_m;
        let standing = Standing { xy_m, support_m, height_m: HEIGHT_M };
        let stands = robot.lockstep().commanded().clone();
        let Ok(plan) = planner.plan(&standing, &Vector3::zeros(), &stands) else { continue };
        let mut before = stands;
        for posture in &plan.approach {
            before = robot.lockstep().commanded().clone();
            robot.go(posture);
        }
        robot.lockstep().wait(0.3);
        looks.push(Look { sight: sight(robot)?, commanded: robot.lockstep().commanded().clone(), before });
    }
    robot.go(&home);
    Ok((before, looks))
}

fn sight(robot: &mut Robot) -> Result<Sight, CommissionError> {
    let seen = robot.look()?;
    let at_s = robot.on_s();
    let eyes_on_s = Some(at_s);
    Ok(Sight { left: seen.left, right: seen.right, posture: seen.posture, at_s, eyes_on_s, seq: 0 })
}

/// The eyes that look for hands.
struct Eyes {
    hand: Hand,
    finder: RenderedHand,
    calibration: Arc<StereoCalibration>,
    before: Sight,
}

impl Eyes {
    /// Looks for a hand with the model in use: where the arm has its palm, where it is seen, m, and the
    /// information of that, 1/m². `None`: it is not found.
    fn find(
        &mut self,
        knowledge: &Knowledge,
        planner: &GraspPlanner,
        look: &Look,
        around_m: f64,
    ) -> Option<(Vector3<f64>, Vector3<f64>, Matrix3<f64>)> {
        let prior = Matrix3::identity() * around_m.powi(2);
        let palm = planner.arm().robot_from_palm(&look.commanded);
        let found = self.finder.find(knowledge, &self.before, &look.sight, &look.commanded, &palm, &prior);
        let found = found.ok()?;
        // What was seen alone: the prior's pull taken out.
        let posterior = found.covariance_m2.try_inverse()?;
        let information = posterior - Matrix3::identity() / around_m.powi(2);
        let measured_m2 = (information + Matrix3::identity() * 1e-2 / around_m.powi(2)).try_inverse()?;
        let palm_m = palm.translation_m();
        let off_m = measured_m2 * posterior * (found.palm.coords.coords - palm_m);
        let information = (measured_m2 + Matrix3::identity() * FOUND_SD_M.powi(2)).try_inverse()?;
        Some((palm_m, palm_m + off_m, information))
    }

    fn knowledge(&self, model: RobotModel) -> Knowledge {
        Knowledge {
            described: model.rig().clone(),
            model,
            calibration: self.calibration.clone(),
            corrections: Corrections::default(),
        }
    }

    /// Hands as the eyes see them, beside the angles of the arm.
    fn seen(
        &mut self,
        lab: &Lab,
        looks: &[Look],
        which: &[usize],
        around_m: f64,
    ) -> Result<SeenHands, CommissionError> {
        let model = lab.known()?;
        let planner = planner(&model, self.hand)?;
        let arm = Arm::of_rig(&lab.rig, self.hand.palm())?;
        let joints: Vec<_> = arm.parts.iter().map(|part| part.index).collect();
        let pan = &lab.rig.description.joint(lab.rig.eyes.pan).name;
        let of_neck =
            model.added().effects().iter().filter(|e| e.id == Kind::HeadJoint.id() && e.site == *pan);
        let neck_rad: f64 = of_neck.flat_map(|effect| &effect.values).sum();
        let knowledge = self.knowledge(model);
        // Those who fit know the neck's zero as an unknown: here it is taken out.
        let mut eyes = [0.0; 7];
        eyes[0] = neck_rad;
        let undone: Isometry3<f64> = Looked::new(&lab.rig).moved(&eyes).inverse();
        let (mut rows, mut seen) = (vec![], vec![]);
        for look in which.iter().map(|i| &looks[*i]) {
            let Some((_, palm_m, information)) = self.find(&knowledge, &planner, look, around_m) else {
                continue;
            };
            rows.push(row(What::Pose, look.sight.posture.of(&joints), look.direction(&joints)));
            seen.push(SeenHand { palm_m: (undone * Point3::from(palm_m)).coords, information });
        }
        if seen.len() < FEWEST {
            return Err(CommissionError::room(format!(
                "the hand was found at {} of {} places only: take away what lies on the table, and see that light falls on it",
                seen.len(),
                which.len()
            )));
        }
        Ok(SeenHands { arm: measurements(&lab.rig, arm, None, rows), seen })
    }

    /// How far along the table hands are seen from where the arm has them, rms, mm; `None`: none is found.
    fn miss_mm(
        &mut self,
        lab: &Lab,
        looks: &[Look],
        which: &[usize],
    ) -> Result<Option<f64>, CommissionError> {
        let model = lab.known()?;
        let planner = planner(&model, self.hand)?;
        let knowledge = self.knowledge(model);
        let found: Vec<f64> = which
            .iter()
            .filter_map(|i| self.find(&knowledge, &planner, &looks[*i], AROUND_M[0]))
            .map(|(palm_m, seen_m, _)| (seen_m - palm_m).xy().norm_squared())
            .collect();
        Ok((!found.is_empty()).then(|| 1e3 * (found.iter().sum::<f64>() / found.len() as f64).sqrt()))
    }
}
