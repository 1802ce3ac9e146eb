//! What the thread of the bus does in each cycle: reads the stop, reads every servo, takes what is
//! asked, moves the goals by a small step that all limits allow, sends those that changed, and tells.
//!
//! Reading comes right before writing, so that a goal rests on what the servo said a few
//! milliseconds ago: that it holds, and where it is.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::chains::Chains;
use super::command::{MoveId, MoveOutcome, Setpoint};
use super::droop::Droop;
use super::exchange::Exchange;
use super::grip::Gripping;
use super::guard::{FloorGuard, Guard};
use super::limiter::Limiter;
use super::options::ArmOptions;
use super::progress::Progress;
use super::rate::Rate;
use super::refusal::{HoldReason, Refusal, Unheard};
use super::requests::Request;
use super::slot::Slot;
use super::trajectory::Trajectory;
use crate::dynamixel::{BusError, BusScan};

/// What moves the goals.
#[derive(Debug)]
pub(super) enum Mode {
    Hold(HoldReason),
    Move { id: MoveId, line: Trajectory, fraction: f64, arrived_at: Option<Instant>, progress: Progress },
    Follow { given_at: Instant, setpoint: Setpoint, speeds_rad_s: Posture },
}

/// A joint is held at an angle read no longer ago than this; else where it is read next. Held at an
/// older one, it would be moved back to where it was.
pub(super) const FRESH: Duration = Duration::from_millis(40);
/// Ends of moves that are remembered.
const OUTCOMES: usize = 16;
/// A cycle that took longer moves the goals no farther than this, s.
const LONGEST_STEP_S: f64 = 0.05;

pub(super) struct Controller {
    pub(super) exchange: Exchange,
    pub(super) limiter: Limiter,
    pub(super) chains: Chains,
    /// Joints with a servo that this program does not know how to talk to.
    voiceless: Vec<JointIndex>,
    pub(super) options: ArmOptions,
    pub(super) mode: Mode,
    /// Fingers that hold something, or close to.
    pub(super) grips: Vec<Gripping>,
    /// Goals as commanded last; joints without a goal as measured.
    pub(super) commanded: Option<Posture>,
    /// How far the joints hang below their goals.
    droop: Droop,
    stop_seen: bool,
    pub(super) behind_since: Vec<Option<Instant>>,
    /// Since when a motion waits for readings that are fresh enough.
    pub(super) waits_since: Option<Instant>,
    pub(super) heavy_since: Vec<Option<Instant>>,
    pub(super) outcomes: VecDeque<(MoveId, MoveOutcome)>,
    pub(super) refusal: Option<(u64, Refusal)>,
    refusals: u64,
    pub(super) seq: u64,
    pub(super) complete: u64,
    pub(super) rate: Rate,
    last_cycle_at: Instant,
    pub(super) gone: Option<String>,
    pub(super) scan: Arc<BusScan>,
}

impl Controller {
    pub fn new(exchange: Exchange, scan: BusScan, rig: Arc<Rig>, options: ArmOptions) -> Self {
        let n = exchange.slots.len();
        let droop = Droop::of(rig.clone(), n);
        let mut guards = options.guards.clone();
        guards.push(Arc::new(FloorGuard::new(&rig).shifted_by(options.floor.clone())));
        let has_slot = |joint: &JointIndex| exchange.slots.iter().any(|slot| slot.reading.joint == *joint);
        let voiceless = rig.servos.iter().map(|s| s.joint).filter(|joint| !has_slot(joint)).collect();
        Self {
            exchange,
            chains: Chains::of(&rig.description),
            voiceless,
            limiter: Limiter { rig, guards },
            options,
            mode: Mode::Hold(HoldReason::Connected),
            grips: vec![],
            commanded: None,
            droop,
            stop_seen: false,
            behind_since: vec![None; n],
            waits_since: None,
            heavy_since: vec![None; n],
            outcomes: VecDeque::new(),
            refusal: None,
            refusals: 0,
            seq: 0,
            complete: 0,
            rate: Rate::default(),
            last_cycle_at: Instant::now(),
            gone: None,
            scan: Arc::new(scan),
        }
    }

    /// All guards, the floor among them.
    pub fn guards(&self) -> Vec<Arc<dyn Guard>> {
        self.limiter.guards.clone()
    }

    /// Answers a stop that came between two cycles.
    pub fn stop_now(&mut self) {
        let stopped = self.answer_stop();
        self.note_bus_error(stopped);
    }

    pub fn on_state(&self) {
        if let Some(tell) = &self.options.on_state {
            tell();
        }
    }

    pub fn period(&self) -> Duration {
        self.options.period
    }

    /// Whether the stop was pressed and not yet answered.
    pub fn stop_is_new(&self) -> bool {
        self.options.stop.is_pressed() && !self.stop_seen
    }

    pub fn is_gone(&self) -> bool {
        self.gone.is_some()
    }

