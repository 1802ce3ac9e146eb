//! The effects that touches can show: names, sites, usual sizes, and what each does to the arm.
//!
//! Sizes follow one rule: the standard deviation of a parameter is half of the upper end of the
//! range that is plausible for a robot of this kind, so that none is favored.

use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::session::Touchscreen;
use serde::{Deserialize, Serialize};

use crate::arm::{Arm, Deviation};

/// A tooth has two flanks: gravity has chosen one when it is clearly larger than this, N m.
const SEATING_TORQUE_NM: f64 = 0.02;
/// How far a usual bracket gives under load, rad/(N m). Only needed to see a wrong mass, which
/// shows through what gives way under it.
const USUAL_COMPLIANCE_RAD_PER_NM: f64 = 0.015;
/// Links shorter than this have no length that could be wrong, m.
const SHORTEST_LINK_M: f64 = 0.02;

/// What kind of effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Encoder zero or horn mounted off.
    JointZero,
    /// Wrong gear ratio.
    JointScale,
    /// Magnet or gear off center: once per turn.
    JointEccentricity,
    /// Play that follows the direction of motion.
    Backlash,
    /// Play that gravity closes on one side.
    GravityBacklash,
    /// The servo gives under load; the encoder sees it.
    ServoDroop,
    /// The bracket gives under load, about the axis; the encoder does not see it.
    JointSag,
    /// The joint gives under load, across the axis.
    SidewaysGive,
    /// The joint moves with the one before it (cable, tendon).
    JointCoupling,
    /// Axis not square.
    AxisSkew,
    /// Link longer or shorter.
    LinkLength,
    /// Fingertip elsewhere in the hand.
    TipOffset,
    /// Contact wanders over the fingertip's pad.
    FingerRoll,
    /// Finger drags after touching down.
    TouchDrag,
    /// Base tilted or shifted against the screen.
    BaseTilt,
    /// Torso leans under the arm's weight.
    TorsoLean,
    /// Hand or weight heavier than thought.
    PayloadMass,
    /// Wrong size of the image.
    ScreenScale,
    /// Screen tilted or shifted.
    ScreenTilt,
    /// Glass bowed.
    ScreenBow,
}

/// A parameter of an effect. Zero is no effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name with the unit.
    pub name: &'static str,
    /// Usual size: standard deviation over robots.
    pub typical: f64,
}

const fn parameter(name: &'static str, typical: f64) -> Parameter {
    Parameter { name, typical }
}

