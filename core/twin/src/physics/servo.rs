//! Servos in the physics: a goal comes in, a torque goes to the motor, the encoder is read.
//!
//! All angles are joint angles as the encoder has them: behind the gear, before play and give.

use plumbline_model::robot::servo::TICK_RAD;

use super::motor::{Motor, MotorHeat};
use crate::scenario::Holding;

/// What a servo is told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Whether it holds at all.
    pub torque_on: bool,
    /// Where to go, rad of the joint.
    pub goal_rad: f64,
    /// How fast, rad/s of the joint; `None`: as fast as it can.
    pub speed_rad_s: Option<f64>,
    /// Largest share of its torque that it may use, 0–1.
    pub torque_limit: f64,
    /// Gain of its position control over the factory's.
    pub gain: f64,
}

/// What a servo reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Joint angle by the encoder, rad.
    pub angle_rad: f64,
    /// Joint speed, rad/s.
    pub speed_rad_s: f64,
    /// Share of the full torque that the motor gives, in the joint's sense, −1 to 1.
    pub load: f64,
    /// Temperature, °C.
    pub temperature_c: f64,
    /// Supply, V.
    pub voltage_v: f64,
}

/// Supply with nothing to do, V, and its drop per servo at full load.
const SUPPLY_V: f64 = 12.0;
const DROP_V: f64 = 0.35;

/// A servo with its motor.
#[derive(Clone, Copy, Debug)]
pub(super) struct ServoMotor {
    motor: Motor,
    ratio: f64,
    holding: Holding,
    pub drive: Drive,
    /// Where the goal is on its way at the demanded speed, rad.
    setpoint_rad: f64,
    pub heat: MotorHeat,
    load: f64,
}

impl ServoMotor {
    pub(super) fn at(motor: Motor, ratio: f64, holding: Holding, angle_rad: f64) -> Self {
        let drive =
            Drive { torque_on: true, goal_rad: angle_rad, speed_rad_s: None, torque_limit: 1.0, gain: 1.0 };
        let heat = MotorHeat::default();
        Self { motor, ratio, holding, drive, setpoint_rad: angle_rad, heat, load: 0.0 }
    }

    /// A step of its control: the torque on the joint, Nm.
    pub(super) fn control(&mut self, dt_s: f64, angle_rad: f64) -> f64 {
        let tick_rad = TICK_RAD / self.ratio;
        let (seen_rad, limit) = match self.holding {
            Holding::Proportional => ((angle_rad / tick_rad).round() * tick_rad, self.drive.torque_limit),
            Holding::Exact => (angle_rad, self.drive.torque_limit),
        };
        if !self.drive.torque_on {
            self.setpoint_rad = angle_rad;
            self.load = 0.0;
            return 0.0;
        }
        let most_rad_s = self.motor.no_load_rad_s() / self.ratio;
        let speed_rad_s = self.drive.speed_rad_s.unwrap_or(most_rad_s).min(most_rad_s);
        let step_rad = speed_rad_s * dt_s;
        self.setpoint_rad += (self.drive.goal_rad - self.setpoint_rad).clamp(-step_rad, step_rad);
        let error_motor_rad = (self.setpoint_rad - seen_rad) * self.ratio;
        self.load = (error_motor_rad * self.motor.duty_per_rad * self.drive.gain).clamp(-limit, limit);
        self.load * self.motor.stall_nm() * self.ratio
    }

    /// Dry friction at the joint, Nm, for a speed of the joint and an outside torque on it.
    pub(super) fn friction_nm(&self, speed_rad_s: f64, outside_nm: f64) -> f64 {
        match self.holding {
            Holding::Exact => 0.0,
            Holding::Proportional => {
                let motor_nm = self.load * self.motor.stall_nm();
                let gear_load_nm = motor_nm - outside_nm / self.ratio;
                self.ratio * self.motor.friction_nm(speed_rad_s * self.ratio, gear_load_nm)
            }
        }
    }

    /// Time passes for its temperature.
    pub(super) fn warm(&mut self, dt_s: f64) {
        self.heat.pass(dt_s, self.load);
    }

    pub(super) fn reading(&self, angle_rad: f64, speed_rad_s: f64) -> Reading {
        Reading {
            angle_rad,
            speed_rad_s,
            load: self.load,
            temperature_c: self.heat.temperature_c,
            voltage_v: SUPPLY_V - DROP_V * self.load.abs(),
        }
    }

    /// As cold as at the start.
    pub(super) fn cool(&mut self) {
        self.heat = MotorHeat::default();
    }

    /// Stands somewhere, at rest, holding.
    pub(super) fn put(&mut self, angle_rad: f64) {
        self.drive.goal_rad = angle_rad;
        self.setpoint_rad = angle_rad;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn servo() -> ServoMotor {
        ServoMotor::at(Motor::of("MX-64").expect("known"), 1.0, Holding::Proportional, 0.0)
    }

    #[test]
    fn torque_is_in_proportion_to_the_error_and_ends_at_its_limit() {
        let mut servo = servo();
        servo.drive.goal_rad = 0.1;
        let mut torque_nm = 0.0;
        for _ in 0..100 {
            torque_nm = servo.control(0.002, 0.0);
        }
        assert!((torque_nm - 0.1 * 32.0).abs() < 0.3, "{torque_nm}");
        servo.drive.goal_rad = 2.0;
        servo.drive.torque_limit = 0.25;
        for _ in 0..1000 {
            torque_nm = servo.control(0.002, 0.0);
        }
        assert!((torque_nm - 0.25 * servo.motor.stall_nm()).abs() < 1e-9);
    }

    #[test]
    fn the_goal_is_approached_at_the_demanded_speed() {
        let mut servo = servo();
        servo.drive.goal_rad = 1.0;
        servo.drive.speed_rad_s = Some(0.5);
        for _ in 0..500 {
            servo.control(0.002, 0.0);
        }
        assert!((servo.setpoint_rad - 0.5).abs() < 1e-9, "a second at 0.5 rad/s");
    }

    #[test]
    fn without_torque_nothing_pulls_and_it_starts_again_from_where_it_is() {
        let mut servo = servo();
        servo.drive.torque_on = false;
        servo.drive.goal_rad = 1.0;
        assert_eq!(servo.control(0.002, 0.4), 0.0);
        assert_eq!(servo.setpoint_rad, 0.4);
    }
}
