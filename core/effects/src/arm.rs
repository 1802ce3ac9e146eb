//! The arm with its masses, and the place of its tip when something deviates.

use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use plumbline_model::robot::{Description, DescriptionError, Joint, JointIndex, JointKind, LinkIndex, Rig};

/// Standard gravity along the robot's z, m/s².
pub(crate) const GRAVITY_M_S2: f64 = -9.80665;

/// The arm from the base to a tip.
#[derive(Clone, Debug)]
pub struct Arm {
    /// From the base on, one per joint of the chain.
    pub parts: Vec<Part>,
    /// From the last joint's turned frame to the tip.
    pub last_from_tip: Isometry3<f64>,
    /// Names of all links that its first joint carries: what ends in one of them is the same arm.
    pub links: Vec<String>,
    /// Where a weight is held, in the last joint's turned frame, m; the tip where the rig names
    /// no palm.
    pub palm_m: Point3<f64>,
    /// Where the finger that ends in the tip points, in the last joint's turned frame: from the
    /// nearest joint of the hand to the tip, or from the last joint where the rig names no hand.
    pub finger: Unit<Vector3<f64>>,
    /// The description gives no masses: every link counts as one kilogram in its middle. Loads
    /// then have the right shape but not the right size.
    pub masses_made_up: bool,
}

/// A joint of the arm and the rigid body that it carries up to the next one.
#[derive(Clone, Debug)]
pub struct Part {
    /// Name of the joint.
    pub joint: String,
    /// Its name for people.
    pub title: String,
    /// Its place in a posture; `None` for what slides, which no posture has.
    pub index: Option<JointIndex>,
    /// Moves along its axis, by meters, instead of about it: all that is said of its angle is then of its place.
    pub slides: bool,
    /// Name of the link that it carries.
    pub link: String,
    /// From the turned frame of the joint before (or the base) to this joint at angle zero.
    pub before: Isometry3<f64>,
    /// Axis of positive motion, own frame.
    pub axis: Unit<Vector3<f64>>,
    /// Mass of everything up to the next joint, hand and other branches at rest, kg.
    pub mass_kg: f64,
    /// Its center of mass, turned frame of the joint, m.
    pub center_m: Point3<f64>,
}

/// What is different from the nominal arm. All zero is the nominal arm exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct Deviation {
    /// Added to each joint's angle, rad; to the place of what slides, m.
    pub joint_rad: Vec<f64>,
    /// Turns each joint before it moves: rotation vector in its own frame, rad.
    pub skew_rad: Vec<Vector3<f64>>,
    /// Shifts the place of each joint, axes of the frame before it, m.
    pub shift_m: Vec<Vector3<f64>>,
    /// Shifts the tip, tip frame, m.
    pub tip_m: Vector3<f64>,
    /// Turns the base: rotation vector, robot frame, rad.
    pub base_rad: Vector3<f64>,
    /// Shifts the base, robot frame, m.
    pub base_m: Vector3<f64>,
    /// Shifts the place of contact, robot frame, m.
    pub contact_m: Vector3<f64>,
    /// The screen's true size against its nominal one, less 1, along u and v.
    pub screen_scale: [f64; 2],
    /// Height of the glass over its plane: per square meter from the middle, along u and v, 1/m.
    pub screen_bow_per_m: [f64; 2],
    /// Shift of what the panel reports toward its nearest borders, at the border, m.
    pub screen_edge_m: f64,
    /// Shifts the screen, robot frame, m.
    pub screen_m: Vector3<f64>,
    /// Turns the screen about the middle of its image: rotation vector, robot frame, rad.
    pub screen_rad: Vector3<f64>,
}

impl Deviation {
    /// The nominal arm with this many joints.
    pub fn none(joints: usize) -> Self {
        Self {
            joint_rad: vec![0.0; joints],
            skew_rad: vec![Vector3::zeros(); joints],
            shift_m: vec![Vector3::zeros(); joints],
            tip_m: Vector3::zeros(),
            base_rad: Vector3::zeros(),
            base_m: Vector3::zeros(),
            contact_m: Vector3::zeros(),
            screen_scale: [0.0; 2],
            screen_bow_per_m: [0.0; 2],
            screen_edge_m: 0.0,
            screen_m: Vector3::zeros(),
            screen_rad: Vector3::zeros(),
        }
    }

