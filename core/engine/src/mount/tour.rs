//! Turning the head from pose to pose and waiting at each until it stands.

use std::time::{Duration, Instant};

use plumbline_model::robot::Rig;

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
}

#[derive(Clone, Debug)]
enum Phase {
    /// To be told where to go.
    Ready,
    Going {
        to: (f64, f64),
        since: Instant,
    },
    Standing {
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
    /// All poses were seen.
    Finished,
    /// It cannot go on; a sentence.
    GiveUp(String),
}

impl Tour {
    /// Through these poses (pan, tilt; rad), in their order.
    pub fn new(poses: &[(f64, f64)]) -> Self {
        Self { left: poses.iter().rev().copied().collect(), phase: Phase::Ready }
    }

    /// Poses that are still to be seen.
    pub fn remaining(&self) -> usize {
        self.left.len() + usize::from(!matches!(self.phase, Phase::Ready))
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
                    self.phase = Phase::Going { to, since: now };
                    Wish::Turn(to.0, to.1)
                }
            },
            Phase::Going { to, since } => {
                let (pan, tilt) = (rig.eyes.pan, rig.eyes.tilt);
                let near = |angle_rad: f64, goal_rad: f64| (angle_rad - goal_rad).abs() < NEAR_RAD;
                let there =
                    robot.measured.as_ref().is_some_and(|p| near(p[pan], to.0) && near(p[tilt], to.1));
                let standing = matches!(robot.motion, MotionState::Holding { .. });
                if there && standing {
                    self.phase = Phase::Standing { since: now };
                } else if let (Some(refusal), true) = (&robot.refusal, standing) {
                    return Wish::GiveUp(format!("The head does not turn on: {refusal}"));
                } else if now.saturating_duration_since(since) > PATIENCE {
                    return Wish::GiveUp(
                        "The head did not arrive. Look whether something holds it, then go on with the rest."
                            .to_owned(),
                    );
                }
                Wish::Nothing
            }
            Phase::Standing { .. } => Wish::Nothing,
        }
    }

    /// Whether an image taken at this time shows what the head looks at while it stands.
    pub fn accepts(&self, captured_at: Instant) -> bool {
        matches!(self.phase, Phase::Standing { since } if captured_at > since + SETTLE)
    }

    /// The pose was seen, or nothing is to be seen from it: on to the next.
    pub fn advance(&mut self) {
        self.phase = Phase::Ready;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::robot::view::Connection;

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
}
