//! Step hand: the eyes look at the hand, whose place the arm knows since its effects were named.
//!
//! A board of unknown place tells how the eyes sit to the joints of the head, and nothing of how the head
//! stands on the robot: its zero to the side moves all places alike. The hand, held open over the table at
//! places that the arm knows, is rendered there and found in both eyes; one small rigid motion of the eyes
//! brings what was seen and what the arm says together.

use nalgebra::{Matrix3, Matrix6, Rotation3, Translation3, UnitQuaternion, Vector3, Vector6};
use plumbline_effects::RobotModel;
use plumbline_grasp::attempt::{HandFinder as _, RenderedHand};
use plumbline_grasp::plan::{GraspPlanner, Standing};
use plumbline_grasp::{Corrections, Knowledge, PalmArm, Sight};
use plumbline_model::robot::{EyeMount, Posture, Rig};
use plumbline_model::{JobContext, Pose, StereoCalibration};
use std::sync::Arc;

use super::error::CommissionError;
use super::lab::Lab;
use super::robot::Robot;
use super::steps::Step;

/// Where the hand is held open over the table: x, y, m.
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
/// What the mount may be off by before, standard deviations: turn (rad) and shift (m).
const TURN_SD_RAD: f64 = 0.03;
const SHIFT_SD_M: f64 = 0.005;
/// Where the arm may be off by, standard deviation per axis, m.
const ARM_SD_M: f64 = 0.003;
/// The hand is looked for this far around, first and in later rounds, m.
const AROUND_M: [f64; 4] = [0.02, 0.012, 0.008, 0.008];
/// Fewer hands tell nothing.
const FEWEST: usize = 5;

/// A hand that was looked at.
struct Look {
    sight: Sight,
    commanded: Posture,
}

/// A hand that was found: where the arm has it, by how much the eyes see it elsewhere, and how much that
/// is worth.
struct Found {
    palm_m: Vector3<f64>,
    off_m: Vector3<f64>,
    information: Matrix3<f64>,
}

/// Looks at the hand from the home posture of the head, and puts the corrected mount in use.
pub(super) fn run(lab: &Lab, robot: &mut Robot, context: &dyn JobContext) -> Result<Step, CommissionError> {
    let mut step = Step::new("hand", "hands that were not used, seen against where the arm has them, rms");
    let calibration = Arc::new(lab.calibration()?);
    let model = lab.known()?;
    let arm = PalmArm::new(&model, "right").map_err(CommissionError::room)?;
    let planner = GraspPlanner::new(arm);
    let (before, looks) = look(robot, &planner, &model, context)?;
    let mut eyes = Eyes { finder: finder(&model)?, calibration, model, planner, before };
    let mut motion = Vector6::zeros();
    let every: Vec<usize> = (0..looks.len()).collect();
    let (used, back): (Vec<usize>, Vec<usize>) = every.iter().partition(|i| *i % 4 != 1);
    let mut tried = Vector6::zeros();
    step.before_mm = eyes.miss_mm(&looks, &back, &motion, 0.02)?;
    for around_m in AROUND_M {
        tried = eyes.fitted(&looks, &used, &tried, around_m)?;
        motion = eyes.fitted(&looks, &every, &motion, around_m)?;
    }
    step.after_mm = eyes.miss_mm(&looks, &back, &tried, 0.02)?;
    let mut mount = lab.mount()?;
    let corrected = eyes.rig_with(&motion)?;
    mount.head_from_left = corrected.eyes.head_from_left;
    let turned_deg: Vec<String> =
        motion.iter().take(3).map(|rad| format!("{:.2}°", rad.to_degrees())).collect();
    step.notes.push(format!(
        "{} hands; the eyes turned by {} about x, y, z of the robot and moved by {:.1} mm.",
        looks.len(),
        turned_deg.join(", "),
        1e3 * motion.fixed_rows::<3>(3).norm()
    ));
    mount.remarks.push("corrected by what the eyes saw of the hand, whose place the arm knows".to_owned());
    lab.accept_mount(&mount)?;
    Ok(step)
}

fn finder(model: &RobotModel) -> Result<RenderedHand, CommissionError> {
    RenderedHand::of_rig(model.rig(), "right_palm_center").map_err(CommissionError::room)
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
        context.report(0.7 * i as f64 / OVER_M.len() as f64, "looking at the hand");
        let support_m = model.rig().table.height_m;
        let standing = Standing { xy_m, support_m, height_m: HEIGHT_M };
        let stands = robot.lockstep().commanded().clone();
        let Ok(plan) = planner.plan(&standing, &Vector3::zeros(), &stands) else { continue };
        for posture in &plan.approach {
            robot.go(posture);
        }
        robot.lockstep().wait(0.3);
        looks.push(Look { sight: sight(robot)?, commanded: robot.lockstep().commanded().clone() });
    }
    robot.go(&home);
    Ok((before, looks))
}

fn sight(robot: &mut Robot) -> Result<Sight, CommissionError> {
    let seen = robot.look()?;
    let at_s = robot.on_s();
    Ok(Sight { left: seen.left, right: seen.right, posture: seen.posture, at_s, seq: 0 })
}

/// The eyes whose place is looked for.
struct Eyes {
    finder: RenderedHand,
    calibration: Arc<StereoCalibration>,
    model: RobotModel,
    planner: GraspPlanner,
    before: Sight,
}

