//! Taking hold of a servo, giving it force again, letting it go; and how fast it answers.

use std::time::Duration;

use plumbline_model::robot::servo::FULL;

use super::exchange::Exchange;
use super::refusal::Refusal;
use super::slot::{Bar, Identity, Slot};
use crate::dynamixel::{Answer, BulkItem, BusError, Item, Register, StatusError, Ticks};

/// How often taking hold is tried; each time from a fresh angle.
const ATTEMPTS: u32 = 4;
/// How many bytes are read to learn the return delay, and the largest torque. Every question has
/// its own length: a late answer is never taken for one to another question.
const RETURN_DELAY_BYTES: u16 = 4;
const MAX_TORQUE_BYTES: u16 = 5;
/// The two limits of the angle lie side by side; read with what follows.
const ANGLE_LIMIT_BYTES: u16 = 6;
/// A joint that sank no farther beyond the limits of its servo is held at the nearer one, ticks (10°).
const MOST_BEYOND: u16 = 114;
/// Who may use less than this share of its torque is given what its memory allows when it is taken hold of.
const FULL_FORCE: f64 = 0.95;

/// Whether it may use less than all its torque.
fn lacks_force(slot: &Slot) -> bool {
    slot.reading.force.is_some_and(|share| share < FULL_FORCE)
}

/// It stands where its servo takes no goal.
fn beyond(slot: &Slot) -> Refusal {
    let servo = &slot.unit.servo;
    Refusal::BeyondServo { joint: servo.joint, name: servo.title.clone() }
}

impl Exchange {
    /// Switches torque. Switched on, a servo holds where it is; one that shut down after an overload
    /// is given its force again. Switched off, it is limp. `hot_c` is too hot to hold.
    pub fn switch_torque(&mut self, i: usize, on: bool, hot_c: f64) -> Result<Option<Refusal>, BusError> {
        self.bus.be_patient(true);
        let switched = if on { self.take_hold(i, hot_c) } else { self.let_go(i) };
        self.bus.be_patient(false);
        let switched = match switched {
            Err(BusError::Servo { .. }) => Ok(Some(unknown(&self.slots[i]))),
            other => other,
        };
        let slot = &mut self.slots[i];
        if on && !slot.in_hand && matches!(switched, Ok(Some(_))) {
            // It may hold by now, unheard: that it is nobody's to command is said until it is taken hold of.
            (slot.let_go, slot.held_goal) = (true, None);
        }
        switched
    }

    fn let_go(&mut self, i: usize) -> Result<Option<Refusal>, BusError> {
        let slot = &self.slots[i];
        let Some(register) = slot.unit.table.register(Item::TorqueEnable).copied() else {
            return Ok(Some(unknown(slot)));
        };
        // Also to who is not known: limp is what it is then.
        let id = slot.unit.id();
        (self.slots[i].in_hand, self.slots[i].held_goal) = (false, None);
        self.bus.await_owed(id)?;
        self.bus.write(id, register.address, &[0])?;
        self.read_block(i)?;
        let slot = &mut self.slots[i];
        (slot.torque_lost, slot.let_go) = (false, false);
        Ok((slot.reading.torque_on != Some(false)).then(|| unknown(slot)))
    }

    /// Asks who it is and where it is, writes that place as its goal, and believes only what the
    /// servo itself says then. No attempt repeats an older angle: between two of them the servo may
    /// have lost its power and sunk.
    fn take_hold(&mut self, i: usize, hot_c: f64) -> Result<Option<Refusal>, BusError> {
        let id = self.slots[i].unit.id();
        if let Some(refusal) = barred(&self.slots[i]) {
            return Ok(Some(refusal));
        }
        if self.slots[i].holds_well() && !lacks_force(&self.slots[i]) {
            return Ok(None);
        }
        self.bus.await_owed(id)?;
        match self.bus.identify(id, true)? {
            // Whether two have its id is decided by a scan, which looks at nothing else meanwhile.
            Answer::Silent | Answer::Collision => return Ok(Some(unknown(&self.slots[i]))),
            Answer::Found(found) => self.slots[i].identified(found),
        }
        if let Some(refusal) = barred(&self.slots[i]) {
            return Ok(Some(refusal));
        }
        for _ in 0..ATTEMPTS {
            self.read_block(i)?;
            let slot = &self.slots[i];
            let shut_down = slot.has_no_force() || slot.alarm;
            if let Some(refusal) = too_hot(slot, hot_c).filter(|_| shut_down) {
                return Ok(Some(refusal));
            }
            let taken = match self.try_take_hold(i)? {
                Ok(taken) => taken,
                Err(refusal) => return Ok(Some(*refusal)),
            };
            if taken {
                let slot = &mut self.slots[i];
                (slot.in_hand, slot.torque_lost, slot.let_go, slot.verify) = (true, false, false, false);
                (slot.hold_pending, slot.insist, slot.force) = (false, false, None);
                slot.reading.goal_rad = slot.goal_rad();
                return Ok(None);
            }
        }
        Ok(Some(unknown(&self.slots[i])))
    }

