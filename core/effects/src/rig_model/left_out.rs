//! Why an effect cannot stand in a robot's description.

use serde::{Deserialize, Serialize};

use super::ModelEffect;
use crate::library::Kind;

/// An effect that a description cannot hold.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LeftOut {
    /// `id@site`.
    pub effect: String,
    /// Why, half a sentence.
    pub reason: String,
}

const LOAD: &str = "gives with the load, and a description is rigid";
const DIRECTION: &str = "depends on the direction or speed of the motion, or on when an angle was read";
const TIME: &str = "changes with time";
const ANGLE: &str = "changes with the angle of a joint other than by a constant";
const CONTACT: &str = "is there only while the finger touches";
const SCREEN: &str = "is of the touchscreen, which is no part of the robot";
const IMAGE: &str = "is of the image, not of where the eyes sit";

/// Why an effect is not in a description.
pub(super) fn why(effect: &ModelEffect) -> &'static str {
    use Kind as K;
    let Some(kind) = Kind::of_id(&effect.id) else { return "is not known to this program" };
    if kind.is_growth_of_eyes(effect.shape) {
        return TIME;
    }
    match kind {
        K::ServoDroop | K::JointSag | K::SidewaysGive | K::LinkBending | K::TorsoLean | K::PayloadMass => {
            LOAD
        }
        K::LinkMass => "is a mass: write it into the description",
        K::Backlash | K::GravityBacklash | K::Stiction | K::TorqueLimit | K::EarlyLog | K::SpeedOvershoot => {
            DIRECTION
        }
        K::Creep | K::ServoWarmUp | K::SlippedHorn | K::EyeYaw | K::EyeKnock => TIME,
        K::JointScale | K::JointEccentricity | K::ToothRipple | K::JointCoupling => ANGLE,
        K::FingerBend | K::FingerRoll | K::TouchDrag => CONTACT,
        K::ScreenBumped | K::ScreenScale | K::ScreenTilt | K::ScreenBow | K::PanelEdge => SCREEN,
        K::ImageShift
        | K::FocalOrBaseline
        | K::LensDistortion
        | K::DisparitySteps
        | K::BackgroundBleed
        | K::ForegroundFattening
        | K::SeenSurface
        | K::BoxBias
        | K::EyeLatency => IMAGE,
        K::TipOffset => "sits at a tip that is a moving link of its own, so that nothing can hold it",
        K::JointZero | K::AxisSkew | K::LinkLength | K::BaseTilt => {
            "was found on an arm that this rig does not have"
        }
        K::CameraMount | K::HeadJoint | K::EyeRoll => "has no place on the eyes of this rig",
    }
}
