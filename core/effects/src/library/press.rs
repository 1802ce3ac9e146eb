//! Which way a fingertip goes along the glass after it has touched: where the joints go on to, and where they give way to.

use nalgebra::{Point3, Vector3};

use crate::arm::{Arm, Frames};

/// Along the glass per way down, at most: nobody comes in flatter, and joints do not turn quite alike.
const FLATTEST: f64 = 3.0;

/// How the tip goes when each joint turns, and which way each of them turned last.
pub(super) struct Press<'a> {
    /// Of each joint that turns: how the tip goes, m/rad, and the sign of its last motion.
    slopes: Vec<(Vector3<f64>, f64)>,
    normal: &'a Vector3<f64>,
}

impl<'a> Press<'a> {
    /// Of a pose with the last direction of motion (−1, 0, 1) of each joint.
    pub fn of(
        arm: &Arm,
        frames: &Frames,
        direction: &[f64],
        tip: Point3<f64>,
        normal: &'a Vector3<f64>,
    ) -> Self {
        let joints = frames.robot_from_joint.iter().zip(&frames.axes).zip(direction).zip(&arm.parts);
        let slopes = joints
            .filter(|(_, part)| !part.slides)
            .map(|(((joint, axis), sign), _)| (axis.cross(&(tip.coords - joint.translation.vector)), *sign))
            .collect();
        Self { slopes, normal }
    }

    /// Where the tip goes along the glass when every joint turns alike, per way down; zero where no direction is known.
    pub fn alike(&self) -> Vector3<f64> {
        self.per_way_down(|_, sign| sign)
    }

    /// The same when joints turn the further the more they bring the tip down, and those that lift it rest: the least
    /// motion with these signs that lowers it.
    fn lowering(&self) -> Vector3<f64> {
        self.per_way_down(|slope, sign| sign * (-sign * self.normal.dot(&slope)).max(0.0))
    }

    /// Where the tip slides while it is pressed on, per meter that the joints are driven on toward the glass.
    ///
    /// Signs of motion are logged and speeds are not: joints go on half of the way as if all turned alike, and half as those
    /// turn that bring the tip down, which are the two ends of what is likely. The glass lets none of that in. Each joint
    /// holds its goal like a spring, all as stiff as each other, so that the force along the normal turns them by what it
    /// takes of Jₙᵀ, and the tip slides by that, too: J_t Jₙᵀ / (Jₙ Jₙᵀ).
    pub fn pressed(&self) -> Vector3<f64> {
        let (alike, lowering) = (self.alike(), self.lowering());
        // Without a direction nothing tells that anything went on.
        if alike == Vector3::zeros() { alike } else { 0.5 * (alike + lowering) + self.gives_way() }
    }

    fn gives_way(&self) -> Vector3<f64> {
        let lifts = |slope: &Vector3<f64>| self.normal.dot(slope);
        let square: f64 = self.slopes.iter().map(|(slope, _)| lifts(slope).powi(2)).sum();
        let turned: Vector3<f64> = self.slopes.iter().map(|(slope, _)| slope * lifts(slope)).sum();
        if square > 0.0 { self.along(turned / square) } else { Vector3::zeros() }
    }

    fn along(&self, vector: Vector3<f64>) -> Vector3<f64> {
        vector - self.normal * self.normal.dot(&vector)
    }

    /// Along the glass per way down, with these rates of the joints.
    fn per_way_down(&self, rate: impl Fn(Vector3<f64>, f64) -> f64) -> Vector3<f64> {
        let velocity: Vector3<f64> =
            self.slopes.iter().map(|(slope, sign)| slope * rate(*slope, *sign)).sum();
        let (down, along) = (self.normal.dot(&velocity), self.along(velocity));
        let Some(unit) = along.try_normalize(1e-6) else { return Vector3::zeros() };
        unit * (along.norm() / down.abs().max(1e-9)).min(FLATTEST)
    }
}
