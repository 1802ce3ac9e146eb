//! The hand is brought over the object by rendering it, as M5 does: high over the object and then low,
//! where less of the way is left on which the arm's error changes. What is found updates what is known of
//! that error, weighted by how sure each is.

use nalgebra::{Matrix3, Vector3};
use plumbline_model::robot::{JointIndex, Posture};

use super::align::{FARTHEST_M, FoundHand, HandFinder, HandMissing, SPEED_RAD_S, near_enough};
use super::sure::{over_table_m, sure_enough};
use super::{Chosen, End, Running, STILL_S};
use crate::body::Sight;
use crate::plan::GraspPlan;
use crate::record::{Failure, Step};

/// Seen low and nearer than this, the hand is lowered straight down, m: smaller moves than the play of the
/// gears end somewhere by chance, and nobody would have looked where.
const NEAR_M: f64 = 0.001;
/// A correction that the hand can reach to within this is one, m.
const REACHED_M: f64 = 0.002;
/// A hand that is known less well than this over the table is looked at once more, m.
const SURE_M: f64 = 0.002;
/// At the end of its reach the hand may stay so far from where it belongs, m; it is sent there with the
/// largest of these shares of what is missing that it reaches.
const SHORT_M: f64 = 0.004;
const SHARES: [f64; 5] = [1.0, 0.75, 0.5, 0.25, 0.0];
/// The second look and those after it are so high over where the hand closes, m: no finger reaches the
/// object yet.
const LOW_M: f64 = 0.04;
/// Looks at the hand, at most.
const LOOKS: usize = 5;
/// Standard deviation of the height that its model has over the table, m: both were taught by touching.
/// What the eyes say of a height is off by millimeters as their mount and lenses are, and off the same way
/// at every look, while the object's height is the table's: a hand that is believed to be higher or lower
/// than it is to the object seems to be beside it. So the arm's word counts for more.
const ARM_HEIGHT_SIGMA_M: f64 = 0.001;
/// It changes with the posture: standard deviation per axis, m, for moving at all (play of the gears), and
/// for a joint that turns by a radian.
const PLAY_SIGMA_M: f64 = 0.0005;
const TURN_SIGMA_M: f64 = 0.008;

/// A servo that stands farther than this short of where it was sent is held up by something, rad: what gives
/// way under the arm's own weight and what rubs is less than half of it.
const HELD_UP_RAD: f64 = 0.08;

/// What is known of an arm's error: real palm less where the model has it.
struct ArmError {
    m: Vector3<f64>,
    covariance_m2: Matrix3<f64>,
    /// What was known of it before the hand was looked at, m².
    by_arm_m2: Matrix3<f64>,
    /// What each look has made of that, m.
    looks_m: Vec<Vector3<f64>>,
}

impl ArmError {
    fn unseen(covariance_m2: Matrix3<f64>) -> Self {
        Self { m: Vector3::zeros(), covariance_m2, by_arm_m2: covariance_m2, looks_m: vec![] }
    }

    /// One more look. What the eyes are wrong by (how the hand is shaped, how lenses bend the rim of an
    /// image) is nearly the same at each, so looks are averaged against their noise, and the arm's word
    /// counts as much after five of them as after the first.
    fn looked(&mut self, palm_off_m: Vector3<f64>, covariance_m2: Matrix3<f64>) {
        self.looks_m.push(palm_off_m);
        self.m = self.looks_m.iter().sum::<Vector3<f64>>() / self.looks_m.len() as f64;
        self.covariance_m2 = covariance_m2;
    }

    /// A move makes all of it a little less known.
    fn moved(&mut self, drift_m2: f64) {
        self.covariance_m2 += Matrix3::identity() * drift_m2;
        self.by_arm_m2 += Matrix3::identity() * drift_m2;
    }
}

/// Where the hand of an attempt is.
struct Over {
    plan: GraspPlan,
    /// From above the object to where it is looked at from low, once it is there.
    lowered: Option<Vec<Posture>>,
}

