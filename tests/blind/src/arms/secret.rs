//! What can be wrong with an arm that is measured from outside.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use strum::{IntoStaticStr, VariantArray};

use super::robot::{Robot, TIP};
use crate::answer::{Hidden, Plan};
use crate::hide;

/// What kind of thing is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, IntoStaticStr, VariantArray)]
#[strum(serialize_all = "kebab-case")]
pub enum Kind {
    /// The driven part was mounted turned.
    JointZero,
    /// The transmission has another ratio.
    JointScale,
    /// The encoder's magnet sits beside the axis.
    JointEccentricity,
    /// Free play: the link stays behind its motor.
    Backlash,
    /// Free play through which the link falls.
    GravityBacklash,
    /// A spring behind the gear, about the axis.
    JointSag,
    /// Springs across the axis.
    SidewaysGive,
    /// A link that bends: hinges with springs all along it.
    LinkBending,
    /// The base stands on a spring.
    TorsoLean,
    /// The motor of another joint pulls this one along.
    JointCoupling,
    /// The axis was drilled at an angle.
    AxisSkew,
    /// A link of another length.
    LinkLength,
    /// The marker sits elsewhere.
    TipOffset,
    /// A horn slipped.
    SlippedHorn,
    /// A bracket warms behind its motor and turns the zero.
    ServoWarmUp,
    /// Encoders were read before the joints had arrived.
    EarlyLog,
    /// Not in the library: a wave of the gear train, not whole in a turn.
    #[strum(serialize = "(gear-train)")]
    GearTrain,
    /// Not in the library: a cable that jumps over an edge at an angle.
    #[strum(serialize = "(cable-step)")]
    CableStep,
    /// Not in the library: a joint that remembers from how far it came.
    #[strum(serialize = "(hysteresis)")]
    Hysteresis,
    /// Not in the library: a bracket that softens as it warms.
    #[strum(serialize = "(soft-when-warm)")]
    SoftWhenWarm,
    /// Not in the library: a cable that another joint than the one before pulls, the more the further.
    #[strum(serialize = "(far-cable)")]
    FarCable,
    /// Not in the library: the tripod of the tracker sways over the session.
    #[strum(serialize = "(tripod)")]
    Tripod,
}

impl Kind {
    /// How many the library knows; they stand first.
    const KNOWN: usize = Self::EarlyLog as usize + 1;

    /// Whether it sits at a joint.
    pub fn is_of_joint(self) -> bool {
        !matches!(self, Self::TorsoLean | Self::TipOffset | Self::EarlyLog | Self::Tripod)
    }

    /// Whether what slides has it: nothing turns there, and no load is borne about its axis.
    pub fn is_of_slides(self) -> bool {
        use Kind::{AxisSkew, Backlash, JointScale, JointZero, LinkBending, LinkLength, SidewaysGive};
        let any = [AxisSkew, Backlash, JointScale, JointZero, LinkBending, LinkLength, SidewaysGive];
        any.contains(&self) || !self.is_of_joint()
    }

    /// Whether its amount has no sign.
    pub fn is_positive(self) -> bool {
        use Kind::{
            Backlash, EarlyLog, GravityBacklash, JointSag, LinkBending, SidewaysGive, SoftWhenWarm, TorsoLean,
        };
        matches!(
            self,
            Backlash
                | EarlyLog
                | GravityBacklash
                | JointSag
                | LinkBending
                | SidewaysGive
                | SoftWhenWarm
                | TorsoLean
        )
    }

    /// A usual amount, and the most that a robot has: rad, m, s, rad/(N m), m/N, 1.
    pub fn usual_and_most(self) -> [f64; 2] {
        match self {
            Self::JointZero | Self::AxisSkew | Self::SlippedHorn => [0.004, 0.08],
            Self::JointScale | Self::JointCoupling => [0.004, 0.05],
            Self::JointEccentricity
            | Self::GearTrain
            | Self::CableStep
            | Self::Hysteresis
            | Self::FarCable => [0.003, 0.04],
            Self::Backlash | Self::GravityBacklash => [0.004, 0.025],
            Self::JointSag | Self::SidewaysGive | Self::SoftWhenWarm => [0.001, 0.02],
            Self::LinkBending => [2e-5, 6e-4],
            Self::TorsoLean => [3e-4, 0.01],
            Self::LinkLength | Self::TipOffset => [0.002, 0.025],
            Self::ServoWarmUp => [0.003, 0.03],
            Self::EarlyLog => [0.005, 0.06],
            Self::Tripod => [0.002, 0.02],
        }
    }
}

impl hide::Kinds for Kind {
    const NAMED: &'static [Self] = Self::VARIANTS.split_at(Self::KNOWN).0;
    const NAMELESS: &'static [Self] = Self::VARIANTS.split_at(Self::KNOWN).1;

    /// Play that the direction decides and early readings need both sides.
    fn shows_in(self, plan: Plan) -> bool {
        plan == Plan::Rich || !matches!(self, Self::Backlash | Self::EarlyLog)
    }
}

/// Something that is wrong, where, and by how much.
#[derive(Clone, Debug, PartialEq)]
pub struct Secret {
    /// What.
    pub kind: Kind,
    /// The joint, for what sits at one.
    pub joint: usize,
    /// How much.
    pub amount: f64,
    /// Directions and phases.
    pub shape: [f64; 3],
    /// When it happens, as a share of the session.
    pub when: f64,
}

