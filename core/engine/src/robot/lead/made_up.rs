//! States of joints that nobody read, for tests.

use std::sync::Arc;
use std::time::Instant;

use plumbline_hardware::joints::{BusStatistics, HoldReason, JointReading, JointState, Motion};
use plumbline_model::Stamp;
use plumbline_model::robot::{JointIndex, Rig};

/// All servos of a rig at this angle and sent to that one, but those that are silent.
pub fn state(
    rig: &Rig,
    captured_at: Instant,
    [angle_rad, goal_rad]: [f64; 2],
    silent: &[JointIndex],
) -> Arc<JointState> {
    let reading = |servo: &plumbline_model::robot::Servo| JointReading {
        joint: servo.joint,
        servo: servo.id,
        angle_rad: Some(angle_rad),
        goal_rad: Some(goal_rad),
        speed_rad_s: None,
        load: None,
        temperature_c: None,
        voltage_v: None,
        current_a: None,
        torque_on: None,
        force: None,
        let_go: false,
        read_at: Some(captured_at),
        age: None,
        problem: None,
    };
    Arc::new(JointState {
        stamp: Stamp { seq: 1, captured_at },
        joints: rig.servos.iter().map(reading).collect(),
        motion: Motion::Holding(HoldReason::Connected),
        stopped: false,
        measured: None,
        unknown: Arc::from(silent),
        late: Arc::from([]),
        slow_answers: 0,
        commanded: None,
        bus: BusStatistics::default(),
        outcomes: Arc::from([]),
        refusal: None,
        warnings: Arc::from([]),
        scan: Arc::default(),
        gone: None,
    })
}
