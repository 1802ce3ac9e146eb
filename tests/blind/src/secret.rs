//! What is hidden: things that are wrong with the physics of a case.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

use crate::physics::Generator;

/// What kind of thing is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[derive(IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Kind {
    /// The driven part was mounted turned.
    JointZero,
    /// The transmission has another ratio.
    JointScale,
    /// The encoder's magnet sits beside the axis.
    JointEccentricity,
    /// Free play that the direction of motion decides: of the gear where friction holds the link,
    /// else of the encoder's drive.
    Backlash,
    /// Free play that gravity closes.
    GravityBacklash,
    /// A spring behind the gear, about the axis.
    JointSag,
    /// Springs across the axis.
    SidewaysGive,
    /// The motor of a joint also winds up the joint before it.
    JointCoupling,
    /// The axis was drilled at an angle.
    AxisSkew,
    /// A link of another length.
    LinkLength,
    /// The fingertip sits elsewhere.
    TipOffset,
    /// A round fingertip.
    FingerRoll,
    /// The panel answers late, while the finger slides on.
    TouchDrag,
    /// The torso stands on a spring.
    TorsoLean,
    /// An image of another size.
    ScreenScale,
    /// A dome of glass.
    ScreenBow,
    /// Somebody pushed the screen.
    ScreenBumped,
    /// A horn slipped.
    SlippedHorn,
    /// A bracket warms behind its motor and turns the zero.
    ServoWarmUp,
    /// The encoders were read before the finger was there.
    EarlyLog,
    /// The servo gives way like a soft spring, and its encoder sees it.
    ServoDroop,
    /// Friction stops the servo short of its goal, and its encoder sees it.
    Stiction,
    /// Not in the library: a wave of the gear train, not whole in a turn.
    #[strum(serialize = "(gear-train)")]
    GearTrain,
    /// Not in the library: a cable that jumps over an edge at an angle.
    #[strum(serialize = "(cable-step)")]
    CableStep,
    /// Not in the library: a fingertip that slips as it drags, but sticks on dry patches of the glass.
    #[strum(serialize = "(stick-slip)")]
    StickSlip,
    /// Not in the library: an encoder that is disturbed near a place of the table.
    #[strum(serialize = "(magnet)")]
    Magnet,
    /// Not in the library: a deflection that remembers where the joint came from.
    #[strum(serialize = "(hysteresis)")]
    Hysteresis,
    /// Not in the library: a bracket that softens as it warms.
    #[strum(serialize = "(soft-when-warm)")]
    SoftWhenWarm,
    /// Not in the library: the other arm leans on the torso, and nobody logged it.
    #[strum(serialize = "(other-arm)")]
    OtherArm,
}

impl Kind {
    /// Those that the library knows.
    pub const NAMED: &'static [Self] = Self::VARIANTS.split_at(Self::KNOWN).0;

    /// Those that it does not know.
    pub const NAMELESS: &'static [Self] = Self::VARIANTS.split_at(Self::KNOWN).1;

    /// How many the library knows; they stand first.
    const KNOWN: usize = Self::Stiction as usize + 1;

