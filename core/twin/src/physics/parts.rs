//! The robot's solid parts: the links of its description with their shapes. A finger, which the
//! description knows as one part, is made of two, so that it can bend around things.

use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use plumbline_model::robot::{
    Description, JointIndex, JointKind, LinkIndex, Rig, Shape as LinkShape, Visual,
};

use crate::scene::{Material, Pattern, Shape};
use crate::toys::along;

/// Which side of the robot a part belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// The hand of the arm with this number in the rig.
    Hand(usize),
    /// The rest of the arm with this number in the rig.
    Arm(usize),
    /// Torso, neck, head.
    Body,
}

/// A finger that bends in two places.
#[derive(Clone, Debug)]
pub(crate) struct Finger {
    /// The middle joint, link frame.
    pub pivot_m: Vector3<f64>,
    /// The part before it, link frame.
    pub near: (Isometry3<f64>, Shape),
    /// The part behind it, frame at the pivot with the axes of the link.
    pub far: (Isometry3<f64>, Shape),
    /// Sign of the angle that closes it.
    pub closing: f64,
}

/// Form and place of a shape of the description.
pub(crate) fn shape_of(visual: &Visual) -> (Isometry3<f64>, Shape) {
    let shape = match visual.shape {
        LinkShape::Box { half_m } => Shape::Box { half_m },
        LinkShape::Sphere { radius_m } => Shape::Ellipsoid { radii_m: Vector3::repeat(radius_m) },
        LinkShape::Capsule { radius_m, half_length_m } => Shape::Capsule { radius_m, half_length_m },
        LinkShape::Cylinder { radius_m, half_length_m } => Shape::Cylinder { radius_m, half_length_m },
    };
    (visual.link_from_shape, shape)
}

/// Which side each link belongs to.
pub(crate) fn sides(rig: &Rig) -> Vec<Side> {
    let description = &rig.description;
    let mut sides = vec![Side::Body; description.links().len()];
    for joint in description.joints() {
        let own = own_joint(description, joint.child).and_then(|index| side_of_joint(rig, index));
        sides[joint.child.0] = own.unwrap_or(sides[joint.parent.0]);
    }
    // The palm hangs on the arm's last joint but looks like a hand.
    for (i, arm) in rig.arms.iter().enumerate() {
        if let Some(last) = arm.joints.last() {
            sides[description.joint(*last).child.0] = Side::Hand(i);
        }
    }
    sides
}

fn own_joint(description: &Description, link: LinkIndex) -> Option<JointIndex> {
    match description.joint_above(link)?.kind {
        JointKind::Revolute { index, .. } => Some(index),
        JointKind::Coupled { ref mimic, .. } => Some(mimic.source),
        JointKind::Fixed => None,
    }
}

fn side_of_joint(rig: &Rig, joint: JointIndex) -> Option<Side> {
    rig.arms.iter().enumerate().find_map(|(i, arm)| {
        if arm.hand.contains(&joint) {
            Some(Side::Hand(i))
        } else {
            arm.joints.contains(&joint).then_some(Side::Arm(i))
        }
    })
}

/// The link as a finger: it hangs on the palm, is moved by a joint of the hand, is one capsule
/// and carries nothing that moves.
pub(crate) fn finger(rig: &Rig, link: LinkIndex) -> Option<Finger> {
    let description = &rig.description;
    let joint = description.joint_above(link)?;
    let index = own_joint(description, link)?;
    let arm = rig.arms.iter().find(|arm| arm.hand.contains(&index))?;
    let palm = description.joint(*arm.joints.last()?).child;
    let leaf = !description.joints().iter().any(|other| other.parent == link && other.motion().is_some());
    if joint.parent != palm || !leaf {
        return None;
    }
    let [visual] = &description.links()[link.0].visuals[..] else { return None };
    let LinkShape::Capsule { radius_m, half_length_m } = visual.shape else { return None };
    let end = |z: f64| (visual.link_from_shape * Point3::new(0.0, 0.0, z)).coords;
    let (mut root, mut tip) = (end(half_length_m), end(-half_length_m));
    if root.norm() > tip.norm() {
        std::mem::swap(&mut root, &mut tip);
    }
    let pivot_m = 0.5 * (root + tip);
    let piece = |from: Vector3<f64>, to: Vector3<f64>| {
        (along(from, to), Shape::Capsule { radius_m, half_length_m: 0.5 * (to - from).norm() })
    };
    let limits = joint.motion()?.1;
    let closing = if limits.upper_rad.abs() > limits.lower_rad.abs() { 1.0 } else { -1.0 };
    Some(Finger { pivot_m, near: piece(root, pivot_m), far: piece(Vector3::zeros(), tip - pivot_m), closing })
}

/// Surface of a shape of the robot: the arms of the real robot are black where the description
/// only tells its parts apart.
pub(crate) fn material_of(visual: &Visual, side: Side) -> Material {
    let [r, g, b, _] = visual.rgba;
    let linear = |c: f32| c.powf(2.2);
    let (darkening, gloss) = match side {
        Side::Body => (1.0, 0.025),
        Side::Arm(_) => (0.06, 0.08),
        Side::Hand(_) => (0.7, 0.08),
    };
    Material { albedo: [r, g, b].map(|c| (linear(c) * darkening).max(0.012)), gloss, pattern: Pattern::Plain }
}

/// Frame at the pivot of a finger.
pub(crate) fn at(point_m: Vector3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(point_m), nalgebra::UnitQuaternion::identity())
}
