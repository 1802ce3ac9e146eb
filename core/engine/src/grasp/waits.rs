//! How a hand was left: around something, low between things, or in the picture.

use plumbline_grasp::{Failure, Halt, Hand, Step};
use plumbline_model::robot::{Posture, Rig};

use super::command::HandStep;
use super::steps::NoStep;
use super::view::{AttemptView, GraspOutcome, HandWaits};
use crate::robot::view::RobotView;

/// An arm whose joints stand elsewhere by more than this was moved since, rad.
const MOVED_RAD: f64 = 0.2;
/// An arm that is farther from home stands in the picture, rad.
const AWAY_RAD: f64 = 0.3;

/// How a hand was left, and where the joints were then.
#[derive(Clone, Debug)]
pub(super) struct Waits {
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
        Some(Self { hand, at: robot.measured.clone() })
    }

    /// After a step of a hand; `before`: how it was left then.
    pub fn after_step(
        (step, done): (HandStep, &Result<(), NoStep>),
        before: Option<&Self>,
        (rig, hand): (&Rig, Hand),
        robot: &RobotView,
    ) -> Option<Self> {
        let was = before.map(|before| before.hand);
        let lets_go = matches!(step, HandStep::Open | HandStep::Place | HandStep::Give | HandStep::Close);
        let hand = match (step, done) {
            (_, Err(why)) if lets_go && had_begun(why) => HandWaits::Around,
            (_, Err(_)) => was?,
            (HandStep::Home, Ok(())) => return None,
            (_, Ok(())) if !is_away(rig, hand, robot) => return None,
            (HandStep::Close, Ok(())) => HandWaits::Around,
            // Opened around what it was around.
            (HandStep::Open, Ok(())) if was == Some(HandWaits::Around) => HandWaits::Low,
            (HandStep::Lift, Ok(())) if matches!(was, Some(HandWaits::Around | HandWaits::Carries)) => {
                HandWaits::Carries
            }
            (_, Ok(())) => HandWaits::InView,
        };
        Some(Self { hand, at: robot.measured.clone() })
    }

    /// How it was left, unless it was moved since.
    pub fn now(&self, robot: &RobotView) -> Option<HandWaits> {
        let was = self.at.as_ref().zip(robot.measured.as_ref());
        was.is_none_or(|(was, is)| was.distance_rad(is) < MOVED_RAD).then_some(self.hand)
    }
}

/// Whether a step that was not made had begun.
fn had_begun(why: &NoStep) -> bool {
    matches!(why, NoStep::Halted(Halt::Stopped | Halt::Cancelled | Halt::Lost(_)) | NoStep::Blocked(_))
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

    /// The right elbow turned so far from home.
    fn at(turned_rad: f64) -> RobotView {
        let rig = default_rig();
        let elbow = rig.description.find_joint("r_elbow_y").expect("an elbow");
        let home = rig.home();
        let measured = home.with(&[elbow], &[home[elbow] + turned_rad]);
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

    #[test]
    fn a_hand_that_was_stopped_around_a_thing_is_opened_lifted_and_brought_home() {
        let robot = at(0.6);
        let of = |step, failure| {
            Waits::after_attempt(&attempt(step, failure), None, &robot).and_then(|waits| waits.now(&robot))
        };
        assert_eq!(of(Step::Close, Failure::Halted), Some(HandWaits::Around));
        assert_eq!(of(Step::Lower, Failure::Halted), Some(HandWaits::Low));
        assert_eq!(of(Step::Align, Failure::Halted), Some(HandWaits::InView));
        assert_eq!(of(Step::Check, Failure::Slipped), Some(HandWaits::InView), "it closed around nothing");
        assert_eq!(of(Step::Look, Failure::NotSeen), None, "nothing has moved");

        assert_eq!(of(Step::Lift, Failure::Halted), Some(HandWaits::Carries));

        let stopped = Waits::after_attempt(&attempt(Step::Close, Failure::Halted), None, &robot);
        let opened = after(HandStep::Open, Ok(()), stopped.as_ref(), &robot);
        assert_eq!(opened.as_ref().and_then(|opened| opened.now(&robot)), Some(HandWaits::Low));
        let lifted = after(HandStep::Lift, Ok(()), opened.as_ref(), &robot);
        assert_eq!(lifted.as_ref().and_then(|lifted| lifted.now(&robot)), Some(HandWaits::InView));
        let unseen = Waits::after_attempt(&attempt(Step::Look, Failure::NotSeen), lifted.as_ref(), &robot);
        assert_eq!(unseen.and_then(|waits| waits.now(&robot)), Some(HandWaits::InView), "it did not move");
        assert!(after(HandStep::Home, Ok(()), lifted.as_ref(), &at(0.0)).is_none());
    }

    #[test]
    fn what_a_hand_closed_around_and_lifted_is_put_down() {
        let robot = at(0.6);
        let closed = after(HandStep::Close, Ok(()), None, &robot);
        assert_eq!(closed.as_ref().and_then(|closed| closed.now(&robot)), Some(HandWaits::Around));
        let lifted = after(HandStep::Lift, Ok(()), closed.as_ref(), &robot);
        assert_eq!(lifted.as_ref().and_then(|lifted| lifted.now(&robot)), Some(HandWaits::Carries));
        let down = after(HandStep::Place, Ok(()), lifted.as_ref(), &robot);
        assert_eq!(down.and_then(|down| down.now(&robot)), Some(HandWaits::InView));
    }

    #[test]
    fn a_step_that_was_stopped_may_hold_and_one_that_never_began_changes_nothing() {
        let robot = at(0.6);
        let of =
            |why: NoStep| after(HandStep::Place, Err(why), None, &robot).and_then(|waits| waits.now(&robot));
        assert_eq!(of(Halt::Stopped.into()), Some(HandWaits::Around));
        assert_eq!(of(NoStep::Blocked("the thumb stays behind".to_owned())), Some(HandWaits::Around));
        assert_eq!(of(NoStep::NotGrasped), None);
    }

    #[test]
    fn an_arm_that_was_moved_since_is_somewhere_else_and_one_at_home_waits_for_nothing() {
        let waits = Waits::after_attempt(&attempt(Step::Close, Failure::Halted), None, &at(0.6));
        let waits = waits.expect("around something");
        assert_eq!(waits.now(&at(0.65)), Some(HandWaits::Around));
        assert_eq!(waits.now(&at(0.1)), None);
        assert_eq!(waits.now(&RobotView::default()), Some(HandWaits::Around), "nobody saw it move");
        assert!(after(HandStep::Open, Ok(()), None, &at(0.0)).is_none());
        assert!(after(HandStep::Place, Ok(()), None, &at(0.6)).is_some(), "it stands over what it put down");
    }
}
