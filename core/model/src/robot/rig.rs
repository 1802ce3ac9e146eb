//! A robot on its table: servos, eyes, table, touchscreen, poses, limits.

use std::sync::{Arc, OnceLock};

use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, UnitQuaternion, Vector3};

use super::chain::Chain;
use super::description::{Description, JointIndex, Limits, LinkIndex};
use super::error::{DescriptionError, RigError};
use super::outlines::Outlines;
use super::posture::Posture;
use crate::frame::{Head, LeftCamera, Point, Pose, Robot};
use crate::parameter_words;
use crate::session::{CalibratedAt, Touchscreen};
use crate::stereo::StereoCameras;
use crate::workspace::Workspace;

/// A robot on its table. Another rig is another file, see `assets/robots`.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// Short name, as sessions refer to it.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// Links and joints.
    pub description: Arc<Description>,
    /// The servo bus.
    pub bus: Bus,
    /// Servos that move a joint each.
    pub servos: Vec<Servo>,
    /// Boards on the bus that move nothing.
    pub boards: Vec<Board>,
    /// Limits that depend on another joint.
    pub coupled_limits: Vec<CoupledLimit>,
    /// The eyes.
    pub eyes: EyeMount,
    /// The table.
    pub table: TableTop,
    /// The patch of the table that is worked on.
    pub work_patch: WorkPatch,
    /// The touchscreen, nominal.
    pub touchscreen: Touchscreen,
    /// Arms with their joints, hands and tips.
    pub arms: Vec<Arm>,
    /// Poses with a name, in the order in which they are offered.
    pub poses: Vec<NamedPose>,
    /// Straight edges that the eyes can measure by.
    pub outlines: Outlines,
    /// What is too hot, too heavy, too fast, too low.
    pub gate: Gate,
    /// Parts that its file does not give ([`Rig::read_measured`]); harmless stand-ins are in their
    /// place. Empty for a rig that can be worked with.
    pub lacking: Vec<RigPart>,
}

/// A part of a rig that may be lacking where a robot was only measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RigPart {
    /// The servo bus and its servos.
    Servos,
    /// The eyes.
    Eyes,
    /// The table and the patch of it that is worked on.
    Table,
    /// The touchscreen.
    Touchscreen,
    /// Arms with hands and tips.
    Arms,
    /// What is too hot, too heavy, too fast, too low.
    Gate,
    /// Limits of some joints.
    Limits,
    /// Masses of the links.
    Masses,
}

impl RigPart {
    /// Its name for people, in a sentence.
    pub fn title(self) -> &'static str {
        match self {
            Self::Servos => "servos",
            Self::Eyes => "eyes",
            Self::Table => "a table",
            Self::Touchscreen => "a touchscreen",
            Self::Arms => "arms with tips",
            Self::Gate => "limits of speed, load and heat",
            Self::Limits => "limits of all joints",
            Self::Masses => "masses of its links",
        }
    }
}

/// The servo bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bus {
    /// Bits per second.
    pub baud: u32,
}

/// A servo and the joint that it moves. `joint = (direction · motor − offset) / ratio`.
#[derive(Clone, Debug, PartialEq)]
pub struct Servo {
    /// Id on the bus.
    pub id: u8,
    /// Model, as the control tables are called ("MX-64", "SEED28").
    pub model: String,
    /// The joint.
    pub joint: JointIndex,
    /// Its name in the description.
    pub joint_name: String,
    /// Its name for people.
    pub title: String,
    /// Whether the motor turns the same way as the joint.
    pub direction: Direction,
    /// Motor angle (after direction) at joint angle zero, rad.
    pub offset_rad: f64,
    /// Turns of the motor per turn of the joint.
    pub ratio: f64,
    /// Range of the motor angle, rad (zero is the middle of the servo's range).
    pub motor_limits: Limits,
}

/// Sense of rotation of a motor against its joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// The same.
    Direct,
    /// The other way.
    Indirect,
}

