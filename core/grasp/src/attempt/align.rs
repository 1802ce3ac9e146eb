//! The hand is brought over the object by what the eyes see.
//!
//! M4 as published: the hand is detected, and the target is shifted by a share of what is missing that
//! halves with every iteration. M5: the measured offset of the rendered hand updates what is known of
//! the arm's error, weighted by how sure each is.

use nalgebra::{Matrix3, Vector3};
use plumbline_model::frame::Tip;
use plumbline_model::robot::Posture;
use plumbline_model::{Point, Pose, Robot};

use super::{Chosen, End, Running, STILL_S};
use crate::body::Sight;
use crate::knowledge::Knowledge;
use crate::method::Method;
use crate::plan::GraspPlan;
use crate::record::{Failure, Iteration, Step};

/// Published: the hand is over the object when it is nearer than this, m.
const PUBLISHED_NEAR_M: f64 = 0.01;
/// Looks at the hand, at most.
const PUBLISHED_LOOKS: usize = 8;
/// Ours: nearer than this it is lowered, m.
const NEAR_M: f64 = 0.002;
/// Looks at the hand, at most.
const LOOKS: usize = 4;
/// A shift of the target beyond this is no correction any more, m.
const FARTHEST_M: f64 = 0.08;
/// Hand and object together may be this uncertain over the table, m: about how far off a hand may be and
/// still hold what it closes around (`tests/tolerance.rs`).
const MOST_SIGMA_M: f64 = 0.010;
/// Standard deviation per axis of what the named effects leave of an arm's error, m.
const ARM_SIGMA_M: f64 = 0.004;
/// The arm's error changes by this much from posture to posture of the same grasp, m per axis.
const DRIFT_SIGMA_M: f64 = 0.0007;
/// Between looks, rad/s.
const SPEED_RAD_S: f64 = 0.5;

/// A hand that was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundHand {
    /// Place of the palm, robot frame.
    pub palm: Point<Robot>,
    /// Covariance of it, the prediction's included, m².
    pub covariance_m2: Matrix3<f64>,
}

/// The hand was not found, and why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct HandMissing(pub String);

/// Finds the hand in a pair of images from where the arm's model has it.
pub trait HandFinder: Send {
    /// `before`: a pair without the hand, the head as now; `robot_from_palm`: where the model has the
    /// palm, `covariance_m2`: how sure it is, m².
    ///
    /// # Errors
    /// Why it was not found.
    fn find(
        &mut self,
        knowledge: &Knowledge,
        before: &Sight,
        now: &Sight,
        commanded: &Posture,
        robot_from_palm: &Pose<Robot, Tip>,
        covariance_m2: &Matrix3<f64>,
    ) -> Result<FoundHand, HandMissing>;
}