impl hide::Secret for Secret {
    type Kind = Kind;

    fn amount(&self) -> f64 {
        self.amount
    }

    fn with_amount(&self, amount: f64) -> Self {
        Self { amount, ..self.clone() }
    }

    fn most(&self) -> f64 {
        self.kind.usual_and_most()[1]
    }
}

impl Secret {
    /// The turn of an axis that is not square: across it, rad.
    pub fn skew(&self, axis: &Vector3<f64>) -> Vector3<f64> {
        let any = Vector3::from(self.shape);
        (any - axis * any.dot(axis)).try_normalize(1e-9).unwrap_or_default() * self.amount
    }

    /// The joint whose motor pulls a cable to a joint that does not follow it.
    pub fn far_joint(&self, joints: usize) -> usize {
        (self.joint + 2) % joints
    }

    fn slides(&self, robot: &Robot) -> bool {
        robot.parts.get(self.joint).is_some_and(|part| part.slides)
    }

    /// As the command line would say it.
    pub fn told(&self, robot: &Robot, size_sigmas: f64) -> Hidden {
        let id: &str = self.kind.into();
        let site = match self.kind {
            Kind::LinkLength | Kind::LinkBending => robot.links()[self.joint - 1].clone(),
            Kind::TipOffset => "tip".to_owned(),
            Kind::TorsoLean => "base".to_owned(),
            Kind::Tripod => TIP.to_owned(),
            Kind::EarlyLog => String::new(),
            _ => robot.joints()[self.joint].clone(),
        };
        Hidden { id: id.to_owned(), site, parameters: self.parameters(robot), size_sigmas }
    }

    fn parameters(&self, robot: &Robot) -> BTreeMap<String, f64> {
        let one = |name: &str| BTreeMap::from([(name.to_owned(), self.amount)]);
        let many = |names: &[&str], values: &[f64]| {
            names.iter().map(|name| (*name).to_owned()).zip(values.iter().copied()).collect()
        };
        match self.kind {
            Kind::JointZero => one(if self.slides(robot) { "offset_m" } else { "offset_rad" }),
            Kind::JointScale => one("scale"),
            Kind::JointEccentricity => {
                many(&["amplitude_rad", "phase_rad"], &[self.amount.abs(), self.wave_phase_rad()])
            }
            Kind::Backlash if self.slides(robot) => one("width_m"),
            Kind::Backlash | Kind::GravityBacklash => one("width_rad"),
            Kind::JointSag | Kind::SidewaysGive => one("compliance_rad_per_nm"),
            Kind::LinkBending => one("compliance_m_per_n"),
            Kind::TorsoLean => one("lean_rad_per_nm"),
            Kind::JointCoupling => one("ratio"),
            Kind::AxisSkew => many(
                &["rot_x_rad", "rot_y_rad", "rot_z_rad"],
                self.skew(&robot.parts[self.joint].axis).as_slice(),
            ),
            Kind::LinkLength => one("length_m"),
            Kind::TipOffset => {
                many(&["x_m", "y_m", "z_m"], self.shape.map(|part| part * self.amount).as_slice())
            }
            Kind::SlippedHorn => one("step_rad"),
            // How far a zero turns while it warms follows from the heat.
            _ => BTreeMap::new(),
        }
    }

    /// Which joint of so many pulls its own along: in half of the cases the one before it, else any other one.
    pub fn puller(&self, joints: usize) -> usize {
        // Of a direction at random this is as often in any part of its range.
        let draw = self.shape[2];
        match self.joint.checked_sub(1).filter(|_| draw < 0.0) {
            Some(before) => before,
            None => {
                let others = joints.saturating_sub(1).max(1);
                let other = ((draw.abs() * others as f64) as usize).min(others - 1);
                other + usize::from(other >= self.joint)
            }
        }
    }

    /// The magnet lies in this direction of the joint, rad.
    pub fn magnet_rad(&self) -> f64 {
        self.shape[1].atan2(self.shape[0])
    }

    /// The reading's wave as amplitude times the sine of angle and phase: the phase, rad.
    fn wave_phase_rad(&self) -> f64 {
        let turned = if self.amount < 0.0 { std::f64::consts::PI } else { 0.0 };
        let phase = turned - self.magnet_rad();
        phase.sin().atan2(phase.cos())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_is_pulled_along_by_each_of_the_others_and_mostly_by_the_one_before() {
        let pullers = |joint: usize| {
            let of = |draw: f64| {
                let shape = [0.0, 0.0, draw];
                Secret { kind: Kind::JointCoupling, joint, amount: 0.01, shape, when: 0.5 }.puller(6)
            };
            (-100..=100).map(|k| of(f64::from(k) / 100.0)).collect::<Vec<_>>()
        };
        for joint in 0..6 {
            let all = pullers(joint);
            for other in 0..6 {
                assert_eq!(all.contains(&other), other != joint, "{other} pulls {joint}");
            }
            let before = all.iter().filter(|other| **other + 1 == joint).count();
            assert!(joint == 0 || before > 100, "{joint}: {before}");
        }
    }
}
