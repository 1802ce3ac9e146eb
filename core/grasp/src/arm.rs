//! A hand that is sent somewhere: inverse kinematics with what is known of the arm.

use std::sync::Arc;

use nalgebra::{Matrix3, Point3, UnitQuaternion, Vector3};
use plumbline_effects::RobotModel;
use plumbline_effects::rig_model::Conditions;
use plumbline_effects::robot_model::ModelArm;
use plumbline_model::frame::Tip;
use plumbline_model::robot::ik::{Options, SolverError, Target};
use plumbline_model::robot::{Arm, JointIndex, LinkIndex, Posture, Rig, Shape};
use plumbline_model::{Point, Pose, Robot};

use crate::hands::Hand;

/// A step of the solution that turns a joint by more is another way to hold the arm, rad.
const JUMP_RAD: f64 = 0.5;
/// Standard deviation per axis of the palm of an arm that nobody has measured, m: about what the arm of the
/// published robot missed by before anything was learned.
const UNMEASURED_M: f64 = 0.012;

/// Why there is no such hand.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoArm {
    /// The robot has no arm of that name with a palm.
    #[error("the robot {rig} has no arm called {arm} with a palm")]
    NoArm {
        /// Name of the rig.
        rig: String,
        /// Name of the arm.
        arm: String,
    },
    /// Its chain cannot be solved.
    #[error(transparent)]
    Solver(#[from] SolverError),
}

/// The palm of an arm, as a model has it.
#[derive(Clone, Debug)]
pub struct PalmArm {
    rig: Arc<Rig>,
    arm: ModelArm,
    /// Joints of the fingers.
    hand: Vec<JointIndex>,
    /// Middle of the palm's body on the palm, m.
    palm_from_body_m: Vector3<f64>,
    /// The link of the palm.
    tip: Option<LinkIndex>,
    is_left: bool,
    /// The other arm was measured, this one was not.
    is_unmeasured: bool,
}

impl PalmArm {
    /// The palm (the first tip) of the arm of this name.
    ///
    /// # Errors
    /// When the rig has no such arm.
    pub fn new(model: &RobotModel, arm: &str) -> Result<Self, NoArm> {
        let rig = model.rig();
        let no_arm = || NoArm::NoArm { rig: rig.name.clone(), arm: arm.to_owned() };
        let arm = rig.arm(arm).ok_or_else(no_arm)?;
        let tip = &arm.tips.first().ok_or_else(no_arm)?.link;
        let palm_from_body_m = body_of_palm(rig, arm, tip).unwrap_or_default();
        let is_left = is_left(rig, arm);
        let link = rig.description.find_link(tip).ok();
        let (hand, arm) = (arm.hand.clone(), model.arm(tip)?);
        let of_an_arm = model.added().effects().iter().any(|effect| effect.tip.is_some());
        let is_unmeasured = of_an_arm && arm.is_nominal();
        Ok(Self { arm, hand, palm_from_body_m, tip: link, is_left, is_unmeasured, rig: rig.clone() })
    }

    /// The robot.
    pub fn rig(&self) -> &Arc<Rig> {
        &self.rig
    }

    /// Joints from the shoulder to the wrist.
    pub fn joints(&self) -> &[JointIndex] {
        self.arm.joints()
    }

    /// Joints of the fingers.
    pub fn hand(&self) -> &[JointIndex] {
        &self.hand
    }

    /// Whether it hangs on the left side of the robot: its hand is the mirror image of a right one, and so
    /// is all that it does.
    pub fn is_left(&self) -> bool {
        self.is_left
    }

    /// Which hand it is.
    pub fn which(&self) -> Hand {
        if self.is_left { Hand::Left } else { Hand::Right }
    }

    /// Where the arm begins, robot frame, m.
    pub fn shoulder_m(&self, posture: &Posture) -> Vector3<f64> {
        let description = &self.rig.description;
        let first = self.arm.joints().first().map(|joint| description.joint(*joint).child);
        first.map_or_else(Vector3::zeros, |link| {
            description.forward(posture).of(link).isometry.translation.vector
        })
    }