    /// Whether it holds where it was just read; one that stands a little beyond the limits of its servo, at the nearer one.
    fn try_take_hold(&mut self, i: usize) -> Result<Result<bool, Box<Refusal>>, BusError> {
        let slot = &self.slots[i];
        let id = slot.unit.id();
        let (Some(torque), Some(address), Some(angle_rad)) = (
            slot.unit.table.register(Item::TorqueEnable).copied(),
            slot.unit.goal_address(),
            slot.reading.angle_rad,
        ) else {
            return Ok(Ok(false));
        };
        let Ok(mut goal) = slot.unit.goal_ticks(angle_rad) else { return Ok(Ok(false)) };
        let bytes = slot.unit.goal_bytes(goal, self.speed_rad_s);
        let lacks_force = lacks_force(slot);
        let Some(said) = self.bus.write_told(id, address, &bytes)? else { return Ok(Ok(false)) };
        if said.is_outside() {
            // It kept the goal that it had, and would go there as soon as it has torque.
            match self.nearest_allowed(i, goal)? {
                Some(nearest) if nearest.0.abs_diff(goal.0) <= MOST_BEYOND => goal = nearest,
                Some(_) => return Ok(Err(Box::new(beyond(&self.slots[i])))),
                None => return Ok(Ok(false)),
            }
            let bytes = self.slots[i].unit.goal_bytes(goal, self.speed_rad_s);
            let taken = self.bus.write_told(id, address, &bytes)?;
            if taken.is_none_or(StatusError::is_outside) {
                return Ok(Ok(false));
            }
        }
        if !self.bus.write_once(id, torque.address, &[1])? {
            return Ok(Ok(false));
        }
        if lacks_force {
            self.restore_force(i)?;
        }
        self.read_block(i)?;
        let slot = &self.slots[i];
        Ok(Ok(slot.reading.torque_on == Some(true) && slot.goal == Some(goal) && !slot.has_no_force()))
    }

    /// The nearest goal that a servo allows by the limits in its memory; `None`: it does not tell them.
    fn nearest_allowed(&mut self, i: usize, goal: Ticks) -> Result<Option<Ticks>, BusError> {
        let unit = &self.slots[i].unit;
        let limits = (unit.table.register(Item::CwAngleLimit), unit.table.register(Item::CcwAngleLimit));
        let (Some(low), Some(high)) = limits else { return Ok(None) };
        let (low, high, id) = (*low, *high, unit.id());
        let status = self.bus.read(id, low.address, ANGLE_LIMIT_BYTES)?;
        let of = |register: Register| register.in_data(low.address, &status.data);
        let (Some(low), Some(high)) = (of(low), of(high)) else { return Ok(None) };
        Ok((low <= high).then(|| Ticks(goal.0.clamp(low, high))))
    }

    /// After an overload shutdown a servo's torque limit is zero, and after a grip it may be small; its
    /// largest torque is what it had before (MX-64 manual, "Torque Limit": the value after power-on is
    /// that of "Max Torque"). Returns whether the servo confirmed it.
    pub(super) fn restore_force(&mut self, i: usize) -> Result<bool, BusError> {
        let table = self.slots[i].unit.table;
        let Some(limit) = table.register(Item::TorqueLimit).copied() else { return Ok(true) };
        let id = self.slots[i].unit.id();
        let raw = match table.register(Item::MaxTorque).copied() {
            Some(most) => {
                let status = self.bus.read(id, most.address, MAX_TORQUE_BYTES)?;
                most.in_data(most.address, &status.data)
            }
            // A model without that register: all it can.
            None => limit.raw(1.0).or(Some(FULL)),
        };
        match raw {
            Some(raw) => self.bus.write_once(id, limit.address, &limit.bytes(raw)),
            None => Ok(true),
        }
    }

