//! How a hand was left: around something, low between things, or in the picture.

use plumbline_grasp::{Failure, Halt, Hand, Step};
use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::command::HandStep;
use super::steps::NoStep;
use super::view::{AttemptView, GraspOutcome, HandWaits};
use crate::robot::view::{JointView, MotionState, RobotView};

/// An arm whose joints stand elsewhere by more than this was moved since, rad.
const MOVED_RAD: f64 = 0.2;
/// An arm that is farther from home stands in the picture, rad.
const AWAY_RAD: f64 = 0.3;
/// Fingers that are bent by more are not open, rad.
const BENT_RAD: f64 = 0.25;

/// How a hand was left, and where the joints were then.
#[derive(Clone, Debug)]
pub(super) struct Waits {
    of: Hand,
    hand: HandWaits,
    at: Option<Posture>,
}

impl Waits {
    /// After an attempt; `before`: how it was left then. `None`: it holds what it lifted, or was left at home.
    pub fn after_attempt(attempt: &AttemptView, before: Option<&Self>, robot: &RobotView) -> Option<Self> {
        let is_ended = match attempt.outcome.as_ref()? {
            GraspOutcome::Success => return None,
            GraspOutcome::Failed { failure, .. } => {
                matches!(failure, Failure::Halted | Failure::EyesLost)
            }
            GraspOutcome::Refused { .. } => false,
        };
        let hand = match attempt.reached? {
            // The arm has not moved.
            Step::Ready | Step::Look | Step::Plan => return before.cloned(),
            Step::Lower if is_ended => HandWaits::Low,
            Step::Close if is_ended => HandWaits::Around,
            Step::Lift | Step::Check if is_ended => HandWaits::Carries,
            _ => HandWaits::InView,
        };
        Some(Self { of: attempt.hand, hand, at: robot.measured.clone() })
    }

    /// When the program begins, after its last attempt: what was held then may be in the hand still, as long as its fingers
    /// are not open.
    pub fn after_restart(last: &AttemptView) -> Option<Self> {
        let may_hold = match &last.outcome {
            Some(_) => last.is_success(),
            None => matches!(last.reached, Some(Step::Close | Step::Lift | Step::Check)),
        };
        may_hold.then_some(Self { of: last.hand, hand: HandWaits::Carries, at: None })
    }

    /// After a step of a hand; `before`: how it was left then.
    pub fn after_step(
        (step, done): (HandStep, &Result<(), NoStep>),
        before: Option<&Self>,
        (rig, of): (&Rig, Hand),
        robot: &RobotView,
    ) -> Option<Self> {
        // The other hand goes on to hold what it may hold.
        if let Some(other) = before.filter(|before| before.of != of && before.hand.may_hold()) {
            return Some(other.clone());
        }
        let was = before.map(|before| before.hand);
        let lets_go = matches!(step, HandStep::Open | HandStep::Place | HandStep::Close);
        let hand = match (step, done) {
            (_, Err(why)) if lets_go && had_begun(why) => HandWaits::Around,
            (_, Err(_)) => was?,
            // It goes home as it is: what it is around comes along.
            (HandStep::Home | HandStep::Lift, Ok(())) if was.is_some_and(HandWaits::may_hold) => {
                HandWaits::Carries
            }
            (HandStep::Give, Ok(())) => HandWaits::Offers,
            (_, Ok(())) if !is_away(rig, of, robot) => return None,
            (HandStep::Close, Ok(())) => HandWaits::Around,
            // Opened around what it was around.
            (HandStep::Open, Ok(())) if was == Some(HandWaits::Around) => HandWaits::Low,
            (_, Ok(())) => HandWaits::InView,
        };
        Some(Self { of, hand, at: robot.measured.clone() })
    }

    /// The hand that may hold something.
    pub fn may_hold(&self) -> Option<Hand> {
        self.hand.may_hold().then_some(self.of)
    }

