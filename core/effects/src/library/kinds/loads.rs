//! What gives way under load.

use nalgebra::Vector3;

use super::{Act, Effect, Entry, Is, Known, Shape, Site, Turning, parameter};
use crate::arm::Deviation;

pub(super) static SERVO_DROOP: Entry = Entry {
    about: "servo gives way under load",
    meaning: "The servo holds its goal like a spring and gives way under load; its encoder sees it.",
    remedy: "Raise the position gain, or command the angle with the droop added.",
    parameters: &[parameter("compliance_rad_per_nm", 0.033)],
    sliding: &[],
    site: Site::JointOrAllAlike,
    shape: Shape::None,
    shown: |rows| rows.arm && rows.commanded,
    act: Act::Turn(|at| at.value() * at.torque_nm()),
    reported: Effect::stiffness,
    is: &[Is::Planned, Is::SeenByEncoder, Is::OfLoad, Is::OneSided],
};

pub(super) static JOINT_SAG: Entry = Entry {
    about: "bracket gives way under load",
    meaning: "The bracket behind the encoder bends under load; the encoder does not see it.",
    remedy: "Stiffen the bracket, tighten its screws, lighten the hand.",
    parameters: &[parameter("compliance_rad_per_nm", 0.015)],
    sliding: &[],
    site: Site::JointOrAllAlike,
    shape: Shape::None,
    shown: |rows| rows.arm,
    act: Act::Turn(|at| at.value() * at.torque_nm()),
    reported: Effect::plain,
    is: &[Is::Planned, Is::OfLoad, Is::OneSided],
};

pub(super) static SIDEWAYS_GIVE: Entry = Entry {
    about: "joint gives way sideways",
    meaning: "The joint gives way across its axis under load.",
    remedy: "Check the bearing and its preload; add a second bearing.",
    parameters: &[parameter("compliance_rad_per_nm", 0.01)],
    sliding: &[],
    site: Site::Joint,
    shape: Shape::None,
    shown: |rows| rows.arm,
    act: Act::Joint(|at, deviation| {
        deviation.skew_rad[at.joint] += at.situation.sideways_nm[at.joint] * at.value();
    }),
    reported: Effect::plain,
    is: &[Is::Planned, Is::OfLoad, Is::OneSided, Is::OfSlides],
};

pub(super) static LINK_BENDING: Entry = Entry {
    about: "bends under load",
    meaning: "The link bends under the load.",
    remedy: "Stiffen the link, lighten the hand.",
    parameters: &[parameter("compliance_m_per_n", 0.0002)],
    sliding: &[],
    site: Site::Link,
    shape: Shape::None,
    shown: |rows| rows.arm,
    act: Act::Joint(bend),
    reported: Effect::plain,
    is: &[Is::OfLoad, Is::OneSided],
};

pub(super) static CREEP: Entry = Entry {
    about: "gives way more the longer it holds",
    meaning: "The arm sinks slowly while it holds a pose.",
    remedy: "Measure soon after arriving; look for soft plastic parts under load.",
    parameters: &[parameter("compliance_rad_per_nm", 0.01)],
    sliding: &[],
    site: Site::Joint,
    shape: Shape::TimeConstant(|rows| rows.longest_hold_s),
    shown: Known::is_held,
    act: Act::Turn(|at| at.value() * at.torque_nm() * at.effect.grown(at.held_s())),
    reported: Effect::plain,
    is: &[Is::OfLoad, Is::OneSided],
};

pub(super) static TORQUE_LIMIT: Entry = Entry {
    about: "servo cannot hold more than its torque limit",
    meaning: "The servo runs into its torque limit in stretched poses.",
    remedy: "Raise the torque limit, cool the servo, avoid stretched poses.",
    parameters: &[parameter("give_rad_per_nm", 0.1)],
    sliding: &[],
    site: Site::Joint,
    shape: Shape::Limit,
    shown: |rows| rows.arm && rows.commanded,
    act: Act::Turn(|at| {
        let (torque_nm, limit_nm) = (at.torque_nm(), at.effect.shape.unwrap_or(f64::INFINITY));
        at.value() * torque_nm.signum() * (torque_nm.abs() - limit_nm).max(0.0)
    }),
    reported: Effect::limit,
    is: &[Is::SeenByEncoder, Is::OfLoad, Is::OneSided],
};

/// The link between joints `j − 1` and `j` as a beam that is held at the former: a force F at its
/// end shifts the end by c F with c = L³/3EI, and turns it by 3c/2L of it; a moment M turns it by
/// 3c/L² M and shifts it by 3c/2L of it.
fn bend(at: &Turning<'_>, deviation: &mut Deviation) {
    let (situation, j) = (at.situation, at.joint);
    let joints = &situation.frames.robot_from_joint;
    let before = &situation.arm.parts[j].before;
    let length_m = before.translation.vector.norm();
    let along = joints[j - 1].rotation * (before.translation.vector / length_m);
    let across = |v: &Vector3<f64>| v - along * along.dot(v);
    let (force, moment) = (across(&situation.weights_n[j]), across(&situation.moments_nm[j]));
    let c = at.value();
    let slope = 1.5 * c / length_m;
    let shift = force * c + moment.cross(&along) * slope;
    let turn = along.cross(&force) * slope + moment * (2.0 * slope / length_m);
    let robot_from_before = joints[j - 1].rotation;
    deviation.shift_m[j] += robot_from_before.inverse() * shift;
    deviation.skew_rad[j] += (robot_from_before * before.rotation).inverse() * turn;
}
