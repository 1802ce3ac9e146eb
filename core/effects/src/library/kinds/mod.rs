//! The library itself: one entry per kind of effect, by what it is wrong with.

mod body;
mod eyes;
mod joints;
mod loads;
mod screen;

use nalgebra::Vector3;

use super::entry::{Act, Entry, EyeSite, Is, Shape, Site, Turning};
use super::known::Known;
use super::{Effect, Kind, Parameter};

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

const fn parameter(name: &'static str, typical: f64) -> Parameter {
    Parameter { name, typical }
}

/// The first three values.
fn vector(values: &[f64]) -> Vector3<f64> {
    Vector3::new(values[0], values[1], values[2])
}

impl Kind {
    /// All that is known of it. A new kind does not compile until it has an entry.
    pub(crate) fn entry(self) -> &'static Entry {
        match self {
            Self::JointZero => &joints::JOINT_ZERO,
            Self::JointScale => &joints::JOINT_SCALE,
            Self::JointEccentricity => &joints::JOINT_ECCENTRICITY,
            Self::ToothRipple => &joints::TOOTH_RIPPLE,
            Self::Backlash => &joints::BACKLASH,
            Self::GravityBacklash => &joints::GRAVITY_BACKLASH,
            Self::Stiction => &joints::STICTION,
            Self::ServoDroop => &loads::SERVO_DROOP,
            Self::JointSag => &loads::JOINT_SAG,
            Self::SidewaysGive => &loads::SIDEWAYS_GIVE,
            Self::LinkBending => &loads::LINK_BENDING,
            Self::Creep => &loads::CREEP,
            Self::EarlyLog => &joints::EARLY_LOG,
            Self::TorqueLimit => &loads::TORQUE_LIMIT,
            Self::ServoWarmUp => &joints::SERVO_WARM_UP,
            Self::SlippedHorn => &joints::SLIPPED_HORN,
            Self::JointCoupling => &joints::JOINT_COUPLING,
            Self::AxisSkew => &joints::AXIS_SKEW,
            Self::LinkLength => &body::LINK_LENGTH,
            Self::TipOffset => &body::TIP_OFFSET,
            Self::FingerBend => &body::FINGER_BEND,
            Self::FingerRoll => &body::FINGER_ROLL,
            Self::TouchDrag => &body::TOUCH_DRAG,
            Self::BaseTilt => &body::BASE_TILT,
            Self::TorsoLean => &body::TORSO_LEAN,
            Self::PayloadMass => &body::PAYLOAD_MASS,
            Self::LinkMass => &body::LINK_MASS,
            Self::ScreenBumped => &screen::SCREEN_BUMPED,
            Self::ScreenScale => &screen::SCREEN_SCALE,
            Self::ScreenTilt => &screen::SCREEN_TILT,
            Self::ScreenBow => &screen::SCREEN_BOW,
            Self::PanelEdge => &screen::PANEL_EDGE,
            Self::CameraMount => &eyes::CAMERA_MOUNT,
            Self::HeadJoint => &eyes::HEAD_JOINT,
            Self::EyeYaw => &eyes::EYE_YAW,
            Self::ImageShift => &eyes::IMAGE_SHIFT,
            Self::FocalOrBaseline => &eyes::FOCAL_OR_BASELINE,
            Self::EyeRoll => &eyes::EYE_ROLL,
            Self::EyeKnock => &eyes::EYE_KNOCK,
            Self::LensDistortion => &eyes::LENS_DISTORTION,
            Self::DisparitySteps => &eyes::DISPARITY_STEPS,
            Self::BackgroundBleed => &eyes::BACKGROUND_BLEED,
            Self::ForegroundFattening => &eyes::FOREGROUND_FATTENING,
            Self::SeenSurface => &eyes::SEEN_SURFACE,
            Self::BoxBias => &eyes::BOX_BIAS,
            Self::EyeLatency => &eyes::EYE_LATENCY,
            Self::SpeedOvershoot => &body::SPEED_OVERSHOOT,
        }
    }
}
