//! An arm of the robot as it is known now.

use std::sync::Arc;

use nalgebra::{Isometry3, Matrix3};
use plumbline_model::frame::Tip;
use plumbline_model::predict::Angles;
use plumbline_model::robot::ik::{IkError, Options, Solver, SolverError, Target};
use plumbline_model::robot::{Chain, JointIndex, Posture, Rig};
use plumbline_model::{Point, Pose, Robot};

use super::uncertainty::of_values;
use crate::arm::Arm;
use crate::library::Present;
use crate::rig_model::{Conditions, DeviatedArm, Measured, Reached, RigModel};

/// An arm of the robot as it is known now. Cheap to clone.
#[derive(Clone, Debug)]
pub struct ModelArm {
    parts: Arc<Parts>,
}

#[derive(Debug)]
struct Parts {
    chain: Chain,
    solver: Solver,
    deviated: DeviatedArm,
    /// Effects that the arm has without a touchscreen.
    free: Measured,
    is_known_together: bool,
}

impl ModelArm {
    pub(super) fn new(rig: &Rig, added: &RigModel, tip: &str) -> Result<Self, SolverError> {
        let solver = Solver::of_rig(rig, tip)?;
        let chain = rig.chain(tip)?;
        let deviated = added.arm(rig, tip)?;
        let arm = Arm::of_rig(rig, tip)?;
        let free = added.measured(Some(tip), Some(&arm), None);
        let free = free.of(|present| !present.effect.kind.is_of_contact());
        let is_known_together = added.is_known_together(&arm);
        Ok(Self { parts: Arc::new(Parts { chain, solver, deviated, free, is_known_together }) })
    }

    /// Nominal inverse kinematics.
    pub fn solver(&self) -> &Solver {
        &self.parts.solver
    }

    /// The nominal chain from the base to the tip.
    pub fn chain(&self) -> &Chain {
        &self.parts.chain
    }

    /// The arm with its effects, which knows of the touchscreen, too.
    pub fn deviated(&self) -> &DeviatedArm {
        &self.parts.deviated
    }

    /// Its joints, from the base on.
    pub fn joints(&self) -> &[JointIndex] {
        self.parts.chain.joints()
    }

    /// Whether no effect moves its tip.
    pub fn is_nominal(&self) -> bool {
        self.parts.free.present.is_empty()
    }

    /// Whether its effects were fitted together, with all that arms usually have: then little is left of its
    /// error beside what [`Self::covariance_m2`] says.
    pub fn is_known_together(&self) -> bool {
        self.parts.is_known_together
    }

    /// Where the tip is when a posture is commanded.
    pub fn tip(&self, commanded: &Posture, conditions: &Conditions) -> Point<Robot> {
        origin(&self.robot_from_tip(commanded, conditions))
    }

    /// The whole place of the tip when a posture is commanded, turned as the effects turn it.
    pub fn robot_from_tip(&self, commanded: &Posture, conditions: &Conditions) -> Pose<Robot, Tip> {
        self.placed(Angles::Commanded, commanded, conditions)
    }

    /// The same when encoders read a posture: what they see of the effects is not added once more.
    pub fn robot_from_tip_by_encoders(
        &self,
        encoders: &Posture,
        conditions: &Conditions,
    ) -> Pose<Robot, Tip> {
        self.placed(Angles::Encoder, encoders, conditions)
    }

    fn placed(&self, angles: Angles, posture: &Posture, conditions: &Conditions) -> Pose<Robot, Tip> {
        if self.is_nominal() {
            return self.parts.chain.robot_from_tip_in(posture);
        }
        Pose::new(self.place_with(angles, posture, conditions, &self.parts.free.present))
    }

    fn place_with(
        &self,
        angles: Angles,
        posture: &Posture,
        conditions: &Conditions,
        effects: &[Present],
    ) -> Isometry3<f64> {
        self.parts.deviated.robot_from_tip((angles, &posture.of(self.joints())), conditions, effects)
    }

    /// Covariance of the tip's place when a posture is commanded, by what is not known of the effects'
    /// values, robot axes, m². Zero without effects, and for effects whose covariance nobody knows.
    pub fn covariance_m2(&self, commanded: &Posture, conditions: &Conditions) -> Matrix3<f64> {
        self.spread_m2(Angles::Commanded, commanded, conditions)
    }

    /// The same when encoders read a posture.
    pub fn covariance_by_encoders_m2(&self, encoders: &Posture, conditions: &Conditions) -> Matrix3<f64> {
        self.spread_m2(Angles::Encoder, encoders, conditions)
    }

    fn spread_m2(&self, angles: Angles, posture: &Posture, conditions: &Conditions) -> Matrix3<f64> {
        let place = |effects: &[Present]| {
            Some(self.place_with(angles, posture, conditions, effects).translation.vector)
        };
        of_values(&self.parts.free, place).expect("an arm has a place with whatever effects")
    }

    /// What must be commanded so that the real tip gets to the target, see [`DeviatedArm::reach`].
    ///
    /// # Errors
    /// As [`Solver::solve`].
    pub fn reach(
        &self,
        target: &Target,
        start: &Posture,
        options: &Options,
        conditions: &Conditions,
    ) -> Result<Reached, IkError> {
        let start_rad = start.of(self.joints());
        self.parts.deviated.reach(&self.parts.solver, target, &start_rad, options, conditions)
    }
}

fn origin(pose: &Pose<Robot, Tip>) -> Point<Robot> {
    let at = pose.translation_m();
    Point::new(at.x, at.y, at.z)
}
