//! States of joints that nobody read, for tests.

use std::sync::Arc;
use std::time::Instant;

use plumbline_hardware::joints::{JointReading, JointState};
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
        angle_rad: Some(angle_rad),
        goal_rad: Some(goal_rad),
        read_at: Some(captured_at),
        ..JointReading::new(servo.joint, servo.id)
    };
    let joints: Vec<JointReading> = rig.servos.iter().map(reading).collect();
    let state = JointState::new(Stamp { seq: 1, captured_at }, joints);
    Arc::new(JointState { unknown: Arc::from(silent), ..state })
}