/// 1.5°, half of the 3° that a printed part or a table may be off.
const TILT: f64 = 0.026;
const TILT_AND_SHIFT: &[Parameter] = &[
    parameter("rot_x_rad", TILT),
    parameter("rot_y_rad", TILT),
    parameter("rot_z_rad", TILT),
    parameter("x_m", 0.01),
    parameter("y_m", 0.01),
    parameter("z_m", 0.01),
];

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 20] = [
        Self::JointZero,
        Self::JointScale,
        Self::JointEccentricity,
        Self::Backlash,
        Self::GravityBacklash,
        Self::ServoDroop,
        Self::JointSag,
        Self::SidewaysGive,
        Self::JointCoupling,
        Self::AxisSkew,
        Self::LinkLength,
        Self::TipOffset,
        Self::FingerRoll,
        Self::TouchDrag,
        Self::BaseTilt,
        Self::TorsoLean,
        Self::PayloadMass,
        Self::ScreenScale,
        Self::ScreenTilt,
        Self::ScreenBow,
    ];

    /// Its name on the command line and in files.
    pub fn id(self) -> &'static str {
        match self {
            Self::JointZero => "joint-zero",
            Self::JointScale => "joint-scale",
            Self::JointEccentricity => "joint-eccentricity",
            Self::Backlash => "backlash",
            Self::GravityBacklash => "gravity-backlash",
            Self::ServoDroop => "servo-droop",
            Self::JointSag => "joint-sag",
            Self::SidewaysGive => "sideways-give",
            Self::JointCoupling => "joint-coupling",
            Self::AxisSkew => "axis-skew",
            Self::LinkLength => "link-length",
            Self::TipOffset => "tip-offset",
            Self::FingerRoll => "finger-roll",
            Self::TouchDrag => "touch-drag",
            Self::BaseTilt => "base-tilt",
            Self::TorsoLean => "torso-lean",
            Self::PayloadMass => "payload-mass",
            Self::ScreenScale => "screen-scale",
            Self::ScreenTilt => "screen-tilt",
            Self::ScreenBow => "screen-bow",
        }
    }

    /// What it is, for people; its site comes after "of" or "at" where it has one.
    pub fn about(self) -> &'static str {
        match self {
            Self::JointZero => "zero position off",
            Self::JointScale => "wrong gear ratio",
            Self::JointEccentricity => "encoder or gear off center",
            Self::Backlash => "play that follows the direction of motion",
            Self::GravityBacklash => "play that gravity closes on one side",
            Self::ServoDroop => "servo gives way under load",
            Self::JointSag => "bracket gives way under load",
            Self::SidewaysGive => "joint gives way sideways",
            Self::JointCoupling => "pulled along by the joint before",
            Self::AxisSkew => "axis not square",
            Self::LinkLength => "wrong length",
            Self::TipOffset => "fingertip elsewhere than in the model",
            Self::FingerRoll => "contact wanders over the fingertip's pad",
            Self::TouchDrag => "finger drags after touching down",
            Self::BaseTilt => "torso tilted or shifted",
            Self::TorsoLean => "torso leans under the arm's weight",
            Self::PayloadMass => "hand heavier or lighter than in the model",
            Self::ScreenScale => "image larger or smaller than in the rig file",
            Self::ScreenTilt => "screen tilted or shifted",
            Self::ScreenBow => "glass bowed",
        }
    }

    /// Its parameters. They enter the prediction nearly linearly, so a compliance stands for a
    /// stiffness, and a sine and a cosine for amplitude and phase.
    pub fn parameters(self) -> &'static [Parameter] {
        const BACKLASH: &[Parameter] = &[parameter("width_rad", 0.007)];
        match self {
            Self::JointZero => const { &[parameter("offset_rad", 0.044)] },
            Self::JointScale => const { &[parameter("scale", 0.01)] },
            Self::JointEccentricity => {
                const { &[parameter("sine_rad", 0.0087), parameter("cosine_rad", 0.0087)] }
            }
            Self::Backlash | Self::GravityBacklash => BACKLASH,
            Self::ServoDroop => const { &[parameter("compliance_rad_per_nm", 0.033)] },
            Self::JointSag => const { &[parameter("compliance_rad_per_nm", 0.015)] },
            Self::SidewaysGive => const { &[parameter("compliance_rad_per_nm", 0.01)] },
            Self::JointCoupling => const { &[parameter("ratio", 0.025)] },
            Self::AxisSkew => const { &[parameter("rot_a_rad", TILT), parameter("rot_b_rad", TILT)] },
            Self::LinkLength => const { &[parameter("length_m", 0.005)] },
            Self::TipOffset => {
                const { &[parameter("x_m", 0.0075), parameter("y_m", 0.0075), parameter("z_m", 0.0075)] }
            }
            Self::FingerRoll => const { &[parameter("radius_m", 0.004)] },
            Self::TouchDrag => const { &[parameter("drag_m", 0.0025)] },
            Self::BaseTilt | Self::ScreenTilt => TILT_AND_SHIFT,
            Self::TorsoLean => const { &[parameter("lean_rad_per_nm", 0.005)] },
            Self::PayloadMass => const { &[parameter("mass_kg", 0.2)] },
            Self::ScreenScale => const { &[parameter("scale_u", 0.075), parameter("scale_v", 0.075)] },
            Self::ScreenBow => const { &[parameter("bow_u_per_m", 0.04), parameter("bow_v_per_m", 0.14)] },
        }
    }

    /// Whether it sits at a joint.
    fn is_of_joint(self) -> bool {
        self <= Self::AxisSkew
    }
}

/// An effect at its site.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Effect {
    /// What kind.
    pub kind: Kind,
    /// A joint, a link, `tip`, `base`, `screen`.
    pub site: String,
    /// What it is and where, for people.
    pub title: String,
    /// Place of the joint in the arm, for effects of a joint or link.
    joint: usize,
}

