//! Through places one after another, each a move that all limits have looked at.

use std::collections::VecDeque;
use std::time::Instant;

use plumbline_hardware::joints::{JointState, Motion, Move, MoveId, MoveOutcome, Pace, Refusal};
use plumbline_model::robot::JointIndex;

use super::late::{Late, Way, ended_late, refused_late};
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
    /// Joints that were not heard in time are waited for.
    late: Late,
}

impl Following {
    pub fn new(way: Vec<Vec<(JointIndex, f64)>>, speed_rad_s: f64) -> Self {
        Self { way: way.into(), speed_rad_s, moving: None, paused: false, late: Late::default() }
    }

    /// Goes on; `true`: the last place is reached.
    pub fn step(&mut self, worker: &Worker, state: &JointState, pause: bool, now: Instant) -> Stepped {
        if pause {
            self.late.paused(now);
            return self.pause(worker);
        }
        self.paused = false;
        if self.late.is_waiting() {
            let (rig, together, joints) = (&*worker.rig, &worker.together, &*self.joints());
            let way = Way { rig, together, state, joints, is_alone: worker.is_alone() };
            if self.late.waits(way, now)? {
                return Ok(false);
            }
        }
        if let Some(id) = self.moving {
            if let Some(outcome) = state.outcome(id).filter(|outcome| ended_late(outcome, state)) {
                self.moving = None;
                self.late.begin(given_up(outcome), true, now)?;
                return Ok(false);
            }
            if !self.has_passed(state, id)? {
                return Ok(false);
            }
            self.moving = None;
            self.way.pop_front();
        }
        while let Some(place) = self.way.front() {
            match self.begin(worker, state, place) {
                Ok(Some(id)) => {
                    self.moving = Some(id);
                    return Ok(false);
                }
                Ok(None) => drop(self.way.pop_front()),
                Err(NotBegun::Refused(refusal)) => {
                    let is_late = refused_late(&refusal);
                    self.late.begin(refusal.into(), is_late, now)?;
                    return Ok(false);
                }
                Err(NotBegun::GivenUp(why)) => return Err(why),
            }
        }
        Ok(true)
    }

    /// Whether it waits for joints that were late.
    pub fn is_waiting(&self) -> bool {
        self.late.is_waiting()
    }

    /// That it waits for joints that were late, for who watches; said once.
    pub fn take_news(&mut self) -> Option<String> {
        self.late.take_news()
    }

    /// Joints that have somewhere to go.
    fn joints(&self) -> Vec<JointIndex> {
        self.way.front().into_iter().flatten().map(|(joint, _)| *joint).collect()
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
    ) -> Result<Option<MoveId>, NotBegun> {
        let not_known = || NotBegun::GivenUp(GivenUp::Lost("the joints are not known".to_owned()));
        let commanded = state.commanded.as_ref().ok_or_else(not_known)?;
        let away = |(joint, goal_rad): &&(JointIndex, f64)| (commanded[*joint] - goal_rad).abs() > THERE_RAD;
        let goals: Vec<(JointIndex, f64)> = place.iter().filter(away).copied().collect();
        if goals.is_empty() {
            return Ok(None);
        }
        let pace = Pace::PeakSpeed(self.speed_rad_s.min(worker.rig.gate.speed_rad_s));
        let arm = worker.arm().map_err(|why| NotBegun::GivenUp(why.into()))?;
        arm.begin(Move { goals, pace }).map(Some).map_err(NotBegun::Refused)
    }

    /// Whether a move is done: on the way its goals were sent, at the end the joints are at rest.
    fn has_passed(&self, state: &JointState, id: MoveId) -> Result<bool, GivenUp> {
        match state.outcome(id) {
            None => {
                let sent = matches!(&state.motion, Motion::Moving { id: moving, fraction, .. } if *moving == id && *fraction >= 1.0);
                Ok(sent && self.way.len() > 1)
            }
            Some(MoveOutcome::Arrived { .. }) => Ok(true),
            Some(outcome) => Err(given_up(outcome)),
        }
    }
}

/// Why a move to a place did not begin.
enum NotBegun {
    Refused(Refusal),
    GivenUp(GivenUp),
}

/// Why a move that did not arrive ends the way.
fn given_up(outcome: &MoveOutcome) -> GivenUp {
    match outcome {
        MoveOutcome::Refused(refusal) => refusal.clone().into(),
        MoveOutcome::Held(reason) => reason.clone().into(),
        MoveOutcome::Arrived { .. } | MoveOutcome::Replaced => {
            GivenUp::Refused("something else moved the arm".to_owned())
        }
    }
}