    /// Reads the cycle's block of one servo, with patience.
    fn read_block(&mut self, i: usize) -> Result<(), BusError> {
        let BulkItem { id, address, length } = self.item(i);
        let status = self.bus.read(id, address, length)?;
        let turn = self.turn;
        self.slots[i].take(&status, turn);
        Ok(())
    }

    /// Notes which servos wait longer than `delay_s` before they answer. Only reads.
    pub fn note_return_delays(&mut self, delay_s: f64) -> Result<(), BusError> {
        for i in 0..self.slots.len() {
            if self.slots[i].in_use() {
                self.slots[i].slow_answers_s = self.return_delay(i, delay_s)?.map(|(_, now_s)| now_s);
            }
        }
        Ok(())
    }

    /// Makes servos answer after `delay_s` where they wait longer. They keep that in their memory for
    /// good, and take it only without torque.
    pub fn shorten_return_delays(&mut self, delay_s: f64) -> Result<(), BusError> {
        for i in 0..self.slots.len() {
            let slot = &self.slots[i];
            if !slot.in_use() || slot.identity != Identity::Right || slot.reading.torque_on != Some(false) {
                continue;
            }
            let Some((register, _)) = self.return_delay(i, delay_s)? else { continue };
            let Some(raw) = register.raw(delay_s) else { continue };
            let id = self.slots[i].unit.id();
            match self.bus.write(id, register.address, &register.bytes(raw)) {
                Ok(_) | Err(BusError::Servo { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        self.note_return_delays(delay_s)
    }

    /// The register and how long the servo waits, s, when that is longer than `delay_s`.
    fn return_delay(&mut self, i: usize, delay_s: f64) -> Result<Option<(Register, f64)>, BusError> {
        let slot = &self.slots[i];
        let Some(register) = slot.unit.table.register(Item::ReturnDelayTime).copied() else {
            return Ok(None);
        };
        let first = register.address - 1;
        match self.bus.read(slot.unit.id(), first, RETURN_DELAY_BYTES) {
            Ok(status) => {
                let raw = register.in_data(first, &status.data);
                let slow = raw.filter(|raw| register.raw(delay_s).is_some_and(|wanted| *raw > wanted));
                Ok(slow.map(|raw| (register, register.si(raw))))
            }
            Err(BusError::Servo { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }
}

/// How long the slow ones wait, and how many there are.
pub(super) fn slow_answers(slots: &[Slot]) -> Option<(usize, Duration)> {
    let slow: Vec<f64> = slots.iter().filter_map(|slot| slot.slow_answers_s).collect();
    let longest_s = slow.iter().copied().fold(0.0, f64::max);
    Some((slow.len(), Duration::try_from_secs_f64(longest_s).ok()?)).filter(|(count, _)| *count > 0)
}

pub(super) fn unknown(slot: &Slot) -> Refusal {
    let (joint, name) = (slot.unit.servo.joint, slot.unit.servo.title.clone());
    Refusal::Unknown { joint, name, why: slot.unheard() }
}

/// Why a servo is never used, if so.
pub(super) fn barred(slot: &Slot) -> Option<Refusal> {
    let Identity::Barred(bar) = &slot.identity else { return None };
    let (joint, name, servo) = (slot.unit.servo.joint, slot.unit.servo.title.clone(), slot.unit.id());
    let why = match bar {
        Bar::Doubled => {
            "two servos answer to its id: connect one of them alone and give it another id".to_owned()
        }
        Bar::WrongModel(found) => format!(
            "the rig file says {}, but it is {found}: correct the rig file or exchange the servo",
            slot.unit.servo.model
        ),
    };
    Some(Refusal::Barred { joint, name, servo, why })
}

fn too_hot(slot: &Slot, limit_c: f64) -> Option<Refusal> {
    // NaN and a missing reading do not count as hot; the servo has an alarm of its own.
    let temperature_c = slot.reading.temperature_c.filter(|t| *t >= limit_c)?;
    let (joint, name) = (slot.unit.servo.joint, slot.unit.servo.title.clone());
    Some(Refusal::Hot { joint, name, temperature_c, limit_c })
}
