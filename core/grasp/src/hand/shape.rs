//! The hand as its description has it: solid parts from the palm on, and the forearm behind it.

use std::sync::Arc;

use nalgebra::{Isometry3, Matrix3, Vector3};
use plumbline_model::frame::{LeftCamera, Robot, Tip};
use plumbline_model::robot::{Description, LinkIndex, Posture, Rig, Shape};
use plumbline_model::{Camera, Eye, Pose, StereoCameras};

use super::solid::{enclosing_radius_m, meet};

/// Links of the arm before the palm that can be seen beside the hand.
const FOREARM_LINKS: usize = 3;

/// Which part of the arm a surface belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The palm: rigid, its place is what is looked for.
    Palm,
    /// A finger or the thumb; a real one bends more than its description knows.
    Digit,
    /// Wrist and lower arm: hides what is behind it, but is no part of the hand.
    Forearm,
}

/// Shape of a hand as the eyes can see it, from the shapes of the rig's description.
#[derive(Clone, Debug)]
pub struct HandShape {
    description: Arc<Description>,
    tip: LinkIndex,
    links: Vec<(LinkIndex, Part)>,
}

/// Why a hand has no shape.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HandShapeError {
    /// No arm of the rig has this tip.
    #[error("no arm of the rig ends in {tip}: choose one of {known}")]
    UnknownTip {
        /// The one asked for.
        tip: String,
        /// Those that there are.
        known: String,
    },
    /// The description has no shapes there.
    #[error(
        "the description shows no shape of the hand that ends in {tip}: add visual shapes to its palm and fingers"
    )]
    NoShapes {
        /// Its tip.
        tip: String,
    },
}

impl HandShape {
    /// The hand that ends in a tip of an arm ("`right_palm_center`").
    ///
    /// # Errors
    /// When no arm has that tip, or its hand has no shapes.
    pub fn of_rig(rig: &Rig, tip: &str) -> Result<Self, HandShapeError> {
        let description = rig.description.clone();
        let arm = rig.arms.iter().find(|arm| arm.tips.iter().any(|known| known.link == tip));
        let found = arm.and_then(|arm| Some((arm, description.find_link(tip).ok()?, arm.joints.last()?)));
        let Some((arm, tip_link, last)) = found else {
            let tips = rig.arms.iter().flat_map(|arm| &arm.tips);
            let known = tips.map(|tip| tip.link.as_str()).collect::<Vec<_>>().join(", ");
            return Err(HandShapeError::UnknownTip { tip: tip.to_owned(), known });
        };
        let palm = description.joint(*last).child;
        let before = arm.joints.iter().rev().skip(1).take(FOREARM_LINKS);
        let forearm: Vec<LinkIndex> = before.map(|joint| description.joint(*joint).child).collect();
        let mut links: Vec<(LinkIndex, Part)> =
            forearm.into_iter().map(|link| (link, Part::Forearm)).collect();
        links.push((palm, Part::Palm));
        // Parents stand before their children.
        for joint in description.joints() {
            let carried = links.iter().any(|(link, part)| *link == joint.parent && *part != Part::Forearm);
            if carried && joint.child != palm {
                links.push((joint.child, Part::Digit));
            }
        }
        let shown = |(link, part): &(LinkIndex, Part)| {
            *part != Part::Forearm && !description.links()[link.0].visuals.is_empty()
        };
        if !links.iter().any(shown) {
            return Err(HandShapeError::NoShapes { tip: tip.to_owned() });
        }
        Ok(Self { description, tip: tip_link, links })
    }

    /// Its solids at joint angles, frame of the tip.
    pub(super) fn posed(&self, posture: &Posture) -> Vec<Solid> {
        let poses = self.description.forward(posture);
        let tip_from_robot = poses.of(self.tip).isometry.inverse();
        let mut solids = vec![];
        let mut digits = 0;
        for (link, part) in &self.links {
            let tip_from_link = tip_from_robot * poses.of(*link).isometry;
            for visual in &self.description.links()[link.0].visuals {
                let digit = (*part == Part::Digit).then_some(digits);
                digits += usize::from(digit.is_some());
                solids.push(Solid {
                    shape: visual.shape,
                    tip_from_shape: tip_from_link * visual.link_from_shape,
                    part: *part,
                    digit,
                    bend_rad: self.bend_rad(*link, posture),
                });
            }
        }
        solids
    }

    /// By how much the joint above a link is turned from zero, rad.
    fn bend_rad(&self, link: LinkIndex, posture: &Posture) -> f64 {
        self.description.joint_above(link).map_or(0.0, |joint| {
            let straight = joint.parent_from_joint.rotation;
            joint.parent_from_child(posture).rotation.angle_to(&straight)
        })
    }
}

/// A shape on the hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid {
    pub shape: Shape,
    pub tip_from_shape: Isometry3<f64>,
    pub part: Part,
    /// Counts the shapes of fingers and thumb.
    pub digit: Option<usize>,
    /// By how much the joint that carries it is turned from zero, rad.
    pub bend_rad: f64,
}

