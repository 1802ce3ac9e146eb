//! One servo and its joint: the only place where registers become angles of the joint and back.

use plumbline_model::robot::servo::{FULL, LAST_TICK, TICKS_PER_TURN};
use plumbline_model::robot::{Servo, ServoDirection};

use super::refusal::Refusal;
use crate::dynamixel::{ControlTable, Item, Register, Ticks};

/// A servo with its registers.
#[derive(Clone, Debug)]
pub(super) struct ServoUnit {
    pub servo: Servo,
    pub table: &'static ControlTable,
    /// Address and length of what is read in every cycle.
    pub block: (u16, u16),
}

/// What a cycle reads of a servo, all of one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Measured {
    pub torque_on: Option<bool>,
    /// The goal's register.
    pub goal: Option<Ticks>,
    /// Share of the stall torque that it may use; zero after an overload shutdown.
    pub torque_limit: Option<f64>,
    /// The position as it counts it; `None` when that is none of a servo in joint mode.
    pub ticks: Option<Ticks>,
    pub speed_rad_s: Option<f64>,
    pub load: Option<f64>,
    pub voltage_v: Option<f64>,
    pub temperature_c: Option<f64>,
}

/// From torque to temperature: what a servo was told lies beside what it does, so that one answer
/// says whether it is still the servo that was told (after a loss of power, torque is off).
const BLOCK: [Item; 8] = [
    Item::TorqueEnable,
    Item::GoalPosition,
    Item::TorqueLimit,
    Item::PresentPosition,
    Item::PresentSpeed,
    Item::PresentLoad,
    Item::PresentVoltage,
    Item::PresentTemperature,
];

