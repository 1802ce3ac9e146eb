//! All servos of the robot, between the bus and the physics.

use std::collections::BTreeSet;
use std::sync::Arc;

use plumbline_hardware::dynamixel::{ControlTable, Item};
use plumbline_model::robot::Rig;
use plumbline_model::robot::servo::{FACTORY_P_GAIN, FULL};

use super::fault::Fault;
use super::memory::{Memory, error_bit};
use crate::error::TwinError;
use crate::physics::{Drive, Reading};

/// A servo at full load for this long switches itself off, s.
const OVERLOAD_S: f64 = 2.0;
/// What counts as full load.
const FULL_LOAD: f64 = 0.95;
/// The overheating alarm ends so many kelvins under the limit.
const COOLED_K: f64 = 5.0;
/// Slower than this counts as standing, rad/s of the motor.
const STANDING_RAD_S: f64 = 0.02;

/// Everything on the bus.
#[derive(Debug)]
pub(crate) struct Bank {
    rig: Arc<Rig>,
    /// The rig's servos in their order, then its boards.
    pub(super) units: Vec<Unit>,
    /// Faults that are on.
    pub(super) faults: BTreeSet<Fault>,
}

/// One participant of the bus.
#[derive(Clone, Debug)]
pub(super) struct Unit {
    pub memory: Memory,
    /// Whether it has power.
    pub powered: bool,
    /// Error bits that stay while their cause does.
    pub alarm: u8,
    loaded_s: f64,
}

impl Unit {
    pub(super) fn id(&self) -> u8 {
        self.memory.get(Item::Id).map_or(0, |id| id.to_le_bytes()[0])
    }
}

impl Bank {
    /// All participants, holding where `angles_rad` (joints, in the order of the rig's servos) say.
    ///
    /// # Errors
    /// When the registers of a model are not known.
    pub(crate) fn new(rig: Arc<Rig>, angles_rad: &[f64]) -> Result<Self, TwinError> {
        let servos = rig.servos.iter().map(|servo| (servo.id, servo.model.as_str()));
        let boards = rig.boards.iter().map(|board| (board.id, board.model.as_str()));
        let mut units = vec![];
        for (id, model) in servos.chain(boards) {
            let table = ControlTable::of_model(model).ok_or_else(|| TwinError::UnknownServo {
                model: model.to_owned(),
                known: ControlTable::all().iter().map(|t| t.model.as_str()).collect::<Vec<_>>().join(", "),
            })?;
            units.push(Unit { memory: Memory::new(table, id), powered: true, alarm: 0, loaded_s: 0.0 });
        }
        let mut bank = Self { rig, units, faults: BTreeSet::new() };
        bank.hold(angles_rad);
        Ok(bank)
    }

    /// Sets the goals of all servos (joint angles in the order of the rig's servos), torque on.
    pub(crate) fn hold(&mut self, angles_rad: &[f64]) {
        for (i, angle_rad) in angles_rad.iter().enumerate() {
            self.hold_at(i, *angle_rad);
        }
    }

    /// Limits of the motor, goal at an angle of the joint, torque on.
    fn hold_at(&mut self, servo: usize, angle_rad: f64) {
        let about = &self.rig.servos[servo];
        let memory = &mut self.units[servo].memory;
        let ticks = |rad: f64| memory.table().ticks(rad).map(|ticks| ticks.0);
        let (low, high) = (ticks(about.motor_limits.lower_rad), ticks(about.motor_limits.upper_rad));
        let goal = ticks(about.motor_rad(angle_rad));
        let values = [(Item::CwAngleLimit, low), (Item::CcwAngleLimit, high), (Item::GoalPosition, goal)];
        for (item, raw) in values {
            if let Some(raw) = raw {
                memory.set(item, raw);
            }
        }
        memory.set(Item::TorqueEnable, 1);
        memory.set(Item::TorqueLimit, FULL);
    }

    /// Switches a fault on or off.
    pub(crate) fn set_fault(&mut self, fault: Fault, on: bool) {
        if on {
            self.faults.insert(fault);
        } else {
            self.faults.remove(&fault);
        }
        self.switch_power();
    }

    /// Gives power to whom no fault takes it, and takes it from the others.
    fn switch_power(&mut self) {
        let all = self.faults.contains(&Fault::PowerCut);
        let one = self.suspect().filter(|_| self.faults.contains(&Fault::ElbowPowerCut));
        for (i, unit) in self.units.iter_mut().enumerate() {
            let powered = !all && one != Some(i);
            if powered != unit.powered {
                unit.power(powered);
            }
        }
    }

    /// Faults that are on.
    pub(crate) fn faults(&self) -> &BTreeSet<Fault> {
        &self.faults
    }

    /// The servo that some faults are about: the fourth joint of the first arm.
    pub(crate) fn suspect(&self) -> Option<usize> {
        let joint = *self.rig.arms.first()?.joints.get(3)?;
        self.rig.servos.iter().position(|servo| servo.joint == joint)
    }

