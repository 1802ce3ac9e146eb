//! The robot: how it is connected, where its joints are, what moves and what would move.

use std::sync::Arc;
use std::time::Duration;

use plumbline_hardware::joints::Unheard;
use plumbline_model::frame::{Point, Robot};
use plumbline_model::robot::{JointIndex, Limits, Posture, Rig, Servo};

pub use super::unable::InTheWay;

/// The robot at one moment. Angles are those of the joints, in radians.
#[derive(Clone, Debug, Default)]
pub struct RobotView {
    /// What the robot is; `None` only when the rig file could not be read.
    pub rig: Option<Arc<Rig>>,
    /// How it is connected.
    pub connection: Connection,
    /// Whether it moves, stands or is limp.
    pub motion: MotionState,
    /// In the middle of what it does it stands, for whoever leads it made it pause: it moves when he lets it go on.
    pub rests_on_the_way: bool,
    /// Whether STOP is latched; nothing moves until it is released.
    pub stopped: bool,
    /// All joints with a servo, in the order of the rig file.
    pub joints: Arc<[JointView]>,
    /// Present angles by the encoders; those of `unknown` joints are where they were last seen.
    /// `None` before the first complete reading.
    pub measured: Option<Posture>,
    /// Joints whose servo does not answer or is not who it should be: where they are is not known.
    pub unknown: Arc<[JointIndex]>,
    /// Those of `unknown` whose servo answers, but later than this computer can wait.
    pub late: Arc<[JointIndex]>,
    /// Angles that the servos were sent last; `None` when nothing was sent.
    pub commanded: Option<Posture>,
    /// The tip that jogging and Cartesian targets speak of.
    pub tip: String,
    /// Where the model says that tip is, by the encoders.
    pub tip_place: Option<TipPlace>,
    /// The model of the robot, for people: "as described", "with 2 effects".
    pub model: Arc<str>,
    /// Places of the tip during the last half minute, oldest first.
    pub trail: Arc<[Point<Robot>]>,
    /// A move that was asked for and does not run yet.
    pub preview: Option<Preview>,
    /// Why the last request was not carried out, and what to do; gone with the next that is.
    pub refusal: Option<String>,
    /// Whether that was merely because joints were not heard, so that it can be asked for again.
    pub is_unheard: bool,
    /// How many requests were not carried out so far: tells a new refusal from an old one.
    pub refused: u64,
    /// Poses to choose from: those of the rig, then the operator's own.
    pub poses: Arc<[PoseView]>,
    /// How the bus is doing.
    pub bus: BusView,
    /// Serial ports of this machine; `None` until asked for.
    pub ports: Option<Arc<[PortView]>>,
    /// Share of the usual speed at which moves run, 0–2.
    pub speed: f64,
}

impl RobotView {
    /// The present angles, if those of all the given joints are known.
    pub fn known(&self, joints: &[JointIndex]) -> Option<&Posture> {
        self.measured.as_ref().filter(|_| joints.iter().all(|joint| !self.unknown.contains(joint)))
    }

    /// What to do where it is not known where a joint is: load is called load.
    pub fn advice_for(&self, joint: JointIndex) -> &'static str {
        let why = if self.late.contains(&joint) { Unheard::TooBusy } else { Unheard::Silent };
        why.advice()
    }
}

/// How the robot is connected.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Connection {
    /// Not at all.
    #[default]
    None,
    /// Being connected.
    Connecting {
        /// To what, for people.
        to: String,
        /// What is being done.
        doing: String,
    },
    /// Connected.
    Connected {
        /// To what: "twin \"lab\"", "/dev/ttyUSB0".
        to: String,
        /// Whether it is the twin, so that nothing real can be hurt.
        twin: bool,
    },
    /// It was connected and is not any more, or could not be.
    Lost {
        /// To what.
        to: String,
        /// What happened and what to do.
        reason: String,
    },
}