impl Solid {
    /// Half of its extents along its own axes, m.
    pub fn half_m(&self) -> Vector3<f64> {
        match self.shape {
            Shape::Box { half_m } => half_m,
            Shape::Sphere { radius_m } => Vector3::repeat(radius_m),
            Shape::Capsule { radius_m, half_length_m } => {
                Vector3::new(radius_m, radius_m, radius_m + half_length_m)
            }
            Shape::Cylinder { radius_m, half_length_m } => Vector3::new(radius_m, radius_m, half_length_m),
        }
    }

    /// The same with half extents larger by `by_m` (m); round shapes stay round.
    pub fn grown(&self, by_m: &Vector3<f64>) -> Self {
        let around = 0.5 * (by_m.x + by_m.y);
        let at_least = |value: f64| value.max(LEAST_HALF_M);
        let shape = match self.shape {
            Shape::Box { half_m } => Shape::Box { half_m: (half_m + by_m).map(at_least) },
            Shape::Sphere { radius_m } => Shape::Sphere { radius_m: at_least(radius_m + by_m.sum() / 3.0) },
            Shape::Capsule { radius_m, half_length_m } => {
                let radius_m = at_least(radius_m + around);
                Shape::Capsule { radius_m, half_length_m: at_least(half_length_m + by_m.z - around) }
            }
            Shape::Cylinder { radius_m, half_length_m } => Shape::Cylinder {
                radius_m: at_least(radius_m + around),
                half_length_m: at_least(half_length_m + by_m.z),
            },
        };
        Self { shape, ..*self }
    }
}

/// However wrong a description is, nothing of a hand is thinner than twice this, m.
const LEAST_HALF_M: f64 = 0.001;

/// The eyes of a robot at one moment: lenses, and where the left eye is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EyesAt {
    /// Both lenses and how the eyes sit to each other.
    pub cameras: StereoCameras,
    /// Place of the left eye.
    pub robot_from_left: Pose<Robot, LeftCamera>,
}

impl EyesAt {
    /// Takes points of the robot frame to that of an eye.
    pub(super) fn camera_from_robot(&self, eye: Eye) -> Isometry3<f64> {
        let left_from_robot = self.robot_from_left.isometry.inverse();
        match eye {
            Eye::Left => left_from_robot,
            Eye::Right => self.cameras.right_from_left.isometry * left_from_robot,
        }
    }

    pub(super) fn camera(&self, eye: Eye) -> &Camera {
        self.cameras.camera(eye)
    }
}

/// A ray's first meeting with the hand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    /// Distance along the ray, m.
    pub range_m: f64,
    /// Place of the solid in the list.
    pub solid: usize,
    pub part: Part,
}

/// The hand in front of an eye, ready to be met by rays from it.
#[derive(Clone, Debug)]
pub(super) struct InView {
    solids: Vec<Placed>,
    pub camera_from_tip: Isometry3<f64>,
}

#[derive(Clone, Debug)]
struct Placed {
    shape: Shape,
    part: Part,
    /// Middle, frame of the camera, m.
    middle: Vector3<f64>,
    radius_m: f64,
    /// A ray that makes it at least this far toward the middle meets the enclosing ball.
    least: f64,
    /// The eye, frame of the shape.
    origin: Vector3<f64>,
    shape_from_camera: Matrix3<f64>,
}

impl InView {
    pub(super) fn new(
        solids: &[Solid],
        camera_from_robot: &Isometry3<f64>,
        robot_from_tip: &Pose<Robot, Tip>,
    ) -> Self {
        let camera_from_tip = camera_from_robot * robot_from_tip.isometry;
        let placed = |solid: &Solid| {
            let camera_from_shape = camera_from_tip * solid.tip_from_shape;
            let shape_from_camera = camera_from_shape.inverse();
            let (middle, radius_m) = (camera_from_shape.translation.vector, enclosing_radius_m(&solid.shape));
            Placed {
                shape: solid.shape,
                part: solid.part,
                middle,
                radius_m,
                least: (middle.norm_squared() - radius_m * radius_m).max(0.0).sqrt(),
                origin: shape_from_camera.translation.vector,
                shape_from_camera: shape_from_camera.rotation.to_rotation_matrix().into_inner(),
            }
        };
        Self { solids: solids.iter().map(placed).collect(), camera_from_tip }
    }

    /// The nearest surface along a unit direction of the camera.
    pub(super) fn cast(&self, direction: &Vector3<f64>) -> Option<Met> {
        let mut nearest: Option<Met> = None;
        for (i, solid) in self.solids.iter().enumerate() {
            if direction.dot(&solid.middle) < solid.least {
                continue;
            }
            let turned = solid.shape_from_camera * direction;
            if let Some(range_m) = meet(&solid.shape, &solid.origin, &turned)
                && nearest.is_none_or(|best| range_m < best.range_m)
            {
                nearest = Some(Met { range_m, solid: i, part: solid.part });
            }
        }
        nearest
    }

    /// Middles and radii (m, frame of the camera) of the balls around the parts of the hand.
    pub(super) fn hand_balls(&self) -> impl Iterator<Item = (&Vector3<f64>, f64)> {
        let hand = self.solids.iter().filter(|solid| solid.part != Part::Forearm);
        hand.map(|solid| (&solid.middle, solid.radius_m))
    }
}
