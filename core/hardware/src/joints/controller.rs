//! What the thread of the bus does in each cycle: reads the stop, takes what is asked, moves the
//! goals by a small step that all limits allow, exchanges with the servos, and tells.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::image_pair::Stamp;
use plumbline_model::robot::{JointIndex, Posture, Rig};

use super::command::{Motion, Move, MoveId, MoveOutcome, Setpoint, SetpointKind};
use super::exchange::{Exchange, Slot};
use super::guard::{FloorGuard, Guard};
use super::limiter::Limiter;
use super::options::ArmOptions;
use super::rate::Rate;
use super::reading::{BusStatistics, JointState};
use super::refusal::{HoldReason, Refusal};
use super::trajectory::Trajectory;
use crate::dynamixel::BusError;

/// What is asked through the queue.
#[derive(Clone, Debug)]
pub(super) enum Request {
    Move(MoveId, Move),
    Hold,
    Torque { joints: Vec<JointIndex>, on: bool },
}

/// What moves the goals.
#[derive(Debug)]
enum Mode {
    Hold(HoldReason),
    Move { id: MoveId, line: Trajectory, fraction: f64, arrived_at: Option<Instant> },
    Follow { given_at: Instant, setpoint: Setpoint, speeds_rad_s: Posture },
}

/// An angle older than this is not what a joint is held at, s.
const FRESH: Duration = Duration::from_millis(150);
/// Ends of moves that are remembered.
const OUTCOMES: usize = 16;
/// After the last goal the joints get this long to come to rest.
const SETTLE: Duration = Duration::from_millis(500);
/// A joint slower than this is at rest, rad/s.
const AT_REST_RAD_S: f64 = 0.02;
/// A cycle that took longer moves the goals no farther than this, s.
const LONGEST_STEP_S: f64 = 0.05;
/// Jogging reaches its speed within this time, s.
const JOG_RAMP_S: f64 = 0.15;
/// How fast a streamed goal is approached, 1/s.
const APPROACH_PER_S: f64 = 8.0;
/// Bits of an advance that are tried where a whole one would go too far ahead.
const PARTS: [f64; 4] = [1.0, 0.5, 0.25, 0.1];

pub(super) struct Controller {
    exchange: Exchange,
    limiter: Limiter,
    options: ArmOptions,
    mode: Mode,
    /// Goals as commanded last; joints without a goal as measured.
    commanded: Option<Posture>,
    stop_seen: bool,
    behind_since: Vec<Option<Instant>>,
    heavy_since: Vec<Option<Instant>>,
    outcomes: VecDeque<(MoveId, MoveOutcome)>,
    refusal: Option<(u64, Refusal)>,
    refusals: u64,
    seq: u64,
    complete: u64,
    rate: Rate,
    last_cycle_at: Instant,
    gone: Option<String>,
}

