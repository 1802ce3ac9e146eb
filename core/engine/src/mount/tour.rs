//! Turning the head from pose to pose and waiting at each until it stands.
//!
//! Where joints were not heard for a moment, the head holds; the same pose is asked for again once they are.

use std::time::{Duration, Instant};

use plumbline_model::robot::{Posture, Rig};

use crate::robot::patience::{Look, Patience};
use crate::robot::view::{MotionState, RobotView};

/// After the head has come to rest, images are waited for that were taken this much later: the
/// camera's own delay, and what still swings.
const SETTLE: Duration = Duration::from_millis(450);
/// A servo under load stops a little short of its goal, rad.
const NEAR_RAD: f64 = 0.06;
/// A head that has not arrived by then will not.
const PATIENCE: Duration = Duration::from_secs(20);

/// Where the head is on its way through the planned poses.
#[derive(Clone, Debug)]
pub struct Tour {
    /// (pan, tilt) still to be seen, the next one last; rad.
    left: Vec<(f64, f64)>,
    phase: Phase,
    patience: Patience,
}

#[derive(Clone, Debug)]
enum Phase {
    /// To be told where to go.
    Ready,
    Going {
        to: (f64, f64),
        since: Instant,
        /// How often something had been refused before: an old refusal says nothing of this turn.
        refused: u64,
    },
    /// Joints were not heard, so the head holds on its way.
    Unheard {
        to: (f64, f64),
    },
    Standing {
        at: (f64, f64),
        since: Instant,
    },
}

/// What the tour wants next.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// Nothing, it waits.
    Nothing,
    /// Turn the head there (pan, tilt; rad).
    Turn(f64, f64),
    /// The head holds because joints were not heard; why, a sentence. It goes on by itself once they are.
    Wait(String),
    /// They are heard again: turn the head on there (pan, tilt; rad).
    TurnOn(f64, f64),
    /// All poses were seen.
    Finished,
    /// It cannot go on; a sentence.
    GiveUp(String),
}

impl Tour {
    /// Through these poses (pan, tilt; rad), in their order.
    pub fn new(poses: &[(f64, f64)]) -> Self {
        let left = poses.iter().rev().copied().collect();
        Self { left, phase: Phase::Ready, patience: Patience::default() }
    }

    /// Poses that are still to be seen.
    pub fn remaining(&self) -> usize {
        self.left.len() + usize::from(self.pose().is_some())
    }

    /// The pose that is under way.
    fn pose(&self) -> Option<(f64, f64)> {
        match self.phase {
            Phase::Ready => None,
            Phase::Going { to, .. } | Phase::Unheard { to } => Some(to),
            Phase::Standing { at, .. } => Some(at),
        }
    }

    /// Whether it waits until joints are heard.
    pub fn waits(&self) -> bool {
        matches!(self.phase, Phase::Unheard { .. })
    }

    /// The robot's state is new, or time has passed.
    pub fn step(&mut self, robot: &RobotView, rig: &Rig, now: Instant) -> Wish {
        if robot.stopped {
            return Wish::GiveUp(
                "STOP was pressed, so the head stays. The views taken so far are kept.".to_owned(),
            );
        }
        if !robot.connection.is_connected() {
            return Wish::GiveUp(
                "The connection to the robot is gone. The views taken so far are kept.".to_owned(),
            );
        }
        match self.phase {
            Phase::Ready => match self.left.pop() {
                None => Wish::Finished,
                Some(to) => {
                    self.go(to, robot, now);
                    Wish::Turn(to.0, to.1)
                }
            },
            Phase::Going { to, since, refused } => self.on_the_way(to, since, refused, robot, rig, now),
            Phase::Unheard { to } => self.look_again(to, robot, rig, now),
            Phase::Standing { .. } => Wish::Nothing,
        }
    }

    fn go(&mut self, to: (f64, f64), robot: &RobotView, now: Instant) {
        self.phase = Phase::Going { to, since: now, refused: robot.refused };
    }

