//! Limits beyond those of single joints: every goal that is sent passes them.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use nalgebra::Isometry3;
use plumbline_model::robot::{Description, LinkIndex, Posture, Rig, Shape};

use super::refusal::Refusal;

/// Looks at a whole posture before it is sent.
pub trait Guard: Send + Sync {
    /// Whether the arm may go from `present` on to `goal`, which is near. Where `present` is
    /// already wrong, what makes it better must be allowed.
    ///
    /// # Errors
    /// When not.
    fn check(&self, present: &Posture, goal: &Posture) -> Result<(), Refusal>;
}

/// Farther from where the rig has it the floor is never taken to lie, m.
pub const FARTHEST_FLOOR_M: f64 = 0.04;

/// By how much the floor lies elsewhere for hands as they are described: one that is known to stand higher than
/// it is described has to be sent lower to get to the same height. Clones are the same shift.
#[derive(Clone, Debug, Default)]
pub struct FloorShift(Arc<AtomicU64>);

impl FloorShift {
    /// From now on the floor lies higher by this much (negative: lower), m. What is farther than
    /// [`FARTHEST_FLOOR_M`] or not a number is not believed of any arm: then it lies where the rig has it.
    pub fn set_m(&self, up_m: f64) {
        let believed_m = if up_m.abs() <= FARTHEST_FLOOR_M { up_m } else { 0.0 };
        self.0.store(believed_m.to_bits(), Ordering::Release);
    }

    /// How much higher it lies, m.
    pub fn up_m(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Acquire))
    }
}

/// No part of an arm below a height.
#[derive(Clone, Debug)]
pub struct FloorGuard {
    description: Arc<Description>,
    parts: Vec<LinkIndex>,
    /// By link: whether it belongs to a hand.
    is_hand: Vec<bool>,
    floor_m: f64,
    shift: FloorShift,
}

/// Where the present posture is below the floor, lower by this much is still no worse, m.
const NO_WORSE_M: f64 = 1e-4;

impl FloorGuard {
    /// For all arms of a rig, at its floor.
    pub fn new(rig: &Rig) -> Self {
        let description = rig.description.clone();
        let arm_joints: Vec<_> = rig.arms.iter().flat_map(|arm| arm.joints.iter().copied()).collect();
        let mut is_arm = vec![false; description.links().len()];
        // Parents come before children.
        for joint in description.joints() {
            let own = arm_joints.iter().any(|index| description.joint(*index).name == joint.name);
            is_arm[joint.child.0] = own || is_arm[joint.parent.0];
        }
        let parts = (0..is_arm.len()).filter(|link| is_arm[*link]).map(LinkIndex).collect();
        let is_hand = hands(rig);
        Self { description, parts, is_hand, floor_m: rig.gate.floor_m, shift: FloorShift::default() }
    }

    /// The same, where a shift says that the floor lies.
    pub fn shifted_by(self, shift: FloorShift) -> Self {
        Self { shift, ..self }
    }

    /// The lowest part of an arm in a posture, and the height of its lowest point (m).
    pub fn lowest(&self, posture: &Posture) -> Option<(LinkIndex, f64)> {
        self.lowest_shifted(posture, 0.0)
    }

    /// The same with hands lower by this much than they are described (negative: higher), m.
    pub fn lowest_shifted(&self, posture: &Posture, down_m: f64) -> Option<(LinkIndex, f64)> {
        let poses = self.description.forward(posture);
        let height = |link: &LinkIndex| {
            let described_m = lowest_m(&self.description, *link, &poses.all()[link.0]);
            (*link, described_m - if self.is_hand[link.0] { down_m } else { 0.0 })
        };
        self.parts.iter().map(height).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Of some links those with shapes, with the height of their lowest points (m), lowest first.
    pub fn heights(&self, posture: &Posture, links: &[LinkIndex]) -> Vec<(LinkIndex, f64)> {
        let poses = self.description.forward(posture);
        let has_shapes = |link: &&LinkIndex| !self.description.links()[link.0].collisions.is_empty();
        let height = |link: &LinkIndex| (*link, lowest_m(&self.description, *link, &poses.all()[link.0]));
        let mut heights: Vec<_> = links.iter().filter(has_shapes).map(height).collect();
        heights.sort_by(|a, b| a.1.total_cmp(&b.1));
        heights
    }
}

impl Guard for FloorGuard {
    fn check(&self, present: &Posture, goal: &Posture) -> Result<(), Refusal> {
        let down_m = self.shift.up_m();
        let Some((link, height_m)) = self.lowest_shifted(goal, down_m) else { return Ok(()) };
        let floor_m = self.floor_m;
        if height_m >= floor_m {
            return Ok(());
        }
        let before_m = self.lowest_shifted(present, down_m).map_or(f64::INFINITY, |(_, height_m)| height_m);
        if before_m < floor_m && height_m >= before_m - NO_WORSE_M {
            return Ok(());
        }
        let link = self.description.links()[link.0].name.clone();
        Err(Refusal::Floor { link, height_m, floor_m })
    }
}

/// By link of a rig: whether it belongs to a hand, which the last joint of an arm moves.
fn hands(rig: &Rig) -> Vec<bool> {
    let description = &rig.description;
    let mut is_hand = vec![false; description.links().len()];
    for wrist in rig.arms.iter().filter_map(|arm| arm.joints.last()) {
        is_hand[description.joint(*wrist).child.0] = true;
    }
    // Parents come before children.
    for joint in description.joints() {
        is_hand[joint.child.0] |= is_hand[joint.parent.0];
    }
    is_hand
}

/// Height of the lowest point of a link, m: of its shapes, or of its origin without any.
fn lowest_m(description: &Description, link: LinkIndex, robot_from_link: &Isometry3<f64>) -> f64 {
    let link = &description.links()[link.0];
    let shapes = if link.collisions.is_empty() { &link.visuals } else { &link.collisions };
    let lowest = |pose: Isometry3<f64>, shape: &Shape| {
        // The third row of the rotation: how much each axis of the shape points up.
        let up = pose.rotation.inverse() * nalgebra::Vector3::z();
        let below_m = match shape {
            Shape::Box { half_m } => up.abs().dot(half_m),
            Shape::Sphere { radius_m } => *radius_m,
            Shape::Capsule { radius_m, half_length_m } => up.z.abs() * half_length_m + radius_m,
            Shape::Cylinder { radius_m, half_length_m } => {
                up.z.abs() * half_length_m + up.x.hypot(up.y) * radius_m
            }
        };
        pose.translation.z - below_m
    };
    shapes
        .iter()
        .map(|visual| lowest(robot_from_link * visual.link_from_shape, &visual.shape))
        .fold(robot_from_link.translation.z, f64::min)
}