impl Eyes {
    /// The robot with its eyes moved: rotation vector (rad) and shift (m), axes of the robot, about the
    /// left eye, the head as at home.
    fn rig_with(&self, motion: &Vector6<f64>) -> Result<Rig, CommissionError> {
        let rig = self.model.rig();
        let home = rig.home();
        let robot_from_left = self.model.robot_from_left(&home).isometry;
        let head_from_robot = (robot_from_left * rig.eyes.head_from_left.isometry.inverse()).inverse();
        let turn = UnitQuaternion::from_scaled_axis(motion.fixed_rows::<3>(0).into_owned());
        let mut moved = robot_from_left;
        moved.rotation = turn * moved.rotation;
        moved.translation =
            Translation3::from(moved.translation.vector + motion.fixed_rows::<3>(3).into_owned());
        let head_from_left = Pose::new(head_from_robot * moved);
        Ok(Rig { eyes: EyeMount { head_from_left, ..rig.eyes.clone() }, ..(**rig).clone() })
    }

    /// Looks for the hands with the eyes moved.
    fn found(
        &mut self,
        looks: &[Look],
        which: &[usize],
        motion: &Vector6<f64>,
        around_m: f64,
    ) -> Result<Vec<Found>, CommissionError> {
        let rig = Arc::new(self.rig_with(motion)?);
        let knowledge = Knowledge {
            model: self.model.with_rig(rig).map_err(CommissionError::room)?,
            described: self.model.rig().clone(),
            calibration: self.calibration.clone(),
            corrections: Corrections::default(),
        };
        let prior = Matrix3::identity() * around_m.powi(2);
        let mut found = vec![];
        for look in which.iter().map(|i| &looks[*i]) {
            let palm = self.planner.arm().robot_from_palm(&look.commanded);
            let seen =
                self.finder.find(&knowledge, &self.before, &look.sight, &look.commanded, &palm, &prior);
            let Ok(seen) = seen else { continue };
            let posterior = seen.covariance_m2.try_inverse();
            let Some(information) = posterior.map(|inverse| inverse - Matrix3::identity() / around_m.powi(2))
            else {
                continue;
            };
            // What was seen alone: the prior's pull taken out, and what the arm may be off by put in.
            let Some(measured_m2) = (information + Matrix3::identity() * 1e-6).try_inverse() else {
                continue;
            };
            let posterior_off = seen.palm.coords.coords - palm.translation_m();
            let off_m = measured_m2 * (information + Matrix3::identity() / around_m.powi(2)) * posterior_off;
            let with_arm = measured_m2 + Matrix3::identity() * ARM_SD_M.powi(2);
            let Some(information) = with_arm.try_inverse() else { continue };
            found.push(Found { palm_m: palm.translation_m(), off_m, information });
        }
        Ok(found)
    }

    /// The motion that brings eyes and arm together, from one that is near.
    fn fitted(
        &mut self,
        looks: &[Look],
        which: &[usize],
        motion: &Vector6<f64>,
        around_m: f64,
    ) -> Result<Vector6<f64>, CommissionError> {
        let found = self.found(looks, which, motion, around_m)?;
        if found.len() < FEWEST {
            return Err(CommissionError::room(format!(
                "the hand was found at {} of {} places only: take away what lies on the table, and see that light falls on it",
                found.len(),
                which.len()
            )));
        }
        let eye_m = self.model.robot_from_left(&self.model.rig().home()).translation_m();
        let mut normal = Matrix6::zeros();
        let mut right = Vector6::zeros();
        for (k, sd) in [TURN_SD_RAD; 3].into_iter().chain([SHIFT_SD_M; 3]).enumerate() {
            normal[(k, k)] += 1.0 / sd.powi(2);
            right[k] -= motion[k] / sd.powi(2);
        }
        for hand in &found {
            // Turned by w about the eye and shifted by t, what was seen lies at off + w × r + t.
            let r = hand.palm_m + hand.off_m - eye_m;
            let mut slope = nalgebra::Matrix3x6::zeros();
            slope.fixed_view_mut::<3, 3>(0, 0).copy_from(&-r.cross_matrix());
            slope.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
            normal += slope.transpose() * hand.information * slope;
            right -= slope.transpose() * hand.information * hand.off_m;
        }
        let change =
            normal.lu().solve(&right).ok_or_else(|| CommissionError::room("the hands tell nothing"))?;
        let turn = Rotation3::from_scaled_axis(change.fixed_rows::<3>(0).into_owned())
            * Rotation3::from_scaled_axis(motion.fixed_rows::<3>(0).into_owned());
        let mut next = motion + change;
        next.fixed_rows_mut::<3>(0).copy_from(&turn.scaled_axis());
        Ok(next)
    }

    /// How far hands are seen from where the arm has them, rms, mm; `None`: none is found.
    fn miss_mm(
        &mut self,
        looks: &[Look],
        which: &[usize],
        motion: &Vector6<f64>,
        around_m: f64,
    ) -> Result<Option<f64>, CommissionError> {
        let found = self.found(looks, which, motion, around_m)?;
        let squares: f64 = found.iter().map(|hand| hand.off_m.xy().norm_squared()).sum();
        Ok((!found.is_empty()).then(|| 1e3 * (squares / found.len() as f64).sqrt()))
    }
}
