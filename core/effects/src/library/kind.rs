//! Kinds of effects by name. All that is known of each stands in its entry.

use plumbline_model::robot::CalibratedAt;
use serde::{Deserialize, Serialize};
use strum::{EnumString, IntoStaticStr, VariantArray};

use super::entry::{EyeSite, Is, Shape, Site};

/// What kind of effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[derive(EnumString, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
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
    /// A link of the arm heavier than thought.
    LinkMass,
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
    /// The right eye stood otherwise against the left one while one set of rows was measured.
    EyeKnock,
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

impl Kind {
    /// All kinds, in the order of the library.
    pub const ALL: &'static [Self] = Self::VARIANTS;

    /// The kind of this name.
    pub fn of_id(id: &str) -> Option<Self> {
        id.parse().ok()
    }

    /// Its name on the command line and in files.
    pub fn id(self) -> &'static str {
        self.into()
    }

    /// What it is, for people; its site comes before it where it has one.
    pub fn about(self) -> &'static str {
        self.entry().about
    }

    /// What it means for the robot, a sentence.
    pub fn meaning(self) -> &'static str {
        self.entry().meaning
    }

    /// What could be done about it in the lab, other than adding it to the model.
    pub fn remedy(self) -> &'static str {
        self.entry().remedy
    }

    /// Its parameters. They enter the prediction nearly linearly, so a compliance stands for a
    /// stiffness, and a sine and a cosine for amplitude and phase. What does not (an order, a time
    /// constant, a moment) is the shape of an effect ([`super::Effect::shape`]).
    pub fn parameters(self) -> &'static [Parameter] {
        self.entry().parameters
    }

    /// Whether it concerns the eyes.
    pub fn is_of_eyes(self) -> bool {
        matches!(self.entry().site, Site::OfEyes(_))
    }

    /// Whether it may be at one eye or the other: both mean nearly the same, since how both sit in the head takes up the rest.
    pub fn is_of_one_eye(self) -> bool {
        matches!(self.entry().site, Site::OfEyes(EyeSite::One | EyeSite::BothOrOne))
    }

    /// Whether an effect of this kind in this shape turns or shifts the eyes the more, the longer they are on.
    pub fn is_growth_of_eyes(self, shape: Option<f64>) -> bool {
        shape.is_some() && matches!(self.entry().shape, Shape::Growth(_))
    }

    /// When the calibration holds that it corrects, s since the eyes were switched on: the mount holds how both sit in
    /// the head, the lenses hold all else. `None`: nobody knows.
    pub fn held_at_s(self, calibrated_at: &CalibratedAt) -> Option<f64> {
        if self == Self::CameraMount { calibrated_at.mount_s } else { calibrated_at.cameras_s }
    }

    /// Whether an encoder sees it, so that a prediction from encoder angles already holds it.
    pub fn is_seen_by_encoder(self) -> bool {
        self.entry().is(Is::SeenByEncoder)
    }

    /// Whether its size is told from loads, and so is known no better than masses are.
    pub fn is_of_load(self) -> bool {
        self.entry().is(Is::OfLoad)
    }

    /// Whether it is never less than nothing: parts give way with a load, and not against it.
    pub fn is_one_sided(self) -> bool {
        self.entry().is(Is::OneSided)
    }

    /// Whether a plan of touches is scored by it: it does not depend on time, speed or logging.
    pub(super) fn is_planned(self) -> bool {
        self.entry().is(Is::Planned)
    }

    /// Whether a robot's description can hold it, as the place of a joint or of the tip.
    pub fn is_origin(self) -> bool {
        self.entry().is(Is::Origin)
    }

    /// Whether it follows the tip and not the arm: another tip of the same hand does not have it.
    pub(crate) fn is_of_tip(self) -> bool {
        matches!(self.entry().site, Site::Tip | Site::Contact)
    }

    /// Whether it is there only while the finger meets the touchscreen.
    pub(crate) fn is_of_contact(self) -> bool {
        matches!(self.entry().site, Site::Contact | Site::Screen)
    }
}
