//! How an arm is driven.

use std::sync::Arc;
use std::time::Duration;

use super::guard::{FloorShift, Guard};
use super::stop::{Heartbeat, StopSwitch};
use crate::dynamixel::BusTiming;

/// Called after every cycle, from the thread of the bus: wake the window, nothing more.
pub type OnState = Box<dyn Fn() + Send>;

/// How an arm is driven. Limits of joints, speed, step, temperature and load are those of the rig.
pub struct ArmOptions {
    /// Timing of the bus; its rate is replaced by the rig's.
    pub timing: BusTiming,
    /// Time from one cycle to the next.
    pub period: Duration,
    /// A cycle's answers are repeated until this time after its beginning.
    pub cycle_deadline: Duration,
    /// The stop.
    pub stop: StopSwitch,
    /// Sign of life of the window; `None` where nobody watches (a script).
    pub heartbeat: Option<Heartbeat>,
    /// Without a sign of life for this long the arm holds.
    pub heartbeat_timeout: Duration,
    /// Limits beyond those of joints; the floor is always among them.
    pub guards: Vec<Arc<dyn Guard>>,
    /// By how much the floor lies elsewhere for the arm as it is described.
    pub floor: FloorShift,
    /// Servos that wait longer than this before they answer are told of; nothing is written to them
    /// unasked.
    pub return_delay: Duration,
    /// A goal is written only to a servo whose angle was read no longer ago than this.
    pub write_window: Duration,
    /// A servo that does not answer for this many cycles, and for the time of `silence`, is silent:
    /// what was known of it is not any more, and what moves with it is held.
    pub missed_cycles: u32,
    /// See `missed_cycles`.
    pub silence: Duration,
    /// A joint that stays behind for this long makes the arm hold.
    pub following_timeout: Duration,
    /// A load above the gate for this long makes the arm hold.
    pub load_timeout: Duration,
    /// Called after every cycle.
    pub on_state: Option<OnState>,
}

impl Default for ArmOptions {
    fn default() -> Self {
        Self {
            timing: BusTiming::default(),
            period: Duration::from_millis(16),
            cycle_deadline: Duration::from_millis(20),
            stop: StopSwitch::default(),
            heartbeat: None,
            heartbeat_timeout: Duration::from_secs(1),
            guards: vec![],
            floor: FloorShift::default(),
            return_delay: Duration::from_micros(10),
            write_window: Duration::from_millis(30),
            missed_cycles: 6,
            silence: Duration::from_millis(200),
            following_timeout: Duration::from_millis(1500),
            load_timeout: Duration::from_millis(300),
            on_state: None,
        }
    }
}