impl Running<'_> {
    pub(super) fn align_by_rendering(
        &mut self,
        plan: GraspPlan,
        chosen: &Chosen,
        before: &Sight,
    ) -> Result<GraspPlan, End> {
        let Some(mut finder) = self.grasper.arm.finder.take() else { return Ok(plan) };
        let done = self.by_rendering(finder.as_mut(), plan, chosen, before);
        self.grasper.arm.finder = Some(finder);
        done
    }

    fn by_rendering(
        &mut self,
        finder: &mut dyn HandFinder,
        plan: GraspPlan,
        chosen: &Chosen,
        before: &Sight,
    ) -> Result<GraspPlan, End> {
        let commanded = self.body.commanded()?;
        let arm = self.grasper.arm.known.arm();
        let covariance_m2 = arm.covariance_m2(&commanded) + Matrix3::identity() * arm.rest_sigma_m().powi(2);
        let mut error = ArmError::unseen(covariance_m2);
        let mut over = Over { plan, lowered: None };
        for look in 1..=LOOKS {
            let Some(missing_m) = self.look_at_hand(finder, &mut error, &over.plan, before)? else { break };
            let sigma_m = over_table_m(&error.covariance_m2);
            let there = missing_m < NEAR_M && (sigma_m < SURE_M || look == LOOKS);
            if there && over.lowered.is_some() {
                over.plan = self.nudged(over.plan, &error.m);
                break;
            }
            self.hold_before(Step::Align)?;
            over = self.corrected(over, &mut error)?;
            over = self.go_over(over, &mut error)?;
        }
        sure_enough(&chosen.covariance_m2, &error.covariance_m2)?;
        Ok(over.plan)
    }

    /// Looks at the hand: how far it is from where it belongs, over the table, m. `None`: it is not found.
    fn look_at_hand(
        &mut self,
        finder: &mut dyn HandFinder,
        error: &mut ArmError,
        plan: &GraspPlan,
        before: &Sight,
    ) -> Result<Option<f64>, End> {
        self.body.wait(STILL_S)?;
        let sight = self.body.look()?;
        let commanded = self.body.commanded()?;
        self.not_held_up(&sight.posture, &commanded)?;
        let robot_from_palm = self.grasper.arm.known.arm().robot_from_palm(&commanded);
        let modeled = robot_from_palm.translation_m();
        let sent = modeled + error.m;
        let knowledge = &self.grasper.knowledge;
        let covariance_m2 = &error.by_arm_m2;
        let found = finder.find(knowledge, before, &sight, &commanded, &robot_from_palm, covariance_m2);
        self.watch.saw(Step::Align, &sight, &[]);
        let found = match found {
            Ok(found) => found,
            Err(HandMissing(why)) => {
                self.looked(&sight, sent, Err(why), None, Some(over_table_m(&error.covariance_m2)));
                return Ok(None);
            }
        };
        let (palm, covariance_m2) = at_height(&found, modeled.z);
        error.looked(palm - modeled, covariance_m2);
        let palm = modeled + error.m;
        let missing_m = (plan.palm_m - palm).xy().norm();
        self.looked(&sight, sent, Ok(palm), Some(missing_m), Some(over_table_m(&error.covariance_m2)));
        if error.m.norm() > FARTHEST_M {
            let why = "the hand seems to be far from where the model has it: touch again in Touch";
            return Err(End::Failed(Failure::HandWrong, why.to_owned()));
        }
        Ok(Some(missing_m))
    }

    /// An arm that something holds up is not pushed on.
    fn not_held_up(&self, encoders: &Posture, commanded: &Posture) -> Result<(), End> {
        let arm = self.grasper.arm.known.arm();
        let short = |joint: &&JointIndex| (encoders[**joint] - commanded[**joint]).abs() > HELD_UP_RAD;
        let Some(joint) = arm.joints().iter().find(short) else { return Ok(()) };
        let name = arm.rig().servo_of(*joint).map_or("a joint", |servo| servo.title.as_str());
        let why = format!(
            "{name} stands {:.0}° short of where it was sent: something holds the arm up; look what it touches, or put the object elsewhere",
            (encoders[*joint] - commanded[*joint]).abs().to_degrees()
        );
        Err(End::Failed(Failure::ReachWrong, why))
    }

    /// The plan with the arm's error undone. Where the hand cannot be sent so with this heading, nearly
    /// there is good enough, else it goes up again and another heading is taken.
    fn corrected(&mut self, over: Over, error: &mut ArmError) -> Result<Over, End> {
        near_enough(&error.m)?;
        let error_m = error.m;
        let nearly = |running: &Self, plan: &GraspPlan, short_m: f64| {
            let planner = running.grasper.planner(running.order.method);
            SHARES
                .into_iter()
                .filter(|share| (1.0 - share) * error_m.xy().norm() <= short_m)
                .find_map(|share| planner.again(plan, &(-share * error_m)).ok())
        };
        if let Some(plan) = nearly(self, &over.plan, REACHED_M) {
            let Some(lowered) = over.lowered else { return Ok(Over { plan, lowered: None }) };
            return Ok(Over { plan: plan.from_low(LOW_M).1, lowered: Some(lowered) });
        }
        if let Some(lowered) = over.lowered {
            let up: Vec<_> = lowered.into_iter().rev().collect();
            self.moved(&up, error)?;
        }
        let from = self.body.commanded()?;
        let standing = over.plan.standing;
        match self.grasper.planner(self.order.method).plan(&standing, &-error.m, &from) {
            Ok(plan) => {
                self.planned(&plan);
                self.moved(&plan.approach, error)?;
                Ok(Over { plan, lowered: None })
            }
            Err(barred) => {
                let plan = nearly(self, &over.plan, SHORT_M).ok_or(barred)?;
                Ok(Over { plan, lowered: None })
            }
        }
    }

    /// What is left is undone on the way down, where the joints turn anyway.
    fn nudged(&self, plan: GraspPlan, error_m: &Vector3<f64>) -> GraspPlan {
        match self.grasper.planner(self.order.method).again(&plan, &-error_m) {
            Ok(again) => GraspPlan { approach: plan.approach, ..again.from_low(LOW_M).1 },
            Err(_) => plan,
        }
    }

    /// To where the hand is looked at next: low over the object.
    fn go_over(&mut self, over: Over, error: &mut ArmError) -> Result<Over, End> {
        let Over { plan, lowered } = over;
        if let Some(lowered) = lowered {
            self.moved(plan.approach.last().map_or(&[], std::slice::from_ref), error)?;
            return Ok(Over { plan, lowered: Some(lowered) });
        }
        let (lowered, plan) = plan.from_low(LOW_M);
        self.moved(&lowered, error)?;
        Ok(Over { plan, lowered: Some(lowered) })
    }

    /// Moves, which makes the arm's error a little less known.
    fn moved(&mut self, way: &[Posture], error: &mut ArmError) -> Result<(), End> {
        let from = self.body.commanded()?;
        let turned_rad = way.last().map_or(0.0, |to| from.distance_rad(to));
        self.follow(Step::Align, way, SPEED_RAD_S)?;
        let drift_m2 = PLAY_SIGMA_M.powi(2) + (TURN_SIGMA_M * turned_rad).powi(2);
        error.moved(drift_m2);
        Ok(())
    }
}

