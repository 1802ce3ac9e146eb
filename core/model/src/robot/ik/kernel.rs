//! Place of the tip and axes of the joints without allocation: what the solver calls many times.

use nalgebra::{Isometry3, Matrix3, Unit, UnitQuaternion, Vector3};

use crate::robot::chain::Chain;

/// Most joints of a chain that is solved.
pub const MAX_JOINTS: usize = 7;

/// One angle per joint; those beyond the chain's length are zero.
pub(super) type Angles = [f64; MAX_JOINTS];

/// A chain whose joint frames are turned so that every joint turns about its own z.
#[derive(Clone, Debug)]
pub(super) struct Kernel {
    count: usize,
    /// From the turned frame of the joint before to this joint's frame at angle zero.
    fixed: [Fixed; MAX_JOINTS],
    /// From the turned frame of the last joint to the tip.
    last: Fixed,
}

#[derive(Clone, Copy, Debug)]
struct Fixed {
    rotation: Matrix3<f64>,
    translation_m: Vector3<f64>,
}

/// The tip and the joints at some angles, robot frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    /// Columns are the tip's axes.
    pub rotation: Matrix3<f64>,
    /// Origin of the tip, m.
    pub position_m: Vector3<f64>,
    /// Axis of each joint.
    pub axes: [Vector3<f64>; MAX_JOINTS],
    /// A point on each axis, m.
    pub origins_m: [Vector3<f64>; MAX_JOINTS],
}

impl Fixed {
    fn new(isometry: &Isometry3<f64>) -> Self {
        Self {
            rotation: isometry.rotation.to_rotation_matrix().into_inner(),
            translation_m: isometry.translation.vector,
        }
    }
}

impl Kernel {
    /// `None` when the chain has no joint or too many.
    pub fn new(chain: &Chain) -> Option<Self> {
        let count = chain.len();
        if count == 0 || count > MAX_JOINTS {
            return None;
        }
        let mut fixed = [Fixed::new(&Isometry3::identity()); MAX_JOINTS];
        let mut turned_from_joint = UnitQuaternion::identity();
        for (slot, (before, axis)) in fixed.iter_mut().zip(chain.segments()) {
            let joint_from_turned = from_z(axis);
            *slot = Fixed::new(&(turned_from_joint * before * joint_from_turned));
            turned_from_joint = joint_from_turned.inverse();
        }
        Some(Self { count, fixed, last: Fixed::new(&(turned_from_joint * chain.last_joint_from_tip())) })
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.count
    }

    /// The tip and the joints at some angles (rad).
    pub fn read(&self, angles_rad: &Angles) -> Reading {
        let mut rotation = Matrix3::identity();
        let mut position_m = Vector3::zeros();
        let mut axes = [Vector3::zeros(); MAX_JOINTS];
        let mut origins_m = [Vector3::zeros(); MAX_JOINTS];
        for i in 0..self.count {
            let fixed = &self.fixed[i];
            position_m += rotation * fixed.translation_m;
            rotation *= fixed.rotation;
            let axis: Vector3<f64> = rotation.column(2).into();
            axes[i] = axis;
            origins_m[i] = position_m;
            let (sine, cosine) = angles_rad[i].sin_cos();
            let (x, y): (Vector3<f64>, Vector3<f64>) = (rotation.column(0).into(), rotation.column(1).into());
            rotation = Matrix3::from_columns(&[x * cosine + y * sine, y * cosine - x * sine, axis]);
        }
        position_m += rotation * self.last.translation_m;
        rotation *= self.last.rotation;
        Reading { rotation, position_m, axes, origins_m }
    }
}

/// A rotation that takes z to `axis`.
fn from_z(axis: &Unit<Vector3<f64>>) -> UnitQuaternion<f64> {
    // Opposite vectors have no unique rotation between them; half a turn about x is one.
    UnitQuaternion::rotation_between(&Vector3::z(), axis)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}
