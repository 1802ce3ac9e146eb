//! What can be wrong with links, hand, finger and torso.

use super::{Act, Effect, Entry, Is, Shape, Site, TILT_AND_SHIFT, parameter, vector};

/// How far a usual bracket gives under load, rad/(N m). Only needed to see a wrong mass, which
/// shows through what gives way under it.
const USUAL_COMPLIANCE_RAD_PER_NM: f64 = 0.015;
/// How hard a finger presses on the glass when it is noticed, N.
const PRESSING_N: f64 = 1.0;

pub(super) static LINK_LENGTH: Entry = Entry {
    about: "wrong length",
    meaning: "The link is longer or shorter than in the model.",
    remedy: "Measure it with a caliper.",
    parameters: &[parameter("length_m", 0.005)],
    sliding: &[],
    site: Site::LinkOrEvery(&[parameter("length_m", 0.005); 12]),
    shape: Shape::None,
    shown: |rows| rows.arm,
    act: Act::Joint(|at, deviation| {
        let along = at.situation.arm.parts[at.joint].before.translation.vector.normalize();
        deviation.shift_m[at.joint] += along * at.value();
    }),
    reported: Effect::plain,
    is: &[Is::Planned, Is::Origin],
};

pub(super) static TIP_OFFSET: Entry = Entry {
    about: "fingertip elsewhere than in the model",
    meaning: "The fingertip lies elsewhere in the hand than in the model.",
    remedy: "Measure the fingertip with a caliper; check how the finger is mounted.",
    parameters: &[parameter("x_m", 0.0075), parameter("y_m", 0.0075), parameter("z_m", 0.0075)],
    sliding: &[],
    site: Site::Tip,
    shape: Shape::None,
    shown: |rows| rows.arm,
    act: Act::Arm(|_, _, values, deviation| deviation.tip_m += vector(values)),
    reported: Effect::plain,
    is: &[Is::Planned, Is::Origin],
};

pub(super) static FINGER_BEND: Entry = Entry {
    about: "finger bends at contact",
    meaning: "The finger bends when it presses.",
    remedy: "Press less, or stop at the first touch.",
    parameters: &[parameter("compliance_m_per_n", 0.0015)],
    sliding: &[],
    site: Site::Contact,
    shape: Shape::None,
    shown: |rows| rows.touches,
    act: Act::Arm(|_, situation, values, deviation| {
        // The glass presses along its normal; only what is across the finger bends it.
        let (normal, finger) = (situation.normal, situation.finger);
        deviation.contact_m += (normal - finger * finger.dot(&normal)) * (PRESSING_N * values[0]);
    }),
    reported: Effect::plain,
    is: &[Is::OneSided],
};

pub(super) static FINGER_ROLL: Entry = Entry {
    about: "contact wanders over the fingertip's pad",
    meaning: "The round pad touches with another point when the finger is inclined.",
    remedy: "Keep the finger's inclination, or use a pointed stylus.",
    parameters: &[parameter("radius_m", 0.004)],
    sliding: &[],
    site: Site::Contact,
    shape: Shape::None,
    shown: |rows| rows.touches,
    act: Act::Arm(|_, situation, values, deviation| deviation.contact_m += situation.roll * values[0]),
    reported: Effect::plain,
    is: &[Is::Planned, Is::OneSided],
};

pub(super) static TOUCH_DRAG: Entry = Entry {
    about: "finger drags after touching down",
    meaning: "The finger slides on after it has touched.",
    remedy: "Come straight from above, and slower.",
    parameters: &[parameter("drag_m", 0.0025)],
    sliding: &[],
    site: Site::Contact,
    // At one speed along the glass; at one speed down: then the way along it goes with how flat the finger comes in; or
    // pressed on for one time, so that the joints give way as well.
    shape: Shape::OneOf(&[
        "same way everywhere",
        "way that grows the flatter the finger comes in",
        "way that the joints yield while the finger presses",
    ]),
    shown: |rows| rows.touches && rows.direction,
    act: Act::Arm(|effect, situation, values, deviation| {
        let way = match effect.choice() {
            0 => situation.sweep,
            1 => situation.slope,
            _ => situation.pressed,
        };
        deviation.contact_m += way * values[0];
    }),
    reported: Effect::one_of,
    is: &[Is::Planned, Is::OneSided],
};

pub(super) static BASE_TILT: Entry = Entry {
    about: "torso tilted or shifted",
    meaning: "The torso stands tilted or shifted.",
    remedy: "Shim and fasten the torso's base.",
    parameters: TILT_AND_SHIFT,
    sliding: &[],
    site: Site::Base,
    shape: Shape::None,
    shown: |rows| rows.arm,
    act: Act::Arm(|_, _, values, deviation| {
        deviation.base_rad += vector(values);
        deviation.base_m += vector(&values[3..]);
    }),
    reported: Effect::plain,
    is: &[Is::Planned, Is::Origin],
};

pub(super) static TORSO_LEAN: Entry = Entry {
    about: "torso leans under the arm's weight",
    meaning: "The torso leans as the arm reaches out.",
    remedy: "Fasten the base; brace the torso.",
    parameters: &[parameter("lean_rad_per_nm", 0.005)],
    sliding: &[],
    site: Site::Base,
    shape: Shape::None,
    shown: |rows| rows.arm,
    act: Act::Arm(|_, situation, values, deviation| deviation.base_rad += situation.lean_nm * values[0]),
    reported: Effect::plain,
    is: &[Is::Planned, Is::OfLoad, Is::OneSided],
};

pub(super) static PAYLOAD_MASS: Entry = Entry {
    about: "hand heavier or lighter than in the model",
    meaning: "Hand or payload weighs more, or less, than the model says.",
    remedy: "Weigh the hand and put its mass into the description.",
    parameters: &[parameter("mass_kg", 0.2)],
    sliding: &[],
    site: Site::Palm,
    shape: Shape::None,
    shown: |rows| rows.arm,
    act: Act::Arm(|_, situation, values, deviation| {
        for (offset, torque) in deviation.joint_rad.iter_mut().zip(&situation.torques_per_kg_nm) {
            *offset += USUAL_COMPLIANCE_RAD_PER_NM * torque * values[0];
        }
    }),
    reported: Effect::plain,
    is: &[Is::Planned, Is::OfLoad],
};

pub(super) static LINK_MASS: Entry = Entry {
    about: "heavier or lighter than in the model",
    meaning: "The link weighs more, or less, than the model says.",
    remedy: "Weigh it, cables and screws included, and put its mass into the description.",
    parameters: &[parameter("mass_kg", 0.1)],
    sliding: &[],
    site: Site::Link,
    shape: Shape::None,
    // A touch feels a mass only through what gives way under it, and takes it for that; servos that give
    // way beside a known weight tell it.
    shown: |_| false,
    act: Act::Unseen,
    reported: Effect::plain,
    is: &[],
};

pub(super) static SPEED_OVERSHOOT: Entry = Entry {
    about: "fast moves overshoot",
    meaning: "Fast moves end elsewhere than slow ones.",
    remedy: "Approach slower, or wait before touching.",
    parameters: &[parameter("latency_s", 0.05)],
    sliding: &[],
    site: Site::WholeArm,
    shape: Shape::None,
    shown: |rows| rows.speeds,
    act: Act::Arm(|_, situation, values, deviation| {
        for (j, angle) in deviation.joint_rad.iter_mut().enumerate() {
            *angle += values[0] * situation.speed_rad_s(j);
        }
    }),
    reported: Effect::plain,
    is: &[],
};