    fn on_the_way(
        &mut self,
        to: (f64, f64),
        since: Instant,
        refused: u64,
        robot: &RobotView,
        rig: &Rig,
        now: Instant,
    ) -> Wish {
        let standing = matches!(robot.motion, MotionState::Holding { .. });
        if standing && is_there(to, robot, rig) {
            self.phase = Phase::Standing { at: to, since: now };
            return Wish::Nothing;
        }
        let refusal = robot.refusal.as_ref().filter(|_| robot.refused != refused);
        match refusal.filter(|_| standing) {
            Some(refusal) if robot.is_unheard && self.patience.begin(now) => {
                self.phase = Phase::Unheard { to };
                Wish::Wait(format!(
                    "The head holds: {refusal} It turns on by itself once its joints are heard."
                ))
            }
            Some(refusal) => Wish::GiveUp(format!("The head does not turn on: {refusal}")),
            None if now.saturating_duration_since(since) > PATIENCE => Wish::GiveUp(
                "The head did not arrive. Look whether something holds it, then go on with the rest."
                    .to_owned(),
            ),
            None => Wish::Nothing,
        }
    }

    /// Looks whether the head's joints are heard again.
    fn look_again(&mut self, to: (f64, f64), robot: &RobotView, rig: &Rig, now: Instant) -> Wish {
        let head = [rig.eyes.pan, rig.eyes.tilt].map(|joint| rig.servo_of(joint));
        let names: Vec<String> = head.into_iter().flatten().map(|servo| servo.joint_name.clone()).collect();
        match self.patience.look(robot, None, &names, now) {
            Look::Same => Wish::Nothing,
            Look::GoesOn => {
                self.go(to, robot, now);
                Wish::TurnOn(to.0, to.1)
            }
            Look::GivesUp(why) => {
                Wish::GiveUp(format!("The head does not turn on: {why} Then go on with the rest."))
            }
        }
    }

    /// Whether an image taken at this time shows what the head looks at while it stands.
    pub fn accepts(&self, captured_at: Instant) -> bool {
        matches!(self.phase, Phase::Standing { since, .. } if captured_at > since + SETTLE)
    }

    /// The pose was seen, or nothing is to be seen from it: on to the next.
    pub fn advance(&mut self) {
        self.phase = Phase::Ready;
        self.patience.done();
    }
}