    /// After a look at the fingers: once they were open they are around nothing, however they are bent later.
    pub fn seen(self, rig: &Rig, robot: &RobotView) -> Self {
        let fingers = rig.arm(self.of.name()).map(|arm| &arm.hand);
        let known = fingers.and_then(|hand| robot.known(hand).map(|measured| (hand, measured)));
        let is_open = |(hand, measured): (&Vec<JointIndex>, &Posture)| {
            hand.iter().all(|joint| measured[*joint].abs() <= BENT_RAD)
        };
        let hand = match self.hand {
            held if !held.may_hold() || !known.is_some_and(is_open) => held,
            HandWaits::Around => HandWaits::Low,
            _ => HandWaits::InView,
        };
        Self { hand, ..self }
    }

    /// How it stands now. Fingers that may be around something stay so until they are open, wherever the arm went: limp
    /// joints sink, and hold what they are around all the same.
    pub fn now(&self, rig: &Rig, robot: &RobotView) -> Option<HandWaits> {
        let Some((arm, measured)) = rig.arm(self.of.name()).zip(robot.measured.as_ref()) else {
            return Some(self.hand);
        };
        let off_rad = |was: &Posture| {
            arm.joints.iter().map(|joint| (was[*joint] - measured[*joint]).abs()).fold(0.0, f64::max)
        };
        let stands = self.at.as_ref().is_some_and(|was| off_rad(was) < MOVED_RAD);
        if self.hand.may_hold() && arm.hand.iter().any(|joint| measured[*joint].abs() > BENT_RAD) {
            // Held out where it was brought, nowhere else.
            let was_moved = self.hand == HandWaits::Offers && !stands;
            return Some(if was_moved { HandWaits::Carries } else { self.hand });
        }
        match self.hand {
            HandWaits::Around | HandWaits::Low if stands => Some(HandWaits::Low),
            _ => is_away(rig, self.of, robot).then_some(HandWaits::InView),
        }
    }
}

/// Whether a step that was not made had begun.
fn had_begun(why: &NoStep) -> bool {
    matches!(why, NoStep::Halted(Halt::Stopped | Halt::Cancelled | Halt::Lost(_)) | NoStep::Blocked(_))
}

/// Whether an arm holds, and not at home. One that is not known, or limp, cannot be brought there.
pub(super) fn stands_in_view(rig: &Rig, hand: Hand, robot: &RobotView) -> bool {
    let Some(arm) = rig.arm(hand.name()) else { return false };
    let is_limp = |joint: &&JointView| arm.joints.contains(&joint.joint) && joint.has_to_be_held();
    matches!(robot.motion, MotionState::Holding { .. })
        && robot.known(&arm.joints).is_some()
        && !robot.joints.iter().any(|joint| is_limp(&joint))
        && is_away(rig, hand, robot)
}