impl Connection {
    /// Whether joints can be read.
    pub fn is_connected(&self) -> bool {
        matches!(self, Self::Connected { .. })
    }
}

/// What the arm does.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum MotionState {
    /// Not known: not connected, or no servo answers.
    #[default]
    Unknown,
    /// No servo has torque: joints can be turned by hand, and sink.
    Limp,
    /// Stands where it is, with torque.
    Holding {
        /// Why, if it was made to ("released the jog key", "servo 5 is too hot").
        why: Option<String>,
    },
    /// Moves.
    Moving {
        /// What it does, for people: "to Home".
        what: String,
        /// How far it is, 0–1; `None` when jogging.
        fraction: Option<f64>,
        /// Time left.
        remaining: Option<Duration>,
    },
}

/// A joint and its servo.
#[derive(Clone, Debug, PartialEq)]
pub struct JointView {
    /// Which joint.
    pub joint: JointIndex,
    /// Its name in the description.
    pub name: String,
    /// Its name for people.
    pub title: String,
    /// The servo's id on the bus.
    pub servo: u8,
    /// The servo's model.
    pub model: String,
    /// Limits.
    pub limits: Limits,
    /// Limits at the present angles of other joints.
    pub limits_now: Limits,
    /// Present angle by the encoder.
    pub angle_rad: Option<f64>,
    /// Angle sent last.
    pub goal_rad: Option<f64>,
    /// Present speed.
    pub speed_rad_s: Option<f64>,
    /// Share of the servo's stall torque, signed.
    pub load: Option<f64>,
    /// Current of its motor, of servos that say it, A.
    pub current_a: Option<f64>,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
    /// Supply voltage, V.
    pub voltage_v: Option<f64>,
    /// Whether it holds.
    pub torque_on: Option<bool>,
    /// It was silent since it was taken hold of, or holds without having been: nothing is sent to it
    /// before its torque is switched on anew.
    pub let_go: bool,
    /// It has torque on and no force: its servo shut down after an overload.
    pub no_force: bool,
    /// Share of its stall torque that its servo may use, as it says.
    pub force: Option<f64>,
    /// Age of the angle.
    pub age: Option<Duration>,
    /// What is wrong with it and what to do.
    pub problem: Option<String>,
    /// The last minutes, oldest first.
    pub history: Arc<[JointSample]>,
}

impl JointView {
    /// Whether it has to be taken hold of before it can be moved.
    pub fn has_to_be_held(&self) -> bool {
        self.torque_on != Some(true) || self.let_go || self.no_force
    }

    /// Of a servo that was not heard yet.
    pub fn unheard(servo: &Servo, limits: Limits) -> Self {
        Self {
            joint: servo.joint,
            name: servo.joint_name.clone(),
            title: servo.title.clone(),
            servo: servo.id,
            model: servo.model.clone(),
            limits,
            limits_now: limits,
            angle_rad: None,
            goal_rad: None,
            speed_rad_s: None,
            load: None,
            current_a: None,
            temperature_c: None,
            voltage_v: None,
            torque_on: None,
            let_go: false,
            no_force: false,
            force: None,
            age: None,
            problem: None,
            history: Arc::from([]),
        }
    }

    /// The same joint when nobody knows anything of it any more.
    pub fn without_readings(&self) -> Self {
        Self {
            angle_rad: None,
            goal_rad: None,
            speed_rad_s: None,
            load: None,
            current_a: None,
            temperature_c: None,
            voltage_v: None,
            torque_on: None,
            let_go: false,
            no_force: false,
            force: None,
            age: None,
            problem: None,
            ..self.clone()
        }
    }
}

/// A joint some time ago.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSample {
    /// Seconds since the connection was made.
    pub at_s: f64,
    /// Share of stall torque, signed.
    pub load: Option<f64>,
    /// Temperature, °C.
    pub temperature_c: Option<f64>,
}

