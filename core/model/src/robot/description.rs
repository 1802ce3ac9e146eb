//! Links, joints and shapes of a robot as a checked tree, and where its links are.

use nalgebra::{Isometry3, Matrix3, Translation3, Unit, UnitQuaternion, Vector3};

use super::error::DescriptionError;
use super::posture::Posture;
use crate::frame::{Link as LinkFrame, Pose, Robot};

/// A joint that moves by itself: its place in a [`Posture`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct JointIndex(pub usize);

/// A link: its place in [`Description::links`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct LinkIndex(pub usize);

/// A robot: a tree of links, parents before children.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    pub(super) name: String,
    pub(super) links: Vec<Link>,
    /// One per link but the base, in the order of the links they carry.
    pub(super) joints: Vec<Joint>,
    /// Place in `joints` of every joint that moves by itself.
    pub(super) movable: Vec<usize>,
    /// Joints that move in a way that is not known, held at zero, with the kind of their motion;
    /// only where a description was read leniently.
    pub(super) held: Vec<(String, String)>,
    /// Those of them that slide, with the direction, axes of the joint.
    pub(super) slides: Vec<Slide>,
}

/// A joint that slides, and along which direction, axes of the joint.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slide {
    pub joint: String,
    pub axis: Unit<Vector3<f64>>,
}

/// A rigid part.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Its name.
    pub name: String,
    /// The link that carries it; `None` for the base.
    pub parent: Option<LinkIndex>,
    /// Mass; `None` for frames without one.
    pub inertia: Option<Inertia>,
    /// What it looks like.
    pub visuals: Vec<Visual>,
    /// What it must not run into something with.
    pub collisions: Vec<Visual>,
}

/// Mass and how it is spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Center of mass, link frame, m.
    pub center_m: Vector3<f64>,
    /// Inertia about the center of mass, axes of the link, kg m².
    pub tensor_kgm2: Matrix3<f64>,
}

/// A shape on a link.
#[derive(Clone, Debug, PartialEq)]
pub struct Visual {
    /// Place of the shape's center.
    pub link_from_shape: Isometry3<f64>,
    /// Its form.
    pub shape: Shape,
    /// Color as red, green, blue, opacity, 0–1.
    pub rgba: [f32; 4],
}

/// Simple forms, centered on their own origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A box.
    Box {
        /// Half of its extents, m.
        half_m: Vector3<f64>,
    },
    /// A ball.
    Sphere {
        /// Radius, m.
        radius_m: f64,
    },
    /// A cylinder along z with round ends, which are not part of the half length.
    Capsule {
        /// Radius, m.
        radius_m: f64,
        /// Half of the straight part, m.
        half_length_m: f64,
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius, m.
        radius_m: f64,
        /// Half of its length, m.
        half_length_m: f64,
    },
}

/// What connects a link to its parent.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Carries.
    pub parent: LinkIndex,
    /// Is carried.
    pub child: LinkIndex,
    /// Place of the child at angle zero.
    pub parent_from_joint: Isometry3<f64>,
    /// How it moves.
    pub kind: JointKind,
}

/// How a joint moves.
#[derive(Clone, Debug, PartialEq)]
pub enum JointKind {
    /// Not at all.
    Fixed,
    /// Turns about `axis` (child frame) by its own angle.
    Revolute {
        /// Axis of positive rotation.
        axis: Unit<Vector3<f64>>,
        /// Range of angles.
        limits: Limits,
        /// Place in a posture.
        index: JointIndex,
    },
    /// Turns about `axis` by an angle that another joint dictates (a tendon, a gear).
    Coupled {
        /// Axis of positive rotation.
        axis: Unit<Vector3<f64>>,
        /// Range of angles.
        limits: Limits,
        /// The joint it follows.
        mimic: Mimic,
    },
}

/// Follows another joint: angle = ratio · angle of `source` + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mimic {
    /// The joint that is followed.
    pub source: JointIndex,
    /// Factor.
    pub ratio: f64,
    /// Angle when the source is at zero, rad.
    pub offset_rad: f64,
}