    /// What the registers tell a servo's motor to do.
    pub(crate) fn drive(&self, servo: usize) -> Drive {
        let about = &self.rig.servos[servo];
        let memory = &self.units[servo].memory;
        let motor_rad = memory.si(Item::GoalPosition).unwrap_or(0.0);
        // Speed zero means: as fast as it can.
        let speed = memory.get(Item::MovingSpeed).filter(|raw| *raw & FULL != 0);
        let speed = speed.and_then(|_| memory.si(Item::MovingSpeed));
        Drive {
            torque_on: memory.get(Item::TorqueEnable) == Some(1),
            goal_rad: about.joint_rad(motor_rad),
            speed_rad_s: speed.map(|speed| speed.abs() / about.ratio),
            torque_limit: memory.si(Item::TorqueLimit).unwrap_or(1.0).clamp(0.0, 1.0),
            gain: f64::from(memory.get(Item::PGain).unwrap_or(FACTORY_P_GAIN)) / f64::from(FACTORY_P_GAIN),
        }
    }

    /// What the physics gives back, after `dt_s`.
    pub(crate) fn take(&mut self, servo: usize, reading: Reading, dt_s: f64) {
        let about = &self.rig.servos[servo];
        let sign = about.motor_rad(1.0) - about.motor_rad(0.0);
        let unit = &mut self.units[servo];
        let memory = &mut unit.memory;
        let ticks = memory.table().ticks(about.motor_rad(reading.angle_rad));
        if let Some(ticks) = ticks {
            memory.set(Item::PresentPosition, ticks.0);
        }
        let speed_rad_s = reading.speed_rad_s * sign;
        let load = reading.load * sign.signum();
        memory.set_si(Item::PresentSpeed, speed_rad_s);
        memory.set_si(Item::PresentLoad, load);
        memory.set_si(Item::PresentVoltage, reading.voltage_v);
        memory.set_si(Item::PresentTemperature, reading.temperature_c);
        memory.set_si(Item::PresentCurrent, current_a(memory.table(), load));
        memory.set(Item::Moving, u16::from(speed_rad_s.abs() > STANDING_RAD_S));
        unit.watch(reading, dt_s);
    }
}

/// Full load of an MX-64 draws about 4 A; the small motors of a hand draw a quarter of an ampere, and say no
/// direction.
fn current_a(table: &ControlTable, load: f64) -> f64 {
    let says_direction =
        table.register(Item::PresentCurrent).is_some_and(|register| register.raw(-1.0).is_some());
    if says_direction { 4.0 * load } else { 0.25 * load.abs() }
}

impl Unit {
    /// Without power it forgets all but its permanent memory. With it again it is limp, its goal is
    /// where it is, and its torque limit is the largest (MX-64 manual: Torque Enable, Goal Position
    /// and Torque Limit after power-on).
    fn power(&mut self, on: bool) {
        self.powered = on;
        (self.alarm, self.loaded_s) = (0, 0.0);
        let memory = &mut self.memory;
        memory.set(Item::TorqueEnable, 0);
        memory.set(Item::Led, 0);
        memory.set(Item::MovingSpeed, 0);
        memory.set(Item::PGain, FACTORY_P_GAIN);
        if let Some(here) = memory.get(Item::PresentPosition) {
            memory.set(Item::GoalPosition, here);
        }
        // A model without a largest torque in its memory: all it can.
        memory.set(Item::TorqueLimit, memory.get(Item::MaxTorque).unwrap_or(FULL));
    }

    /// Alarms and what the shutdown register does about them.
    fn watch(&mut self, reading: Reading, dt_s: f64) {
        let Some(shutdown) = self.memory.get(Item::Shutdown) else { return };
        if let Some(limit_c) = self.memory.si(Item::TemperatureLimit) {
            if reading.temperature_c >= limit_c {
                self.alarm |= error_bit::HOT;
            } else if reading.temperature_c < limit_c - COOLED_K {
                self.alarm &= !error_bit::HOT;
            }
        }
        self.loaded_s = if reading.load.abs() >= FULL_LOAD { self.loaded_s + dt_s } else { 0.0 };
        if self.loaded_s > OVERLOAD_S && self.memory.table().register(Item::AlarmLed).is_some() {
            self.alarm |= error_bit::OVERLOAD;
        }
        let torque_on = self.memory.get(Item::TorqueEnable) == Some(1);
        if u16::from(self.alarm) & shutdown & 0x24 != 0 && torque_on {
            self.memory.set(Item::TorqueEnable, 0);
            self.memory.set(Item::TorqueLimit, 0);
        }
    }

    /// The host gives it torque again: the overload is over until it comes back.
    pub(super) fn written(&mut self) {
        if self.memory.get(Item::TorqueLimit).is_some_and(|limit| limit > 0) {
            self.alarm &= !error_bit::OVERLOAD;
        }
    }
}
