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
    /// Magnet or gear off center: once or twice per turn.
    JointEccentricity,
    /// Teeth of a gear: many times per turn.
    ToothRipple,
    /// Play that follows the direction of motion.
    Backlash,
    /// Play that gravity closes on one side.
    GravityBacklash,
    /// Friction stops the servo short of its goal; the encoder sees it.
    Stiction,
    /// The servo gives under load; the encoder sees it.
    ServoDroop,
    /// The bracket gives under load, about the axis; the encoder does not see it.
    JointSag,
    /// The joint gives under load, across the axis.
    SidewaysGive,
    /// A printed link bends under load.
    LinkBending,
    /// A joint gives more the longer it holds.
    Creep,
    /// The encoder was read before the joint had arrived.
    EarlyLog,
    /// The servo cannot hold more than a certain torque; the encoder sees it.
    TorqueLimit,
    /// The zero wanders while the servo warms up.
    ServoWarmUp,
    /// The horn slipped at a moment.
    SlippedHorn,
    /// The joint moves with the one before it (cable, tendon).
    JointCoupling,
    /// Axis not square.
    AxisSkew,
    /// Link longer or shorter.
    LinkLength,
    /// Fingertip elsewhere in the hand.
    TipOffset,
    /// The finger bends at contact.
    FingerBend,
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
    /// Screen pushed at a moment.
    ScreenBumped,
    /// Wrong size of the image.
    ScreenScale,
    /// Screen tilted or shifted.
    ScreenTilt,
    /// Glass bowed.
    ScreenBow,
    /// The panel errs near its border.
    PanelEdge,
    /// Both eyes sit elsewhere in the head.
    CameraMount,
    /// Zero of a joint of the neck off.
    HeadJoint,
    /// The right eye is turned sideways against the left one.
    EyeYaw,
    /// The image of one eye is shifted.
    ImageShift,
    /// Focal length or baseline wrong.
    FocalOrBaseline,
    /// The right eye is rolled or pitched against the left one.
    EyeRoll,
    /// Distortion of the lenses that the calibration left over.
    LensDistortion,
    /// Disparities come in steps.
    DisparitySteps,
    /// Depth of the background leaks into what is seen.
    BackgroundBleed,
    /// What is near seems wider than it is.
    ForegroundFattening,
    /// The eyes see the surface, not the middle.
    SeenSurface,
    /// The detector's box sits beside the object.
    BoxBias,
    /// The eyes do not look at the same moment.
    EyeLatency,
    /// Fast moves overshoot.
    SpeedOvershoot,
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
/// Of [`Kind::EyeYaw`] when it grows with time.
pub(super) const YAW_WARM_UP: &[Parameter] = &[parameter("amplitude_rad", 0.01)];

impl Kind {
    /// All kinds, in the order of the library.
    pub const ALL: [Self; 45] = [
        Self::JointZero,
        Self::JointScale,
        Self::JointEccentricity,
        Self::ToothRipple,
        Self::Backlash,
        Self::GravityBacklash,
        Self::Stiction,
        Self::ServoDroop,
        Self::JointSag,
        Self::SidewaysGive,
        Self::LinkBending,
        Self::Creep,
        Self::EarlyLog,
        Self::TorqueLimit,
        Self::ServoWarmUp,
        Self::SlippedHorn,
        Self::JointCoupling,
        Self::AxisSkew,
        Self::LinkLength,
        Self::TipOffset,
        Self::FingerBend,
        Self::FingerRoll,
        Self::TouchDrag,
        Self::BaseTilt,
        Self::TorsoLean,
        Self::PayloadMass,
        Self::ScreenBumped,
        Self::ScreenScale,
        Self::ScreenTilt,
        Self::ScreenBow,
        Self::PanelEdge,
        Self::CameraMount,
        Self::HeadJoint,
        Self::EyeYaw,
        Self::ImageShift,
        Self::FocalOrBaseline,
        Self::EyeRoll,
        Self::LensDistortion,
        Self::DisparitySteps,
        Self::BackgroundBleed,
        Self::ForegroundFattening,
        Self::SeenSurface,
        Self::BoxBias,
        Self::EyeLatency,
        Self::SpeedOvershoot,
    ];

