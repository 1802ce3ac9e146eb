//! What can be wrong with a joint: zeros, gears, play, axes, cables.

use super::{Act, Effect, Entry, Is, Known, Shape, Site, TILT, Turning, parameter};

/// A tooth has two flanks: gravity has chosen one when it is clearly larger than this, N m.
const SEATING_TORQUE_NM: f64 = 0.02;
/// The same of gears that rub.
const RUBBING_TORQUE_NM: f64 = 0.1;
/// Masses are off by about a seventh, each by itself: as if so much of what a joint bears were at the hand, or were
/// missing there.
const SHARE_AT_HAND: f64 = 0.1;

pub(super) static JOINT_ZERO: Entry = Entry {
    about: "zero position off",
    meaning: "The joint stands elsewhere than its encoder says, by the same angle everywhere.",
    remedy: "Remount the horn, or set the encoder's zero against a jig.",
    parameters: &[parameter("offset_rad", 0.044)],
    sliding: &[parameter("offset_m", 0.01)],
    site: Site::JointOrEvery(&[parameter("offset_rad", 0.044); 12]),
    shape: Shape::None,
    shown: |rows| rows.arm,
    act: Act::Turn(|at| at.value()),
    reported: Effect::plain,
    is: &[Is::Planned, Is::Origin, Is::OfSlides],
};

pub(super) static JOINT_SCALE: Entry = Entry {
    about: "wrong gear ratio",
    meaning: "The joint turns further, or less far, than commanded, in proportion to its angle.",
    remedy: "Check the gear ratio and the ticks per turn in the servo's settings.",
    parameters: &[parameter("scale", 0.01)],
    sliding: &[],
    site: Site::Joint,
    shape: Shape::None,
    shown: |rows| rows.arm,
    act: Act::Turn(|at| at.value() * at.angle_rad()),
    reported: Effect::plain,
    is: &[Is::Planned, Is::OfSlides],
};

pub(super) static JOINT_ECCENTRICITY: Entry = Entry {
    about: "encoder or gear off center",
    meaning: "The reading swings once or twice per turn: magnet or gear sits off the axis.",
    remedy: "Recenter the encoder's magnet, or swap the servo.",
    parameters: &[parameter("sine_rad", 0.0087), parameter("cosine_rad", 0.0087)],
    sliding: &[],
    site: Site::Joint,
    shape: Shape::OnceOrTwice,
    shown: |rows| rows.arm,
    act: Act::Turn(wave),
    reported: Effect::wave,
    is: &[Is::Planned],
};

pub(super) static TOOTH_RIPPLE: Entry = Entry {
    about: "gear teeth ripple",
    meaning: "The reading ripples with every tooth of a gear.",
    remedy: "Look for a chipped or dry gear; grease or swap it.",
    parameters: &[parameter("sine_rad", 0.00175), parameter("cosine_rad", 0.00175)],
    sliding: &[],
    site: Site::Joint,
    shape: Shape::Teeth,
    shown: |rows| rows.arm,
    act: Act::Turn(wave),
    reported: Effect::wave,
    is: &[Is::SeenBehindGear],
};

pub(super) static BACKLASH: Entry = Entry {
    about: "play that follows the direction of motion",
    meaning: "The joint stops on one side or the other of its play, as it last moved.",
    remedy: "Approach always from one side; tighten or swap worn gears.",
    parameters: &[parameter("width_rad", 0.007)],
    sliding: &[parameter("width_m", 0.002)],
    site: Site::Joint,
    shape: Shape::None,
    shown: |rows| rows.directions,
    act: Act::Turn(|at| 0.5 * at.value() * at.direction()),
    reported: Effect::size,
    is: &[Is::Planned, Is::SeenBehindGear, Is::OfSlides],
};

pub(super) static GRAVITY_BACKLASH: Entry = Entry {
    about: "play that gravity closes on one side",
    meaning: "The load pushes the gears to one flank; where the load turns over, the joint drops through its play.",
    remedy: "Keep to postures that load the joint one way, or add a light spring.",
    parameters: &[parameter("width_rad", 0.007)],
    sliding: &[],
    site: Site::Joint,
    // Masses are never quite those of the description, so the load turns over in other postures than it says; and gears
    // that rub stay between their flanks until the load is larger than what rubs.
    shape: Shape::OneOf(&[
        "load as described",
        "heavier toward the hand",
        "lighter toward the hand",
        "gears that rub",
    ]),
    shown: |rows| rows.arm,
    act: Act::Turn(|at| {
        let (heavier, seating_nm) = [
            (0.0, SEATING_TORQUE_NM),
            (SHARE_AT_HAND, SEATING_TORQUE_NM),
            (-SHARE_AT_HAND, SEATING_TORQUE_NM),
            (0.0, RUBBING_TORQUE_NM),
        ][at.effect.choice().min(3)];
        let load_nm = at.torque_nm() + heavier * at.torque_of_weight_at_hand_nm();
        0.5 * at.value() * (load_nm / seating_nm).tanh()
    }),
    reported: Effect::size,
    is: &[Is::Planned, Is::OneSided, Is::SeenBehindGear],
};