    /// Back to the nominal arm, without giving back the memory.
    pub(crate) fn clear(&mut self) {
        let mut none = Self::none(0);
        std::mem::swap(&mut none.joint_rad, &mut self.joint_rad);
        std::mem::swap(&mut none.skew_rad, &mut self.skew_rad);
        std::mem::swap(&mut none.shift_m, &mut self.shift_m);
        none.joint_rad.fill(0.0);
        none.skew_rad.fill(Vector3::zeros());
        none.shift_m.fill(Vector3::zeros());
        *self = none;
    }
}

/// Joint frames of the nominal arm in one pose.
#[derive(Clone, Debug)]
pub struct Frames {
    /// Turned frame of each joint, robot frame.
    pub robot_from_joint: Vec<Isometry3<f64>>,
    /// Axis of each joint, robot frame.
    pub axes: Vec<Vector3<f64>>,
    /// Place of the tip.
    pub robot_from_tip: Isometry3<f64>,
}

impl Part {
    /// From the joint at zero to the joint where it stands (rad; m of what slides).
    pub fn motion(&self, at: f64) -> Isometry3<f64> {
        if self.slides {
            Translation3::from(self.axis.into_inner() * at).into()
        } else {
            Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(&self.axis, at))
        }
    }

    /// How it turns the frame after it, for the same.
    pub(crate) fn turn(&self, at: f64) -> UnitQuaternion<f64> {
        self.motion(at).rotation
    }

    /// Name of its column of commands (`cmd`) or encoders (`enc`).
    pub fn column(&self, prefix: &str) -> String {
        format!("{prefix}_{}_{}", self.joint, if self.slides { "m" } else { "rad" })
    }
}

impl Arm {
    /// The arm of a rig that ends in the link `tip`; other joints are as in the rig's home pose.
    ///
    /// # Errors
    /// When there is no such link.
    pub fn of_rig(rig: &Rig, tip: &str) -> Result<Self, DescriptionError> {
        Self::logged(rig, tip, &[])
    }

    /// The same with those of these joints that slide
    /// ([`slide_axis`](plumbline_model::robot::Description::slide_axis)), for rows that say where they stood.
    ///
    /// # Errors
    /// When there is no such link.
    pub fn logged(rig: &Rig, tip: &str, logged: &[String]) -> Result<Self, DescriptionError> {
        let description = &*rig.description;
        let home = rig.home();
        let path = path_to(description, tip)?;
        let mut parts: Vec<Part> = vec![];
        let mut rest = Isometry3::identity();
        let mut carriers: Vec<LinkIndex> = vec![];
        for joint in &path {
            let slide = description.slide_axis(&joint.name).filter(|_| logged.contains(&joint.name));
            let (axis, index) = match &joint.kind {
                JointKind::Revolute { axis, index, .. } => (*axis, Some(*index)),
                JointKind::Fixed | JointKind::Coupled { .. } => match slide {
                    Some(axis) => (axis, None),
                    None => {
                        rest *= joint.parent_from_child(&home);
                        continue;
                    }
                },
            };
            let title = index
                .and_then(|index| rig.servo_of(index))
                .map_or_else(|| joint.name.replace('_', " "), |servo| servo.title.clone());
            parts.push(Part {
                joint: joint.name.clone(),
                title,
                index,
                slides: index.is_none(),
                link: description.links()[joint.child.0].name.clone(),
                before: std::mem::replace(&mut rest, Isometry3::identity()) * joint.parent_from_joint,
                axis,
                mass_kg: 0.0,
                center_m: Point3::origin(),
            });
            carriers.push(joint.child);
        }
        lump_masses(rig, &carriers, &mut parts);
        let tip_m = rest.translation.vector;
        let masses_made_up = parts.iter().all(|part| part.mass_kg <= 0.0);
        if masses_made_up {
            make_up_masses(&mut parts, tip_m);
        }
        let palm_m = palm(rig, tip, &carriers).unwrap_or_else(|| Point3::from(tip_m));
        let finger_m = tip_m - knuckle(rig, tip, &carriers, tip_m).unwrap_or_default();
        let finger = Unit::try_new(finger_m, 1e-9).unwrap_or(-Vector3::z_axis());
        let links = carried(description, carriers.first().copied());
        Ok(Self { parts, last_from_tip: rest, links, palm_m, finger, masses_made_up })
    }

