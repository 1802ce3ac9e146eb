//! What is asked of the thread of the bus, and whether it may be done: moves, goals that follow one
//! another, torque, a new scan.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::robot::{JointIndex, Posture};

use super::command::{Move, MoveId, MoveOutcome, Setpoint};
use super::controller::{Controller, Mode};
use super::driver::expected_servos;
use super::grip::Grip;
use super::progress::Progress;
use super::refusal::{HoldReason, Refusal, Unheard};
use super::slot::{Bar, Identity, Slot};
use super::torque::{barred, unknown};
use super::trajectory::Trajectory;
use crate::dynamixel::{BusError, BusScan, ScanRange};

/// What is asked through the queue.
#[derive(Clone, Debug)]
pub(super) enum Request {
    Move(MoveId, Move),
    Grip(Grip),
    Hold,
    Torque { joints: Vec<JointIndex>, on: bool },
    Scan(ScanRange),
    ShortenAnswers,
}

/// A motion begins from angles read no longer ago than this.
const RECENT: Duration = Duration::from_millis(600);

impl Controller {
    /// Says that what was asked is not done.
    pub(super) fn refuse_request(&mut self, request: &Request, refusal: Refusal) {
        if let Request::Move(id, _) = request {
            self.remember(*id, MoveOutcome::Refused(refusal.clone()));
        }
        self.refuse(refusal);
    }

    /// Does what is asked, or refuses it.
    pub(super) fn take(&mut self, request: Request) -> Result<(), BusError> {
        match request {
            Request::Hold => self.hold(HoldReason::Asked),
            Request::Scan(range) => self.scan_again(range)?,
            Request::ShortenAnswers => {
                self.stay(MoveOutcome::Replaced, HoldReason::Asked);
                self.exchange.shorten_return_delays(self.options.return_delay.as_secs_f64())?;
            }
            Request::Torque { joints, on } => self.switch_torque(&joints, on)?,
            Request::Grip(grip) => {
                if let Err(refusal) = self.begin_grip(&grip) {
                    self.refuse(refusal);
                }
            }
            Request::Move(id, wanted) => match self.begin_move(&wanted) {
                Ok(line) => {
                    self.commanded = Some(line.start.clone());
                    self.stay(MoveOutcome::Replaced, HoldReason::Asked);
                    self.end_grip(&line.joints);
                    self.mode = Mode::Move {
                        id,
                        line,
                        fraction: 0.0,
                        arrived_at: None,
                        progress: Progress::default(),
                    };
                }
                Err(refusal) => self.refuse_request(&Request::Move(id, wanted), refusal),
            },
        }
        Ok(())
    }

    fn switch_torque(&mut self, joints: &[JointIndex], on: bool) -> Result<(), BusError> {
        // A moving joint that goes limp, or a limp one that holds, ends the motion.
        self.stay(MoveOutcome::Replaced, HoldReason::Asked);
        self.grips.retain(|grip| !(joints.is_empty() || joints.contains(&grip.joint)));
        let hot_c = self.limiter.rig.gate.hot_c;
        for i in 0..self.exchange.slots.len() {
            let slot = &self.exchange.slots[i];
            let joint = slot.reading.joint;
            if !(joints.is_empty() || joints.contains(&joint)) {
                continue;
            }
            // Waiting for each of many that are silent would take seconds.
            if slot.silent && joints.len() != 1 {
                let refusal = barred(slot).unwrap_or_else(|| unknown(slot));
                self.refuse(refusal);
                continue;
            }
            if let Some(refusal) = self.exchange.switch_torque(i, on, hot_c)? {
                self.refuse(refusal);
            }
            let slot = &self.exchange.slots[i];
            let held_rad = slot.reading.goal_rad.filter(|_| slot.holds_torque()).or(slot.reading.angle_rad);
            if let (Some(commanded), Some(angle_rad)) = (&mut self.commanded, held_rad) {
                commanded[joint] = angle_rad;
            }
        }
        Ok(())
    }

    /// Asks anew who is on the bus, while the arm stands. A servo that is back takes part again,
    /// limp until it is taken hold of; one that is not who the rig says is used no more.
    fn scan_again(&mut self, range: ScanRange) -> Result<(), BusError> {
        self.stay(MoveOutcome::Replaced, HoldReason::Asked);
        let scan = self.exchange.bus.scan(&expected_servos(&self.limiter.rig), range)?;
        for slot in &mut self.exchange.slots {
            note_scan(slot, &scan);
        }
        self.scan = Arc::new(scan);
        self.exchange.note_return_delays(self.options.return_delay.as_secs_f64())
    }

    fn begin_move(&mut self, wanted: &Move) -> Result<Trajectory, Refusal> {
        let joints: Vec<JointIndex> = wanted.goals.iter().map(|(joint, _)| *joint).collect();
        let (start, measured) = self.may_move(&joints, &self.at_rest())?;
        self.limiter.plan(&start, &measured, wanted)
    }

