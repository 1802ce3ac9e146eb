//! What would bring more, tried out on a copy of the plan.

use nalgebra::{DMatrix, DVector, Vector3};
use plumbline_model::decompose;
use plumbline_model::robot::Rig;
use serde::{Deserialize, Serialize};

use super::spectrum::Information;
use super::{Noise, PlannedContact};
use crate::arm::{Arm, Deviation};
use crate::library::{Effect, Surface};

/// At most this many touches are added to see what they bring.
const MOST_ADDED: usize = 40;
/// Height of the block that is tried, m.
const BLOCK_M: f64 = 0.06;
/// Weight that is tried, kg.
const WEIGHT_KG: f64 = 0.25;
/// How far joints turn for another posture with the tip in place, rad.
const POSTURE_RAD: f64 = 0.35;
/// A pose found for a place must reach it within this, m.
const REACHED_M: f64 = 1e-4;

/// What can be added to a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Addition {
    /// Arrive from the other side.
    OtherSide,
    /// Lay the screen on a block.
    RaisedScreen,
    /// Hold a weight.
    Weight,
    /// Touch with another posture of the arm.
    VariedPosture,
}

impl Addition {
    const ALL: [Self; 4] = [Self::OtherSide, Self::RaisedScreen, Self::Weight, Self::VariedPosture];

    fn sentence(self, touches: usize, before: usize, after: usize) -> String {
        let what = match self {
            Self::OtherSide => "arriving from the other side".to_owned(),
            Self::RaisedScreen => format!("with the screen on a block of {:.0} mm", BLOCK_M * 1e3),
            Self::Weight => format!("with a weight of {:.0} g in the hand", WEIGHT_KG * 1e3),
            Self::VariedPosture => "with the elbow held higher or lower".to_owned(),
        };
        format!(
            "Touch {touches} of the targets again {what}: {after} instead of {before} mixtures of causes are told apart."
        )
    }
}

/// One thing that would bring more.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Advice {
    /// What to add.
    pub addition: Addition,
    /// What to do and what it brings.
    pub sentence: String,
    /// Directions that the plan would then see.
    pub directions_after: usize,
}

/// What the plan is made for.
pub(super) struct Scene<'a> {
    pub rig: &'a Rig,
    pub arm: &'a Arm,
    pub surface: &'a Surface,
    pub effects: &'a [Effect],
    pub noise: &'a Noise,
}

pub(super) fn advice(scene: &Scene<'_>, contacts: &[PlannedContact], plan: &Information) -> Vec<Advice> {
    let before = plan.spectrum().directions();
    let with = |added: &[PlannedContact]| {
        let mut both = plan.clone();
        both += &Information::of(scene.arm, scene.surface, scene.effects, added, scene.noise);
        both.spectrum().directions()
    };
    let every = contacts.len().div_ceil(MOST_ADDED);
    let some: Vec<&PlannedContact> = contacts.iter().step_by(every.max(1)).collect();
    // More touches of the same kind bring something, too: what is advised must bring more.
    let repeated = with(&some.iter().copied().cloned().collect::<Vec<_>>());
    let mut advice: Vec<Advice> = Addition::ALL
        .into_iter()
        .filter_map(|addition| {
            let added: Vec<PlannedContact> = some
                .iter()
                .enumerate()
                .filter_map(|(i, contact)| scene.changed(addition, contact, i))
                .collect();
            if added.is_empty() {
                return None;
            }
            let after = with(&added);
            let sentence = addition.sentence(added.len(), before, after);
            (after > repeated).then_some(Advice { addition, sentence, directions_after: after })
        })
        .collect();
    advice.sort_by_key(|advice| std::cmp::Reverse(advice.directions_after));
    advice
}

impl Scene<'_> {
    /// The touch with something changed; `None` where that does not change it or the arm cannot.
    fn changed(&self, addition: Addition, contact: &PlannedContact, i: usize) -> Option<PlannedContact> {
        let mut changed = PlannedContact { group: format!("{} again", contact.group), ..contact.clone() };
        match addition {
            Addition::OtherSide => {
                changed.direction.iter_mut().for_each(|sign| *sign = -*sign);
                changed.direction.iter().any(|sign| *sign != 0.0).then_some(())?;
            }
            Addition::Weight => changed.payload_kg += WEIGHT_KG,
            Addition::RaisedScreen => {
                changed.screen_height_m += BLOCK_M;
                let lift = self.surface.normal() * BLOCK_M;
                changed.angles_rad = self.moved(&contact.angles_rad, &contact.angles_rad, lift)?;
            }
            Addition::VariedPosture => {
                let sign = if i.is_multiple_of(2) { 1.0 } else { -1.0 };
                let aside = [sign, -sign].into_iter().find_map(|sign| {
                    let start = self.aside(&contact.angles_rad, sign)?;
                    self.moved(&contact.angles_rad, &start, Vector3::zeros())
                });
                changed.angles_rad = aside?;
            }
        }
        Some(changed)
    }

    /// Angles inside the limits that put the tip `by` away from where `from` has it, by
    /// Gauss–Newton steps from `start`.
    fn moved(&self, from: &[f64], start: &[f64], by: Vector3<f64>) -> Option<Vec<f64>> {
        let none = Deviation::none(self.arm.len());
        let goal = self.arm.tip_m(from, &none) + by;
        let mut angles = DVector::from_column_slice(start);
        for _ in 0..12 {
            let error = goal - self.arm.tip_m(angles.as_slice(), &none);
            if error.norm() < REACHED_M {
                break;
            }
            let inverse = decompose::pseudo_inverse(self.jacobian(angles.as_slice()), 1e-3)?;
            let step = inverse * DVector::from_column_slice(error.as_slice());
            // A long step leaves the range in which the arm is nearly linear.
            angles += &step * (0.5 / step.amax()).min(1.0);
        }
        let reached = (goal - self.arm.tip_m(angles.as_slice(), &none)).norm() < REACHED_M;
        let inside = self.arm.parts.iter().zip(angles.iter()).all(|(part, angle_rad)| {
            let limits = part.index.map(|index| self.rig.limits(index));
            limits.is_none_or(|limits| (limits.lower_rad..=limits.upper_rad).contains(angle_rad))
        });
        (reached && inside).then(|| angles.as_slice().to_vec())
    }

    /// Angles with the tip nearly in place and joints turned as far as they then can.
    fn aside(&self, angles_rad: &[f64], sign: f64) -> Option<Vec<f64>> {
        let jacobian = self.jacobian(angles_rad);
        let inverse = decompose::pseudo_inverse(jacobian.clone(), 1e-3)?;
        let free = DMatrix::identity(self.arm.len(), self.arm.len()) - inverse * jacobian;
        let best =
            (0..free.ncols()).max_by(|a, b| free.column(*a).norm().total_cmp(&free.column(*b).norm()))?;
        let turn = free.column(best);
        let largest = turn.amax();
        (largest > 1e-3).then(|| {
            angles_rad
                .iter()
                .zip(turn.iter())
                .map(|(angle, turn)| angle + sign * POSTURE_RAD * turn / largest)
                .collect()
        })
    }

    /// Velocity of the tip per joint, m/rad.
    fn jacobian(&self, angles_rad: &[f64]) -> DMatrix<f64> {
        let frames = self.arm.frames(angles_rad);
        let tip = frames.robot_from_tip.translation.vector;
        DMatrix::from_fn(3, self.arm.len(), |row, j| {
            frames.axes[j].cross(&(tip - frames.robot_from_joint[j].translation.vector))[row]
        })
    }
}