    /// Whether a tip of the robot is one of this arm.
    pub fn has_tip(&self, tip: &str) -> bool {
        self.links.iter().any(|link| link == tip)
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.parts.len()
    }

    /// Whether nothing moves the tip.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Where joints and tip are, nominally; one angle (rad) per joint.
    pub fn frames(&self, angles_rad: &[f64]) -> Frames {
        let mut place = Isometry3::identity();
        let (mut robot_from_joint, mut axes) = (vec![], vec![]);
        for (part, angle_rad) in self.parts.iter().zip(angles_rad) {
            place = place * part.before * part.motion(*angle_rad);
            robot_from_joint.push(place);
            axes.push(place.rotation * part.axis.into_inner());
        }
        Frames { robot_from_joint, axes, robot_from_tip: place * self.last_from_tip }
    }

    /// Where the tip is when something deviates, robot frame, m.
    pub fn tip_m(&self, angles_rad: &[f64], deviation: &Deviation) -> Point3<f64> {
        self.robot_from_tip(angles_rad, deviation).translation.vector.into()
    }

    /// The same with how the tip is turned.
    pub fn robot_from_tip(&self, angles_rad: &[f64], deviation: &Deviation) -> Isometry3<f64> {
        let mut place = Isometry3::from_parts(
            Translation3::from(deviation.base_m),
            UnitQuaternion::from_scaled_axis(deviation.base_rad),
        );
        for (i, (part, angle_rad)) in self.parts.iter().zip(angles_rad).enumerate() {
            let shift = part.before.translation.vector + deviation.shift_m[i];
            place *= Isometry3::from_parts(Translation3::from(shift), part.before.rotation);
            place.rotation *= UnitQuaternion::from_scaled_axis(deviation.skew_rad[i]);
            place *= part.motion(angle_rad + deviation.joint_rad[i]);
        }
        place *= self.last_from_tip * Translation3::from(deviation.tip_m);
        place.translation.vector += deviation.contact_m;
        place
    }

    /// Moment of gravity about each joint's origin, robot frame, N m, with a point mass (kg) at
    /// the palm. Its part along the axis is what the servo holds against.
    pub fn gravity_moments_nm(&self, frames: &Frames, payload_kg: f64) -> Vec<Vector3<f64>> {
        let weights: Vec<(Point3<f64>, Vector3<f64>)> = self
            .parts
            .iter()
            .enumerate()
            .map(|(i, part)| (frames.robot_from_joint[i] * part.center_m, weight_n(part.mass_kg)))
            .collect();
        let held = frames.robot_from_joint.last().map(|last| (last * self.palm_m, weight_n(payload_kg)));
        frames
            .robot_from_joint
            .iter()
            .enumerate()
            .map(|(i, place)| {
                let about = Point3::from(place.translation.vector);
                weights[i..].iter().chain(&held).map(|(at, force)| (at - about).cross(force)).sum()
            })
            .collect()
    }
}

impl Arm {
    /// Weight of what hangs on each joint and beyond it, robot frame, N.
    pub fn weights_beyond_n(&self, payload_kg: f64) -> Vec<Vector3<f64>> {
        let mut beyond_kg = payload_kg;
        let mut weights: Vec<_> = self
            .parts
            .iter()
            .rev()
            .map(|part| {
                beyond_kg += part.mass_kg;
                weight_n(beyond_kg)
            })
            .collect();
        weights.reverse();
        weights
    }
}

fn weight_n(mass_kg: f64) -> Vector3<f64> {
    Vector3::new(0.0, 0.0, GRAVITY_M_S2 * mass_kg)
}