/// Range of angles, rad.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Limits {
    /// Smallest.
    pub lower_rad: f64,
    /// Largest.
    pub upper_rad: f64,
}

impl Limits {
    /// Whether an angle (rad) lies inside, ends included; `false` for NaN.
    pub fn contain(&self, angle_rad: f64) -> bool {
        angle_rad >= self.lower_rad && angle_rad <= self.upper_rad
    }

    /// How far outside an angle lies (rad): negative below, positive above, zero inside.
    pub fn excess_rad(&self, angle_rad: f64) -> f64 {
        angle_rad - angle_rad.clamp(self.lower_rad, self.upper_rad)
    }

    /// The middle, rad.
    pub fn middle_rad(&self) -> f64 {
        0.5 * (self.lower_rad + self.upper_rad)
    }

    /// Upper minus lower, rad.
    pub fn span_rad(&self) -> f64 {
        self.upper_rad - self.lower_rad
    }
}

impl Joint {
    /// Place of the child in the parent for a posture.
    pub fn parent_from_child(&self, posture: &Posture) -> Isometry3<f64> {
        match &self.kind {
            JointKind::Fixed => self.parent_from_joint,
            JointKind::Revolute { axis, index, .. } => self.turned(axis, posture[*index]),
            JointKind::Coupled { axis, mimic, .. } => {
                self.turned(axis, mimic.ratio * posture[mimic.source] + mimic.offset_rad)
            }
        }
    }

    fn turned(&self, axis: &Unit<Vector3<f64>>, angle_rad: f64) -> Isometry3<f64> {
        let turn = UnitQuaternion::from_axis_angle(axis, angle_rad);
        self.parent_from_joint * Isometry3::from_parts(Translation3::identity(), turn)
    }

    /// Axis and limits, if it moves.
    pub fn motion(&self) -> Option<(&Unit<Vector3<f64>>, &Limits)> {
        match &self.kind {
            JointKind::Fixed => None,
            JointKind::Revolute { axis, limits, .. } | JointKind::Coupled { axis, limits, .. } => {
                Some((axis, limits))
            }
        }
    }
}

/// Where every link is.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkPoses {
    robot_from_link: Vec<Isometry3<f64>>,
}

impl LinkPoses {
    /// Place of a link.
    pub fn of(&self, link: LinkIndex) -> Pose<Robot, LinkFrame> {
        Pose::new(self.robot_from_link[link.0])
    }

    /// Places of all links, by [`LinkIndex`].
    pub fn all(&self) -> &[Isometry3<f64>] {
        &self.robot_from_link
    }
}

impl Description {
    /// Name of the robot.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// All links, parents before children; the first is the base (the robot frame).
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// All joints, in the order of the links they carry.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Joints and links of a robot by name, wide of any limits: to look names up in what is not sound.
    pub(super) fn of_names(robot: &urdf_rs::Robot) -> Self {
        let link = |link: &urdf_rs::Link| Link {
            name: link.name.clone(),
            parent: None,
            inertia: None,
            visuals: vec![],
            collisions: vec![],
        };
        let whole_rad = 4.0 * std::f64::consts::PI;
        let moves = robot
            .joints
            .iter()
            .filter(|joint| !matches!(joint.joint_type, urdf_rs::JointType::Fixed) && joint.mimic.is_none());
        let joint = |(index, joint): (usize, &urdf_rs::Joint)| {
            let (lower, upper) = (joint.limit.lower, joint.limit.upper);
            let usable = lower < upper && lower.is_finite() && upper.is_finite();
            let (lower_rad, upper_rad) = if usable { (lower, upper) } else { (-whole_rad, whole_rad) };
            let limits = Limits { lower_rad, upper_rad };
            let kind = JointKind::Revolute { axis: Vector3::z_axis(), limits, index: JointIndex(index) };
            let name = joint.name.clone();
            let parent_from_joint = Isometry3::identity();
            Joint { name, parent: LinkIndex(0), child: LinkIndex(0), parent_from_joint, kind }
        };
        let joints: Vec<Joint> = moves.enumerate().map(joint).collect();
        Self {
            name: robot.name.clone(),
            links: robot.links.iter().map(link).collect(),
            movable: (0..joints.len()).collect(),
            joints,
            held: vec![],
            slides: vec![],
        }
    }