    /// Where the palm is, by the model, when a posture is commanded.
    pub fn palm(&self, commanded: &Posture) -> Point<Robot> {
        self.arm.tip(commanded, &Conditions::default())
    }

    /// The same with how it is turned: x along the fingers, z out of the back of the hand.
    pub fn robot_from_palm(&self, commanded: &Posture) -> Pose<Robot, Tip> {
        self.arm.robot_from_tip(commanded, &Conditions::default())
    }

    /// Middle of the palm's body, which a box around the hand is drawn for; the palm itself where the
    /// description shows no body.
    pub fn body(&self, commanded: &Posture) -> Vector3<f64> {
        (self.robot_from_palm(commanded).isometry * Point3::from(self.palm_from_body_m)).coords
    }

    /// How sure the model is of that place, from the uncertainty of its effects, m². Of an arm that was not
    /// measured while the other one was, what such arms usually miss by.
    pub fn covariance_m2(&self, commanded: &Posture) -> Matrix3<f64> {
        let unmeasured_m = if self.is_unmeasured { UNMEASURED_M } else { 0.0 };
        let unmeasured_m2 = Matrix3::identity() * (unmeasured_m * unmeasured_m);
        self.arm.covariance_m2(commanded, &Conditions::default()) + unmeasured_m2
    }

    /// Standard deviation per axis of what its effects leave of its error, beside what is not known of their
    /// values, m. Where they were fitted together, hands of a commissioned twin that were not used are seen
    /// 1.5 mm beside where the arm has them; a few named ones leave more.
    pub fn rest_sigma_m(&self) -> f64 {
        if self.arm.is_known_together() { 0.0015 } else { 0.004 }
    }

    /// How level the palm is: the cosine of its inclination, 1 when it faces straight down.
    pub fn level(&self, posture: &Posture) -> f64 {
        (self.robot_from_palm(posture).isometry.rotation * Vector3::z()).z
    }

    /// The heading (azimuth of the fingers, rad) that is asked for to be held so, see [`Self::sent_to`]: that of the
    /// arm as it is described. What the model knows turns the hand a little from there.
    pub fn heading_rad(&self, commanded: &Posture) -> f64 {
        let fingers = self.arm.chain().robot_from_tip_in(commanded).isometry.rotation * Vector3::x();
        fingers.y.atan2(fingers.x)
    }

    /// What must be commanded so that the palm comes to a point with a heading, held as near to level as
    /// the arm can; the rest of the robot as in `from`. `None`: it does not get there.
    pub fn sent_to(&self, point: Point<Robot>, heading_rad: f64, from: &Posture) -> Option<Posture> {
        self.solved(point, heading_rad, from, &Options::upright())
    }

    /// The same, held like `from`: a neighbor of it on a way.
    pub fn next_to(&self, point: Point<Robot>, heading_rad: f64, from: &Posture) -> Option<Posture> {
        let options = Options { other_starts: 0, ..Options::upright() };
        self.solved(point, heading_rad, from, &options).filter(|next| next.distance_rad(from) < JUMP_RAD)
    }

    /// How far a point (robot frame, m) is from the nearest body of arm and hand, m: the bodies of the
    /// description, where the model has the palm; 0 inside of one, infinite where it shows none.
    pub fn distance_m(&self, commanded: &Posture, point_m: &Vector3<f64>) -> f64 {
        let description = &self.rig.description;
        let poses = description.forward(commanded);
        let described = self.tip.map(|tip| poses.of(tip).isometry.translation.vector);
        let beside_m =
            described.map_or_else(Vector3::zeros, |at_m| self.palm(commanded).coords.coords - at_m);
        let at = Point3::from(point_m - beside_m);
        let mut links: Vec<LinkIndex> =
            self.arm.joints().first().map(|joint| description.joint(*joint).child).into_iter().collect();
        let mut nearest_m = f64::INFINITY;
        for (i, link) in description.links().iter().enumerate() {
            if link.parent.is_some_and(|parent| links.contains(&parent)) {
                links.push(LinkIndex(i));
            }
            for body in link.collisions.iter().filter(|_| links.contains(&LinkIndex(i))) {
                let in_shape = (poses.all()[i] * body.link_from_shape).inverse() * at;
                nearest_m = nearest_m.min(beside_shape_m(&body.shape, &in_shape.coords));
            }
        }
        nearest_m
    }

