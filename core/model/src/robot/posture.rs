//! One angle for every movable joint.

use std::ops::{Index, IndexMut};

use super::description::JointIndex;

/// Angles of all joints that move by themselves, radians of the joint (not of its motor), in the
/// order of [`super::Description::movable`].
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Posture {
    angles_rad: Vec<f64>,
}

impl Posture {
    /// From one angle (rad) per movable joint, in their order.
    pub fn new(angles_rad: Vec<f64>) -> Self {
        Self { angles_rad }
    }

    /// All angles, rad.
    pub fn angles_rad(&self) -> &[f64] {
        &self.angles_rad
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.angles_rad.len()
    }

    /// Whether there is no joint at all.
    pub fn is_empty(&self) -> bool {
        self.angles_rad.is_empty()
    }

    /// Whether every angle is a number.
    pub fn is_finite(&self) -> bool {
        self.angles_rad.iter().all(|angle| angle.is_finite())
    }

    /// The same posture with some joints at other angles (rad).
    pub fn with(&self, joints: &[JointIndex], angles_rad: &[f64]) -> Self {
        let mut posture = self.clone();
        for (joint, angle_rad) in joints.iter().zip(angles_rad) {
            posture[*joint] = *angle_rad;
        }
        posture
    }

    /// Angles (rad) of some joints.
    pub fn of(&self, joints: &[JointIndex]) -> Vec<f64> {
        joints.iter().map(|joint| self[*joint]).collect()
    }

    /// Part of the way (0 here, 1 there) to another posture, joint by joint.
    pub fn toward(&self, other: &Self, fraction: f64) -> Self {
        let pairs = self.angles_rad.iter().zip(&other.angles_rad);
        Self::new(pairs.map(|(from, to)| from + fraction * (to - from)).collect())
    }

    /// Largest difference of a joint to another posture, rad.
    pub fn distance_rad(&self, other: &Self) -> f64 {
        let pairs = self.angles_rad.iter().zip(&other.angles_rad);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }
}

impl Index<JointIndex> for Posture {
    type Output = f64;

    fn index(&self, joint: JointIndex) -> &f64 {
        &self.angles_rad[joint.0]
    }
}

impl IndexMut<JointIndex> for Posture {
    fn index_mut(&mut self, joint: JointIndex) -> &mut f64 {
        &mut self.angles_rad[joint.0]
    }
}