impl Effect {
    /// Every effect of the library at every site of an arm.
    pub fn all(arm: &Arm) -> Vec<Self> {
        let mut effects = vec![];
        for kind in Kind::ALL {
            if kind.is_of_joint() {
                // The first joint has none before it.
                let first = usize::from(kind == Kind::JointCoupling);
                effects.extend((first..arm.len()).map(|joint| {
                    let part = &arm.parts[joint];
                    Self::new(kind, &part.joint, &part.title, joint)
                }));
                continue;
            }
            match kind {
                Kind::LinkLength => effects.extend(links(arm)),
                Kind::TipOffset | Kind::FingerRoll | Kind::TouchDrag => {
                    effects.push(Self::new(kind, "tip", "", 0));
                }
                Kind::PayloadMass => {
                    let palm = arm.parts.last().map_or("tip", |part| part.link.as_str());
                    effects.push(Self::new(kind, palm, "", 0));
                }
                Kind::BaseTilt | Kind::TorsoLean => effects.push(Self::new(kind, "base", "", 0)),
                _ => effects.push(Self::new(kind, "screen", "", 0)),
            }
        }
        effects
    }

    fn new(kind: Kind, site: &str, whose: &str, joint: usize) -> Self {
        let title =
            if whose.is_empty() { kind.about().to_owned() } else { format!("{whose}: {}", kind.about()) };
        Self { kind, site: site.to_owned(), title, joint }
    }

    /// Its name on the command line and in files.
    pub fn id(&self) -> &'static str {
        self.kind.id()
    }

    /// Its parameters.
    pub fn parameters(&self) -> &'static [Parameter] {
        self.kind.parameters()
    }

    /// What it does to the arm in a situation, added to `deviation`; one value per parameter.
    pub fn deviate(&self, situation: &Situation<'_>, values: &[f64], deviation: &mut Deviation) {
        let (j, value) = (self.joint, values[0]);
        let angle = situation.angles_rad.get(j).copied().unwrap_or_default();
        let torque = situation.torques_nm.get(j).copied().unwrap_or_default();
        match self.kind {
            Kind::JointZero => deviation.joint_rad[j] += value,
            Kind::JointScale => deviation.joint_rad[j] += value * angle,
            Kind::JointEccentricity => {
                deviation.joint_rad[j] += value * angle.sin() + values[1] * angle.cos()
            }
            Kind::Backlash => deviation.joint_rad[j] += 0.5 * value * situation.direction[j],
            Kind::GravityBacklash => {
                deviation.joint_rad[j] += 0.5 * value * (torque / SEATING_TORQUE_NM).tanh();
            }
            Kind::ServoDroop | Kind::JointSag => deviation.joint_rad[j] += value * torque,
            Kind::SidewaysGive => deviation.skew_rad[j] += situation.sideways_nm[j] * value,
            Kind::JointCoupling => deviation.joint_rad[j] += value * situation.angles_rad[j - 1],
            Kind::AxisSkew => {
                let (a, b) = across(&situation.arm.parts[j].axis);
                deviation.skew_rad[j] += a * value + b * values[1];
            }
            Kind::LinkLength => {
                deviation.shift_m[j] += situation.arm.parts[j].before.translation.vector.normalize() * value;
            }
            Kind::TipOffset => deviation.tip_m += Vector3::new(value, values[1], values[2]),
            Kind::FingerRoll => deviation.contact_m += situation.roll * value,
            Kind::TouchDrag => deviation.contact_m += situation.sweep * value,
            Kind::BaseTilt => {
                deviation.base_rad += Vector3::new(value, values[1], values[2]);
                deviation.base_m += Vector3::new(values[3], values[4], values[5]);
            }
            Kind::TorsoLean => deviation.base_rad += situation.lean_nm * value,
            Kind::PayloadMass => {
                for (offset, torque) in deviation.joint_rad.iter_mut().zip(&situation.torques_per_kg_nm) {
                    *offset += USUAL_COMPLIANCE_RAD_PER_NM * torque * value;
                }
            }
            Kind::ScreenScale => {
                deviation.screen_scale[0] += value;
                deviation.screen_scale[1] += values[1];
            }
            // A screen that moves is an arm that moves the other way.
            Kind::ScreenTilt => {
                deviation.base_rad -= Vector3::new(value, values[1], values[2]);
                deviation.base_m -= Vector3::new(values[3], values[4], values[5]);
            }
            Kind::ScreenBow => {
                deviation.screen_bow_per_m[0] += value;
                deviation.screen_bow_per_m[1] += values[1];
            }
        }
    }
}

/// Lengths between the joints of an arm; the way to the tip belongs to the tip's offset.
fn links(arm: &Arm) -> impl Iterator<Item = Effect> {
    (1..arm.len()).filter(|&j| arm.parts[j].before.translation.vector.norm() > SHORTEST_LINK_M).map(|j| {
        let link = &arm.parts[j - 1].link;
        Effect::new(Kind::LinkLength, link, &link.replace('_', " "), j)
    })
}

