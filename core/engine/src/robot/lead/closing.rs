//! Fingers that bend until they meet something, each for itself.
//!
//! A move would wait for the finger that met something first, and then let go of it. So fingers follow
//! speeds; one that stays behind and stands keeps the goal that it was sent last, which is what presses.

use std::time::{Duration, Instant};

use plumbline_hardware::joints::{HoldReason, JointReading, JointState, Motion, Setpoint, SetpointKind};
use plumbline_model::robot::{JointIndex, Posture};

use super::{GivenUp, Stepped};
use crate::robot::worker::Worker;

/// Fingers bend this fast, rad/s.
const SPEED_RAD_S: f64 = 0.8;
/// Their goals are approached at no more than this rate, 1/s.
const APPROACH_PER_S: f64 = 8.0;
/// A finger that is this near is there, rad.
const THERE_RAD: f64 = 0.015;
/// A finger that is this far behind its goal and stands has met something, rad. About three quarters of
/// the torque of a servo of the hand: less than what its gate allows, enough to hold a thing.
const BEHIND_RAD: f64 = 0.06;
/// Slower than this it stands, rad/s.
const STANDS_RAD_S: f64 = 0.12;
/// It stands for this long.
const STANDS: Duration = Duration::from_millis(120);
/// A speed is followed for this long when nothing newer comes.
const VALID: Duration = Duration::from_millis(150);
/// An arm that holds is believed so many cycles after it was told to follow.
const CYCLES: u64 = 4;
/// It is over after this long, whatever the fingers say.
const LONGEST: Duration = Duration::from_secs(12);

struct Finger {
    joint: JointIndex,
    goal_rad: f64,
    behind_since: Option<Instant>,
    done: bool,
}

/// Fingers under way.
pub(super) struct Closing {
    fingers: Vec<Finger>,
    began: Option<Instant>,
    /// Refusals up to this number are older.
    refusals: Option<u64>,
    /// When speeds were sent last.
    last_sent: Option<Instant>,
    /// Number of the bus's cycle in which the first were.
    since_cycle: Option<u64>,
}

impl Closing {
    pub fn new(goals: Vec<(JointIndex, f64)>) -> Self {
        let finger = |(joint, goal_rad)| Finger { joint, goal_rad, behind_since: None, done: false };
        let fingers = goals.into_iter().map(finger).collect();
        Self { fingers, began: None, refusals: None, last_sent: None, since_cycle: None }
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
            // What was sent last expires, and the fingers stand.
            return Ok(false);
        }
        let began = *self.began.get_or_insert(now);
        if now.saturating_duration_since(began) > LONGEST {
            return Err(GivenUp::Refused("the fingers do not come to rest".to_owned()));
        }
        let known = state.commanded.as_ref();
        let commanded = known.ok_or_else(|| GivenUp::Lost("the joints are not known".to_owned()))?;
        for finger in &mut self.fingers {
            finger.look(commanded, state.of(finger.joint), now);
        }
        let speed = |finger: &Finger| {
            let off_rad = finger.goal_rad - commanded[finger.joint];
            let presses = finger.behind_since.is_some();
            let speed =
                if presses { 0.0 } else { (APPROACH_PER_S * off_rad).clamp(-SPEED_RAD_S, SPEED_RAD_S) };
            (finger.joint, speed)
        };
        let joints: Vec<_> = self.fingers.iter().filter(|finger| !finger.done).map(speed).collect();
        if joints.is_empty() {
            // The last speeds have expired when nothing follows any more.
            let waited = self.last_sent.map_or(VALID, |sent| now.saturating_duration_since(sent));
            return Ok(waited >= VALID);
        }
        worker.arm()?.follow(Setpoint { kind: SetpointKind::Velocity, joints, valid_for: VALID })?;
        self.last_sent = Some(now);
        self.since_cycle.get_or_insert(state.stamp.seq);
        Ok(false)
    }

    fn has_new_refusal(&mut self, state: &JointState) -> bool {
        let newest = state.refusal.as_ref().map_or(0, |(number, _)| *number);
        newest > *self.refusals.get_or_insert(newest)
    }

    /// Whether the arm was made to hold.
    fn ended(&self, state: &JointState) -> Result<(), GivenUp> {
        let (Motion::Holding(reason), Some(since)) = (&state.motion, self.since_cycle) else { return Ok(()) };
        let is_usual = matches!(
            reason,
            HoldReason::JogEnded | HoldReason::Asked | HoldReason::Arrived | HoldReason::Connected
        );
        if is_usual || state.stamp.seq <= since + CYCLES { Ok(()) } else { Err(reason.clone().into()) }
    }
}

impl Finger {
    fn look(&mut self, commanded: &Posture, reading: Option<&JointReading>, now: Instant) {
        let Some((reading, angle_rad)) = reading.and_then(|reading| Some((reading, reading.angle_rad?)))
        else {
            return;
        };
        if self.done {
            return;
        }
        let stands = reading.speed_rad_s.is_none_or(|speed| speed.abs() < STANDS_RAD_S);
        let behind_rad = (commanded[self.joint] - angle_rad).abs();
        let near = (self.goal_rad - commanded[self.joint]).abs() < THERE_RAD;
        self.behind_since = (stands && behind_rad > BEHIND_RAD).then(|| self.behind_since.unwrap_or(now));
        let met = self.behind_since.is_some_and(|since| now.saturating_duration_since(since) >= STANDS);
        self.done = near || met;
    }
}
