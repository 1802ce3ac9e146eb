//! A hand that is sent somewhere: inverse kinematics with what is known of the arm.

use std::sync::Arc;

use nalgebra::Vector3;
use plumbline_effects::RigModel;
use plumbline_effects::rig_model::{Conditions, DeviatedArm};
use plumbline_model::frame::Tip;
use plumbline_model::robot::ik::{Options, Solver, SolverError, Target};
use plumbline_model::robot::{Chain, DescriptionError, JointIndex, Posture, Rig};
use plumbline_model::{Point, Pose, Robot};

/// A step of the solution that turns a joint by more is another way to hold the arm, rad.
const JUMP_RAD: f64 = 0.5;

/// Why there is no such hand.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoArm {
    /// The robot has no arm of that name with a palm.
    #[error("the robot {rig} has no arm called {arm} with a palm")]
    NoArm {
        /// Name of the rig.
        rig: String,
        /// Name of the arm.
        arm: String,
    },
    /// Its chain cannot be solved.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The description lacks something.
    #[error(transparent)]
    Description(#[from] DescriptionError),
}

/// The palm of an arm, as a model has it.
#[derive(Clone, Debug)]
pub struct PalmArm {
    rig: Arc<Rig>,
    solver: Solver,
    chain: Chain,
    model: DeviatedArm,
    /// Joints of the fingers.
    hand: Vec<JointIndex>,
}

impl PalmArm {
    /// The palm (the first tip) of the arm of this name; `model`: the effects that it has.
    ///
    /// # Errors
    /// When the rig has no such arm.
    pub fn new(rig: &Arc<Rig>, model: &RigModel, arm: &str) -> Result<Self, NoArm> {
        let no_arm = || NoArm::NoArm { rig: rig.name.clone(), arm: arm.to_owned() };
        let arm = rig.arm(arm).ok_or_else(no_arm)?;
        let tip = &arm.tips.first().ok_or_else(no_arm)?.link;
        Ok(Self {
            solver: Solver::of_rig(rig, tip)?,
            chain: rig.chain(tip)?,
            model: model.arm(rig, tip)?,
            hand: arm.hand.clone(),
            rig: rig.clone(),
        })
    }

    /// The robot.
    pub fn rig(&self) -> &Arc<Rig> {
        &self.rig
    }

    /// Joints from the shoulder to the wrist.
    pub fn joints(&self) -> &[JointIndex] {
        self.solver.joints()
    }

    /// Joints of the fingers.
    pub fn hand(&self) -> &[JointIndex] {
        &self.hand
    }

    /// Where the palm is, by the model, when a posture is commanded.
    pub fn palm(&self, commanded: &Posture) -> Point<Robot> {
        self.model.tip(&commanded.of(self.joints()), &Conditions::default())
    }

    /// The whole place of the palm as described, whatever the model says.
    pub fn described(&self, posture: &Posture) -> Pose<Robot, Tip> {
        self.chain.robot_from_tip_in(posture)
    }

    /// How level the palm is: the cosine of its inclination, 1 when it faces straight down.
    pub fn level(&self, posture: &Posture) -> f64 {
        (self.described(posture).isometry.rotation * Vector3::z()).z
    }

    /// What must be commanded so that the palm comes to a point with a heading, held as near to level as
    /// the arm can; the rest of the robot as in `from`. `None`: it does not get there.
    pub fn sent_to(&self, point: Point<Robot>, heading_rad: f64, from: &Posture) -> Option<Posture> {
        let target = Target::PositionYaw { point, yaw_rad: heading_rad };
        let start = from.of(self.joints());
        let reached = self
            .model
            .reach(&self.solver, &target, &start, &Options::upright(), &Conditions::default())
            .ok()
            .filter(|reached| reached.answer.is_reached())?;
        Some(from.with(self.joints(), &reached.answer.best().joints))
    }

    /// The same, held like `from`: a neighbor of it on a way.
    pub fn next_to(&self, point: Point<Robot>, heading_rad: f64, from: &Posture) -> Option<Posture> {
        let target = Target::PositionYaw { point, yaw_rad: heading_rad };
        let options = Options { other_starts: 0, ..Options::upright() };
        let start = from.of(self.joints());
        let reached =
            self.model.reach(&self.solver, &target, &start, &options, &Conditions::default()).ok()?;
        let next = from.with(self.joints(), &reached.answer.best().joints);
        (reached.answer.is_reached() && next.distance_rad(from) < JUMP_RAD).then_some(next)
    }
}
