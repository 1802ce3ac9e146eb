//! One servo and its joint: the only place where registers become angles of the joint and back.

use plumbline_model::robot::{Servo, ServoDirection};

use super::refusal::Refusal;
use crate::dynamixel::{ControlTable, Item, LAST_TICK, Register, Ticks};

/// A servo with its registers.
#[derive(Clone, Debug)]
pub(super) struct ServoUnit {
    pub servo: Servo,
    pub table: &'static ControlTable,
    /// Address and length of what is read in every cycle.
    pub block: (u16, u16),
}

/// What a cycle reads of a servo.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Measured {
    pub angle_rad: Option<f64>,
    pub speed_rad_s: Option<f64>,
    pub load: Option<f64>,
    pub voltage_v: Option<f64>,
    pub temperature_c: Option<f64>,
}

const BLOCK: [Item; 5] = [
    Item::PresentPosition,
    Item::PresentSpeed,
    Item::PresentLoad,
    Item::PresentVoltage,
    Item::PresentTemperature,
];

impl ServoUnit {
    /// `None` when the model is not known or cannot move.
    pub fn new(servo: &Servo) -> Option<Self> {
        let table = ControlTable::of_model(&servo.model).filter(|table| table.moves)?;
        let registers = || BLOCK.iter().filter_map(|item| table.register(*item));
        let first = registers().map(|r| r.address).min()?;
        let end = registers().map(|r| r.address + r.size).max()?;
        Some(Self { servo: servo.clone(), table, block: (first, end - first) })
    }

    pub fn id(&self) -> u8 {
        self.servo.id
    }

    fn sign(&self) -> f64 {
        match self.servo.direction {
            ServoDirection::Direct => 1.0,
            ServoDirection::Indirect => -1.0,
        }
    }

    /// What the bytes of the cycle's block say.
    pub fn measured(&self, data: &[u8]) -> Measured {
        let first = self.block.0;
        let si = |item| {
            let register: &Register = self.table.register(item)?;
            Some(register.si(register.in_data(first, data)?))
        };
        Measured {
            angle_rad: self
                .ticks(data)
                .and_then(|ticks| self.table.motor_rad(ticks))
                .map(|m| self.servo.joint_rad(m)),
            speed_rad_s: si(Item::PresentSpeed).map(|speed| self.sign() * speed / self.servo.ratio),
            load: si(Item::PresentLoad).map(|load| self.sign() * load),
            voltage_v: si(Item::PresentVoltage),
            temperature_c: si(Item::PresentTemperature),
        }
    }

    /// The position, if it is one that a servo in joint mode can have.
    fn ticks(&self, data: &[u8]) -> Option<Ticks> {
        let raw = self.table.register(Item::PresentPosition)?.in_data(self.block.0, data)?;
        (raw <= LAST_TICK).then_some(Ticks(raw))
    }

    /// Bytes of goal position and moving speed, which lie side by side from
    /// [`goal_address`](Self::goal_address) on, for an angle (rad) and a largest speed (rad/s) of
    /// the joint.
    pub fn goal_bytes(&self, joint_rad: f64, speed_rad_s: f64) -> Result<Vec<u8>, Refusal> {
        let motor_rad = self.servo.motor_rad(joint_rad);
        let ticks = self.table.ticks(motor_rad).ok_or_else(|| self.out_of_range(joint_rad))?;
        let mut bytes = ticks.0.to_le_bytes().to_vec();
        if let Some(register) = self.table.register(Item::MovingSpeed) {
            // Zero would mean "as fast as possible".
            let largest = 0x3FF;
            let raw = register
                .raw(speed_rad_s.abs() * self.servo.ratio.abs())
                .map_or(largest, |raw| raw.min(largest));
            bytes.extend_from_slice(&raw.max(1).to_le_bytes());
        }
        Ok(bytes)
    }

    /// Angle of the joint (rad) that the bytes of the goal's register stand for.
    pub fn goal_rad(&self, data: &[u8]) -> Option<f64> {
        let register = self.table.register(Item::GoalPosition)?;
        let raw = register.in_data(register.address, data).filter(|raw| *raw <= LAST_TICK)?;
        Some(self.servo.joint_rad(register.si(raw)))
    }

    /// Where goals are written; `None` for a servo without goals.
    pub fn goal_address(&self) -> Option<u16> {
        self.table.register(Item::GoalPosition).map(|register| register.address)
    }

    /// The angle that is really sent for a wanted one, after rounding to ticks.
    #[cfg(test)]
    pub fn rounded_rad(&self, joint_rad: f64) -> Option<f64> {
        let ticks = self.table.ticks(self.servo.motor_rad(joint_rad))?;
        self.table.motor_rad(ticks).map(|motor_rad| self.servo.joint_rad(motor_rad))
    }

    fn out_of_range(&self, joint_rad: f64) -> Refusal {
        let (joint, name) = (self.servo.joint, self.servo.title.clone());
        if !joint_rad.is_finite() {
            return Refusal::NotANumber { joint, name };
        }
        let limits = self.servo.joint_limits();
        let beyond_rad = limits.excess_rad(joint_rad);
        let limit_rad = joint_rad - beyond_rad;
        Refusal::Position { joint, name, wanted_rad: joint_rad, limit_rad, beyond_rad }
    }
}