pub(super) static STICTION: Entry = Entry {
    about: "friction stops it short of its goal",
    meaning: "Friction stops the joint short of its goal, on the side it came from.",
    remedy: "Raise the integral gain a little, or approach from one side.",
    parameters: &[parameter("width_rad", 0.005)],
    sliding: &[],
    site: Site::Joint,
    shape: Shape::None,
    shown: |rows| rows.directions && rows.commanded,
    act: Act::Turn(|at| -0.5 * at.value() * at.direction()),
    reported: Effect::size,
    is: &[Is::SeenByEncoder, Is::OneSided],
};

pub(super) static EARLY_LOG: Entry = Entry {
    about: "angle was logged before it had arrived",
    meaning: "Angles were logged before the arm had come to rest.",
    remedy: "Wait longer before logging, or lower the tolerance of arrival.",
    parameters: &[parameter("fraction", 0.5)],
    sliding: &[],
    site: Site::JointOrAllAlike,
    // A servo that gives way under its load stays behind its command where it has arrived, too.
    shape: Shape::OneOf(&["whole lag", "lag beyond what gives way under load"]),
    shown: |rows| rows.lag,
    act: Act::Turn(|at| at.value() * if at.effect.choice() == 0 { at.lag_rad() } else { at.way_left_rad() }),
    reported: Effect::one_of,
    is: &[],
};

pub(super) static SERVO_WARM_UP: Entry = Entry {
    about: "zero position wanders while the servo warms up",
    meaning: "The joint's zero wanders while the servo warms up.",
    remedy: "Let the servos warm up before measuring, or calibrate warm.",
    parameters: &[parameter("amplitude_rad", 0.0044)],
    sliding: &[],
    site: Site::Joint,
    shape: Shape::TimeConstant(Known::arm_span_s),
    shown: Known::arm_lasts,
    act: Act::Turn(|at| at.value() * at.effect.grown(at.t_secs())),
    reported: Effect::plain,
    is: &[],
};

pub(super) static SLIPPED_HORN: Entry = Entry {
    about: "horn slipped at a moment",
    meaning: "From one moment on the joint stands elsewhere: something slipped.",
    remedy: "Tighten the horn's screw, then measure its zero again.",
    parameters: &[parameter("step_rad", 0.087)],
    sliding: &[],
    site: Site::Joint,
    shape: Shape::Moment,
    shown: Known::has_moments,
    act: Act::Turn(|at| at.value() * at.effect.stepped(at.t_secs())),
    reported: Effect::plain,
    is: &[Is::SeenBehindGear],
};

pub(super) static JOINT_COUPLING: Entry = Entry {
    about: "pulled along by another joint",
    meaning: "The joint moves along with another one: a cable or tendon pulls.",
    remedy: "Give the cable more slack, or route it through the axis.",
    parameters: &[parameter("ratio", 0.025)],
    sliding: &[],
    site: Site::JointBesideAnother,
    shape: Shape::AnotherJoint,
    shown: |rows| rows.arm,
    act: Act::Turn(|at| at.value() * at.angle_of_puller_rad()),
    reported: Effect::coupled,
    is: &[Is::Planned, Is::SeenBehindGear],
};

pub(super) static AXIS_SKEW: Entry = Entry {
    about: "axis not square",
    meaning: "The axis is not at the angle that the model gives it.",
    remedy: "Check how the part is seated.",
    parameters: &[parameter("rot_a_rad", TILT), parameter("rot_b_rad", TILT)],
    sliding: &[],
    site: Site::JointOrEvery(&[parameter("rot_rad", TILT); 24]),
    shape: Shape::None,
    shown: |rows| rows.arm,
    act: Act::Joint(|at, deviation| {
        let [a, b] = at.effect.across.unwrap_or_default();
        deviation.skew_rad[at.joint] += a * at.value() + b * at.values[1];
    }),
    reported: Effect::skew,
    is: &[Is::Planned, Is::Origin, Is::OfSlides],
};

/// A sine and a cosine of the angle, `shape` times per turn.
fn wave(at: &Turning<'_>) -> f64 {
    let (sine, cosine) = (at.effect.shape.unwrap_or(1.0) * at.angle_rad()).sin_cos();
    at.values[0] * sine + at.values[1] * cosine
}