    /// Its name on the command line.
    pub fn id(self) -> &'static str {
        self.into()
    }

    /// Whether only commands against encoders show it.
    pub fn is_of_servo(self) -> bool {
        matches!(self, Self::ServoDroop | Self::Stiction)
    }

    /// Whether a generator can hide it. Where the load is fed forward, the log of commands holds the load.
    pub fn is_hidden_by(self, generator: Generator) -> bool {
        generator == Generator::Worn || !self.is_of_servo()
    }

    /// Whether the library knows it.
    pub fn is_named(self) -> bool {
        !Self::NAMELESS.contains(&self)
    }

    /// Joints (by place in the arm) at which it may sit; empty where it sits at no joint.
    ///
    /// The zero of the first joint is a turn of the screen and shows nothing; a wrong ratio of it
    /// does. Play that the direction decides needs a joint that hardly carries weight, or a play in
    /// the encoder's drive.
    pub fn joints(self) -> &'static [usize] {
        match self {
            Self::JointZero
            | Self::JointCoupling
            | Self::LinkLength
            | Self::SlippedHorn
            | Self::ServoWarmUp => &[1, 2, 3, 4, 5],
            Self::JointScale | Self::JointEccentricity | Self::Backlash | Self::AxisSkew => {
                &[0, 1, 2, 3, 4, 5]
            }
            Self::GravityBacklash | Self::JointSag | Self::ServoDroop => &[1, 2, 3, 4, 5],
            Self::Stiction => &[0, 1, 2, 3, 4, 5],
            Self::SidewaysGive => &[0, 1, 2, 3, 4],
            Self::GearTrain | Self::CableStep | Self::Magnet | Self::Hysteresis => &[1, 2, 3],
            Self::SoftWhenWarm => &[1, 2, 3],
            _ => &[],
        }
    }

    /// Whether a plan with one side, one height and no weight can show it. Play, drag and early
    /// readings are constant there, a finger that hardly changes its inclination hardly rolls, and
    /// a bracket that softens in one posture is a zero that wanders.
    pub fn shows_from_one_side(self) -> bool {
        !matches!(
            self,
            Self::Backlash
                | Self::GravityBacklash
                | Self::TouchDrag
                | Self::EarlyLog
                | Self::FingerRoll
                | Self::StickSlip
                | Self::SoftWhenWarm
                | Self::Stiction
        )
    }

    /// A usual amount, to start from when a size is wanted.
    pub fn usual(self) -> f64 {
        match self {
            Self::JointZero | Self::SlippedHorn | Self::AxisSkew => 0.02,
            Self::JointScale => 0.02,
            Self::JointEccentricity | Self::GearTrain | Self::CableStep | Self::Magnet | Self::Hysteresis => {
                0.01
            }
            Self::Backlash | Self::GravityBacklash => 0.015,
            Self::JointSag | Self::SidewaysGive | Self::SoftWhenWarm => 0.02,
            Self::JointCoupling => 0.02,
            Self::LinkLength | Self::TipOffset | Self::FingerRoll => 0.006,
            Self::TouchDrag => 0.03,
            Self::TorsoLean => 0.005,
            Self::ScreenScale => 0.03,
            Self::ServoDroop => 0.05,
            Self::Stiction => 0.02,
            Self::ScreenBow => 0.1,
            Self::ScreenBumped => 0.004,
            Self::ServoWarmUp => 0.01,
            Self::EarlyLog => 0.03,
            Self::StickSlip => 0.06,
            Self::OtherArm => 0.004,
        }
    }

    /// No robot of this kind is worse than this.
    pub fn most(self) -> f64 {
        match self {
            Self::JointZero | Self::SlippedHorn => 0.12,
            Self::AxisSkew => 0.08,
            Self::JointScale => 0.08,
            Self::JointEccentricity => 0.05,
            Self::GearTrain | Self::CableStep | Self::Magnet | Self::Hysteresis => 0.06,
            Self::Backlash | Self::GravityBacklash => 0.03,
            Self::JointSag | Self::SidewaysGive | Self::SoftWhenWarm => 0.08,
            Self::JointCoupling => 0.1,
            Self::LinkLength | Self::TipOffset => 0.025,
            Self::FingerRoll => 0.012,
            Self::TouchDrag => 0.12,
            Self::TorsoLean => 0.02,
            Self::ScreenScale => 0.2,
            Self::ServoDroop => 0.15,
            Self::Stiction => 0.06,
            Self::ScreenBow => 0.4,
            Self::ScreenBumped => 0.03,
            Self::ServoWarmUp => 0.03,
            Self::EarlyLog => 0.12,
            Self::StickSlip => 0.2,
            Self::OtherArm => 0.03,
        }
    }
}

/// Over how far along the glass it changes by a radian whether a finger sticks: patches of six centimeters, m.
const PATCH_M: f64 = 0.02;

/// Something that is wrong, where, and by how much.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Secret {
    /// What.
    pub kind: Kind,
    /// Place of the joint in the arm, for what sits at a joint.
    pub joint: usize,
    /// How much: rad, m, s, rad/(N m), 1 by its kind; the sign counts where it has a meaning.
    pub amount: f64,
    /// What else it needs, drawn by chance: directions, phases, places.
    pub shape: [f64; 3],
    /// When it happens, as a share of the session; for what happens at a moment.
    pub when: f64,
}

