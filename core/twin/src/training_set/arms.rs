//! Arms in postures that a robot at its table takes, and hands as they are labeled.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use plumbline_model::robot::{JointKind, LinkIndex, Posture, Rig};

use super::dice::Dice;
use super::room::put;
use crate::hand_look::{self, HandLook};
use crate::physics::parts::{self, Side};
use crate::scene::{Item, Material, Pattern, Shape};

/// Postures thrown for each arm to choose from.
const THROWN: usize = 12_000;
/// No part of an arm is nearer to the eyes than this, m.
const CLEAR_OF_EYES_M: f64 = 0.12;

/// What a hand is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Doing {
    /// Lies on the table.
    Resting,
    /// Is held up beside the head.
    Raised,
    /// Works above the table.
    Working,
    /// Anything else.
    Anything,
}

/// Postures of both arms, sorted by what the hand is doing.
pub(super) struct Bank {
    of_arms: Vec<[Vec<Vec<f64>>; 4]>,
}

impl Bank {
    /// Throws postures for a rig; always the same ones.
    pub fn new(rig: &Rig) -> Self {
        let mut dice = Dice::of_pair(0x70_6f_73_65, 0);
        let palms = hand_look::palms(rig);
        let sides = parts::sides(rig);
        let of_arms = (0..rig.arms.len())
            .map(|arm| {
                let mut sorted: [Vec<Vec<f64>>; 4] = Default::default();
                let Some(palm) = palms[arm] else { return sorted };
                for _ in 0..THROWN {
                    let angles: Vec<f64> = rig.arms[arm]
                        .joints
                        .iter()
                        .map(|joint| {
                            let limits = rig.limits(*joint);
                            dice.within(limits.lower_rad, limits.upper_rad)
                        })
                        .collect();
                    let posture = rig.home().with(&rig.arms[arm].joints, &angles);
                    if let Some(doing) = doing(rig, arm, palm, &sides, &posture) {
                        sorted[doing as usize].push(angles);
                    }
                }
                sorted
            })
            .collect();
        Self { of_arms }
    }

    /// A posture of an arm; `None` if none of that kind was found.
    pub fn pick(&self, arm: usize, doing: Doing, dice: &mut Dice) -> Option<Vec<f64>> {
        let known = &self.of_arms.get(arm)?[doing as usize];
        if known.is_empty() { None } else { Some(dice.pick(known).clone()) }
    }
}

/// What the hand does in a posture; `None` where the arm is in the table, in the robot or before the
/// eyes.
fn doing(rig: &Rig, arm: usize, palm: LinkIndex, sides: &[Side], posture: &Posture) -> Option<Doing> {
    let places = rig.description.forward(posture);
    let eye = rig.robot_from_left(posture).isometry.translation.vector;
    for (i, link) in rig.description.links().iter().enumerate() {
        let own = matches!(sides[i], Side::Arm(a) | Side::Hand(a) if a == arm);
        if !own {
            continue;
        }
        for visual in &link.visuals {
            let (place, shape) = parts::shape_of(visual);
            let Shape::Capsule { radius_m, half_length_m } = shape else { continue };
            for z in [-half_length_m, 0.0, half_length_m] {
                let at = places.of(LinkIndex(i)).isometry * place * Point3::new(0.0, 0.0, z);
                let over_table = at.x > rig.table.x_range_m[0] && at.x < rig.table.x_range_m[1] + 0.4;
                let inside = at.x.abs() < 0.06 && at.y.abs() < 0.06 && at.z < 0.22;
                let before_eyes = (at.coords - eye).norm() < CLEAR_OF_EYES_M;
                if over_table && at.z - radius_m < rig.table.height_m - 0.004 || inside || before_eyes {
                    return None;
                }
            }
        }
    }
    let at = (places.of(palm).isometry * Point3::new(0.0, 0.0, -0.034)).coords;
    let over_m = at.z - rig.table.height_m;
    let on_table = at.x > 0.12 && at.x < 0.6 && at.y.abs() < 0.5;
    Some(if on_table && over_m < 0.045 {
        Doing::Resting
    } else if on_table && over_m < 0.22 {
        Doing::Working
    } else if over_m > 0.22 && (at - eye).norm() < 0.40 && at.x > -0.02 {
        Doing::Raised
    } else {
        Doing::Anything
    })
}

/// Where a hand is.
pub(super) struct Hand {
    /// Middle of the palm, robot frame.
    pub palm_m: Vector3<f64>,
    /// Where a toy in the hand would be.
    pub grasp_m: Vector3<f64>,
}

