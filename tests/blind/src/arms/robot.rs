//! A robot drawn by chance, and its description as URDF.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write as _;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use rand::Rng;
use rand::rngs::StdRng;

/// Name of the frame that is measured.
pub const TIP: &str = "marker";
/// Joints turn so far to either side, rad.
pub const RANGE_RAD: f64 = 2.6;
/// What slides goes so far where what turns goes a radian, m.
const SLIDE_M: f64 = 0.15;
/// One arm in so many has a joint that slides.
const SLIDING: f64 = 0.2;
/// Axes that are parallel stand at least so far apart, m: else they would be one.
const LEAST_APART_M: f64 = 0.06;

/// A joint with the link that it carries.
#[derive(Clone, Debug)]
pub struct Part {
    /// Place of the joint in the link before: shift (m), then roll, pitch and yaw (rad).
    pub shift_m: Vector3<f64>,
    /// Roll, pitch and yaw, rad.
    pub turn_rad: [f64; 3],
    /// Axis, own frame.
    pub axis: Vector3<f64>,
    /// Center of mass of the link, own frame, m.
    pub center_m: Vector3<f64>,
    /// Its mass, kg.
    pub mass_kg: f64,
    /// The joint slides along its axis: what is an angle of others is a length, m.
    pub slides: bool,
}

impl Part {
    /// The joint in the link before, at angle zero.
    pub fn place(&self) -> Isometry3<f64> {
        placed(&self.shift_m, &self.turn_rad)
    }

    /// What the joint does when it stands here (rad, or m of what slides).
    pub fn moved(&self, to: f64) -> Isometry3<f64> {
        if self.slides {
            Isometry3::from_parts(Translation3::from(self.axis * to), UnitQuaternion::identity())
        } else {
            Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_scaled_axis(self.axis * to))
        }
    }

    /// How far it goes where a joint that turns goes a radian: rad, or m of what slides.
    pub fn stroke(&self) -> f64 {
        if self.slides { SLIDE_M } else { 1.0 }
    }
}

/// A robot.
#[derive(Clone, Debug)]
pub struct Robot {
    /// Joints from the base on.
    pub parts: Vec<Part>,
    /// The marker in the last link: shift, then roll, pitch and yaw.
    pub marker: (Vector3<f64>, [f64; 3]),
}

