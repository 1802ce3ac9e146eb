//! Fingers that close until each has met something, and go on pressing.
//!
//! A move would wait for the finger that met something first, and then let go of it. A grip lets each
//! finger bend for itself, and what it holds is pressed on with a limited force while the arm lifts.

use std::time::{Duration, Instant};

use plumbline_grasp::body::{GRIP_RAD_S, grip_force};
use plumbline_hardware::joints::{Grip, GripFinger, HoldReason, JointReading, JointState, Motion};
use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::{GivenUp, Stepped};
use crate::robot::worker::Worker;

/// Where a servo says that it may use no more than this beyond what it was told, it has taken its limit.
const TAKEN: f64 = 0.01;
/// A finger that is this near is there, rad.
const THERE_RAD: f64 = 0.03;
/// A finger whose goal is this far ahead of it and that stands has met something, rad.
const AHEAD_RAD: f64 = 0.05;
/// Slower than this it stands, rad/s.
const STANDS_RAD_S: f64 = 0.12;
/// All have met something, or are there, for this long.
const MET: Duration = Duration::from_millis(200);
/// A finger that stands for this long without pressing is kept from going on: what protects the robot
/// lets it bend no farther.
const KEPT: Duration = Duration::from_millis(1500);
/// An arm that holds is believed so many cycles after it was told to close.
const CYCLES: u64 = 4;
/// It is over after this long, whatever the fingers say.
const LONGEST: Duration = Duration::from_secs(12);

/// Fingers under way.
pub(super) struct Closing {
    goals: Vec<(JointIndex, f64)>,
    began: Option<Instant>,
    /// Number of the bus's cycle in which they were told to close; `None`: not, or to stand since.
    since_cycle: Option<u64>,
    /// Refusals up to this number are older.
    refusals: Option<u64>,
    stand_since: Option<Instant>,
    met_since: Option<Instant>,
}

impl Closing {
    pub fn new(goals: Vec<(JointIndex, f64)>) -> Self {
        Self { goals, began: None, since_cycle: None, refusals: None, stand_since: None, met_since: None }
    }

    /// Goes on; `true`: every finger has met something or is where it was sent.
    pub fn step(&mut self, worker: &Worker, state: &JointState, pause: bool, now: Instant) -> Stepped {
        if self.has_new_refusal(state)
            && let Some((_, refusal)) = &state.refusal
        {
            return Err(refusal.clone().into());
        }
        self.ended(state)?;
        if pause {
            if self.since_cycle.take().is_some() {
                self.stand(worker, state)?;
            }
            // Time does not run while it pauses.
            (self.began, self.stand_since, self.met_since) = (None, None, None);
            return Ok(false);
        }
        if self.since_cycle.is_none() {
            worker.arm()?.grip(grip(&worker.rig, self.goals.iter().copied()))?;
            self.since_cycle = Some(state.stamp.seq);
        }
        let began = *self.began.get_or_insert(now);
        if now.saturating_duration_since(began) > LONGEST {
            return Err(GivenUp::Refused("the fingers do not come to rest".to_owned()));
        }
        let known = state.commanded.as_ref();
        let commanded = known.ok_or_else(|| GivenUp::Lost("the joints are not known".to_owned()))?;
        let fingers = self.goals.iter();
        let fingers: Vec<Finger> = fingers
            .map(|goal| finger(commanded, state.of(goal.0), *goal, grip_force(&worker.rig, goal.0)))
            .collect();
        let since = |so: bool, since: Option<Instant>| so.then(|| since.unwrap_or(now));
        self.stand_since = since(!fingers.contains(&Finger::Turns), self.stand_since);
        self.met_since = since(fingers.iter().all(|finger| *finger == Finger::Met), self.met_since);
        let lasts = |since: Option<Instant>, long: Duration| {
            since.is_some_and(|since| now.saturating_duration_since(since) >= long)
        };
        Ok(lasts(self.met_since, MET) || lasts(self.stand_since, KEPT))
    }

    /// Fingers stay where they are, and press no more than that takes.
    pub fn stand(&self, worker: &Worker, state: &JointState) -> Result<(), GivenUp> {
        let here = |(joint, _): &(JointIndex, f64)| Some((*joint, state.of(*joint)?.angle_rad?));
        let here: Option<Vec<_>> = self.goals.iter().map(here).collect();
        let here = here.ok_or_else(|| GivenUp::Lost("the joints are not known".to_owned()))?;
        Ok(worker.arm()?.grip(grip(&worker.rig, here.into_iter()))?)
    }

    fn has_new_refusal(&mut self, state: &JointState) -> bool {
        let newest = state.refusal.as_ref().map_or(0, |(number, _)| *number);
        newest > *self.refusals.get_or_insert(newest)
    }

    /// Whether the arm was made to hold since it began.
    fn ended(&self, state: &JointState) -> Result<(), GivenUp> {
        let (Motion::Holding(reason), Some(since)) = (&state.motion, self.since_cycle) else { return Ok(()) };
        let is_usual = matches!(
            reason,
            HoldReason::JogEnded | HoldReason::Asked | HoldReason::Arrived | HoldReason::Connected
        );
        if is_usual || state.stamp.seq <= since + CYCLES { Ok(()) } else { Err(reason.clone().into()) }
    }
}

fn grip(rig: &Rig, goals: impl Iterator<Item = (JointIndex, f64)>) -> Grip {
    let finger = |(joint, goal_rad)| GripFinger { joint, goal_rad, force: grip_force(rig, joint) };
    Grip { fingers: goals.map(finger).collect(), speed_rad_s: GRIP_RAD_S }
}

/// What a finger does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Finger {
    /// It turns, or it is not known, or may use all its force yet.
    Turns,
    Stands,
    /// It stands where it was sent, or presses on what it met.
    Met,
}

fn finger(
    commanded: &Posture,
    reading: Option<&JointReading>,
    (joint, goal_rad): (JointIndex, f64),
    force: f64,
) -> Finger {
    let Some((reading, angle_rad)) = reading.and_then(|reading| Some((reading, reading.angle_rad?))) else {
        return Finger::Turns;
    };
    let is_limited = reading.force.is_none_or(|share| share <= force + TAKEN);
    let is_slow = reading.speed_rad_s.is_none_or(|speed| speed.abs() < STANDS_RAD_S);
    let is_there = (goal_rad - angle_rad).abs() < THERE_RAD;
    let presses = (commanded[joint] - angle_rad).abs() > AHEAD_RAD;
    match (is_limited && is_slow, is_there || presses) {
        (false, _) => Finger::Turns,
        (true, false) => Finger::Stands,
        (true, true) => Finger::Met,
    }
}
