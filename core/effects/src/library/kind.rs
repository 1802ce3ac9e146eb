//! Kinds of effects: names, words, parameters.

use serde::{Deserialize, Serialize};

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
    pub(super) fn is_of_joint(self) -> bool {
        self <= Self::AxisSkew
    }
}