    /// Whether these joints may move at all; from where they set out, and where they are. `at_rest`: those that may
    /// set out from where they are.
    pub(super) fn may_move(
        &self,
        joints: &[JointIndex],
        at_rest: &[JointIndex],
    ) -> Result<(Posture, Posture), Refusal> {
        if self.options.stop.is_pressed() {
            return Err(Refusal::Stopped);
        }
        if self.heartbeat_age().is_some_and(|age| age > self.options.heartbeat_timeout) {
            return Err(Refusal::NoHeartbeat);
        }
        for joint in joints {
            let slot = self.exchange.slots.iter().find(|slot| slot.reading.joint == *joint);
            may_move(slot.ok_or(Refusal::NoServo { joint: *joint })?, self.limiter.rig.gate.hot_c)?;
        }
        self.chains.check(&self.limiter.rig, joints, &self.unknown(), &self.late())?;
        let not_known = || {
            let slot = self.exchange.slots.iter().find(|slot| slot.reading.angle_rad.is_none());
            slot.map_or_else(
                || Refusal::Unknown {
                    joint: JointIndex(0),
                    name: "the arm".to_owned(),
                    why: Unheard::Silent,
                },
                unknown,
            )
        };
        let measured = self.measured().ok_or_else(not_known)?;
        let sent = self.commanded.clone().ok_or_else(not_known)?;
        let start = self.limiter.set_out(&sent, &measured, joints, at_rest);
        Ok((start, measured))
    }

    /// Joints that stand and may set out from where they are: those that hold, and do not press on purpose.
    pub(super) fn at_rest(&self) -> Vec<JointIndex> {
        let grips = |joint: JointIndex| self.grips.iter().any(|grip| grip.joint == joint);
        let rests = |slot: &&Slot| {
            slot.holds_torque()
                && slot.is_known()
                && slot.silence() < RECENT
                && !slot.is_limited()
                && !grips(slot.reading.joint)
        };
        match &self.mode {
            Mode::Hold(_) => {
                self.exchange.slots.iter().filter(rests).map(|slot| slot.reading.joint).collect()
            }
            _ => vec![],
        }
    }

    /// Follows the newest goals, where they are new and may be followed.
    pub(super) fn take_setpoint(&mut self, newest: Option<(Instant, Setpoint)>) {
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
        let checked = self.may_move(&joints, &self.at_rest()).and_then(|(start, _)| {
            self.limiter.setpoint(&setpoint)?;
            Ok(start)
        });
        match checked {
            Err(refusal) => {
                if matches!(self.mode, Mode::Follow { .. }) {
                    self.stay(MoveOutcome::Replaced, HoldReason::Refused(refusal.clone()));
                }
                self.refuse(refusal);
            }
            Ok(start) => {
                let speeds_rad_s = match &self.mode {
                    Mode::Follow { speeds_rad_s, .. } => speeds_rad_s.clone(),
                    _ => Posture::new(vec![0.0; start.len()]),
                };
                self.commanded = Some(start);
                if matches!(self.mode, Mode::Move { .. }) {
                    self.stay(MoveOutcome::Replaced, HoldReason::Asked);
                }
                self.end_grip(&joints);
                self.mode = Mode::Follow { given_at, setpoint, speeds_rad_s };
            }
        }
    }
}

/// Whether one joint may move.
fn may_move(slot: &Slot, limit_c: f64) -> Result<(), Refusal> {
    let (joint, name) = (slot.unit.servo.joint, slot.unit.servo.title.clone());
    if let Some(refusal) = barred(slot) {
        return Err(refusal);
    }
    if !slot.is_known() || slot.silence() >= RECENT {
        return Err(unknown(slot));
    }
    if !slot.holds_torque() && (slot.let_go || slot.holds_unasked()) {
        return Err(Refusal::LetGo { joint, name });
    }
    if !slot.holds_torque() {
        return Err(Refusal::Limp { joint, name });
    }
    if slot.has_no_force() {
        return Err(Refusal::NoForce { joint, name });
    }
    if let Some(temperature_c) = slot.reading.temperature_c.filter(|t| *t >= limit_c) {
        return Err(Refusal::Hot { joint, name, temperature_c, limit_c });
    }
    Ok(())
}

/// What a scan says of a servo.
pub(super) fn note_scan(slot: &mut Slot, scan: &BusScan) {
    let id = slot.unit.id();
    if scan.duplicates_suspected.contains(&id) {
        return slot.bar(Bar::Doubled);
    }
    if let Some(wrong) = scan.wrong_model.iter().find(|wrong| wrong.found.id == id) {
        return slot.bar(Bar::WrongModel(wrong.found.clone()));
    }
    if !scan.found.iter().any(|found| found.id == id) {
        return;
    }
    if slot.silent {
        (slot.silent, slot.missed, slot.verify) = (false, 0, true);
    }
    slot.identity = Identity::Right;
}