/// Whether the head has the angles (pan, tilt; rad) that it was sent to.
fn is_there(to: (f64, f64), robot: &RobotView, rig: &Rig) -> bool {
    let near = |angle_rad: f64, goal_rad: f64| (angle_rad - goal_rad).abs() < NEAR_RAD;
    let is_near = |posture: &Posture| near(posture[rig.eyes.pan], to.0) && near(posture[rig.eyes.tilt], to.1);
    robot.measured.as_ref().is_some_and(is_near)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use plumbline_model::robot::Limits;

    use super::*;
    use crate::robot::patience::MOST;
    use crate::robot::view::{Connection, JointView};

    fn robot(rig: &Rig, pan_rad: f64, tilt_rad: f64, motion: MotionState) -> RobotView {
        let posture = rig.home().with(&[rig.eyes.pan, rig.eyes.tilt], &[pan_rad, tilt_rad]);
        RobotView {
            rig: Some(Arc::new(rig.clone())),
            connection: Connection::Connected { to: "test".to_owned(), twin: true },
            measured: Some(posture),
            motion,
            ..RobotView::default()
        }
    }

    fn rig() -> Rig {
        Rig::built_in("nico").expect("the rig that comes with the program")
    }

    const HOLDING: MotionState = MotionState::Holding { why: None };

    #[test]
    fn each_pose_is_seen_only_after_the_head_stands() {
        let rig = rig();
        let mut tour = Tour::new(&[(0.2, -0.5), (-0.2, -0.4)]);
        let start = Instant::now();
        let away = robot(&rig, 0.0, -0.5, HOLDING);
        assert_eq!(tour.step(&away, &rig, start), Wish::Turn(0.2, -0.5));
        assert_eq!(tour.step(&away, &rig, start), Wish::Nothing);
        assert!(!tour.accepts(start + Duration::from_secs(9)), "it has not arrived");
        let there = robot(&rig, 0.2, -0.5, HOLDING);
        tour.step(&there, &rig, start);
        assert!(!tour.accepts(start + Duration::from_millis(100)), "it may still swing");
        assert!(tour.accepts(start + Duration::from_secs(1)));
        tour.advance();
        assert_eq!(tour.step(&there, &rig, start), Wish::Turn(-0.2, -0.4));
        tour.step(&robot(&rig, -0.2, -0.4, HOLDING), &rig, start);
        tour.advance();
        assert_eq!(tour.step(&there, &rig, start), Wish::Finished);
    }

    #[test]
    fn stop_a_lost_connection_and_a_blocked_head_end_it() {
        let rig = rig();
        let start = Instant::now();
        let mut tour = Tour::new(&[(0.2, -0.5)]);
        let mut stopped = robot(&rig, 0.0, -0.5, HOLDING);
        stopped.stopped = true;
        assert!(matches!(tour.step(&stopped, &rig, start), Wish::GiveUp(_)));
        let mut lost = robot(&rig, 0.0, -0.5, HOLDING);
        lost.connection = Connection::None;
        assert!(matches!(tour.step(&lost, &rig, start), Wish::GiveUp(_)));
        let away = robot(&rig, 0.0, -0.5, HOLDING);
        tour.step(&away, &rig, start);
        assert!(matches!(tour.step(&away, &rig, start + PATIENCE * 2), Wish::GiveUp(_)));
    }

    /// It holds on its way, because the head was not heard for a moment; both joints are heard again.
    fn unheard(rig: &Rig, refused: u64) -> RobotView {
        let limits = Limits { lower_rad: -1.5, upper_rad: 1.5 };
        let heard = |servo| JointView {
            torque_on: Some(true),
            age: Some(Duration::from_millis(10)),
            ..JointView::unheard(servo, limits)
        };
        RobotView {
            joints: rig.servos.iter().map(heard).collect(),
            refusal: Some("The servo of Head turn was not heard in time.".to_owned()),
            is_unheard: true,
            refused,
            ..robot(rig, 0.0, -0.5, HOLDING)
        }
    }

    #[test]
    fn joints_that_were_not_heard_are_waited_for_and_the_same_pose_is_asked_for_again() {
        let rig = rig();
        let start = Instant::now();
        let mut tour = Tour::new(&[(0.2, -0.5), (-0.2, -0.4)]);
        let away = robot(&rig, 0.0, -0.5, HOLDING);
        assert_eq!(tour.step(&away, &rig, start), Wish::Turn(0.2, -0.5));
        let held = unheard(&rig, 1);
        assert!(
            matches!(tour.step(&held, &rig, start), Wish::Wait(why) if why.contains("not heard in time"))
        );
        assert!(tour.waits());
        assert_eq!(tour.remaining(), 2, "the one that was under way is still to be seen");
        assert_eq!(tour.step(&held, &rig, start), Wish::Nothing, "one reading is not enough");
        let later = start + Duration::from_secs(2);
        assert_eq!(tour.step(&held, &rig, later), Wish::TurnOn(0.2, -0.5));
        assert_eq!(tour.step(&held, &rig, later), Wish::Nothing, "what was refused before is over");
        tour.step(&robot(&rig, 0.2, -0.5, HOLDING), &rig, later);
        assert!(tour.accepts(later + Duration::from_secs(1)), "it arrived");
    }

    #[test]
    fn it_waits_a_few_times_in_a_row_only_and_never_where_the_head_is_refused_for_another_reason() {
        let rig = rig();
        let start = Instant::now();
        let mut tour = Tour::new(&[(0.2, -0.5)]);
        tour.step(&robot(&rig, 0.0, -0.5, HOLDING), &rig, start);
        let at = |i: usize, second: u64| start + Duration::from_secs(4 * i as u64 + second);
        for i in 0..MOST {
            let held = unheard(&rig, 1 + i as u64);
            assert!(matches!(tour.step(&held, &rig, at(i, 0)), Wish::Wait(_)), "{i}");
            tour.step(&held, &rig, at(i, 1));
            assert_eq!(tour.step(&held, &rig, at(i, 3)), Wish::TurnOn(0.2, -0.5), "{i}");
        }
        let held = unheard(&rig, 1 + MOST as u64);
        assert!(matches!(tour.step(&held, &rig, at(MOST, 0)), Wish::GiveUp(_)));

        let mut tour = Tour::new(&[(0.2, -0.5)]);
        tour.step(&robot(&rig, 0.0, -0.5, HOLDING), &rig, start);
        let refused = RobotView { is_unheard: false, ..unheard(&rig, 1) };
        assert!(matches!(tour.step(&refused, &rig, start), Wish::GiveUp(_)));
    }
}