fn placed(shift_m: &Vector3<f64>, [roll, pitch, yaw]: &[f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(
        Translation3::from(*shift_m),
        UnitQuaternion::from_euler_angles(*roll, *pitch, *yaw),
    )
}

impl Robot {
    /// Drawn by chance.
    pub fn drawn(random: &mut StdRng) -> Self {
        let joints = random.random_range(4..=7);
        let size = random.random_range(0.6..1.4);
        let mut parts: Vec<Part> = vec![];
        while parts.len() < joints {
            let part = part(parts.len(), joints, size, random);
            if parts.last().is_none_or(|before| differ(before, &part)) {
                parts.push(part);
            }
        }
        // By chance of its own, so that arms without are as they would be if none had any. Wrists turn.
        let mut other = random.clone();
        if other.random_bool(SLIDING) {
            parts[other.random_range(0..joints - 2)].slides = true;
        }
        let mut within = |low: f64, high: f64| random.random_range(low..high);
        let shift_m = Vector3::new(within(0.04, 0.1), within(-0.04, 0.04), within(0.03, 0.12));
        Self { parts, marker: (shift_m, [within(-PI, PI), within(-1.2, 1.2), within(-PI, PI)]) }
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.parts.len()
    }

    /// Names of the joints.
    pub fn joints(&self) -> Vec<String> {
        (1..=self.len()).map(|number| format!("joint_{number}")).collect()
    }

    /// Names of those that slide.
    pub fn slides(&self) -> Vec<String> {
        let all = self.joints().into_iter().zip(&self.parts);
        all.filter(|(_, part)| part.slides).map(|(joint, _)| joint).collect()
    }

    /// Names of the links that they carry.
    pub fn links(&self) -> Vec<String> {
        (1..=self.len()).map(|number| format!("link_{number}")).collect()
    }

    /// The marker in the last link.
    pub fn last_from_marker(&self) -> Isometry3<f64> {
        placed(&self.marker.0, &self.marker.1)
    }

    /// Its description.
    pub fn urdf(&self) -> String {
        let mut text = "<robot name=\"drawn\">\n<link name=\"base\"/>\n".to_owned();
        let three = |v: &[f64]| v.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
        let mut parent = "base".to_owned();
        for (part, (joint, link)) in self.parts.iter().zip(self.joints().iter().zip(self.links())) {
            let _ = writeln!(
                text,
                r#"<link name="{link}"><inertial><origin xyz="{}"/><mass value="{}"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="{joint}" type="{}"><parent link="{parent}"/><child link="{link}"/><origin xyz="{}" rpy="{}"/><axis xyz="{}"/><limit lower="-{}" upper="{}" effort="100" velocity="2"/></joint>"#,
                three(part.center_m.as_slice()),
                part.mass_kg,
                if part.slides { "prismatic" } else { "revolute" },
                three(part.shift_m.as_slice()),
                three(&part.turn_rad),
                three(part.axis.as_slice()),
                RANGE_RAD * part.stroke(),
                RANGE_RAD * part.stroke(),
            );
            parent = link;
        }
        let (shift_m, turn_rad) = &self.marker;
        let _ = writeln!(
            text,
            r#"<link name="{TIP}"/>
<joint name="{TIP}_mount" type="fixed"><parent link="{parent}"/><child link="{TIP}"/><origin xyz="{}" rpy="{}"/></joint>
</robot>"#,
            three(shift_m.as_slice()),
            three(turn_rad)
        );
        text
    }
}

fn part(j: usize, joints: usize, size: f64, random: &mut StdRng) -> Part {
    let axis = Vector3::ith(random.random_range(0..3), if random.random_bool(0.7) { 1.0 } else { -1.0 });
    // The usual quarter turns; one part in five is twisted by any angle.
    let turn_rad = std::array::from_fn(|k| {
        let quarter = FRAC_PI_2 * f64::from(random.random_range(-1..=1));
        let any = random.random_range(-0.7..0.7);
        match random.random_bool(0.2) {
            true => any,
            // A pitch of a quarter turn has no roll of its own.
            false if k == 1 => 0.0,
            false => quarter,
        }
    });
    // Wrists are short.
    let reach_m =
        size * if j + 2 < joints { random.random_range(0.1..0.4) } else { random.random_range(0.05..0.15) };
    let mut shift_m = Vector3::ith(random.random_range(0..3), reach_m);
    shift_m +=
        Vector3::from_fn(|_, _| if random.random_bool(0.3) { random.random_range(-0.06..0.06) } else { 0.0 });
    let mass_kg = size * random.random_range(0.5..2.0) * if j + 2 < joints { 1.0 } else { 0.4 };
    let center_m = Vector3::from_fn(|_, _| random.random_range(-0.05..0.12) * size);
    Part { shift_m, turn_rad, axis, center_m, mass_kg, slides: false }
}

/// Whether two joints that follow each other are no single one.
fn differ(before: &Part, part: &Part) -> bool {
    let axis = part.place().rotation * part.axis;
    let along = before.axis.dot(&axis).abs();
    let apart_m = before.axis.cross(&part.shift_m).norm();
    along < 0.9 || apart_m > LEAST_APART_M
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn one_arm_in_five_has_a_joint_that_slides_and_its_description_says_so() {
        let robots: Vec<Robot> =
            (0..100).map(|seed| Robot::drawn(&mut StdRng::seed_from_u64(seed))).collect();
        let sliding: Vec<&Robot> = robots.iter().filter(|robot| !robot.slides().is_empty()).collect();
        assert!((10..=30).contains(&sliding.len()), "{}", sliding.len());
        for robot in sliding {
            assert_eq!(robot.slides().len(), 1);
            assert_eq!(robot.urdf().matches("prismatic").count(), 1);
            let part = robot.parts.iter().find(|part| part.slides).expect("one");
            let moved = part.moved(0.1);
            assert!((moved.translation.vector - part.axis * 0.1).norm() < 1e-12);
            assert!(moved.rotation.angle() < 1e-12);
        }
    }
}
