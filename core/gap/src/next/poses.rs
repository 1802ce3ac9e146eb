//! Other poses of the arm near one that was measured.

use nalgebra::{DMatrix, DVector, Vector3};
use plumbline_effects::arm::{Arm, Deviation};
use plumbline_model::decompose;

/// A pose found for a place must reach it within this, m.
const REACHED_M: f64 = 1e-4;
/// No joint is turned further than this: what limits it is not known here, rad.
const FURTHEST_RAD: f64 = 0.7;
/// How far joints turn for another posture with the tip in place, rad.
const POSTURE_RAD: f64 = 0.35;
/// Joints that move less than this share of the fastest one are at rest.
const AT_REST: f64 = 0.05;
/// Damping of the inverse of the Jacobian, m/rad.
const DAMPING: f64 = 1e-3;

/// Angles that put the tip `by` (robot frame, m) away from where `from` has it.
pub(super) fn moved(arm: &Arm, from: &[f64], by: Vector3<f64>) -> Option<Vec<f64>> {
    reach(arm, from, from, by)
}

/// Angles with the tip in place and the joints that are free turned one way or the other.
pub(super) fn other_posture(arm: &Arm, from: &[f64], sign: f64) -> Option<Vec<f64>> {
    let jacobian = jacobian(arm, from);
    let inverse = decompose::pseudo_inverse(jacobian.clone(), DAMPING)?;
    let free = DMatrix::identity(arm.len(), arm.len()) - inverse * jacobian;
    let best = (0..free.ncols()).max_by(|a, b| free.column(*a).norm().total_cmp(&free.column(*b).norm()))?;
    let turn = free.column(best).clone_owned();
    let largest = turn.amax();
    if largest < 1e-3 {
        return None;
    }
    [sign, -sign].into_iter().find_map(|sign| {
        let start: Vec<f64> =
            from.iter().zip(turn.iter()).map(|(a, t)| a + sign * POSTURE_RAD * t / largest).collect();
        reach(arm, from, &start, Vector3::zeros())
    })
}

/// Direction of motion of each joint (−1, 0, 1) when the tip moves along `way`.
pub(super) fn directions(arm: &Arm, angles: &[f64], way: &Vector3<f64>) -> Option<Vec<f64>> {
    let inverse = decompose::pseudo_inverse(jacobian(arm, angles), DAMPING)?;
    let speed = inverse * DVector::from_column_slice(way.as_slice());
    let fastest = speed.amax();
    (fastest > 0.0)
        .then(|| speed.iter().map(|v| if v.abs() < AT_REST * fastest { 0.0 } else { v.signum() }).collect())
}

fn reach(arm: &Arm, from: &[f64], start: &[f64], by: Vector3<f64>) -> Option<Vec<f64>> {
    let none = Deviation::none(arm.len());
    let goal = arm.tip_m(from, &none) + by;
    let mut angles = DVector::from_column_slice(start);
    for _ in 0..15 {
        let error = goal - arm.tip_m(angles.as_slice(), &none);
        if error.norm() < REACHED_M {
            break;
        }
        let inverse = decompose::pseudo_inverse(jacobian(arm, angles.as_slice()), DAMPING)?;
        let step = inverse * DVector::from_column_slice(error.as_slice());
        angles += &step * (0.5 / step.amax()).min(1.0);
    }
    let reached = (goal - arm.tip_m(angles.as_slice(), &none)).norm() < REACHED_M;
    let near = angles.iter().zip(from).all(|(a, b)| (a - b).abs() < FURTHEST_RAD);
    (reached && near).then(|| angles.as_slice().to_vec())
}

/// Velocity of the tip per joint, m/rad.
fn jacobian(arm: &Arm, angles: &[f64]) -> DMatrix<f64> {
    let frames = arm.frames(angles);
    let tip = frames.robot_from_tip.translation.vector;
    DMatrix::from_fn(3, arm.len(), |row, j| {
        frames.axes[j].cross(&(tip - frames.robot_from_joint[j].translation.vector))[row]
    })
}