    /// Height of the lowest point of the hand by the description, robot frame, m: of what it must not run
    /// into something with. `None`: the description shows no body.
    pub fn lowest_m(&self, posture: &Posture) -> Option<f64> {
        let description = &self.rig.description;
        let poses = description.forward(posture);
        let mut hand = vec![description.joint(*self.arm.joints().last()?).child];
        let mut lowest_m: Option<f64> = None;
        for (i, link) in description.links().iter().enumerate() {
            if link.parent.is_some_and(|parent| hand.contains(&parent)) {
                hand.push(LinkIndex(i));
            }
            for body in link.collisions.iter().filter(|_| hand.contains(&LinkIndex(i))) {
                let place = poses.all()[i] * body.link_from_shape;
                let low_m = place.translation.z - below_m(&body.shape, &place.rotation);
                lowest_m = Some(lowest_m.map_or(low_m, |least_m| least_m.min(low_m)));
            }
        }
        lowest_m
    }

    fn solved(
        &self,
        point: Point<Robot>,
        heading_rad: f64,
        from: &Posture,
        options: &Options,
    ) -> Option<Posture> {
        let target = Target::PositionYaw { point, yaw_rad: heading_rad };
        let reached = self.arm.reach(&target, from, options, &Conditions::default()).ok()?;
        let joints = reached.answer.is_reached().then(|| reached.answer.best().joints)?;
        Some(from.with(self.joints(), &joints))
    }
}

/// Whether an arm begins on the left side of the robot, by the description.
fn is_left(rig: &Rig, arm: &Arm) -> bool {
    let description = &rig.description;
    let shoulder = arm.joints.first().map(|joint| description.joint(*joint).child);
    shoulder.is_some_and(|link| description.forward(&rig.home()).of(link).isometry.translation.y > 0.0)
}

/// How far a point is from a shape, in its own frame, m; 0 inside.
fn beside_shape_m(shape: &Shape, at: &Vector3<f64>) -> f64 {
    match *shape {
        Shape::Box { half_m } => (at.abs() - half_m).sup(&Vector3::zeros()).norm(),
        Shape::Sphere { radius_m } => (at.norm() - radius_m).max(0.0),
        Shape::Capsule { radius_m, half_length_m } => {
            let along_m = (at.z.abs() - half_length_m).max(0.0);
            (at.xy().norm().hypot(along_m) - radius_m).max(0.0)
        }
        Shape::Cylinder { radius_m, half_length_m } => {
            let along_m = (at.z.abs() - half_length_m).max(0.0);
            (at.xy().norm() - radius_m).max(0.0).hypot(along_m)
        }
    }
}

/// How far a shape reaches below its middle, m.
fn below_m(shape: &Shape, robot_from_shape: &UnitQuaternion<f64>) -> f64 {
    let down = robot_from_shape.inverse() * Vector3::z();
    match *shape {
        Shape::Box { half_m } => half_m.dot(&down.abs()),
        Shape::Sphere { radius_m } => radius_m,
        Shape::Capsule { radius_m, half_length_m } => radius_m + half_length_m * down.z.abs(),
        Shape::Cylinder { radius_m, half_length_m } => {
            radius_m * down.xy().norm() + half_length_m * down.z.abs()
        }
    }
}

/// Middle of what is drawn of the palm, frame of the tip, m; `None`: nothing is.
fn body_of_palm(rig: &Rig, arm: &Arm, tip: &str) -> Option<Vector3<f64>> {
    let description = &rig.description;
    let palm = description.joint(*arm.joints.last()?).child;
    let poses = description.forward(&rig.home());
    let tip_from_palm =
        poses.of(description.find_link(tip).ok()?).isometry.inverse() * poses.of(palm).isometry;
    let shapes = &description.links()[palm.0].visuals;
    let middle: Vector3<f64> =
        shapes.iter().map(|shape| shape.link_from_shape.translation.vector).sum::<Vector3<f64>>()
            / shapes.len().max(1) as f64;
    (!shapes.is_empty()).then(|| (tip_from_palm * Point3::from(middle)).coords)
}
