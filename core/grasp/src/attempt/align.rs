//! The hand is brought over the object by what the eyes see. M4 as published: the hand is detected, and
//! the target is shifted by a share of what is missing that halves with every iteration.

use nalgebra::{Matrix3, Vector2, Vector3};
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
/// A shift of the target beyond this is no correction any more, m.
pub(super) const FARTHEST_M: f64 = 0.08;
/// What is taken for the hand farther than this from where the arm's description has it is a forearm, or
/// something beside the robot, m: the published robot was off by up to 0.1 m, and a box tells a few more.
const HAND_WITHIN_M: f64 = 0.25;
/// Between looks, rad/s.
pub(super) const SPEED_RAD_S: f64 = 0.5;

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
            Method::M4 => self.align_as_published(plan, shift_m),
            _ => self.align_by_rendering(plan, chosen, before),
        }
    }

    fn align_as_published(
        &mut self,
        mut plan: GraspPlan,
        mut shift_m: Vector3<f64>,
    ) -> Result<GraspPlan, End> {
        for k in 1..=PUBLISHED_LOOKS {
            if k > 1 {
                self.hold_before(Step::Align)?;
            }
            let above = above(&plan)?;
            let shown = self.grasper.arm.described.palm_to_eyes(&above);
            self.follow(Step::Align, std::slice::from_ref(&shown), SPEED_RAD_S)?;
            self.body.wait(STILL_S)?;
            let sight = self.body.look()?;
            let arm = self.grasper.arm.described.arm();
            let (sent, turned) = (arm.palm(&above).coords.coords, arm.body(&shown));
            let hand = match self.detected_hand(&sight, turned)? {
                Ok(hand) => hand,
                Err(HandMissing(why)) => {
                    let said = format!("the hand was not found by the detector: {why}");
                    self.looked(&sight, sent, Err(why), None, None);
                    return Err(End::Failed(Failure::HandWrong, said));
                }
            };
            // The box is around the body of a palm that is turned to the eyes; how that lies to the palm
            // over the object, the description says.
            let palm = hand + (sent - turned);
            let wanted = plan.palm_m;
            let missing = (wanted - palm).xy();
            self.looked(&sight, sent, Ok(palm), Some(missing.norm()), None);
            if missing.norm() < PUBLISHED_NEAR_M {
                break;
            }
            shift_m += shift_after_m(&missing, k);
            plan = self.again(&plan, shift_m)?;
        }
        // Back with the palm down before it is lowered.
        let above = above(&plan)?;
        self.follow(Step::Align, std::slice::from_ref(&above), SPEED_RAD_S)?;
        Ok(plan)
    }

    /// Where the detector sees the hand that is nearest to where it may be; inside, why it sees none there.
    fn detected_hand(
        &mut self,
        sight: &Sight,
        near: Vector3<f64>,
    ) -> Result<Result<Vector3<f64>, HandMissing>, End> {
        let grasper = &mut *self.grasper;
        let seen = grasper.looker.look(sight, &grasper.knowledge)?;
        self.watch.saw(Step::Align, sight, &seen);
        let hands = seen.iter().filter(|thing| thing.class.ends_with("Hand"));
        let places = hands.filter_map(|thing| Some(thing.place.as_ref().ok()?.point().coords.coords));
        Ok(nearest_hand(places, &near))
    }

    /// The plan from above the same object, the palm sent elsewhere.
    fn again(&mut self, plan: &GraspPlan, shift_m: Vector3<f64>) -> Result<GraspPlan, End> {
        near_enough(&shift_m)?;
        Ok(self.grasper.planner(self.order.method).again(plan, &shift_m)?)
    }

    pub(super) fn looked(
        &mut self,
        sight: &Sight,
        sent: Vector3<f64>,
        hand: Result<Vector3<f64>, String>,
        distance_m: Option<f64>,
        sigma_m: Option<f64>,
    ) {
        let (hand_m, not_found) = match hand {
            Ok(hand) => (Some(hand.into()), None),
            Err(why) => (None, Some(why)),
        };
        let (at_s, sent_m) = (Some(sight.at_s), sent.into());
        let iteration = Iteration { at_s, sent_m, hand_m, not_found, distance_m, sigma_m };
        self.watch.aligned(&iteration);
        self.record.iterations.push(iteration);
    }
}