/// Draws one arm, whose palm gets an object number, or (without an arm) torso and head.
pub(super) fn draw(
    rig: &Rig,
    posture: &Posture,
    only: Option<(usize, u16)>,
    dice: &mut Dice,
    items: &mut Vec<Item>,
) -> Option<Hand> {
    let places = rig.description.forward(posture);
    let sides = parts::sides(rig);
    let palms = hand_look::palms(rig);
    let look = some_look(dice);
    let sleeve = Material {
        albedo: dice.gray(0.003, 0.02),
        gloss: dice.within_f32(0.0, 0.04),
        pattern: Pattern::Plain,
    };
    let mut hand = None;
    for (i, link) in rig.description.links().iter().enumerate() {
        let index = LinkIndex(i);
        let robot_from_link = places.of(index).isometry;
        // The outer part of a finger bends more than its joint says.
        let bend = dice.within(0.0, 0.9);
        let blocks = arm_blocks(dice);
        let arm = match sides[i] {
            Side::Hand(arm) | Side::Arm(arm) => Some(arm),
            Side::Body => None,
        };
        if arm != only.map(|(arm, _)| arm) {
            continue;
        }
        let is_palm = palms.contains(&Some(index));
        let object = only.map_or(0, |(_, object)| if is_palm { object } else { 0 });
        let mut add = |robot_from_body: Isometry3<f64>, drawn: Vec<hand_look::Drawn>| {
            for (place, shape, material) in drawn {
                put(items, object, robot_from_body * place, shape, material);
            }
        };
        if let Some(finger) = parts::finger(rig, index) {
            let (near, far) = hand_look::finger(&finger, &look);
            add(robot_from_link, near);
            add(robot_from_link * outer(rig, index, &finger, bend), far);
            continue;
        }
        for visual in &link.visuals {
            let (place, shape) = parts::shape_of(visual);
            match (&shape, sides[i]) {
                (Shape::Box { half_m }, Side::Hand(arm)) if is_palm => {
                    add(robot_from_link, hand_look::palm(&place, half_m, &look));
                    let at = |x: f64| (robot_from_link * place * Point3::new(x, 0.0, 0.0)).coords;
                    let side = if rig.arms[arm].name == "left" { -1.0 } else { 1.0 };
                    hand = Some(Hand { palm_m: at(0.0), grasp_m: at(side * (half_m.x + 0.022)) });
                }
                (_, Side::Hand(_)) => add(robot_from_link, hand_look::thumb(&place, &shape, &look)),
                (_, Side::Arm(_)) => {
                    for (block, half_m) in &blocks {
                        let shape = Shape::Box { half_m: *half_m };
                        add(robot_from_link, vec![(place * block, shape, sleeve)]);
                    }
                    add(robot_from_link, vec![(place, shape, sleeve)]);
                }
                _ => add(robot_from_link, vec![(place, shape, parts::material_of(visual, sides[i]))]),
            }
        }
    }
    hand
}

fn some_look(dice: &mut Dice) -> HandLook {
    HandLook {
        black: dice.within_f32(0.003, 0.02),
        metal: dice.within_f32(0.03, 0.45),
        tip: dice.within_f32(0.02, 0.16),
        breadth: dice.within(0.62, 1.05),
        wire: dice.chance(0.4).then(|| dice.within(-0.9, 0.9)),
    }
}

/// Servos and covers on an arm.
fn arm_blocks(dice: &mut Dice) -> Vec<(Isometry3<f64>, Vector3<f64>)> {
    (0..dice.count(0, 3))
        .map(|_| {
            let at = dice.place([-0.018, -0.018, -0.05], [0.018, 0.018, 0.05]);
            let half = dice.place([0.008, 0.008, 0.012], [0.024, 0.024, 0.032]);
            (Isometry3::from_parts(at.into(), UnitQuaternion::identity()), half)
        })
        .collect()
}

/// Place of a finger's outer part on its link.
fn outer(rig: &Rig, link: LinkIndex, finger: &parts::Finger, bend_rad: f64) -> Isometry3<f64> {
    let axis = rig.description.joint_above(link).and_then(|joint| joint.motion().map(|(axis, _)| *axis));
    let turn = axis.map_or_else(UnitQuaternion::identity, |axis| {
        UnitQuaternion::from_axis_angle(&axis, finger.closing * bend_rad)
    });
    Isometry3::from_parts(Translation3::from(finger.pivot_m), turn)
}

/// Angles for the joints of a hand: open, half closed or a fist.
pub(super) fn grip(rig: &Rig, arm: usize, posture: &Posture, dice: &mut Dice) -> Posture {
    let closed = if dice.chance(0.6) { dice.within(0.0, 0.25) } else { dice.within(0.0, 0.9) };
    let angles: Vec<f64> = rig.arms[arm]
        .hand
        .iter()
        .map(|joint| {
            let limits = rig.limits(*joint);
            let share = (closed + dice.normal(0.12)).clamp(0.0, 1.0);
            let open_is_lower = limits.lower_rad.abs() < limits.upper_rad.abs();
            let share = if open_is_lower { share } else { 1.0 - share };
            limits.lower_rad + share * limits.span_rad()
        })
        .collect();
    debug_assert!(
        rig.arms[arm]
            .hand
            .iter()
            .all(|joint| matches!(rig.description.joint(*joint).kind, JointKind::Revolute { .. }))
    );
    posture.with(&rig.arms[arm].hand, &angles)
}