/// Two directions at right angles to an axis and to each other.
fn across(axis: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let start = Vector3::ith(axis.iamin(), 1.0);
    let a = axis.cross(&start).normalize();
    (a, axis.cross(&a))
}

/// All that effects depend on, in one pose of the arm on the screen.
#[derive(Clone, Debug)]
pub struct Situation<'a> {
    arm: &'a Arm,
    angles_rad: &'a [f64],
    direction: &'a [f64],
    /// Gravity about each axis.
    torques_nm: Vec<f64>,
    /// The same for one kilogram at the palm.
    torques_per_kg_nm: Vec<f64>,
    /// Gravity across each axis, own frame.
    sideways_nm: Vec<Vector3<f64>>,
    /// Gravity about the base, level part, robot frame.
    lean_nm: Vector3<f64>,
    /// Shift of the contact per meter of pad radius, robot frame.
    roll: Vector3<f64>,
    /// Direction of the last motion along the glass, robot frame; zero if unknown.
    sweep: Vector3<f64>,
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
            moments.iter().zip(&frames.axes).map(|(moment, axis)| moment.dot(axis)).collect()
        };
        let (torques_nm, torques_heavier) = (along(&moments), along(&heavier));
        let sideways_nm = (0..arm.len())
            .map(|j| {
                let across = moments[j] - frames.axes[j] * torques_nm[j];
                frames.robot_from_joint[j].rotation.inverse() * across
            })
            .collect();
        let tip = Point3::from(frames.robot_from_tip.translation.vector);
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
            sweep: sweep(&frames.robot_from_joint, &frames.axes, direction, tip, normal),
        }
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

fn sweep(
    joints: &[Isometry3<f64>],
    axes: &[Vector3<f64>],
    direction: &[f64],
    tip: Point3<f64>,
    normal: &Vector3<f64>,
) -> Vector3<f64> {
    let velocity: Vector3<f64> = joints
        .iter()
        .zip(axes)
        .zip(direction)
        .map(|((joint, axis), sign)| axis.cross(&(tip.coords - joint.translation.vector)) * *sign)
        .sum();
    let along = velocity - normal * normal.dot(&velocity);
    along.try_normalize(1e-6).unwrap_or_default()
}

/// The screen as predictions need it.
#[derive(Clone, Debug)]
pub struct Surface {
    middle_m: Point3<f64>,
    u: Vector3<f64>,
    v: Vector3<f64>,
    normal: Vector3<f64>,
}

impl Surface {
    /// Of a touchscreen.
    pub fn of(screen: &Touchscreen) -> Self {
        Self {
            middle_m: screen.point_at(screen.middle()).coords,
            u: screen.u_axis.vector(),
            v: screen.v_axis.vector(),
            normal: screen.normal().vector(),
        }
    }

    /// Direction out of the glass.
    pub fn normal(&self) -> &Vector3<f64> {
        &self.normal
    }

    /// Where a touch is seen along u and v from the middle of the image, and how high the model
    /// puts the fingertip over a glass that lies on a block of `raised_m`; m.
    pub fn touch_m(&self, tip: Point3<f64>, raised_m: f64, deviation: &Deviation) -> Vector3<f64> {
        let offset = tip - self.middle_m;
        let (u_m, v_m) = (offset.dot(&self.u), offset.dot(&self.v));
        let [scale_u, scale_v] = deviation.screen_scale;
        let [bow_u, bow_v] = deviation.screen_bow_per_m;
        let glass_m = raised_m + bow_u * u_m * u_m + bow_v * v_m * v_m;
        Vector3::new(u_m / (1.0 + scale_u), v_m / (1.0 + scale_v), offset.dot(&self.normal) - glass_m)
    }

    /// How that changes when the screen is moved rigidly: shift along and turn about u, v and the
    /// normal, one column each (m/m, m/rad).
    pub fn gauge(&self, tip: Point3<f64>) -> nalgebra::Matrix3x6<f64> {
        let axes = [self.u, self.v, self.normal];
        let lever = tip - self.middle_m;
        nalgebra::Matrix3x6::from_fn(|row, column| match column {
            0..3 => axes[column].dot(&axes[row]),
            _ => axes[column - 3].cross(&lever).dot(&axes[row]),
        })
    }
}
