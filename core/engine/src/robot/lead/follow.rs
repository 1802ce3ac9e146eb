//! Through places one after another, each a move that all limits have looked at.

use std::collections::VecDeque;

use plumbline_hardware::joints::{JointState, Motion, Move, MoveId, MoveOutcome, Pace};
use plumbline_model::robot::JointIndex;

use super::{GivenUp, Stepped};
use crate::robot::worker::Worker;

/// Joints nearer to their goal need not move, rad.
const THERE_RAD: f64 = 5e-4;

/// Places that are still to be passed.
pub(super) struct Following {
    way: VecDeque<Vec<(JointIndex, f64)>>,
    speed_rad_s: f64,
    moving: Option<MoveId>,
    /// It was made to stand.
    paused: bool,
}

impl Following {
    pub fn new(way: Vec<Vec<(JointIndex, f64)>>, speed_rad_s: f64) -> Self {
        Self { way: way.into(), speed_rad_s, moving: None, paused: false }
    }

    /// Goes on; `true`: the last place is reached.
    pub fn step(&mut self, worker: &Worker, state: &JointState, pause: bool) -> Stepped {
        if pause {
            return self.pause(worker);
        }
        self.paused = false;
        if let Some(id) = self.moving {
            if !self.has_passed(state, id)? {
                return Ok(false);
            }
            self.moving = None;
            self.way.pop_front();
        }
        while let Some(place) = self.way.front() {
            if let Some(id) = self.begin(worker, state, place)? {
                self.moving = Some(id);
                return Ok(false);
            }
            self.way.pop_front();
        }
        Ok(true)
    }

    /// Stands where it is; the place that it was on its way to comes next.
    fn pause(&mut self, worker: &Worker) -> Stepped {
        if !self.paused && self.moving.take().is_some() {
            worker.arm()?.hold()?;
        }
        self.paused = true;
        Ok(false)
    }

    fn begin(
        &self,
        worker: &Worker,
        state: &JointState,
        place: &[(JointIndex, f64)],
    ) -> Result<Option<MoveId>, GivenUp> {
        let commanded =
            state.commanded.as_ref().ok_or_else(|| GivenUp::Lost("the joints are not known".to_owned()))?;
        let away = |(joint, goal_rad): &&(JointIndex, f64)| (commanded[*joint] - goal_rad).abs() > THERE_RAD;
        let goals: Vec<(JointIndex, f64)> = place.iter().filter(away).copied().collect();
        if goals.is_empty() {
            return Ok(None);
        }
        let pace = Pace::PeakSpeed(self.speed_rad_s.min(worker.rig.gate.speed_rad_s));
        Ok(Some(worker.arm()?.begin(Move { goals, pace })?))
    }

    /// Whether a move is done: on the way its goals were sent, at the end the joints are at rest.
    fn has_passed(&self, state: &JointState, id: MoveId) -> Result<bool, GivenUp> {
        match state.outcome(id) {
            None => {
                let sent = matches!(&state.motion, Motion::Moving { id: moving, fraction, .. } if *moving == id && *fraction >= 1.0);
                Ok(sent && self.way.len() > 1)
            }
            Some(MoveOutcome::Arrived { .. }) => Ok(true),
            Some(MoveOutcome::Refused(refusal)) => Err(refusal.clone().into()),
            Some(MoveOutcome::Held(reason)) => Err(reason.clone().into()),
            Some(MoveOutcome::Replaced) => Err(GivenUp::Refused("something else moved the arm".to_owned())),
        }
    }
}