impl Controller {
    pub fn new(exchange: Exchange, rig: Arc<Rig>, options: ArmOptions) -> Self {
        let n = exchange.slots.len();
        let mut guards = options.guards.clone();
        guards.push(Arc::new(FloorGuard::new(&rig)));
        Self {
            exchange,
            limiter: Limiter { rig, guards },
            options,
            mode: Mode::Hold(HoldReason::Connected),
            commanded: None,
            stop_seen: false,
            behind_since: vec![None; n],
            heavy_since: vec![None; n],
            outcomes: VecDeque::new(),
            refusal: None,
            refusals: 0,
            seq: 0,
            complete: 0,
            rate: Rate::default(),
            last_cycle_at: Instant::now(),
            gone: None,
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
    pub fn cycle(&mut self, requests: impl Iterator<Item = Request>, setpoint: Option<(Instant, Setpoint)>) {
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
        setpoint: Option<(Instant, Setpoint)>,
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
        for request in requests {
            self.take(request)?;
        }
        self.take_setpoint(setpoint);
        self.watch(now);
        self.advance(now, dt_s);
        self.send()?;
        let complete = self.exchange.read_all(now + self.options.cycle_deadline)?;
        if complete {
            self.complete += 1;
            self.rate.count(Instant::now());
        }
        self.rate.last_cycle = self.exchange.bus.wire().since(&wire_before);
        self.begin_commanded();
        Ok(())
    }

    /// STOP: every servo with torque is told to stay where it is, before anything else is said.
    fn answer_stop(&mut self) -> Result<(), BusError> {
        self.stop_seen = true;
        self.exchange.bus.interrupt_on(None);
        // An answer on its way would collide with the hold; one bulk read lasts 2 ms.
        self.exchange.bus.let_pass(Duration::from_millis(4))?;
        self.hold(HoldReason::Stop);
        self.send()
    }

    /// Goals become where the joints are, and whatever moved ends.
    fn hold(&mut self, reason: HoldReason) {
        if let Some(commanded) = &mut self.commanded {
            for slot in &self.exchange.slots {
                let fresh = slot.reading.read_at.is_some_and(|at| at.elapsed() < FRESH);
                let known = slot.reading.angle_rad.filter(|_| fresh).or(slot.reading.goal_rad);
                if let Some(angle_rad) = known {
                    commanded[slot.reading.joint] = angle_rad;
                }
            }
        }
        self.end_motion(MoveOutcome::Held(reason.clone()), reason);
    }

    /// Goals stay as they were sent last, and whatever moved ends.
    fn stay(&mut self, outcome: MoveOutcome, reason: HoldReason) {
        self.end_motion(outcome, reason);
    }

    fn end_motion(&mut self, outcome: MoveOutcome, reason: HoldReason) {
        if let Mode::Move { id, .. } = &self.mode {
            self.outcomes.push_back((*id, outcome));
            if self.outcomes.len() > OUTCOMES {
                self.outcomes.pop_front();
            }
        }
        self.behind_since.fill(None);
        self.heavy_since.fill(None);
        self.mode = Mode::Hold(reason);
    }

    fn refuse(&mut self, refusal: Refusal) {
        self.refusals += 1;
        self.refusal = Some((self.refusals, refusal));
    }

    fn refuse_request(&mut self, request: &Request, refusal: Refusal) {
        if let Request::Move(id, _) = request {
            self.outcomes.push_back((*id, MoveOutcome::Refused(refusal.clone())));
            if self.outcomes.len() > OUTCOMES {
                self.outcomes.pop_front();
            }
        }
        self.refuse(refusal);
    }

    fn take(&mut self, request: Request) -> Result<(), BusError> {
        match request {
            Request::Hold => self.hold(HoldReason::Asked),
            Request::Torque { joints, on } => {
                // A moving joint that goes limp, or a limp one that holds, ends the motion.
                self.stay(MoveOutcome::Replaced, HoldReason::Asked);
                for i in 0..self.exchange.slots.len() {
                    let joint = self.exchange.slots[i].reading.joint;
                    if !(joints.is_empty() || joints.contains(&joint)) {
                        continue;
                    }
                    if let Some(refusal) = self.exchange.switch_torque(i, on)? {
                        self.refuse(refusal);
                    } else if let (Some(commanded), Some(angle_rad)) =
                        (&mut self.commanded, self.exchange.slots[i].reading.angle_rad)
                    {
                        commanded[joint] = angle_rad;
                    }
                }
            }
            Request::Move(id, wanted) => match self.begin_move(&wanted) {
                Ok(line) => {
                    self.stay(MoveOutcome::Replaced, HoldReason::Asked);
                    self.mode = Mode::Move { id, line, fraction: 0.0, arrived_at: None };
                }
                Err(refusal) => self.refuse_request(&Request::Move(id, wanted), refusal),
            },
        }
        Ok(())
    }

    fn begin_move(&self, wanted: &Move) -> Result<Trajectory, Refusal> {
        let joints: Vec<JointIndex> = wanted.goals.iter().map(|(joint, _)| *joint).collect();
        let (commanded, measured) = self.may_move(&joints)?;
        self.limiter.plan(&commanded, &measured, wanted)
    }

    /// Whether these joints may move at all; where they are commanded to be, and where they are.
    fn may_move(&self, joints: &[JointIndex]) -> Result<(Posture, Posture), Refusal> {
        if self.options.stop.is_pressed() {
            return Err(Refusal::Stopped);
        }
        if self.heartbeat_age().is_some_and(|age| age > self.options.heartbeat_timeout) {
            return Err(Refusal::NoHeartbeat);
        }
        for joint in joints {
            let slot = self.exchange.slots.iter().find(|slot| slot.reading.joint == *joint);
            let slot = slot.ok_or(Refusal::NoServo { joint: *joint })?;
            let (joint, name) = (*joint, slot.unit.servo.title.clone());
            let fresh = slot.reading.read_at.is_some_and(|at| at.elapsed() < FRESH * 4);
            if !fresh || !slot.in_use() {
                return Err(Refusal::Unknown { joint, name });
            }
            if !slot.holds_torque() {
                return Err(Refusal::Limp { joint, name });
            }
            let limit_c = self.limiter.rig.gate.hot_c;
            if let Some(temperature_c) = slot.reading.temperature_c.filter(|t| *t >= limit_c) {
                return Err(Refusal::Hot { joint, name, temperature_c, limit_c });
            }
        }
        let unknown = || {
            let slot = self.exchange.slots.iter().find(|slot| slot.reading.angle_rad.is_none());
            let (joint, name) = slot.map_or((JointIndex(0), "the arm".to_owned()), |slot| {
                (slot.reading.joint, slot.unit.servo.title.clone())
            });
            Refusal::Unknown { joint, name }
        };
        Ok((self.commanded.clone().ok_or_else(unknown)?, self.measured().ok_or_else(unknown)?))
    }

    fn heartbeat_age(&self) -> Option<Duration> {
        self.options.heartbeat.as_ref().map(super::stop::Heartbeat::age)
    }

    fn take_setpoint(&mut self, newest: Option<(Instant, Setpoint)>) {
        let Some((given_at, setpoint)) = newest else { return };
        if let Mode::Follow { given_at: known, setpoint: followed, .. } = &mut self.mode
            && *known == given_at
        {
            // Known; but it may have been shortened since.
            followed.valid_for = setpoint.valid_for;
            return;
        }
        if given_at.elapsed() > setpoint.valid_for {
            return;
        }
        let joints: Vec<JointIndex> = setpoint.joints.iter().map(|(joint, _)| *joint).collect();
        let checked = self.may_move(&joints).and_then(|(commanded, _)| {
            self.limiter.setpoint(&setpoint)?;
            Ok(commanded)
        });
        match checked {
            Err(refusal) => {
                if matches!(self.mode, Mode::Follow { .. }) {
                    self.stay(MoveOutcome::Replaced, HoldReason::Refused(refusal.clone()));
                }
                self.refuse(refusal);
            }
            Ok(commanded) => {
                let speeds_rad_s = match &self.mode {
                    Mode::Follow { speeds_rad_s, .. } => speeds_rad_s.clone(),
                    _ => Posture::new(vec![0.0; commanded.len()]),
                };
                if matches!(self.mode, Mode::Move { .. }) {
                    self.stay(MoveOutcome::Replaced, HoldReason::Asked);
                }
                self.mode = Mode::Follow { given_at, setpoint, speeds_rad_s };
            }
        }
    }

    /// Joints that move now.
    fn moving(&self) -> Vec<JointIndex> {
        match &self.mode {
            Mode::Hold(_) => vec![],
            Mode::Move { line, .. } => line.joints.clone(),
            Mode::Follow { setpoint, .. } => setpoint.joints.iter().map(|(joint, _)| *joint).collect(),
        }
    }

    /// Ends a motion that must not go on.
    fn watch(&mut self, now: Instant) {
        let moving = self.moving();
        if moving.is_empty() {
            return;
        }
        if let Some(age) = self.heartbeat_age().filter(|age| *age > self.options.heartbeat_timeout) {
            let reason = HoldReason::NoHeartbeat(age);
            return self.stay(MoveOutcome::Held(reason.clone()), reason);
        }
        if let Mode::Follow { given_at, setpoint, .. } = &self.mode
            && given_at.elapsed() > setpoint.valid_for
        {
            return self.stay(MoveOutcome::Held(HoldReason::JogEnded), HoldReason::JogEnded);
        }
        if let Some(reason) = (0..self.exchange.slots.len()).find_map(|i| self.unfit(i, &moving, now)) {
            self.hold(reason);
        }
    }

    /// Why a servo makes the arm hold.
    fn unfit(&mut self, i: usize, moving: &[JointIndex], now: Instant) -> Option<HoldReason> {
        let gate = self.limiter.rig.gate;
        let slot = &self.exchange.slots[i];
        let reading = &slot.reading;
        let (joint, name, servo) = (reading.joint, slot.unit.servo.title.clone(), reading.servo);
        if !moving.contains(&joint) {
            return None;
        }
        if slot.missed >= self.options.missed_cycles {
            return Some(HoldReason::NoAnswer { joint, name, servo, cycles: slot.missed });
        }
        if slot.torque_lost || reading.torque_on == Some(false) {
            return Some(HoldReason::TorqueLost { joint, name, servo });
        }
        if slot.alarm {
            let words = slot.complaint.clone().unwrap_or_default();
            return Some(HoldReason::Alarm { joint, name, servo, words });
        }
        if let Some(temperature_c) = reading.temperature_c.filter(|t| *t >= gate.hot_c) {
            let limit_c = gate.hot_c;
            return Some(HoldReason::Refused(Refusal::Hot { joint, name, temperature_c, limit_c }));
        }
        let load = reading.load.map(f64::abs).filter(|load| *load >= gate.load);
        let since = load.map(|_| self.heavy_since[i].unwrap_or(now));
        self.heavy_since[i] = since;
        if let (Some(load), Some(since)) = (load, since)
            && now.duration_since(since) >= self.options.load_timeout
        {
            return Some(HoldReason::Heavy { joint, name, load, limit: gate.load });
        }
        let behind_rad =
            self.commanded.as_ref().zip(reading.angle_rad).map(|(goals, angle_rad)| goals[joint] - angle_rad);
        if let (Some(since), Some(behind_rad)) = (self.behind_since[i], behind_rad)
            && now.duration_since(since) >= self.options.following_timeout
        {
            let since = now.duration_since(since);
            return Some(HoldReason::NotFollowing { joint, name, behind_rad, since });
        }
        None
    }

    /// Moves the goals by one step.
    fn advance(&mut self, now: Instant, dt_s: f64) {
        let (Some(commanded), Some(measured)) = (self.commanded.clone(), self.measured()) else { return };
        let joints = self.moving();
        let wanted = match &mut self.mode {
            Mode::Hold(_) => return,
            Mode::Move { .. } => return self.advance_move(now, dt_s, &commanded, &measured, &joints),
            Mode::Follow { setpoint, speeds_rad_s, .. } => {
                let gate = &self.limiter.rig.gate;
                let mut next = commanded.clone();
                for (joint, value) in &setpoint.joints {
                    let wanted_rad_s = match setpoint.kind {
                        SetpointKind::Velocity => *value,
                        SetpointKind::Position => {
                            let usual = gate.usual_speed_rad_s;
                            (APPROACH_PER_S * (value - commanded[*joint])).clamp(-usual, usual)
                        }
                    };
                    let ramp = gate.speed_rad_s * dt_s / JOG_RAMP_S;
                    let change = (wanted_rad_s - speeds_rad_s[*joint]).clamp(-ramp, ramp);
                    speeds_rad_s[*joint] += change;
                    next[*joint] += speeds_rad_s[*joint] * dt_s;
                }
                next
            }
        };
        if let Err(refusal) = self.limiter.step(&commanded, &measured, &wanted, &joints) {
            self.refuse(refusal.clone());
            return self
                .stay(MoveOutcome::Held(HoldReason::Refused(refusal.clone())), HoldReason::Refused(refusal));
        }
        if self.note_behind(now, &commanded, &measured, &wanted, &joints) {
            self.commanded = Some(wanted);
        } else if let Mode::Follow { speeds_rad_s, .. } = &mut self.mode {
            *speeds_rad_s = Posture::new(vec![0.0; speeds_rad_s.len()]);
        }
    }

    fn advance_move(
        &mut self,
        now: Instant,
        dt_s: f64,
        commanded: &Posture,
        measured: &Posture,
        joints: &[JointIndex],
    ) {
        let Mode::Move { line, fraction, arrived_at, .. } = &self.mode else { return };
        if let Some(at) = arrived_at {
            let moves = |slot: &&Slot| {
                joints.contains(&slot.reading.joint)
                    && slot.reading.speed_rad_s.is_some_and(|v| v.abs() > AT_REST_RAD_S)
            };
            let waited = now.duration_since(*at);
            let at_rest = waited > SETTLE / 5 && !self.exchange.slots.iter().any(|slot| moves(&slot));
            if at_rest || waited > SETTLE {
                let residual_rad =
                    joints.iter().map(|j| (commanded[*j] - measured[*j]).abs()).fold(0.0, f64::max);
                self.stay(MoveOutcome::Arrived { residual_rad }, HoldReason::Arrived);
            }
            return;
        }
        // Where a joint is behind, the whole move waits for it.
        let whole = dt_s / line.duration_s;
        let tries: Vec<(f64, Posture)> = PARTS
            .iter()
            .map(|part| (fraction + part * whole).min(1.0))
            .map(|fraction| (fraction, line.at(fraction)))
            .collect();
        let fits =
            tries.iter().find(|(_, next)| self.too_far_ahead(commanded, measured, next, joints).is_empty());
        let (new_fraction, wanted) = fits.unwrap_or(&tries[0]).clone();
        if let Err(refusal) = self.limiter.step(commanded, measured, &wanted, joints) {
            self.refuse(refusal.clone());
            return self.hold(HoldReason::Refused(refusal));
        }
        if self.note_behind(now, commanded, measured, &wanted, joints) {
            self.commanded = Some(wanted);
            if let Mode::Move { fraction, arrived_at, .. } = &mut self.mode {
                *fraction = new_fraction;
                *arrived_at = (new_fraction >= 1.0).then_some(now);
            }
        }
    }

    /// Joints whose next goal would be farther ahead of the present angle than the step limit, and
    /// farther than it is now.
    fn too_far_ahead(
        &self,
        commanded: &Posture,
        measured: &Posture,
        next: &Posture,
        joints: &[JointIndex],
    ) -> Vec<JointIndex> {
        let step_rad = self.limiter.rig.gate.step_rad;
        let is_too_far = |joint: &&JointIndex| {
            let ahead = (next[**joint] - measured[**joint]).abs();
            // A small share of the step is left for rounding to ticks.
            ahead > step_rad * 0.95
                && ahead > (commanded[**joint] - measured[**joint]).abs() - 1e-12
                && next[**joint] != commanded[**joint]
        };
        joints.iter().filter(is_too_far).copied().collect()
    }

    /// Notes which joints are behind; returns whether none is.
    fn note_behind(
        &mut self,
        now: Instant,
        commanded: &Posture,
        measured: &Posture,
        next: &Posture,
        joints: &[JointIndex],
    ) -> bool {
        let behind = self.too_far_ahead(commanded, measured, next, joints);
        for (slot, since) in self.exchange.slots.iter().zip(&mut self.behind_since) {
            *since = behind.contains(&slot.reading.joint).then(|| since.unwrap_or(now));
        }
        behind.is_empty()
    }

    /// Sends the goals of all joints with torque.
    fn send(&mut self) -> Result<(), BusError> {
        let Some(commanded) = self.commanded.clone() else { return Ok(()) };
        // A joint that was never sent a goal keeps the one it has until something moves it: its
        // own goal may be elsewhere than it is.
        let refusal = self.exchange.send_goals(|_, slot| Some(commanded[slot.reading.joint]))?;
        if let Some(refusal) = refusal {
            self.hold(HoldReason::Refused(refusal.clone()));
            self.refuse(refusal);
        }
        Ok(())
    }

    /// All joints as measured; `None` until every servo in use was read.
    fn measured(&self) -> Option<Posture> {
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

    /// What is commanded before anything was: where the joints are. A limp joint's goal is where
    /// it was turned to by hand.
    fn begin_commanded(&mut self) {
        let Some(measured) = self.measured() else { return };
        let commanded = self.commanded.get_or_insert_with(|| measured.clone());
        for slot in self.exchange.slots.iter().filter(|slot| !slot.holds_torque()) {
            commanded[slot.reading.joint] = measured[slot.reading.joint];
        }
    }

    /// What is known now.
    pub fn state(&self) -> JointState {
        let now = Instant::now();
        let gate = &self.limiter.rig.gate;
        let mut warnings = vec![];
        let joints = self.exchange.slots.iter().map(|slot| {
            let mut reading = slot.reading.clone();
            reading.age = reading.read_at.map(|at| now.duration_since(at));
            reading.problem = super::problem::of(slot, gate);
            if let Some(temperature_c) = reading.temperature_c.filter(|t| *t >= gate.warm_c) {
                warnings.push(super::problem::warm(&slot.unit.servo.title, temperature_c, gate));
            }
            reading
        });
        let joints: Arc<[_]> = joints.collect();
        let limp = joints.iter().all(|reading| reading.torque_on != Some(true));
        let motion = match &self.mode {
            Mode::Hold(_) if limp && self.gone.is_none() => Motion::Limp,
            Mode::Hold(reason) => Motion::Holding(reason.clone()),
            Mode::Move { id, line, fraction, .. } => {
                let remaining = Duration::from_secs_f64((1.0 - fraction).max(0.0) * line.duration_s);
                Motion::Moving { id: *id, fraction: *fraction, remaining }
            }
            Mode::Follow { .. } => Motion::Following,
        };
        let timing = self.exchange.bus.timing();
        JointState {
            stamp: Stamp { seq: self.seq, captured_at: now },
            joints,
            motion,
            stopped: self.options.stop.is_pressed(),
            measured: self.measured(),
            commanded: self.commanded.clone(),
            bus: BusStatistics {
                cycles: self.seq,
                complete_cycles: self.complete,
                complete_per_s: self.rate.per_s(now),
                last_cycle: self.rate.last_cycle,
                last_wire_s: self.rate.last_cycle.seconds(
                    timing.baud,
                    self.options.return_delay.unwrap_or(Duration::from_micros(500)).as_secs_f64(),
                    0.0,
                ),
                counts: self.exchange.bus.counts().clone(),
            },
            outcomes: self.outcomes.iter().cloned().collect(),
            refusal: self.refusal.clone(),
            warnings: warnings.into(),
            gone: self.gone.clone(),
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