/// Whether an arm is known to stand elsewhere than at home.
fn is_away(rig: &Rig, hand: Hand, robot: &RobotView) -> bool {
    let Some((arm, measured)) = rig.arm(hand.name()).zip(robot.measured.as_ref()) else { return false };
    let home = rig.home();
    arm.joints.iter().any(|joint| (measured[*joint] - home[*joint]).abs() > AWAY_RAD)
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::default_rig;

    use super::*;

    /// The right elbow turned so far from home, the fingers bent so far.
    fn at(turned_rad: f64, bent_rad: f64) -> RobotView {
        let rig = default_rig();
        let elbow = rig.description.find_joint("r_elbow_y").expect("an elbow");
        let hand = &rig.arm("right").expect("an arm").hand;
        let home = rig.home();
        let measured =
            home.with(&[elbow], &[home[elbow] + turned_rad]).with(hand, &vec![bent_rad; hand.len()]);
        RobotView { measured: Some(measured), ..RobotView::default() }
    }

    fn attempt(reached: Step, failure: Failure) -> AttemptView {
        AttemptView {
            reached: Some(reached),
            outcome: Some(GraspOutcome::Failed { failure, why: String::new() }),
            ..super::super::held::tests::attempt()
        }
    }

    fn after(
        step: HandStep,
        done: Result<(), NoStep>,
        before: Option<&Waits>,
        robot: &RobotView,
    ) -> Option<Waits> {
        Waits::after_step((step, &done), before, (&default_rig(), Hand::Right), robot)
    }

    fn now(waits: Option<&Waits>, robot: &RobotView) -> Option<HandWaits> {
        waits.and_then(|waits| waits.now(&default_rig(), robot))
    }

    #[test]
    fn a_hand_that_was_stopped_around_a_thing_is_opened_lifted_and_brought_home() {
        let (closed, open) = (at(0.6, 0.8), at(0.6, 0.0));
        let of = |step, failure, robot| {
            now(Waits::after_attempt(&attempt(step, failure), None, robot).as_ref(), robot)
        };
        assert_eq!(of(Step::Close, Failure::Halted, &closed), Some(HandWaits::Around));
        assert_eq!(of(Step::Lift, Failure::Halted, &closed), Some(HandWaits::Carries));
        assert_eq!(of(Step::Lower, Failure::Halted, &open), Some(HandWaits::Low));
        assert_eq!(of(Step::Align, Failure::Halted, &open), Some(HandWaits::InView));
        assert_eq!(of(Step::Check, Failure::Slipped, &closed), Some(HandWaits::InView), "around nothing");
        assert_eq!(of(Step::Look, Failure::NotSeen, &open), None, "nothing has moved");

        let stopped = Waits::after_attempt(&attempt(Step::Close, Failure::Halted), None, &closed);
        let opened = after(HandStep::Open, Ok(()), stopped.as_ref(), &open);
        assert_eq!(now(opened.as_ref(), &open), Some(HandWaits::Low));
        let lifted = after(HandStep::Lift, Ok(()), opened.as_ref(), &open);
        assert_eq!(now(lifted.as_ref(), &open), Some(HandWaits::InView));
        let unseen = Waits::after_attempt(&attempt(Step::Look, Failure::NotSeen), lifted.as_ref(), &open);
        assert_eq!(now(unseen.as_ref(), &open), Some(HandWaits::InView), "it did not move");
        assert!(after(HandStep::Home, Ok(()), lifted.as_ref(), &at(0.0, 0.0)).is_none());
    }

    #[test]
    fn what_a_hand_closed_around_and_lifted_is_put_down() {
        let (shut, open) = (at(0.6, 0.8), at(0.6, 0.0));
        let closed = after(HandStep::Close, Ok(()), None, &shut);
        assert_eq!(now(closed.as_ref(), &shut), Some(HandWaits::Around));
        let lifted = after(HandStep::Lift, Ok(()), closed.as_ref(), &shut);
        assert_eq!(now(lifted.as_ref(), &shut), Some(HandWaits::Carries));
        let home = after(HandStep::Home, Ok(()), lifted.as_ref(), &at(0.0, 0.8));
        assert_eq!(now(home.as_ref(), &at(0.0, 0.8)), Some(HandWaits::Carries), "it comes along");
        let opened = after(HandStep::Open, Ok(()), home.as_ref(), &at(0.0, 0.0));
        assert_eq!(now(opened.as_ref(), &at(0.0, 0.0)), None);
        let down = after(HandStep::Place, Ok(()), lifted.as_ref(), &open);
        assert_eq!(now(down.as_ref(), &open), Some(HandWaits::InView));
    }

    #[test]
    fn what_was_held_when_the_program_ended_may_be_held_until_the_hand_is_open() {
        let held =
            AttemptView { outcome: Some(GraspOutcome::Success), ..attempt(Step::Check, Failure::Halted) };
        let waits = Waits::after_restart(&held);
        assert_eq!(now(waits.as_ref(), &at(0.0, 0.8)), Some(HandWaits::Carries));
        assert_eq!(now(waits.as_ref(), &at(0.0, 0.0)), None, "it was opened meanwhile");
        let broken_off = |reached| AttemptView { outcome: None, ..attempt(reached, Failure::Halted) };
        assert!(Waits::after_restart(&broken_off(Step::Lift)).is_some());
        assert!(Waits::after_restart(&broken_off(Step::Lower)).is_none(), "the hand was open");
        assert!(Waits::after_restart(&attempt(Step::Check, Failure::Slipped)).is_none());
    }

    #[test]
    fn what_is_held_out_is_so_until_the_hand_is_open_or_goes_elsewhere() {
        let (there, open, elsewhere) = (at(0.6, 0.8), at(0.6, 0.0), at(1.2, 0.8));
        let given = after(HandStep::Give, Ok(()), None, &there);
        assert_eq!(now(given.as_ref(), &there), Some(HandWaits::Offers));
        assert_eq!(now(given.as_ref(), &elsewhere), Some(HandWaits::Carries));
        let opened = after(HandStep::Open, Ok(()), given.as_ref(), &open);
        assert_eq!(now(opened.as_ref(), &open), Some(HandWaits::InView));
        let home = after(HandStep::Home, Ok(()), given.as_ref(), &at(0.0, 0.8));
        assert_eq!(now(home.as_ref(), &at(0.0, 0.8)), Some(HandWaits::Carries), "it comes along");
    }

    #[test]
    fn a_step_of_one_hand_forgets_nothing_of_the_other() {
        let right = Waits { of: Hand::Right, hand: HandWaits::Carries, at: None };
        let home = Waits::after_step(
            (HandStep::Home, &Ok(())),
            Some(&right),
            (&default_rig(), Hand::Left),
            &at(0.0, 0.8),
        );
        assert_eq!(home.and_then(|waits| waits.may_hold()), Some(Hand::Right));
    }

    /// Fingers are bent to touch, too: once they were seen open they are around nothing.
    #[test]
    fn what_was_seen_open_holds_nothing_however_the_fingers_are_bent_later() {
        let (open, bent) = (at(0.0, 0.0), at(0.6, 0.8));
        let carries = || Waits { of: Hand::Right, hand: HandWaits::Carries, at: None };
        assert_eq!(now(Some(&carries().seen(&default_rig(), &bent)), &bent), Some(HandWaits::Carries));
        let seen = carries().seen(&default_rig(), &open);
        assert_eq!(now(Some(&seen), &bent), Some(HandWaits::InView));
        assert!(seen.may_hold().is_none());
        // What is not known is not open.
        let unknown = RobotView { unknown: default_rig().arms[0].hand.clone().into(), ..open };
        assert!(carries().seen(&default_rig(), &unknown).may_hold().is_some());
    }

    #[test]
    fn a_step_that_was_stopped_may_hold_and_one_that_never_began_changes_nothing() {
        let robot = at(0.6, 0.8);
        let of = |why: NoStep| now(after(HandStep::Place, Err(why), None, &robot).as_ref(), &robot);
        assert_eq!(of(Halt::Stopped.into()), Some(HandWaits::Around));
        assert_eq!(of(NoStep::Blocked("the thumb stays behind".to_owned())), Some(HandWaits::Around));
        assert_eq!(of(NoStep::NotGrasped), None);
    }

    /// Joints that went limp and are held again are elsewhere, and the fingers around the thing still.
    #[test]
    fn fingers_that_may_hold_do_so_until_they_are_open_wherever_the_arm_went() {
        let waits = Waits::after_attempt(&attempt(Step::Close, Failure::Halted), None, &at(0.6, 0.8));
        for turned_rad in [0.65, 0.1, 1.2, 0.0] {
            assert_eq!(now(waits.as_ref(), &at(turned_rad, 0.8)), Some(HandWaits::Around), "{turned_rad}");
        }
        assert_eq!(now(waits.as_ref(), &at(0.65, 0.0)), Some(HandWaits::Low), "opened by hand");
        assert_eq!(now(waits.as_ref(), &at(1.2, 0.0)), Some(HandWaits::InView));
        assert_eq!(now(waits.as_ref(), &at(0.0, 0.0)), None, "it is home");
        assert_eq!(now(waits.as_ref(), &RobotView::default()), Some(HandWaits::Around), "nobody saw it move");
        assert!(after(HandStep::Open, Ok(()), None, &at(0.0, 0.0)).is_none());
        let holds =
            |turned_rad| RobotView { motion: MotionState::Holding { why: None }, ..at(turned_rad, 0.0) };
        let rig = default_rig();
        assert!(
            stands_in_view(&rig, Hand::Right, &holds(0.6)) && !stands_in_view(&rig, Hand::Right, &holds(0.1))
        );
        assert!(!stands_in_view(&rig, Hand::Left, &holds(0.6)), "the other arm is home");
        assert!(!stands_in_view(&rig, Hand::Right, &at(0.6, 0.0)), "nobody knows whether it holds");
        let over = after(HandStep::Place, Ok(()), None, &at(0.6, 0.0));
        assert_eq!(now(over.as_ref(), &at(0.6, 0.0)), Some(HandWaits::InView), "over what it put down");
    }
}