/// The place of a detected hand that is nearest to where the hand may be (robot frame, m), if it is near
/// enough to be that hand.
fn nearest_hand(
    places: impl Iterator<Item = Vector3<f64>>,
    near: &Vector3<f64>,
) -> Result<Vector3<f64>, HandMissing> {
    let off_m = |place: &Vector3<f64>| (place - near).norm();
    let nearest = places.min_by(|a, b| off_m(a).total_cmp(&off_m(b)));
    let nearest = nearest.ok_or_else(|| HandMissing("no hand was detected in both eyes".to_owned()))?;
    if off_m(&nearest) <= HAND_WITHIN_M {
        return Ok(nearest);
    }
    Err(HandMissing(format!(
        "what was taken for a hand is {:.0} mm from where the arm has it, more than {:.0} mm: look what else is \
         before the eyes",
        off_m(&nearest) * 1e3,
        HAND_WITHIN_M * 1e3
    )))
}

/// Published: after look `k` (from 1) the target is shifted by a share of what the hand misses over the table, 1/2^(k−1).
fn shift_after_m(missing_m: &Vector2<f64>, k: usize) -> Vector3<f64> {
    let share = 0.5f64.powi(k as i32 - 1);
    Vector3::new(missing_m.x, missing_m.y, 0.0) * share
}

/// Refuses to send a hand far from where it belongs by the model.
pub(super) fn near_enough(shift_m: &Vector3<f64>) -> Result<(), End> {
    if shift_m.xy().norm() <= FARTHEST_M {
        return Ok(());
    }
    let why = format!(
        "the eyes want the hand {:.0} mm from where it was sent, more than {:.0} mm: look what else is before them, or \
         calibrate how they sit in the head",
        shift_m.xy().norm() * 1e3,
        FARTHEST_M * 1e3
    );
    Err(End::Failed(Failure::HandWrong, why))
}

pub(super) fn above(plan: &GraspPlan) -> Result<Posture, End> {
    plan.above()
        .cloned()
        .ok_or_else(|| End::Refused("there is no way to above the object: plan again".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn m4_shifts_by_all_then_half_then_a_quarter_of_what_is_missing_and_never_in_height() {
        let missing = Vector2::new(0.04, -0.02);
        for (k, share) in [(1, 1.0), (2, 0.5), (3, 0.25), (PUBLISHED_LOOKS, 1.0 / 128.0)] {
            assert_eq!(
                shift_after_m(&missing, k),
                Vector3::new(0.04 * share, -0.02 * share, 0.0),
                "look {k}"
            );
        }
        // However long eyes are wrong by the same, the hand goes less than twice as far.
        let all: Vector3<f64> = (1..=PUBLISHED_LOOKS).map(|k| shift_after_m(&missing, k)).sum();
        let share = all.norm() / missing.norm();
        assert!((1.9..2.0).contains(&share), "{share}");
    }

    #[test]
    fn a_hand_that_would_be_sent_far_away_is_not_and_what_to_do_is_said() {
        let across = |m: f64| Vector3::new(0.6 * m, -0.8 * m, 0.5);
        assert!(near_enough(&across(FARTHEST_M - 1e-3)).is_ok(), "the height does not count");
        let Err(End::Failed(Failure::HandWrong, why)) = near_enough(&across(0.12)) else { panic!("far") };
        assert!(why.contains("120 mm from where it was sent, more than 80 mm: look"), "{why}");
    }

    #[test]
    fn a_forearm_that_is_taken_for_a_hand_far_from_the_arm_is_none_and_the_reason_is_said() {
        let sent = Vector3::new(0.3, -0.1, 0.15);
        let beside = |x_m: f64| sent + Vector3::new(x_m, 0.0, 0.0);
        // An arm that nothing was learned of is off by a hand's breadth.
        let found = nearest_hand([beside(-0.4), beside(0.12)].into_iter(), &sent);
        assert_eq!(found, Ok(beside(0.12)));
        let HandMissing(why) = nearest_hand([beside(-0.4), beside(0.3)].into_iter(), &sent).expect_err("far");
        assert!(why.contains("300 mm from where the arm has it, more than 250 mm"), "{why}");
        let HandMissing(why) = nearest_hand(std::iter::empty(), &sent).expect_err("there is none");
        assert!(why.contains("no hand was detected"), "{why}");
    }
}
