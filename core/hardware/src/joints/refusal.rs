//! Why something is not done, and why the arm holds: which joint, which limit, by how much.

use std::time::Duration;

use plumbline_model::robot::JointIndex;

/// Why nothing is heard of a servo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unheard {
    /// It does not answer.
    Silent,
    /// It answers, later than anybody waits, or is not even asked in time: this computer or the line does
    /// not keep up.
    TooBusy,
}

impl Unheard {
    /// What to do.
    pub fn advice(self) -> &'static str {
        match self {
            Self::Silent => "check its cable and power",
            Self::TooBusy => {
                "the computer was too busy to hear its answers in time: close other programs, or wait until it has less to do"
            }
        }
    }

    fn happened(self) -> &'static str {
        match self {
            Self::Silent => "does not answer",
            Self::TooBusy => "was not heard in time",
        }
    }
}

/// Why a motion is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// NaN or infinity.
    #[error("the goal of {name} is not a number: the arm stays; choose another goal")]
    NotANumber {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
    },
    /// A move without joints, or a duration or a speed out of range.
    #[error("this is not a move: {what}")]
    NotAMove {
        /// What is wrong and what is right.
        what: String,
    },
    /// Nothing drives the joint.
    #[error("joint number {} has no servo: choose a joint that the rig file lists", .joint.0)]
    NoServo {
        /// The joint.
        joint: JointIndex,
    },
    /// Beyond a limit of the joint.
    #[error("{name} would go to {:.1}°, {:.1}° beyond its limit of {:.1}°", .wanted_rad.to_degrees(), .beyond_rad.abs().to_degrees(), .limit_rad.to_degrees())]
    Position {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Asked for.
        wanted_rad: f64,
        /// The limit that is exceeded.
        limit_rad: f64,
        /// By how much; negative below the lower limit.
        beyond_rad: f64,
    },
    /// Beyond what another joint leaves.
    #[error("{name} would be at {:.1}° where only ±{:.1}° are free ({why}): move the other joint first", .wanted_rad.to_degrees(), .largest_rad.to_degrees())]
    Coupled {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Where it would be.
        wanted_rad: f64,
        /// Largest angle to either side there.
        largest_rad: f64,
        /// What is in the way.
        why: String,
    },
    /// Too fast.
    #[error("{name} would turn at {:.0}°/s, its limit is {:.0}°/s: {advice}", .wanted_rad_s.abs().to_degrees(), .limit_rad_s.to_degrees())]
    Speed {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Asked for.
        wanted_rad_s: f64,
        /// Allowed.
        limit_rad_s: f64,
        /// What to do.
        advice: String,
    },
    /// Too hot to move.
    #[error(
        "the servo of {name} is {temperature_c:.0} °C hot, from {limit_c:.0} °C on nothing moves: relax the arm and let it cool down"
    )]
    Hot {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Measured.
        temperature_c: f64,
        /// Allowed.
        limit_c: f64,
    },
    /// Below the floor.
    #[error("{link} would be {:.0} mm high, {:.0} mm below the floor of {:.0} mm: keep the goal higher", .height_m * 1e3, (.floor_m - .height_m) * 1e3, .floor_m * 1e3)]
    Floor {
        /// The part of the arm.
        link: String,
        /// Its lowest point, m.
        height_m: f64,
        /// Allowed, m.
        floor_m: f64,
    },
    /// A guard's own reason: a collision, for example.
    #[error("{0}")]
    Guarded(String),
    /// No torque.
    #[error("{name} is limp: hold all joints first")]
    Limp {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
    },
    /// Its angle is not known.
    #[error("the servo of {name} {}, so its angle is not known: {}", .why.happened(), .why.advice())]
    Unknown {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Why it is not heard.
        why: Unheard,
    },
    /// Where another joint of its chain is, is not known.
    #[error(
        "{name} stays, because it is not known where {unknown_name} is, and with it the rest of that arm; its servo {}: {}", .why.happened(), .why.advice()
    )]
    UnknownInChain {
        /// The joint that was to move.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// The joint that is not known.
        unknown: JointIndex,
        /// Its name.
        unknown_name: String,
        /// Why it is not heard.
        why: Unheard,
    },
    /// It does not take a limit of its torque.
    #[error("the servo of {name} does not take a limit of {:.0} % of its torque, so it does not grip: look at its cable, then take hold of it anew (torque off and on)", .share * 1e2)]
    Force {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Asked for.
        share: f64,
    },
    /// It is not who the rig says.
    #[error("the servo of {name} (id {servo}) is not used: {why}")]
    Barred {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Id.
        servo: u8,
        /// What is wrong and what to do.
        why: String,
    },
    /// It was silent.
    #[error(
        "the servo of {name} did not answer for a while, so nothing is sent to it: look where it stands, then take hold of it (Hold all joints, in Robot)"
    )]
    LetGo {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
    },
    /// It stands far beyond the limits in its servo's memory.
    #[error(
        "{name} stands far beyond the limits in the memory of its servo, which takes no goal there: support it, turn it back by hand, then take hold of it (Hold all joints, in Robot)"
    )]
    BeyondServo {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
    },
    /// It shut down after an overload.
    #[error(
        "the servo of {name} shut down after an overload and has no force: support the joint, lighten it, then give it force again (torque on)"
    )]
    NoForce {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
    },
    /// Stop is pressed.
    #[error("STOP is pressed: release it first")]
    Stopped,
    /// The window does not answer.
    #[error(
        "the window does not answer, so nothing moves until it does: if it stays so, close other programs that keep the computer busy"
    )]
    NoHeartbeat,
    /// The bus is gone.
    #[error("there is no connection to the servos: {0}")]
    Gone(String),
    /// Too many commands at once.
    #[error("commands come faster than the arm can take them: wait for the move before")]
    Busy,
}