    /// The joint that carries a link; `None` for the base.
    pub fn joint_above(&self, link: LinkIndex) -> Option<&Joint> {
        link.0.checked_sub(1).and_then(|i| self.joints.get(i))
    }

    /// Joints that move by themselves, by [`JointIndex`].
    pub fn movable(&self) -> impl ExactSizeIterator<Item = &Joint> {
        self.movable.iter().map(|i| &self.joints[*i])
    }

    /// The kind of motion of a joint that is held at zero because this program cannot move it
    /// (only of robots that are only measured).
    pub fn held_kind(&self, joint: &str) -> Option<&str> {
        self.held.iter().find(|(name, _)| name == joint).map(|(_, kind)| kind.as_str())
    }

    /// The same of joints that no row of a session can move: what slides is moved by what was logged.
    pub fn unmoved_kind(&self, joint: &str) -> Option<&str> {
        self.held_kind(joint).filter(|_| self.slide_axis(joint).is_none())
    }

    /// Along which direction, axes of the joint, a joint that is held slides; `None` for all others. A session that
    /// logged where it stood can still be looked at.
    pub fn slide_axis(&self, joint: &str) -> Option<Unit<Vector3<f64>>> {
        self.slides.iter().find(|slide| slide.joint == joint).map(|slide| slide.axis)
    }

    /// Names of the joints that slide and are held.
    pub fn slides(&self) -> Vec<String> {
        self.slides.iter().map(|slide| slide.joint.clone()).collect()
    }

    /// Number of joints that move by themselves.
    pub fn movable_count(&self) -> usize {
        self.movable.len()
    }

    /// A joint that moves by itself.
    pub fn joint(&self, index: JointIndex) -> &Joint {
        &self.joints[self.movable[index.0]]
    }

    /// Limits of a joint that moves by itself.
    pub fn limits(&self, index: JointIndex) -> Limits {
        match &self.joint(index).kind {
            JointKind::Revolute { limits, .. } | JointKind::Coupled { limits, .. } => *limits,
            JointKind::Fixed => Limits { lower_rad: 0.0, upper_rad: 0.0 },
        }
    }

    /// Finds a joint that moves by itself.
    pub fn find_joint(&self, name: &str) -> Result<JointIndex, DescriptionError> {
        self.movable().position(|joint| joint.name == name).map(JointIndex).ok_or_else(|| {
            let known = self.movable().map(|joint| joint.name.as_str()).collect::<Vec<_>>().join(", ");
            DescriptionError::Unknown { what: "joint", name: name.to_owned(), known }
        })
    }

    /// Finds a link.
    pub fn find_link(&self, name: &str) -> Result<LinkIndex, DescriptionError> {
        self.links.iter().position(|link| link.name == name).map(LinkIndex).ok_or_else(|| {
            let known = self.links.iter().map(|link| link.name.as_str()).collect::<Vec<_>>().join(", ");
            DescriptionError::Unknown { what: "link", name: name.to_owned(), known }
        })
    }

    /// Every joint at zero, or at the limit that is nearest to zero.
    pub fn rest(&self) -> Posture {
        let at = |i| self.limits(JointIndex(i));
        Posture::new((0..self.movable.len()).map(|i| 0f64.clamp(at(i).lower_rad, at(i).upper_rad)).collect())
    }

    /// Places every link. `posture` must have one angle per movable joint.
    pub fn forward(&self, posture: &Posture) -> LinkPoses {
        let mut robot_from_link = Vec::with_capacity(self.links.len());
        robot_from_link.push(Isometry3::identity());
        for joint in &self.joints {
            let parent: &Isometry3<f64> = &robot_from_link[joint.parent.0];
            robot_from_link.push(parent * joint.parent_from_child(posture));
        }
        LinkPoses { robot_from_link }
    }
}