    /// One cycle. Never fails: a port that is gone is told in the state.
    pub fn cycle(
        &mut self,
        requests: impl Iterator<Item = Request>,
        setpoint: impl FnOnce() -> Option<(Instant, Setpoint)>,
    ) {
        self.seq += 1;
        if self.gone.is_some() {
            for request in requests {
                self.refuse_request(&request, Refusal::Gone(self.gone.clone().unwrap_or_default()));
            }
            return;
        }
        match self.try_cycle(requests, setpoint) {
            Ok(()) => {}
            // The stop came in the middle: the hold goes out now, not in the next cycle.
            Err(BusError::Interrupted) => {
                let stopped = self.answer_stop();
                self.note_bus_error(stopped);
            }
            Err(error) => self.note_bus_error(Err(error)),
        }
    }

    fn note_bus_error(&mut self, result: Result<(), BusError>) {
        if let Err(error) = result {
            let reason = error.to_string();
            self.hold(HoldReason::Gone(reason.clone()));
            self.gone = Some(reason);
        }
    }

    fn try_cycle(
        &mut self,
        requests: impl Iterator<Item = Request>,
        setpoint: impl FnOnce() -> Option<(Instant, Setpoint)>,
    ) -> Result<(), BusError> {
        let now = Instant::now();
        let dt_s = now.duration_since(self.last_cycle_at).as_secs_f64().min(LONGEST_STEP_S);
        self.last_cycle_at = now;
        let wire_before = self.exchange.bus.wire();
        if self.stop_is_new() {
            self.answer_stop()?;
        }
        self.stop_seen &= self.options.stop.is_pressed();
        self.exchange.bus.interrupt_on((!self.stop_seen).then(|| self.options.stop.flag()));
        let complete = self.exchange.read_all(now + self.options.cycle_deadline)?;
        if complete {
            self.complete += 1;
            self.rate.count(Instant::now());
        }
        self.rate.count_strays(Instant::now(), self.exchange.bus.counts().stray_bytes);
        self.begin_commanded();
        self.note_droop(now);
        for request in requests {
            self.take(request)?;
        }
        // Looked at after the requests: whoever ended it before a move must not see it replace that.
        self.take_setpoint(setpoint());
        self.watch(now);
        self.advance(now, dt_s);
        self.advance_grips(dt_s);
        self.send()?;
        self.exchange.set_forces(self.options.write_window)?;
        self.rate.last_cycle = self.exchange.bus.wire().since(&wire_before);
        Ok(())
    }

    /// STOP: what moves is told to stay where it is, and every other servo with torque once more what
    /// it was told, before anything else is said.
    fn answer_stop(&mut self) -> Result<(), BusError> {
        self.stop_seen = true;
        self.exchange.bus.interrupt_on(None);
        // An answer on its way would collide with the hold, and tells where the joint is; one bulk
        // read lasts 4 ms.
        self.exchange.take_late(Duration::from_millis(5))?;
        self.grips.clear();
        self.hold(HoldReason::Stop);
        self.send()
    }

    /// The goals of joints that move become what keeps them where they are; whatever moved ends.
    pub(super) fn hold(&mut self, reason: HoldReason) {
        let (moving, goals_rad) = (self.moving(), self.goals_that_keep());
        if let Some(commanded) = &mut self.commanded {
            let slots = self.exchange.slots.iter_mut().zip(goals_rad);
            for (slot, goal_rad) in slots.filter(|(slot, _)| slot.holds_torque()) {
                slot.insist = true;
                let joint = slot.reading.joint;
                if !moving.contains(&joint) && !is_turning(slot) {
                    continue;
                }
                match goal_rad.filter(|_| slot.silence() < FRESH) {
                    Some(goal_rad) => commanded[joint] = goal_rad,
                    None => slot.hold_pending = true,
                }
            }
        }
        self.end_motion(MoveOutcome::Held(reason.clone()), reason);
    }

    /// For each servo the goal at which it stays where it was just read; `None`: it was not read.
    fn goals_that_keep(&self) -> Vec<Option<f64>> {
        let slots = self.exchange.slots.iter();
        match self.commanded.as_ref().zip(self.measured()) {
            Some((sent, measured)) => slots
                .enumerate()
                .map(|(i, slot)| self.droop.goal_rad(i, slot, sent[slot.reading.joint], &measured))
                .collect(),
            None => slots.map(|slot| slot.reading.angle_rad).collect(),
        }
    }

    /// Goals stay as they were sent last, and whatever moved ends.
    pub(super) fn stay(&mut self, outcome: MoveOutcome, reason: HoldReason) {
        self.end_motion(outcome, reason);
    }

    fn end_motion(&mut self, outcome: MoveOutcome, reason: HoldReason) {
        if let Mode::Move { id, .. } = &self.mode {
            let id = *id;
            self.remember(id, outcome);
        }
        self.behind_since.fill(None);
        self.waits_since = None;
        self.heavy_since.fill(None);
        self.mode = Mode::Hold(reason);
    }

    /// Remembers how a move ended.
    pub(super) fn remember(&mut self, id: MoveId, outcome: MoveOutcome) {
        self.outcomes.push_back((id, outcome));
        if self.outcomes.len() > OUTCOMES {
            self.outcomes.pop_front();
        }
    }