/// Why the arm holds.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HoldReason {
    /// It was connected and has not moved since.
    #[error("connected, nothing was moved yet")]
    Connected,
    /// A move is done.
    #[error("the move is done")]
    Arrived,
    /// The operator wants it.
    #[error("asked to hold")]
    Asked,
    /// The last jog setpoint is over.
    #[error("jogging ended")]
    JogEnded,
    /// STOP.
    #[error("STOP was pressed")]
    Stop,
    /// No sign of life from the window.
    #[error(
        "the window did not answer for {:.1} s, so the arm holds; servos and cables are well: close other programs that keep the computer busy, then go on",
        .0.as_secs_f64()
    )]
    NoHeartbeat(Duration),
    /// On its way something was refused.
    #[error("{0}")]
    Refused(Refusal),
    /// A joint stays behind.
    #[error("{name} stays {:.1}° behind for {:.1} s: something blocks it, or it is too weak for its load", .behind_rad.abs().to_degrees(), .since.as_secs_f64())]
    NotFollowing {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Goal minus present, rad.
        behind_rad: f64,
        /// For how long.
        since: Duration,
    },
    /// Too much load.
    #[error("{name} carries {:.0} % of what its servo can, the limit is {:.0} %: lighten the load or change the pose", .load * 100.0, .limit * 100.0)]
    Heavy {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Share of the stall torque, without sign.
        load: f64,
        /// Allowed.
        limit: f64,
    },
    /// A servo that has to move is read too seldom.
    #[error(
        "the servo of {name} is read too seldom to move it safely (nothing newer than {:.0} ms for {:.1} s): look what the bus lamp says about the adapter, and close other programs",
        .age.as_secs_f64() * 1e3,
        .since.as_secs_f64()
    )]
    Slow {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Age of its angle.
        age: Duration,
        /// For how long.
        since: Duration,
    },
    /// A servo that has to move does not answer.
    #[error("the servo of {name} (id {servo}) did not answer in {cycles} cycles: check its cable and power")]
    NoAnswer {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Id.
        servo: u8,
        /// Cycles in a row.
        cycles: u32,
    },
    /// A servo raises an alarm.
    #[error("the servo of {name} (id {servo}) complains: {words}; lighten its load and let it cool down")]
    Alarm {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Id.
        servo: u8,
        /// What it says.
        words: String,
    },
    /// A servo switched its own torque off.
    #[error(
        "the servo of {name} (id {servo}) lost its torque: its power was cut, or it was overloaded or too hot; support the joint, then take hold of it (Hold all joints, in Robot)"
    )]
    TorqueLost {
        /// The joint.
        joint: JointIndex,
        /// Its name.
        name: String,
        /// Id.
        servo: u8,
    },
    /// The port vanished: servos stand where they were sent last.
    #[error("{0}; the servos keep the goal they were sent last")]
    Gone(String),
}