/// The hand that was found, with what the arm's model says of its height.
fn at_height(found: &FoundHand, height_m: f64) -> (Vector3<f64>, Matrix3<f64>) {
    let (palm, covariance_m2) = (found.palm.coords.coords, found.covariance_m2);
    let gain = covariance_m2.column(2) / (covariance_m2[(2, 2)] + ARM_HEIGHT_SIGMA_M.powi(2));
    let row = covariance_m2.row(2).into_owned();
    (palm - gain * (palm.z - height_m), covariance_m2 - gain * row)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_eyes_are_wrong_by_at_every_look_does_not_add_up() {
        let by_arm_m2 = Matrix3::identity() * 0.002f64.powi(2);
        let mut error = ArmError::unseen(by_arm_m2);
        // Each look on its own, against the arm's word: half of 6 mm that are not there.
        for _ in 0..LOOKS {
            error.looked(Vector3::new(0.0, 0.003, 0.0), 0.5 * by_arm_m2);
        }
        assert!((error.m - Vector3::new(0.0, 0.003, 0.0)).norm() < 1e-12, "{}", error.m);
        assert_eq!(error.by_arm_m2, by_arm_m2);
        // Noise is averaged.
        error.looked(Vector3::new(0.0, -0.003, 0.0), 0.5 * by_arm_m2);
        assert!((error.m.y - 0.002).abs() < 1e-12, "{}", error.m);
        // A move makes the arm less sure, and what is known of it now.
        error.moved(0.001f64.powi(2));
        assert!(error.by_arm_m2[(0, 0)] > by_arm_m2[(0, 0)] && error.covariance_m2[(0, 0)] > 2e-6);
    }
}
