//! What effects depend on: loads, directions, where the finger points.

use nalgebra::{Isometry3, Point3, Vector3};

use super::press::Press;
use crate::arm::{Arm, Frames, Part};
use crate::observation::Observation;

/// All that effects depend on, in one pose of the arm on the screen.
#[derive(Clone, Debug)]
pub struct Situation<'a> {
    pub(super) arm: &'a Arm,
    pub(super) angles_rad: &'a [f64],
    pub(super) direction: &'a [f64],
    /// Gravity about each axis.
    pub(super) torques_nm: Vec<f64>,
    /// The same for one kilogram at the palm.
    pub(super) torques_per_kg_nm: Vec<f64>,
    /// Gravity across each axis, own frame at angle zero.
    pub(super) sideways_nm: Vec<Vector3<f64>>,
    /// Gravity about the base, level part, robot frame.
    pub(super) lean_nm: Vector3<f64>,
    /// Shift of the contact per meter of pad radius, robot frame.
    pub(super) roll: Vector3<f64>,
    /// Direction of the last motion along the glass, robot frame; zero if unknown.
    pub(super) sweep: Vector3<f64>,
    /// The same, as long as the way along the glass per way down.
    pub(super) slope: Vector3<f64>,
    /// Where the tip slides along the glass per meter that the joints are driven on against it, robot frame; zero if no
    /// direction is known.
    pub(super) pressed: Vector3<f64>,
    /// Where the nominal joints are.
    pub(super) frames: Frames,
    /// Moment of gravity about each joint's origin, robot frame.
    pub(super) moments_nm: Vec<Vector3<f64>>,
    /// Weight of what hangs on each joint and beyond, robot frame.
    pub(super) weights_n: Vec<Vector3<f64>>,
    /// Out of the glass, robot frame.
    pub(super) normal: Vector3<f64>,
    /// Where the finger points, robot frame.
    pub(super) finger: Vector3<f64>,
    /// What else is known of the row: lags, times, temperatures. `None` for a touch that is only
    /// planned.
    pub(super) row: Option<&'a Observation>,
}

impl<'a> Situation<'a> {
    /// Of one pose: angles at contact (rad) and last direction of motion (−1, 0, 1) per joint.
    pub fn new(
        arm: &'a Arm,
        angles_rad: &'a [f64],
        direction: &'a [f64],
        payload_kg: f64,
        normal: &Vector3<f64>,
    ) -> Self {
        let frames = arm.frames(angles_rad);
        let moments = arm.gravity_moments_nm(&frames, payload_kg);
        let heavier = arm.gravity_moments_nm(&frames, payload_kg + 1.0);
        let along = |moments: &[Vector3<f64>]| -> Vec<f64> {
            // What slides bears forces along its axis, and no torque about it.
            let about = |part: &Part| if part.slides { 0.0 } else { 1.0 };
            let all = moments.iter().zip(&frames.axes).zip(&arm.parts);
            all.map(|((moment, axis), part)| about(part) * moment.dot(axis)).collect()
        };
        let (torques_nm, torques_heavier) = (along(&moments), along(&heavier));
        let sideways_nm = (0..arm.len())
            .map(|j| {
                let across = moments[j] - frames.axes[j] * torques_nm[j];
                // A joint gives way across its axis before it turns: the frame at angle zero.
                arm.parts[j].turn(angles_rad[j]) * (frames.robot_from_joint[j].rotation.inverse() * across)
            })
            .collect();
        let tip = Point3::from(frames.robot_from_tip.translation.vector);
        let press = Press::of(arm, &frames, direction, tip, normal);
        let slope = press.alike();
        let lean_nm = moments.first().map_or(Vector3::zeros(), |m| Vector3::new(m.x, m.y, 0.0));
        Self {
            arm,
            angles_rad,
            direction,
            torques_per_kg_nm: torques_heavier.iter().zip(&torques_nm).map(|(a, b)| a - b).collect(),
            torques_nm,
            sideways_nm,
            lean_nm,
            roll: roll(arm, &frames.robot_from_joint, normal),
            sweep: slope.try_normalize(0.0).unwrap_or_default(),
            slope,
            pressed: press.pressed(),
            weights_n: arm.weights_beyond_n(payload_kg),
            moments_nm: moments,
            normal: *normal,
            finger: frames.robot_from_joint.last().map_or(-*normal, |last| last.rotation * *arm.finger),
            frames,
            row: None,
        }
    }

    /// The same with what was logged in a row. Measured torques take the place of those of the
    /// description's masses.
    pub fn during(mut self, row: &'a Observation) -> Self {
        if let Some(torque_nm) = row.torque_nm.as_ref().filter(|t| t.len() == self.torques_nm.len()) {
            self.torques_nm.clone_from(torque_nm);
        }
        self.row = Some(row);
        self
    }

    /// Gravity about each axis, N m.
    pub fn torques_nm(&self) -> &[f64] {
        &self.torques_nm
    }
}

/// A round pad touches with its lowest point, the model's tip lies at its end: per meter of
/// radius the contact moves by −(finger + normal).
fn roll(arm: &Arm, joints: &[Isometry3<f64>], normal: &Vector3<f64>) -> Vector3<f64> {
    let Some(last) = joints.last() else { return Vector3::zeros() };
    -(last.rotation * arm.finger.into_inner() + normal)
}