    pub(super) fn refuse(&mut self, refusal: Refusal) {
        self.refusals += 1;
        self.refusal = Some((self.refusals, refusal));
    }

    pub(super) fn heartbeat_age(&self) -> Option<Duration> {
        self.options.heartbeat.as_ref().map(super::stop::Heartbeat::age)
    }

    /// Sends goals where they differ from what the servos were told.
    fn send(&mut self) -> Result<(), BusError> {
        let window = self.options.write_window;
        let pends = self.exchange.slots.iter().any(|slot| slot.hold_pending);
        let goals_rad = if pends { self.goals_that_keep() } else { vec![] };
        let Some(commanded) = &mut self.commanded else { return Ok(()) };
        for (slot, goal_rad) in self.exchange.slots.iter_mut().zip(goals_rad) {
            let known = goal_rad.filter(|_| slot.hold_pending && slot.may_be_written(FRESH));
            if let Some(goal_rad) = known {
                commanded[slot.reading.joint] = goal_rad;
                slot.hold_pending = false;
            }
        }
        let commanded = commanded.clone();
        if let Some(refusal) = self.exchange.send_goals(window, |slot| commanded[slot.reading.joint])? {
            self.hold(HoldReason::Refused(refusal.clone()));
            self.refuse(refusal);
        }
        Ok(())
    }

    /// All joints as measured, those that are not known as last seen; `None` until every servo in
    /// use was read.
    pub(super) fn measured(&self) -> Option<Posture> {
        let mut posture = self.limiter.rig.description.rest();
        for slot in &self.exchange.slots {
            match slot.reading.angle_rad {
                Some(angle_rad) => posture[slot.reading.joint] = angle_rad,
                None if slot.in_use() => return None,
                None => {}
            }
        }
        Some(posture)
    }

    /// Joints of which it is not known where they are.
    pub(super) fn unknown(&self) -> Vec<JointIndex> {
        let slots = self.exchange.slots.iter().filter(|slot| !slot.is_known());
        slots.map(|slot| slot.reading.joint).chain(self.voiceless.iter().copied()).collect()
    }

    /// Those of them whose servo answers, but too late.
    pub(super) fn late(&self) -> Vec<JointIndex> {
        let slots = self.exchange.slots.iter().filter(|slot| !slot.is_known());
        slots.filter(|slot| slot.unheard() == Unheard::TooBusy).map(|slot| slot.reading.joint).collect()
    }

    /// Whether all that moves was read just now, and may be written.
    pub(super) fn is_fresh(&self, joints: &[JointIndex]) -> bool {
        let window = self.options.write_window;
        let slot = |joint: &JointIndex| self.exchange.slots.iter().find(|slot| slot.reading.joint == *joint);
        joints.iter().all(|joint| slot(joint).is_some_and(|slot| slot.may_be_written(window)))
    }

    fn note_droop(&mut self, now: Instant) {
        if !matches!(self.mode, Mode::Hold(_)) {
            self.droop.moves();
        } else if let Some(measured) = self.measured() {
            self.droop.stands(now, &self.exchange.slots, measured);
        }
    }

    /// What is commanded before anything was: what a servo holds already, else where it is. The
    /// goal of a joint that does not hold is where it is.
    fn begin_commanded(&mut self) {
        let Some(measured) = self.measured() else { return };
        let slots = &self.exchange.slots;
        let commanded = self.commanded.get_or_insert_with(|| {
            let mut held = measured.clone();
            for slot in slots.iter().filter(|slot| slot.holds_torque()) {
                if let Some(goal_rad) = slot.goal_rad() {
                    held[slot.reading.joint] = goal_rad;
                }
            }
            held
        });
        let stands = matches!(self.mode, Mode::Hold(_));
        let step_rad = self.limiter.rig.gate.step_rad;
        for slot in slots {
            let joint = slot.reading.joint;
            // NaN fails the comparison.
            let is_near = |goal_rad: &f64| (goal_rad - measured[joint]).abs() <= step_rad;
            if !slot.holds_torque() {
                commanded[joint] = measured[joint];
            } else if stands && !is_near(&commanded[joint]) {
                // It was told elsewhere, or hangs far from its goal: what is never written is not
                // what it is commanded to.
                if let Some(goal_rad) = slot.goal_rad() {
                    commanded[joint] = goal_rad;
                }
            }
        }
    }

    /// The driver ends: the arm stays where it is, with torque.
    pub fn end(&mut self) {
        if self.gone.is_none() && !matches!(self.mode, Mode::Hold(_)) {
            self.hold(HoldReason::Asked);
            let sent = self.send();
            self.note_bus_error(sent);
        }
    }
}

/// Faster than this a joint turns, rad/s.
const TURNS_RAD_S: f64 = 0.1;

fn is_turning(slot: &Slot) -> bool {
    slot.reading.speed_rad_s.is_some_and(|speed| speed.abs() > TURNS_RAD_S)
}
