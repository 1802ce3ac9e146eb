//! One tip and the joints between it and the base: where it is, and how it moves.

use nalgebra::{Isometry3, Matrix3xX, Matrix6xX, Translation3, Unit, UnitQuaternion, Vector3};

use super::description::{Description, JointIndex, JointKind, Limits};
use super::error::DescriptionError;
use super::posture::Posture;
use crate::frame::{Pose, Robot, Tip};

/// The joints from the base to a tip. Joints that follow others count as fixed at the posture
/// it was made for.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    tip: String,
    joints: Vec<JointIndex>,
    names: Vec<String>,
    limits: Vec<Limits>,
    segments: Vec<Segment>,
    /// Last joint to tip.
    last: Isometry3<f64>,
}

/// What lies between one joint and the one before, and the joint's axis.
#[derive(Clone, Debug, PartialEq)]
struct Segment {
    before: Isometry3<f64>,
    axis: Unit<Vector3<f64>>,
    /// Moves along its axis instead of about it.
    slides: bool,
}

impl Segment {
    /// From the joint at zero to the joint where it stands, rad or m.
    fn motion(&self, at: f64) -> Isometry3<f64> {
        if self.slides {
            Translation3::from(self.axis.into_inner() * at).into()
        } else {
            turn(&self.axis, at)
        }
    }
}

impl Chain {
    /// The chain that ends in the link `tip`. `others` gives the angle of joints that follow
    /// another joint outside of the chain.
    ///
    /// # Errors
    /// When there is no such link.
    pub fn to(description: &Description, tip: &str, others: &Posture) -> Result<Self, DescriptionError> {
        Self::logged(description, tip, others, &[])
    }

    /// The same with those of these joints that slide ([`Description::slide_axis`]) among its joints, for rows that
    /// say where they stood, m. Only [`Self::names`] and [`Self::robot_from_tip`] know them.
    ///
    /// # Errors
    /// When there is no such link.
    pub fn logged(
        description: &Description,
        tip: &str,
        others: &Posture,
        logged: &[String],
    ) -> Result<Self, DescriptionError> {
        let mut path = vec![];
        let mut link = description.find_link(tip)?;
        while let Some(joint) = description.joint_above(link) {
            path.push(joint);
            link = joint.parent;
        }
        let mut chain = Self {
            tip: tip.to_owned(),
            joints: vec![],
            names: vec![],
            limits: vec![],
            segments: vec![],
            last: Isometry3::identity(),
        };
        for joint in path.into_iter().rev() {
            match &joint.kind {
                JointKind::Revolute { axis, limits, index } => {
                    let before = std::mem::replace(&mut chain.last, Isometry3::identity());
                    let before = before * joint.parent_from_joint;
                    chain.segments.push(Segment { before, axis: *axis, slides: false });
                    chain.joints.push(*index);
                    chain.names.push(joint.name.clone());
                    chain.limits.push(*limits);
                }
                JointKind::Fixed | JointKind::Coupled { .. } => {
                    let slide = description.slide_axis(&joint.name).filter(|_| logged.contains(&joint.name));
                    if let Some(axis) = slide {
                        let before = std::mem::replace(&mut chain.last, Isometry3::identity());
                        let before = before * joint.parent_from_joint;
                        chain.segments.push(Segment { before, axis, slides: true });
                        chain.names.push(joint.name.clone());
                    } else {
                        chain.last *= joint.parent_from_child(others);
                    }
                }
            }
        }
        Ok(chain)
    }

    /// Name of the tip.
    pub fn tip(&self) -> &str {
        &self.tip
    }

    /// Its joints, from the base on.
    pub fn joints(&self) -> &[JointIndex] {
        &self.joints
    }

    /// Names of its joints.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Limits of its joints.
    pub fn limits(&self) -> &[Limits] {
        &self.limits
    }

    /// Before each joint what lies between the joint before and it, and its axis.
    pub(super) fn segments(&self) -> impl ExactSizeIterator<Item = (&Isometry3<f64>, &Unit<Vector3<f64>>)> {
        self.segments.iter().map(|segment| (&segment.before, &segment.axis))
    }

    /// From the last joint's turned frame to the tip.
    pub(super) fn last_joint_from_tip(&self) -> &Isometry3<f64> {
        &self.last
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.joints.len()
    }

    /// Whether the tip cannot be moved at all.
    pub fn is_empty(&self) -> bool {
        self.joints.is_empty()
    }

    /// No posture takes the tip farther than this from the origin of the robot frame, m: the sum of
    /// all lengths.
    pub fn farthest_m(&self) -> f64 {
        let before = self.segments.iter().map(|segment| segment.before.translation.vector.norm());
        before.sum::<f64>() + self.last.translation.vector.norm()
    }

    /// Place of the tip; one angle (rad) per joint of the chain.
    pub fn robot_from_tip(&self, angles_rad: &[f64]) -> Pose<Robot, Tip> {
        debug_assert_eq!(angles_rad.len(), self.segments.len());
        let mut place = Isometry3::identity();
        for (segment, angle_rad) in self.segments.iter().zip(angles_rad) {
            place = place * segment.before * segment.motion(*angle_rad);
        }
        Pose::new(place * self.last)
    }

    /// Place of the tip in a whole posture.
    pub fn robot_from_tip_in(&self, posture: &Posture) -> Pose<Robot, Tip> {
        self.robot_from_tip(&posture.of(&self.joints))
    }

    /// Place of the tip and its geometric Jacobian, robot frame: rows 0–2 the velocity of the
    /// tip's origin (m/rad), rows 3–5 its angular velocity (rad/rad), one column per joint.
    pub fn jacobian(&self, angles_rad: &[f64]) -> (Pose<Robot, Tip>, Matrix6xX<f64>) {
        let mut place = Isometry3::identity();
        let mut axes = Matrix3xX::zeros(self.len());
        let mut origins = Matrix3xX::zeros(self.len());
        for (i, (segment, angle_rad)) in self.segments.iter().zip(angles_rad).enumerate() {
            place *= segment.before;
            axes.set_column(i, &(place.rotation * segment.axis.into_inner()));
            origins.set_column(i, &place.translation.vector);
            place *= turn(&segment.axis, *angle_rad);
        }
        place *= self.last;
        let tip = place.translation.vector;
        let mut jacobian = Matrix6xX::zeros(self.len());
        for i in 0..self.len() {
            let axis: Vector3<f64> = axes.column(i).into();
            let arm: Vector3<f64> = tip - origins.column(i);
            jacobian.fixed_view_mut::<3, 1>(0, i).copy_from(&axis.cross(&arm));
            jacobian.fixed_view_mut::<3, 1>(3, i).copy_from(&axis);
        }
        (Pose::new(place), jacobian)
    }
}

fn turn(axis: &Unit<Vector3<f64>>, angle_rad: f64) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_axis_angle(axis, angle_rad))
}