/// Ticks of a whole turn.
const TURN: i32 = TICKS_PER_TURN as i32;
/// A joint may read this far beyond the first or last tick: it was pushed over the seam.
pub(super) const OVER_THE_SEAM: i32 = 64;

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
        let raw = |item| self.table.register(item)?.in_data(self.block.0, data);
        let si = |item| {
            let register: &Register = self.table.register(item)?;
            Some(register.si(register.in_data(self.block.0, data)?))
        };
        let position = |item| raw(item).filter(|raw| *raw <= LAST_TICK).map(Ticks);
        Measured {
            torque_on: raw(Item::TorqueEnable).map(|on| on != 0),
            goal: position(Item::GoalPosition),
            torque_limit: si(Item::TorqueLimit),
            ticks: position(Item::PresentPosition),
            speed_rad_s: si(Item::PresentSpeed).map(|speed| self.sign() * speed / self.servo.ratio),
            load: si(Item::PresentLoad).map(|load| self.sign() * load),
            voltage_v: si(Item::PresentVoltage),
            temperature_c: si(Item::PresentTemperature),
        }
    }

    /// Angle of the joint (rad) at a count, which may lie a little beyond the seam of the turn.
    pub fn joint_rad(&self, ticks: i32) -> Option<f64> {
        let register = self.table.register(Item::PresentPosition)?;
        let tick_rad = register.si(1) - register.si(0);
        Some(self.servo.joint_rad(register.si(0) + f64::from(ticks) * tick_rad))
    }

    /// Where to send it for an angle (rad). A place a little beyond the seam of the turn is the
    /// last tick before it: sent across, the servo would take a whole turn.
    pub fn goal_ticks(&self, joint_rad: f64) -> Result<Ticks, Refusal> {
        let out = || self.out_of_range(joint_rad);
        let register = self.table.register(Item::GoalPosition).ok_or_else(out)?;
        let tick_rad = register.si(1) - register.si(0);
        let count = ((self.servo.motor_rad(joint_rad) - register.si(0)) / tick_rad).round();
        let over = f64::from(OVER_THE_SEAM);
        // NaN fails the comparison.
        if !(count >= -over && count <= f64::from(LAST_TICK) + over) {
            return Err(out());
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it was made to fit")]
        Ok(Ticks(count.clamp(0.0, f64::from(LAST_TICK)) as u16))
    }

    /// Bytes of goal position and moving speed, which lie side by side from
    /// [`goal_address`](Self::goal_address) on, with a largest speed (rad/s) of the joint.
    pub fn goal_bytes(&self, goal: Ticks, speed_rad_s: f64) -> Vec<u8> {
        let mut bytes = goal.0.to_le_bytes().to_vec();
        if let Some(register) = self.table.register(Item::MovingSpeed) {
            // Zero would mean "as fast as possible".
            let raw =
                register.raw(speed_rad_s.abs() * self.servo.ratio.abs()).map_or(FULL, |raw| raw.min(FULL));
            bytes.extend_from_slice(&raw.max(1).to_le_bytes());
        }
        bytes
    }

    /// Where goals are written; `None` for a servo without goals.
    pub fn goal_address(&self) -> Option<u16> {
        self.table.register(Item::GoalPosition).map(|register| register.address)
    }

    /// The angle that is really sent for a wanted one, after rounding to ticks.
    #[cfg(test)]
    pub fn rounded_rad(&self, joint_rad: f64) -> Option<f64> {
        self.joint_rad(i32::from(self.goal_ticks(joint_rad).ok()?.0))
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

/// Which turn a count belongs to: a joint that stood near one end of the turn and reads near the
/// other went over the seam, for it cannot have turned all the way. `near` is where it is known to
/// have been a moment ago. Beyond [`OVER_THE_SEAM`] the count is taken as it is.
pub(super) fn unwrapped(ticks: Ticks, near: Option<i32>) -> i32 {
    let plain = i32::from(ticks.0);
    let Some(near) = near else { return plain };
    let others = [plain - TURN, plain + TURN];
    let possible = |count: &i32| (-OVER_THE_SEAM..=i32::from(LAST_TICK) + OVER_THE_SEAM).contains(count);
    let mut best = plain;
    for other in others.into_iter().filter(possible) {
        if (other - near).abs() < (best - near).abs() {
            best = other;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use plumbline_model::robot::Rig;

    use super::*;

    #[test]
    fn a_count_beside_the_seam_belongs_to_where_the_joint_was() {
        for (ticks, near, expected) in [
            (4095, Some(0), -1),
            (4090, Some(-1), -6),
            (0, Some(-6), 0),
            (0, Some(4095), 4096),
            (3, Some(4096), 4099),
            (4095, Some(4099), 4095),
            (4095, None, 4095),
            (0, None, 0),
            (2048, Some(0), 2048),
            // Too far over the seam to be a push.
            (3900, Some(0), 3900),
            (300, Some(4095), 300),
        ] {
            assert_eq!(unwrapped(Ticks(ticks), near), expected, "{ticks} near {near:?}");
        }
    }

    #[test]
    fn a_finger_over_the_seam_is_held_on_its_own_side() {
        let rig = Rig::built_in("nico").expect("comes with the program");
        for name in ["r_thumb_x", "r_indexfinger_x", "l_thumb_z", "r_wrist_x"] {
            let joint = rig.description.find_joint(name).expect("a joint");
            let unit = ServoUnit::new(rig.servo_of(joint).expect("a servo")).expect("known");
            for (count, held) in [(-1, 0), (-64, 0), (0, 0), (4095, 4095), (4096, 4095), (4159, 4095)] {
                let angle_rad = unit.joint_rad(count).expect("an angle");
                assert_eq!(unit.goal_ticks(angle_rad), Ok(Ticks(held)), "{name} at {count}");
            }
            for count in [-66, 4162] {
                let angle_rad = unit.joint_rad(count).expect("an angle");
                assert!(
                    matches!(unit.goal_ticks(angle_rad), Err(Refusal::Position { .. })),
                    "{name} at {count}"
                );
            }
        }
    }
}
