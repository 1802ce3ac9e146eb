//! What is known about the joints at one moment.

use std::sync::Arc;
use std::time::{Duration, Instant};

use plumbline_model::image_pair::Stamp;
use plumbline_model::robot::{JointIndex, Posture};

use super::command::{Motion, MoveId, MoveOutcome};
use super::refusal::{HoldReason, Refusal};
use crate::dynamixel::{BusCounts, BusScan, WireTime};

/// One joint. What is not known is `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct JointReading {
    /// The joint.
    pub joint: JointIndex,
    /// Id of its servo.
    pub servo: u8,
    /// Angle by the encoder, rad of the joint, as last read.
    pub angle_rad: Option<f64>,
    /// Angle sent last, rad of the joint.
    pub goal_rad: Option<f64>,
    /// Speed, rad/s of the joint.
    pub speed_rad_s: Option<f64>,
    /// Load as a signed share of the stall torque, in the joint's direction.
    pub load: Option<f64>,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
    /// Supply voltage, V.
    pub voltage_v: Option<f64>,
    /// Current, A.
    pub current_a: Option<f64>,
    /// Whether its torque is on, as the servo said last; `None` when it is silent.
    pub torque_on: Option<bool>,
    /// Share of the stall torque that it may use: 0 after it shut down for an overload, so that it
    /// has torque on and no force.
    pub force: Option<f64>,
    /// It was silent since it was taken hold of: nothing is sent to it until it is taken hold of anew.
    pub let_go: bool,
    /// When the angle was read, host clock.
    pub read_at: Option<Instant>,
    /// Age of the angle when the state was published.
    pub age: Option<Duration>,
    /// What is wrong with it and what to do.
    pub problem: Option<String>,
}

impl JointReading {
    /// Of a servo that was never read.
    pub fn new(joint: JointIndex, servo: u8) -> Self {
        Self {
            joint,
            servo,
            angle_rad: None,
            goal_rad: None,
            speed_rad_s: None,
            load: None,
            temperature_c: None,
            voltage_v: None,
            current_a: None,
            torque_on: None,
            force: None,
            let_go: false,
            read_at: None,
            age: None,
            problem: None,
        }
    }
}

/// How the bus is doing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BusStatistics {
    /// Cycles so far.
    pub cycles: u64,
    /// Cycles in which every servo in use was read.
    pub complete_cycles: u64,
    /// Complete cycles per second over the last second; `None` during the first.
    pub complete_per_s: Option<f64>,
    /// What passed over the wire in the last cycle.
    pub last_cycle: WireTime,
    /// Time of the last cycle on the wire itself, without the host's pauses, s.
    pub last_wire_s: f64,
    /// Answers and faults since the connection was made.
    pub counts: BusCounts,
}

/// All joints at one moment.
#[derive(Clone, Debug)]
pub struct JointState {
    /// Counts up by one per cycle.
    pub stamp: Stamp,
    /// In the order of the rig's servos.
    pub joints: Arc<[JointReading]>,
    /// What the arm does.
    pub motion: Motion,
    /// Whether STOP is latched.
    pub stopped: bool,
    /// All joints as measured; joints without a servo stand as at rest, those that are `unknown`
    /// where they were last seen. `None` until every servo in use was read once.
    pub measured: Option<Posture>,
    /// Joints whose servo is silent, was never read, or is not who the rig says: where they are is
    /// not known, whatever `measured` holds for them.
    pub unknown: Arc<[JointIndex]>,
    /// Those of `unknown` whose servo answers, but later than this machine or the line can wait.
    pub late: Arc<[JointIndex]>,
    /// All joints as commanded last, the others as measured.
    pub commanded: Option<Posture>,
    /// Joints that stand and set out from where they are where their goals lie in something.
    pub at_rest: Arc<[JointIndex]>,
    /// The bus.
    pub bus: BusStatistics,
    /// The newest ends of moves, oldest first.
    pub outcomes: Arc<[(MoveId, MoveOutcome)]>,
    /// The newest refusal of anything that was asked, with a number that grows with each.
    pub refusal: Option<(u64, Refusal)>,
    /// What the operator should know, a sentence each (a servo gets warm).
    pub warnings: Arc<[String]>,
    /// Servos that wait longer before each answer than they need to; see
    /// [`ArmDriver::shorten_answers`](super::ArmDriver::shorten_answers).
    pub slow_answers: usize,
    /// Why the port is gone.
    pub gone: Option<String>,
    /// Who was on the bus when it was last asked.
    pub scan: Arc<BusScan>,
}

impl JointState {
    /// Of an arm that holds since it was connected; nothing else is known than what its joints say.
    pub fn new(stamp: Stamp, joints: impl Into<Arc<[JointReading]>>) -> Self {
        Self {
            stamp,
            joints: joints.into(),
            motion: Motion::Holding(HoldReason::Connected),
            stopped: false,
            measured: None,
            unknown: Arc::from([]),
            late: Arc::from([]),
            commanded: None,
            at_rest: Arc::from([]),
            bus: BusStatistics::default(),
            outcomes: Arc::from([]),
            refusal: None,
            warnings: Arc::from([]),
            slow_answers: 0,
            gone: None,
            scan: Arc::default(),
        }
    }

    /// The reading of a joint.
    pub fn of(&self, joint: JointIndex) -> Option<&JointReading> {
        self.joints.iter().find(|reading| reading.joint == joint)
    }

    /// Whether it is known where a joint is; joints without a servo do not move.
    pub fn knows(&self, joint: JointIndex) -> bool {
        !self.unknown.contains(&joint)
    }

    /// How a move ended, if it did and not too many ended since.
    pub fn outcome(&self, id: MoveId) -> Option<&MoveOutcome> {
        self.outcomes.iter().find(|(ended, _)| *ended == id).map(|(_, outcome)| outcome)
    }
}