impl Secret {
    /// The same with another amount.
    #[must_use]
    pub fn with_amount(&self, amount: f64) -> Self {
        Self { amount, ..self.clone() }
    }

    /// Where it is, as the command line says it.
    pub fn site(&self, joints: &[String], links: &[String]) -> String {
        match self.kind {
            Kind::LinkLength => links[self.joint - 1].clone(),
            Kind::TipOffset | Kind::FingerRoll | Kind::TouchDrag | Kind::StickSlip => "tip".to_owned(),
            Kind::TorsoLean | Kind::OtherArm => "base".to_owned(),
            Kind::ScreenScale | Kind::ScreenBow | Kind::ScreenBumped => "screen".to_owned(),
            Kind::EarlyLog => String::new(),
            _ => joints[self.joint].clone(),
        }
    }

    /// Its parameters as the command line names them.
    pub fn parameters(&self, axes: &[nalgebra::Vector3<f64>]) -> BTreeMap<String, f64> {
        let one = |name: &str| BTreeMap::from([(name.to_owned(), self.amount)]);
        let many = |names: &[&str], values: &[f64]| {
            names.iter().map(|name| (*name).to_owned()).zip(values.iter().copied()).collect()
        };
        let [a, b, c] = self.shape;
        let amount = self.amount;
        match self.kind {
            Kind::JointZero => one("offset_rad"),
            Kind::JointScale => one("scale"),
            Kind::JointEccentricity => {
                // The reading runs ahead of the joint by a vector sum, see `reading`.
                let sign = amount.signum();
                many(&["amplitude_rad", "phase_rad"], &[amount.abs(), (-b * sign).atan2(a * sign)])
            }
            Kind::Backlash | Kind::GravityBacklash | Kind::Stiction => one("width_rad"),
            Kind::ServoDroop => BTreeMap::from([("stiffness_nm_per_rad".to_owned(), 1.0 / amount)]),
            Kind::JointSag | Kind::SidewaysGive => one("compliance_rad_per_nm"),
            Kind::JointCoupling => one("ratio"),
            Kind::AxisSkew => {
                let turn = self.skew(&axes[self.joint]);
                many(&["rot_x_rad", "rot_y_rad", "rot_z_rad"], turn.as_slice())
            }
            Kind::LinkLength => one("length_m"),
            Kind::TipOffset => many(&["x_m", "y_m", "z_m"], &[a * amount, b * amount, c * amount]),
            Kind::FingerRoll => one("radius_m"),
            Kind::TorsoLean => one("lean_rad_per_nm"),
            Kind::ScreenScale => many(&["scale_u", "scale_v"], &[a * amount, b * amount]),
            Kind::ScreenBow => many(&["bow_u_per_m", "bow_v_per_m"], &[0.0, -amount]),
            Kind::ScreenBumped => {
                // Axes of the robot: the screen's x (along u) is its −y, the screen's y its x.
                many(&["dx_m", "dy_m", "yaw_rad"], &[b * amount, -a * amount, c * amount * 8.0])
            }
            Kind::SlippedHorn => one("step_rad"),
            Kind::EarlyLog => one("early_secs"),
            // How far the finger slides while the panel thinks, or a zero turns while it warms,
            // comes out of the physics.
            _ => BTreeMap::new(),
        }
    }

    /// Whether a finger sticks on the glass at a place (m): on half of it, in patches.
    pub fn sticks_at(&self, at_m: [f64; 2]) -> bool {
        let wave = |k: usize| (at_m[k] / PATCH_M + self.shape[k] * std::f64::consts::TAU).sin();
        wave(0) * wave(1) > 0.0
    }

    /// The turn of an axis that is not square: across it, rad.
    pub fn skew(&self, axis: &nalgebra::Vector3<f64>) -> nalgebra::Vector3<f64> {
        let any = nalgebra::Vector3::from(self.shape);
        let across = any - axis * any.dot(axis);
        across.try_normalize(1e-9).unwrap_or_default() * self.amount
    }
}