/// Place and direction of a tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipPlace {
    /// Place.
    pub point: Point<Robot>,
    /// Turn about the vertical, rad.
    pub yaw_rad: f64,
    /// One standard deviation of the place along the worst direction, by what is not known of the
    /// model's effects, m; zero without effects.
    pub sigma_m: f64,
}

/// A move that does not run yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Preview {
    /// What would be done, for people: "to Home", "right elbow to 92°".
    pub title: String,
    /// Where it would end.
    pub end: Posture,
    /// Whether it can run: how near it comes to something (m, and what), or why not.
    pub path: Result<PathCheck, InTheWay>,
    /// How long it would take.
    pub duration: Duration,
    /// The joint that turns most, for people, and by how much (rad).
    pub largest_turn: Option<(String, f64)>,
    /// The model of the robot, for people: "as described", "with 2 effects".
    pub model: Arc<str>,
    /// One standard deviation of the place that the tip gets to, along the worst direction, by what is
    /// not known of the model's effects, m; `None` where no place was asked for.
    pub tip_sigma_m: Option<f64>,
}

/// A path that can run.
#[derive(Clone, Debug, PartialEq)]
pub struct PathCheck {
    /// Smallest distance of two parts that are not neighbors, or of a part to the table, m.
    pub smallest_m: f64,
    /// Which two, for people.
    pub between: String,
}

/// A pose to choose.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseView {
    /// Short name.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// What it is for.
    pub about: String,
    /// Joints and their angles, rad.
    pub joints: Vec<(JointIndex, f64)>,
    /// Whether the operator saved it (and can delete it).
    pub own: bool,
}

/// How the bus is doing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BusView {
    /// Complete cycles per second over the last second.
    pub cycles_per_s: Option<f64>,
    /// Complete cycles so far.
    pub cycles: u64,
    /// Answers that did not come, came late, were garbled, had a wrong id or checksum, by kind
    /// for people, with how many there were.
    pub faults: Vec<(String, u64)>,
    /// Packets that were asked for again within their cycle.
    pub retries: u64,
    /// Ids that the rig has and the bus has not.
    pub missing: Vec<u8>,
    /// Ids of servos that answer, but later than this computer can wait.
    pub late: Vec<u8>,
    /// Ids on the bus that the rig does not know, with their model.
    pub unexpected: Vec<(u8, String)>,
    /// Servos that wait longer before each answer than they need to.
    pub slow_answers: usize,
    /// What the operator should know, with what to do (latency timer, one id twice).
    pub warnings: Vec<String>,
}

impl BusView {
    /// Which servos answer too late and what to do, a sentence; `None` where none does.
    pub fn late_answers(&self) -> Option<String> {
        let ids = self.late.iter().map(u8::to_string).collect::<Vec<_>>().join(", ");
        let who = match self.late.len() {
            0 => return None,
            1 => format!("Servo {ids} answers"),
            _ => format!("Servos {ids} answer"),
        };
        Some(format!("{who} too late: {}.", Unheard::TooBusy.advice()))
    }
}

/// A serial port of this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortView {
    /// Path, as it is opened.
    pub path: String,
    /// What is plugged in there, for people.
    pub what: String,
}

/// The robot as nobody knows it any more: no motion, no rate, no angles.
pub(crate) fn robot_without_its_thread(before: &RobotView, reason: &str) -> RobotView {
    let to = match &before.connection {
        Connection::None => "the robot".to_owned(),
        Connection::Connecting { to, .. }
        | Connection::Connected { to, .. }
        | Connection::Lost { to, .. } => to.clone(),
    };
    RobotView {
        connection: Connection::Lost { to, reason: reason.to_owned() },
        motion: MotionState::Unknown,
        rests_on_the_way: false,
        // Whoever looks after the threads has pressed it.
        stopped: true,
        joints: before.joints.iter().map(JointView::without_readings).collect(),
        measured: None,
        commanded: None,
        tip_place: None,
        trail: Arc::default(),
        preview: None,
        refusal: Some(reason.to_owned()),
        bus: BusView::default(),
        ..before.clone()
    }
}