/// Names of a link and of all that hang on it.
fn carried(description: &Description, first: Option<LinkIndex>) -> Vec<String> {
    let mut links: Vec<LinkIndex> = first.into_iter().collect();
    // Parents stand before their children.
    for joint in description.joints() {
        if links.contains(&joint.parent) {
            links.push(joint.child);
        }
    }
    links.into_iter().map(|link| description.links()[link.0].name.clone()).collect()
}

fn path_to<'a>(description: &'a Description, tip: &str) -> Result<Vec<&'a Joint>, DescriptionError> {
    let mut path = vec![];
    let mut link = description.find_link(tip)?;
    while let Some(joint) = description.joint_above(link) {
        path.push(joint);
        link = joint.parent;
    }
    path.reverse();
    Ok(path)
}

/// Place, among the links that the arm's joints carry, of the one that a link hangs on.
fn carrier(description: &Description, mut link: LinkIndex, carriers: &[LinkIndex]) -> Option<usize> {
    loop {
        if let Some(i) = carriers.iter().position(|carrier| *carrier == link) {
            return Some(i);
        }
        link = description.joint_above(link)?.parent;
    }
}

/// Adds up what hangs on each joint of the arm, other joints at home.
fn lump_masses(rig: &Rig, carriers: &[LinkIndex], parts: &mut [Part]) {
    let poses = rig.description.forward(&rig.home());
    let mut moments = vec![Vector3::zeros(); parts.len()];
    for (k, link) in rig.description.links().iter().enumerate() {
        let on = carrier(&rig.description, LinkIndex(k), carriers);
        let (Some(i), Some(inertia)) = (on, link.inertia) else { continue };
        let carrier_from_link = poses.of(carriers[i]).isometry.inverse() * poses.of(LinkIndex(k)).isometry;
        let center = carrier_from_link * Point3::from(inertia.center_m);
        parts[i].mass_kg += inertia.mass_kg;
        moments[i] += center.coords * inertia.mass_kg;
    }
    for (part, moment) in parts.iter_mut().zip(moments) {
        if part.mass_kg > 0.0 {
            part.center_m = Point3::from(moment / part.mass_kg);
        }
    }
}

/// One kilogram in the middle of every link.
fn make_up_masses(parts: &mut [Part], tip_m: Vector3<f64>) {
    let mut end_m = tip_m;
    for part in parts.iter_mut().rev() {
        part.mass_kg = 1.0;
        part.center_m = Point3::from(0.5 * end_m);
        end_m = part.before.translation.vector;
    }
}

/// The usual tip of the arm that has this tip (its palm), in the last joint's frame.
fn palm(rig: &Rig, tip: &str, carriers: &[LinkIndex]) -> Option<Point3<f64>> {
    let arm = rig.arms.iter().find(|arm| arm.tips.iter().any(|known| known.link == tip))?;
    let palm = rig.description.find_link(&arm.tips.first()?.link).ok()?;
    let poses = rig.description.forward(&rig.home());
    let last = poses.of(*carriers.last()?).isometry;
    Some(Point3::from((last.inverse() * poses.of(palm).isometry).translation.vector))
}

/// The joint of the hand that is nearest to the tip, in the last joint's frame. Fingers are rigid
/// parts of the way to the tip, so their joints are not on the chain.
fn knuckle(rig: &Rig, tip: &str, carriers: &[LinkIndex], tip_m: Vector3<f64>) -> Option<Vector3<f64>> {
    let arm = rig.arms.iter().find(|arm| arm.tips.iter().any(|known| known.link == tip))?;
    let poses = rig.description.forward(&rig.home());
    let last = poses.of(*carriers.last()?).isometry.inverse();
    arm.hand
        .iter()
        .map(|joint| (last * poses.of(rig.description.joint(*joint).child).isometry).translation.vector)
        .filter(|knuckle| (knuckle - tip_m).norm() > 1e-6)
        .min_by(|a, b| (a - tip_m).norm().total_cmp(&(b - tip_m).norm()))
}