    /// Kinds that a plan of touches is scored by: what does not depend on time, speed or logging.
    pub(super) const OF_PLANS: [Self; 20] = [
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

    /// The kind of this name.
    pub fn of_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.id() == id)
    }

    /// Its name on the command line and in files.
    pub fn id(self) -> &'static str {
        match self {
            Self::JointZero => "joint-zero",
            Self::JointScale => "joint-scale",
            Self::JointEccentricity => "joint-eccentricity",
            Self::ToothRipple => "tooth-ripple",
            Self::Backlash => "backlash",
            Self::GravityBacklash => "gravity-backlash",
            Self::Stiction => "stiction",
            Self::ServoDroop => "servo-droop",
            Self::JointSag => "joint-sag",
            Self::SidewaysGive => "sideways-give",
            Self::LinkBending => "link-bending",
            Self::Creep => "creep",
            Self::EarlyLog => "early-log",
            Self::TorqueLimit => "torque-limit",
            Self::ServoWarmUp => "servo-warm-up",
            Self::SlippedHorn => "slipped-horn",
            Self::JointCoupling => "joint-coupling",
            Self::AxisSkew => "axis-skew",
            Self::LinkLength => "link-length",
            Self::TipOffset => "tip-offset",
            Self::FingerBend => "finger-bend",
            Self::FingerRoll => "finger-roll",
            Self::TouchDrag => "touch-drag",
            Self::BaseTilt => "base-tilt",
            Self::TorsoLean => "torso-lean",
            Self::PayloadMass => "payload-mass",
            Self::ScreenBumped => "screen-bumped",
            Self::ScreenScale => "screen-scale",
            Self::ScreenTilt => "screen-tilt",
            Self::ScreenBow => "screen-bow",
            Self::PanelEdge => "panel-edge",
            Self::CameraMount => "camera-mount",
            Self::HeadJoint => "head-joint",
            Self::EyeYaw => "eye-yaw",
            Self::ImageShift => "image-shift",
            Self::FocalOrBaseline => "focal-or-baseline",
            Self::EyeRoll => "eye-roll",
            Self::LensDistortion => "lens-distortion",
            Self::DisparitySteps => "disparity-steps",
            Self::BackgroundBleed => "background-bleed",
            Self::ForegroundFattening => "foreground-fattening",
            Self::SeenSurface => "seen-surface",
            Self::BoxBias => "box-bias",
            Self::EyeLatency => "eye-latency",
            Self::SpeedOvershoot => "speed-overshoot",
        }
    }

    /// What it is, for people; its site comes before it where it has one.
    pub fn about(self) -> &'static str {
        match self {
            Self::JointZero => "zero position off",
            Self::JointScale => "wrong gear ratio",
            Self::JointEccentricity => "encoder or gear off center",
            Self::ToothRipple => "gear teeth ripple",
            Self::Backlash => "play that follows the direction of motion",
            Self::GravityBacklash => "play that gravity closes on one side",
            Self::Stiction => "friction stops it short of its goal",
            Self::ServoDroop => "servo gives way under load",
            Self::JointSag => "bracket gives way under load",
            Self::SidewaysGive => "joint gives way sideways",
            Self::LinkBending => "bends under load",
            Self::Creep => "gives way more the longer it holds",
            Self::EarlyLog => "angle was logged before it had arrived",
            Self::TorqueLimit => "servo cannot hold more than its torque limit",
            Self::ServoWarmUp => "zero position wanders while the servo warms up",
            Self::SlippedHorn => "horn slipped at a moment",
            Self::JointCoupling => "pulled along by the joint before",
            Self::AxisSkew => "axis not square",
            Self::LinkLength => "wrong length",
            Self::TipOffset => "fingertip elsewhere than in the model",
            Self::FingerBend => "finger bends at contact",
            Self::FingerRoll => "contact wanders over the fingertip's pad",
            Self::TouchDrag => "finger drags after touching down",
            Self::BaseTilt => "torso tilted or shifted",
            Self::TorsoLean => "torso leans under the arm's weight",
            Self::PayloadMass => "hand heavier or lighter than in the model",
            Self::ScreenBumped => "screen was pushed at a moment",
            Self::ScreenScale => "image larger or smaller than in the rig file",
            Self::ScreenTilt => "screen tilted or shifted",
            Self::ScreenBow => "glass bowed",
            Self::PanelEdge => "touch panel errs near its border",
            Self::CameraMount => "eyes sit elsewhere in the head than in the model",
            Self::HeadJoint => "zero position of the neck off",
            Self::EyeYaw => "right eye turned sideways against the left one",
            Self::ImageShift => "image of the right eye shifted",
            Self::FocalOrBaseline => "focal length or distance of the eyes wrong",
            Self::EyeRoll => "right eye rolled or pitched against the left one",
            Self::LensDistortion => "lens distortion left over",
            Self::DisparitySteps => "disparity comes in steps",
            Self::BackgroundBleed => "depth of the background leaks in",
            Self::ForegroundFattening => "what is near seems wider than it is",
            Self::SeenSurface => "eyes see the surface, not the middle",
            Self::BoxBias => "detected box sits beside the object",
            Self::EyeLatency => "eyes do not look at the same moment",
            Self::SpeedOvershoot => "fast moves overshoot",
        }
    }

    /// Its parameters at up to twelve sites in turn, for kinds that come at every site at once.
    pub(super) fn parameters_of_many(self) -> &'static [Parameter] {
        match self {
            Self::JointZero => const { &[parameter("offset_rad", 0.044); 12] },
            Self::AxisSkew => const { &[parameter("rot_rad", TILT); 24] },
            Self::LinkLength => const { &[parameter("length_m", 0.005); 12] },
            _ => &[],
        }
    }

    /// Its parameters. They enter the prediction nearly linearly, so a compliance stands for a
    /// stiffness, and a sine and a cosine for amplitude and phase. What does not (an order, a time
    /// constant, a moment) is the shape of an effect ([`super::Effect::shape`]).
    pub fn parameters(self) -> &'static [Parameter] {
        const BACKLASH: &[Parameter] = &[parameter("width_rad", 0.007)];
        match self {
            Self::JointZero => const { &[parameter("offset_rad", 0.044)] },
            Self::JointScale => const { &[parameter("scale", 0.01)] },
            Self::JointEccentricity => {
                const { &[parameter("sine_rad", 0.0087), parameter("cosine_rad", 0.0087)] }
            }
            Self::ToothRipple => {
                const { &[parameter("sine_rad", 0.00175), parameter("cosine_rad", 0.00175)] }
            }
            Self::Backlash | Self::GravityBacklash => BACKLASH,
            Self::Stiction => const { &[parameter("width_rad", 0.005)] },
            Self::ServoDroop => const { &[parameter("compliance_rad_per_nm", 0.033)] },
            Self::JointSag => const { &[parameter("compliance_rad_per_nm", 0.015)] },
            Self::SidewaysGive => const { &[parameter("compliance_rad_per_nm", 0.01)] },
            Self::LinkBending => const { &[parameter("compliance_m_per_n", 0.0002)] },
            Self::Creep => const { &[parameter("compliance_rad_per_nm", 0.01)] },
            Self::EarlyLog => const { &[parameter("fraction", 0.5)] },
            Self::TorqueLimit => const { &[parameter("give_rad_per_nm", 0.1)] },
            Self::ServoWarmUp => const { &[parameter("amplitude_rad", 0.0044)] },
            Self::SlippedHorn => const { &[parameter("step_rad", 0.087)] },
            Self::JointCoupling => const { &[parameter("ratio", 0.025)] },
            Self::AxisSkew => const { &[parameter("rot_a_rad", TILT), parameter("rot_b_rad", TILT)] },
            Self::LinkLength => const { &[parameter("length_m", 0.005)] },
            Self::TipOffset => {
                const { &[parameter("x_m", 0.0075), parameter("y_m", 0.0075), parameter("z_m", 0.0075)] }
            }
            Self::FingerBend => const { &[parameter("compliance_m_per_n", 0.0015)] },
            Self::FingerRoll => const { &[parameter("radius_m", 0.004)] },
            Self::TouchDrag => const { &[parameter("drag_m", 0.0025)] },
            Self::BaseTilt | Self::ScreenTilt => TILT_AND_SHIFT,
            Self::TorsoLean => const { &[parameter("lean_rad_per_nm", 0.005)] },
            Self::PayloadMass => const { &[parameter("mass_kg", 0.2)] },
            Self::ScreenBumped => {
                const { &[parameter("dx_m", 0.01), parameter("dy_m", 0.01), parameter("yaw_rad", 0.044)] }
            }
            Self::ScreenScale => const { &[parameter("scale_u", 0.075), parameter("scale_v", 0.075)] },
            Self::ScreenBow => const { &[parameter("bow_u_per_m", 0.04), parameter("bow_v_per_m", 0.14)] },
            Self::PanelEdge => const { &[parameter("edge_m", 0.0015)] },
            Self::CameraMount => {
                const {
                    &[
                        parameter("x_m", 0.02),
                        parameter("y_m", 0.02),
                        parameter("z_m", 0.02),
                        parameter("rot_x_rad", TILT),
                        parameter("rot_y_rad", TILT),
                        parameter("rot_z_rad", TILT),
                    ]
                }
            }
            Self::HeadJoint => const { &[parameter("offset_rad", TILT)] },
            Self::EyeYaw => const { &[parameter("yaw_rad", 0.01)] },
            Self::ImageShift => const { &[parameter("du_px", 1.5), parameter("dv_px", 1.5)] },
            Self::FocalOrBaseline => const { &[parameter("scale", 0.05)] },
            Self::EyeRoll => const { &[parameter("roll_rad", 0.0025), parameter("pitch_rad", 0.0025)] },
            Self::LensDistortion => const { &[parameter("k_px", 1.0)] },
            Self::DisparitySteps => const { &[parameter("step_px", 0.03)] },
            Self::BackgroundBleed => const { &[parameter("weight", 0.5)] },
            Self::ForegroundFattening => const { &[parameter("shift_px", 1.5)] },
            Self::SeenSurface => const { &[parameter("radius_m", 0.02)] },
            Self::BoxBias => const { &[parameter("du_px", 4.0), parameter("dv_px", 4.0)] },
            Self::EyeLatency => const { &[parameter("latency_s", 0.025)] },
            Self::SpeedOvershoot => const { &[parameter("latency_s", 0.05)] },
        }
    }

    /// Whether it sits at a joint of the arm.
    pub(super) fn is_of_joint(self) -> bool {
        matches!(
            self,
            Self::JointZero
                | Self::JointScale
                | Self::JointEccentricity
                | Self::ToothRipple
                | Self::Backlash
                | Self::GravityBacklash
                | Self::Stiction
                | Self::ServoDroop
                | Self::JointSag
                | Self::SidewaysGive
                | Self::Creep
                | Self::EarlyLog
                | Self::TorqueLimit
                | Self::ServoWarmUp
                | Self::SlippedHorn
                | Self::JointCoupling
                | Self::AxisSkew
        )
    }

    /// Whether it also comes as one size for all joints of the arm: parts of one make, one
    /// controller.
    pub(super) fn is_shared(self) -> bool {
        matches!(self, Self::ServoDroop | Self::JointSag | Self::EarlyLog)
    }

    /// Whether it concerns the eyes.
    pub fn is_of_eyes(self) -> bool {
        matches!(
            self,
            Self::CameraMount
                | Self::HeadJoint
                | Self::EyeYaw
                | Self::ImageShift
                | Self::FocalOrBaseline
                | Self::EyeRoll
                | Self::LensDistortion
                | Self::DisparitySteps
                | Self::BackgroundBleed
                | Self::ForegroundFattening
                | Self::SeenSurface
                | Self::BoxBias
                | Self::EyeLatency
        )
    }

    /// Whether an encoder sees it, so that a prediction from encoder angles already holds it.
    pub fn is_seen_by_encoder(self) -> bool {
        matches!(self, Self::Stiction | Self::ServoDroop | Self::TorqueLimit)
    }
}
