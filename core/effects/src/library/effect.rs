//! Effects at their sites, and what they do.

use nalgebra::Vector3;

use super::{Kind, Parameter, Situation};
use crate::arm::{Arm, Deviation};
use crate::eyes::{EyeSituation, EyesDeviation};

/// A tooth has two flanks: gravity has chosen one when it is clearly larger than this, N m.
const SEATING_TORQUE_NM: f64 = 0.02;
/// How far a usual bracket gives under load, rad/(N m). Only needed to see a wrong mass, which
/// shows through what gives way under it.
const USUAL_COMPLIANCE_RAD_PER_NM: f64 = 0.015;
/// Links shorter than this have no length that could be wrong, m.
const SHORTEST_LINK_M: f64 = 0.02;

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

impl Effect {
    /// What it does to the eyes in a situation, added to `deviation`; one value per parameter.
    pub fn deviate_eyes(&self, situation: &EyeSituation, values: &[f64], deviation: &mut EyesDeviation) {
        let _ = (situation, values, deviation);
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