impl Servo {
    /// Joint angle (rad) at a motor angle (rad).
    pub fn joint_rad(&self, motor_rad: f64) -> f64 {
        (self.sign() * motor_rad - self.offset_rad) / self.ratio
    }

    /// Motor angle (rad) at a joint angle (rad).
    pub fn motor_rad(&self, joint_rad: f64) -> f64 {
        self.sign() * (joint_rad * self.ratio + self.offset_rad)
    }

    /// Range of the joint that the motor's range allows.
    pub fn joint_limits(&self) -> Limits {
        let ends = [self.motor_limits.lower_rad, self.motor_limits.upper_rad].map(|end| self.joint_rad(end));
        Limits { lower_rad: ends[0].min(ends[1]), upper_rad: ends[0].max(ends[1]) }
    }

    fn sign(&self) -> f64 {
        match self.direction {
            Direction::Direct => 1.0,
            Direction::Indirect => -1.0,
        }
    }
}

/// Something on the bus that moves nothing (a hand's main board).
#[derive(Clone, Debug, PartialEq)]
pub struct Board {
    /// Id on the bus.
    pub id: u8,
    /// Model.
    pub model: String,
    /// Name for people.
    pub title: String,
}

/// How far a joint may turn to either side depends on another joint.
#[derive(Clone, Debug, PartialEq)]
pub struct CoupledLimit {
    /// The limited joint.
    pub joint: JointIndex,
    /// The joint that it depends on.
    pub by: JointIndex,
    /// (angle of `by`, largest |angle| of `joint`), rad, rising in `by`; linear in between.
    pub table_rad: Vec<(f64, f64)>,
    /// What is in the way, for people.
    pub why: String,
}

impl CoupledLimit {
    /// Largest |angle| (rad) of the joint when the other is at `by_rad`; `None` beyond the
    /// table's upper end, where nothing is in the way. Below its lower end the first value holds.
    pub fn largest_rad(&self, by_rad: f64) -> Option<f64> {
        let (first, last) = (self.table_rad.first()?, self.table_rad.last()?);
        if by_rad <= first.0 {
            return Some(first.1);
        }
        if by_rad > last.0 {
            return None;
        }
        self.table_rad.windows(2).find(|pair| by_rad <= pair[1].0).map(|pair| {
            let part = (by_rad - pair[0].0) / (pair[1].0 - pair[0].0);
            pair[0].1 + part * (pair[1].1 - pair[0].1)
        })
    }
}

/// The eyes in the head.
#[derive(Clone, Debug, PartialEq)]
pub struct EyeMount {
    /// The link that carries them.
    pub link: LinkIndex,
    /// The joint that turns the head to the side (positive: left).
    pub pan: JointIndex,
    /// The joint that nods (positive: up).
    pub tilt: JointIndex,
    /// Place of the left eye in that link, nominal unless calibrated.
    pub head_from_left: Pose<Head, LeftCamera>,
    /// Lenses and how the eyes sit to each other, nominal unless calibrated.
    pub cameras: StereoCameras,
    /// How warm the eyes were when both were calibrated.
    pub calibrated_at: CalibratedAt,
}

impl EyeMount {
    /// The mount of an eye at `position_m` in the head that looks along the head's x axis with
    /// its image upright, turned by `rotation_rad` (rotation vector, axes of the head).
    pub fn pose(position_m: Vector3<f64>, rotation_rad: Vector3<f64>) -> Pose<Head, LeftCamera> {
        // The optical axis is the head's x, image right is its −y, image down its −z.
        let axes =
            Rotation3::from_matrix_unchecked(Matrix3::new(0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0));
        let turn =
            UnitQuaternion::from_scaled_axis(rotation_rad) * UnitQuaternion::from_rotation_matrix(&axes);
        Pose::new(Isometry3::from_parts(Translation3::from(position_m), turn))
    }
}

/// The table in front of the robot: level in the robot frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableTop {
    /// Height of its top, m.
    pub height_m: f64,
    /// Nearest and farthest x, m.
    pub x_range_m: [f64; 2],
    /// Rightmost and leftmost y (y points left), m.
    pub y_range_m: [f64; 2],
}