impl Running<'_> {
    /// Brings the hand over the object; the plan from there.
    pub(super) fn align(
        &mut self,
        plan: GraspPlan,
        shift_m: Vector3<f64>,
        chosen: &Chosen,
        before: &Sight,
    ) -> Result<GraspPlan, End> {
        match self.order.method {
            Method::M4 => self.align_as_published(plan, shift_m, chosen),
            _ => self.align_by_rendering(plan, chosen, before),
        }
    }

    fn align_as_published(
        &mut self,
        mut plan: GraspPlan,
        mut shift_m: Vector3<f64>,
        chosen: &Chosen,
    ) -> Result<GraspPlan, End> {
        for k in 1..=PUBLISHED_LOOKS {
            let above = above(&plan)?;
            let shown = self.grasper.described.palm_to_eyes(&above);
            self.follow(Step::Align, std::slice::from_ref(&shown), SPEED_RAD_S)?;
            self.body.wait(STILL_S)?;
            let sight = self.body.look()?;
            let arm = self.grasper.described.arm();
            let (sent, turned) = (arm.palm(&above).coords.coords, arm.palm(&shown).coords.coords);
            let hand = self.detected_hand(&sight, turned)?;
            let Some(hand) = hand else {
                self.looked(sent, Err("no hand was detected in both eyes".to_owned()), None, None);
                let why = "the hand was not found by the detector".to_owned();
                return Err(End::Failed(Failure::HandWrong, why));
            };
            // Turning the palm to the eyes moves it; by how much, the description says.
            let palm = hand + (sent - turned);
            let wanted = plan.palm_m;
            let missing = (wanted - palm).xy();
            self.looked(sent, Ok(palm), Some(missing.norm()), None);
            if missing.norm() < PUBLISHED_NEAR_M {
                break;
            }
            let share = 0.5f64.powi(k as i32 - 1);
            shift_m += Vector3::new(missing.x, missing.y, 0.0) * share;
            plan = self.again(&plan, shift_m, chosen)?;
        }
        // Back with the palm down before it is lowered.
        let above = above(&plan)?;
        self.follow(Step::Align, std::slice::from_ref(&above), SPEED_RAD_S)?;
        Ok(plan)
    }

    /// Where the detector sees the hand that is nearest to where it may be.
    fn detected_hand(&mut self, sight: &Sight, near: Vector3<f64>) -> Result<Option<Vector3<f64>>, End> {
        let grasper = &mut *self.grasper;
        let seen = grasper.looker.look(sight, &grasper.knowledge)?;
        self.watch.saw(Step::Align, sight, &seen);
        let hands = seen.iter().filter(|thing| thing.class.ends_with("Hand"));
        let places = hands.filter_map(|thing| Some(thing.place.as_ref().ok()?.point().coords.coords));
        Ok(places.min_by(|a, b| (a - near).norm().total_cmp(&(b - near).norm())))
    }

    fn align_by_rendering(
        &mut self,
        mut plan: GraspPlan,
        chosen: &Chosen,
        before: &Sight,
    ) -> Result<GraspPlan, End> {
        let Some(mut finder) = self.grasper.finder.take() else { return Ok(plan) };
        let done = self.by_rendering(finder.as_mut(), &mut plan, chosen, before);
        self.grasper.finder = Some(finder);
        done.map(|()| plan)
    }

    fn by_rendering(
        &mut self,
        finder: &mut dyn HandFinder,
        plan: &mut GraspPlan,
        chosen: &Chosen,
        before: &Sight,
    ) -> Result<(), End> {
        // What is known of the arm's error here: real palm less where the model has it.
        let mut error_m = Vector3::zeros();
        let commanded = self.body.commanded()?;
        let mut covariance_m2 =
            self.grasper.known.arm().covariance_m2(&commanded) + Matrix3::identity() * ARM_SIGMA_M.powi(2);
        for look in 1..=LOOKS {
            self.body.wait(STILL_S)?;
            let sight = self.body.look()?;
            let commanded = self.body.commanded()?;
            let mut robot_from_palm = self.grasper.known.arm().robot_from_palm(&commanded);
            let modeled = robot_from_palm.translation_m();
            let sent = modeled + error_m;
            robot_from_palm.isometry.translation.vector = sent;
            let knowledge = &self.grasper.knowledge;
            match finder.find(knowledge, before, &sight, &commanded, &robot_from_palm, &covariance_m2) {
                Ok(found) => {
                    error_m = found.palm.coords.coords - modeled;
                    covariance_m2 = found.covariance_m2;
                    self.watch.saw(Step::Align, &sight, &[]);
                }
                Err(HandMissing(why)) => {
                    self.watch.saw(Step::Align, &sight, &[]);
                    self.looked(sent, Err(why), None, Some(over_table_m(&covariance_m2)));
                    return self.sure_enough(chosen, &covariance_m2);
                }
            }
            let wanted = plan.palm_m;
            let wanted_above = Vector3::new(wanted.x, wanted.y, modeled.z);
            let missing_m = (wanted_above - (modeled + error_m)).xy().norm();
            let sigma_m = over_table_m(&covariance_m2);
            self.looked(sent, Ok(modeled + error_m), Some(missing_m), Some(sigma_m));
            if error_m.norm() > FARTHEST_M {
                let why = "the hand seems to be far from where the model has it: touch again in Touch";
                return Err(End::Failed(Failure::HandWrong, why.to_owned()));
            }
            if missing_m < NEAR_M && look > 1 {
                break;
            }
            *plan = self.again(plan, -error_m, chosen)?;
            let above = above(plan)?;
            self.follow(Step::Align, std::slice::from_ref(&above), SPEED_RAD_S)?;
            covariance_m2 += Matrix3::identity() * DRIFT_SIGMA_M.powi(2);
        }
        self.sure_enough(chosen, &covariance_m2)
    }

    /// Refuses when hand and object together are not known well enough.
    fn sure_enough(&self, chosen: &Chosen, hand_m2: &Matrix3<f64>) -> Result<(), End> {
        let sigma_m = over_table_m(&(chosen.covariance_m2 + hand_m2));
        if sigma_m <= MOST_SIGMA_M {
            return Ok(());
        }
        Err(End::Refused(format!(
            "hand and object are known to {:.0} mm only, {:.0} mm are needed: calibrate the mount of the eyes, or name the effects in Gap",
            sigma_m * 1e3,
            MOST_SIGMA_M * 1e3
        )))
    }

    /// The plan from above the same object, the palm sent elsewhere.
    fn again(&mut self, plan: &GraspPlan, shift_m: Vector3<f64>, chosen: &Chosen) -> Result<GraspPlan, End> {
        if shift_m.xy().norm() > FARTHEST_M {
            let why = "the eyes want the hand far from where it was sent".to_owned();
            return Err(End::Failed(Failure::HandWrong, why));
        }
        let _ = chosen;
        Ok(self.grasper.planner(self.order.method).again(plan, &shift_m)?)
    }

    fn looked(
        &mut self,
        sent: Vector3<f64>,
        hand: Result<Vector3<f64>, String>,
        distance_m: Option<f64>,
        sigma_m: Option<f64>,
    ) {
        let (hand_m, not_found) = match hand {
            Ok(hand) => (Some(hand.into()), None),
            Err(why) => (None, Some(why)),
        };
        let iteration = Iteration { sent_m: sent.into(), hand_m, not_found, distance_m, sigma_m };
        self.watch.aligned(&iteration);
        self.record.iterations.push(iteration);
    }
}

fn above(plan: &GraspPlan) -> Result<Posture, End> {
    plan.above().cloned().ok_or_else(|| End::Refused("there is no way to above the object".to_owned()))
}

/// Standard deviation in the worst direction over the table, m.
fn over_table_m(covariance_m2: &Matrix3<f64>) -> f64 {
    let (a, b, c) = (covariance_m2[(0, 0)], covariance_m2[(0, 1)], covariance_m2[(1, 1)]);
    let (mean, half) = (0.5 * (a + c), 0.5 * (a - c));
    (mean + half.hypot(b)).max(0.0).sqrt()
}
