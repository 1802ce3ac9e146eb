//! How the robots' servos count (Dynamixel MX, Seed Robotics' hands): once for the bus, for the twin
//! and for whoever predicts what they read.

use std::f64::consts::TAU;

/// Positions of a whole turn of a motor.
pub const TICKS_PER_TURN: u16 = 4096;
/// The last of them.
pub const LAST_TICK: u16 = TICKS_PER_TURN - 1;
/// The one that stands for angle zero.
pub const MIDDLE_TICK: u16 = TICKS_PER_TURN / 2;
/// From one position to the next, rad of the motor.
pub const TICK_RAD: f64 = TAU / TICKS_PER_TURN as f64;

/// Largest number of ten bits: all torque, all load, the largest speed.
pub const FULL: u16 = 0x3FF;
/// Set beside ten bits when they are negative: clockwise.
pub const SIGN_BIT: u16 = 0x400;

/// One count of a share of all torque or load.
pub const FRACTION: f64 = 1.0 / FULL as f64;
/// One count of speed, rad/s of the motor: 0.114 turns per minute.
pub const SPEED_RAD_S: f64 = 0.114 * TAU / 60.0;
/// One count of acceleration, rad/s² of the motor: 8.583°/s².
pub const ACCELERATION_RAD_S2: f64 = 8.583 * TAU / 360.0;
/// One count of supply voltage, V.
pub const VOLTAGE_V: f64 = 0.1;
/// One count of the delay before an answer, s.
pub const RETURN_DELAY_S: f64 = 2e-6;
/// Gain of the position control as from the factory.
pub const FACTORY_P_GAIN: u16 = 32;