/// The patch of the table that the robot works on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkPatch {
    /// Nearest and farthest x, m.
    pub x_range_m: [f64; 2],
    /// Rightmost and leftmost y, m.
    pub y_range_m: [f64; 2],
    /// Height above the table that objects and hands take up, m.
    pub headroom_m: f64,
}

/// An arm.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// Short name ("right").
    pub name: String,
    /// Name for people.
    pub title: String,
    /// Joints from the shoulder to the wrist.
    pub joints: Vec<JointIndex>,
    /// Joints of the hand.
    pub hand: Vec<JointIndex>,
    /// Points of the hand that are sent to targets, the usual one first.
    pub tips: Vec<TipName>,
}

/// A tip of an arm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TipName {
    /// Link of the description.
    pub link: String,
    /// Name for people.
    pub title: String,
}

/// A pose of some joints.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPose {
    /// Short name.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// What it is for, a sentence.
    pub about: String,
    /// Joints and their angles, rad; other joints stay.
    pub joints: Vec<(JointIndex, f64)>,
}

impl NamedPose {
    /// The whole posture when the other joints stay as they are.
    pub fn applied_to(&self, posture: &Posture) -> Posture {
        let mut posture = posture.clone();
        for (joint, angle_rad) in &self.joints {
            posture[*joint] = *angle_rad;
        }
        posture
    }
}

/// What is too hot, too heavy, too fast, too low.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gate {
    /// Servo temperature from which the operator is warned, °C.
    pub warm_c: f64,
    /// Servo temperature from which nothing moves any more, °C.
    pub hot_c: f64,
    /// Share of a servo's stall torque from which the arm holds.
    pub load: f64,
    /// Fastest joint, rad/s.
    pub speed_rad_s: f64,
    /// Speed of ordinary moves, rad/s.
    pub usual_speed_rad_s: f64,
    /// How far ahead of the present angle a goal may be sent, rad of the joint.
    pub step_rad: f64,
    /// No tip and no link of an arm goes below this height in the robot frame, m.
    pub floor_m: f64,
}

impl Rig {
    /// The robot among surroundings that all lie elsewhere by as much, m: table, touchscreen and the lowest
    /// height allowed. What an arm that is known to stand beside where it is described has to be checked
    /// against: it meets the glass where the described one is beside the glass by as much.
    pub fn with_surroundings_moved(&self, by_m: Vector3<f64>) -> Self {
        let mut rig = self.clone();
        rig.touchscreen = rig.touchscreen.moved(&Translation3::from(by_m).into());
        rig.table.height_m += by_m.z;
        rig.table.x_range_m = rig.table.x_range_m.map(|x_m| x_m + by_m.x);
        rig.table.y_range_m = rig.table.y_range_m.map(|y_m| y_m + by_m.y);
        rig.gate.floor_m += by_m.z;
        rig
    }

    /// Limits of a joint: those of the description and those of its servo together.
    pub fn limits(&self, joint: JointIndex) -> Limits {
        let own = self.description.limits(joint);
        let servo = self.servo_of(joint).map_or(own, Servo::joint_limits);
        Limits {
            lower_rad: own.lower_rad.max(servo.lower_rad),
            upper_rad: own.upper_rad.min(servo.upper_rad),
        }
    }

    /// Limits of a joint in a posture, with what depends on other joints.
    pub fn limits_in(&self, joint: JointIndex, posture: &Posture) -> Limits {
        let mut limits = self.limits(joint);
        for coupled in self.coupled_limits.iter().filter(|coupled| coupled.joint == joint) {
            if let Some(largest_rad) = coupled.largest_rad(posture[coupled.by]) {
                limits.lower_rad = limits.lower_rad.max(-largest_rad);
                limits.upper_rad = limits.upper_rad.min(largest_rad);
            }
        }
        limits
    }

    /// Whether its file gives a part.
    pub fn has(&self, part: RigPart) -> bool {
        !self.lacking.contains(&part)
    }

    /// Refuses work that needs a part which its file does not give.
    ///
    /// # Errors
    /// When the part is lacking.
    pub fn need(&self, part: RigPart) -> Result<(), RigError> {
        if self.has(part) {
            return Ok(());
        }
        Err(RigError::Lacks { rig: self.name.clone(), part: part.title() })
    }

    /// The servo that moves a joint.
    pub fn servo_of(&self, joint: JointIndex) -> Option<&Servo> {
        self.servos.iter().find(|servo| servo.joint == joint)
    }

    /// What people call a joint: the title of its servo, or what its name says.
    pub fn joint_title(&self, joint: JointIndex) -> String {
        let named = || parameter_words::place(&self.description.joint(joint).name);
        self.servo_of(joint).map_or_else(named, |servo| servo.title.clone())
    }

    /// An arm by its short name.
    pub fn arm(&self, name: &str) -> Option<&Arm> {
        self.arms.iter().find(|arm| arm.name == name)
    }

    /// A pose by its short name.
    pub fn pose(&self, name: &str) -> Option<&NamedPose> {
        self.poses.iter().find(|pose| pose.name == name)
    }

    /// The posture of the pose offered first, all other joints at rest.
    pub fn home(&self) -> Posture {
        let rest = self.description.rest();
        self.poses.first().map_or_else(|| rest.clone(), |pose| pose.applied_to(&rest))
    }

    /// The chain to a tip.
    pub fn chain(&self, tip: &str) -> Result<Chain, DescriptionError> {
        Chain::to(&self.description, tip, &self.home())
    }

    /// Where the left eye is in a posture.
    pub fn robot_from_left(&self, posture: &Posture) -> Pose<Robot, LeftCamera> {
        let link = self.description.forward(posture).of(self.eyes.link).isometry;
        Pose::<Robot, Head>::new(link) * self.eyes.head_from_left
    }

    /// What the eyes have to see, and from where, in a posture.
    pub fn workspace(&self, posture: &Posture) -> Workspace {
        Workspace {
            robot_from_left: self.robot_from_left(posture),
            table_height_m: self.table.height_m,
            x_range_m: self.work_patch.x_range_m,
            y_range_m: self.work_patch.y_range_m,
            headroom_m: self.work_patch.headroom_m,
        }
    }

    /// Angles of the head (pan, tilt; rad) at which the left eye looks at a point of the robot
    /// frame, limits not considered. Turning the head moves the eye too, so this is found by
    /// repeated aiming; each pass leaves about a quarter of the error for points at arm's length.
    pub fn look_at(&self, point: Point<Robot>, posture: &Posture) -> (f64, f64) {
        self.look_at_by(point, posture, |posture| self.robot_from_left(posture))
    }

    /// The same with a left eye that is elsewhere in each posture than the description has it.
    pub fn look_at_by(
        &self,
        point: Point<Robot>,
        posture: &Posture,
        robot_from_left: impl Fn(&Posture) -> Pose<Robot, LeftCamera>,
    ) -> (f64, f64) {
        let mut posture = posture.clone();
        for _ in 0..40 {
            let eye = robot_from_left(&posture).isometry;
            let wanted = point.coords.coords - eye.translation.vector;
            let axis = eye.rotation * Vector3::z();
            let level = |v: &Vector3<f64>| v.z.atan2(v.x.hypot(v.y));
            let turn_rad = wanted.y.atan2(wanted.x) - axis.y.atan2(axis.x);
            posture[self.eyes.pan] += turn_rad.sin().atan2(turn_rad.cos());
            posture[self.eyes.tilt] += level(&wanted) - level(&axis);
        }
        (posture[self.eyes.pan], posture[self.eyes.tilt])
    }
}

impl Default for Workspace {
    /// That of the rig that comes with the program, its head at work over the table.
    fn default() -> Self {
        static USUAL: OnceLock<Workspace> = OnceLock::new();
        *USUAL.get_or_init(|| {
            let rig = Rig::built_in("nico").expect("the rig that comes with the program is tested");
            rig.workspace(&rig.home())
        })
    }
}
