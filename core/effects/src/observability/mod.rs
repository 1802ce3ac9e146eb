//! What a plan of touches will be able to tell apart.
//!
//! For every effect at every site the tangent of the predicted touch (along u, along v, height of
//! the fingertip over the glass) is computed by differences through the forward kinematics, in
//! units of the noise and for an effect of usual size. Where the screen lies is not known better
//! than by the touches themselves, so its six degrees of freedom are projected out.

mod advice;
mod spectrum;
mod tangent;
#[cfg(test)]
mod tests;

use plumbline_model::robot::servo::TICK_RAD;
use plumbline_model::robot::{DescriptionError, Rig};
use serde::{Deserialize, Serialize};

use crate::arm::Arm;
use crate::library::{Effect, Surface};

pub use advice::{Addition, Advice};
use spectrum::Information;

/// An effect, or a mixture of effects, of usual size counts as seen from this on, in standard
/// deviations of what noise alone would do.
pub const SEEN_SIGMAS: f64 = 3.0;
/// Two effects are alike from this cosine between what they do to the touches on.
pub const ALIKE_COSINE: f64 = 0.95;

/// A touch to come, as the arm will make it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedContact {
    /// Angles at contact, one per joint of the chain to the tip ([`Rig::chain`]), rad.
    pub angles_rad: Vec<f64>,
    /// Last motion of each joint before contact: −1, 0 (not known or none) or 1.
    pub direction: Vec<f64>,
    /// Height of the block under the screen, m.
    pub screen_height_m: f64,
    /// Known mass at the palm, kg.
    pub payload_kg: f64,
    /// Touches of one group repeat the same command from the same side.
    pub group: String,
}

/// How good one touch is: standard deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Along each direction of the glass, m.
    pub in_plane_m: f64,
    /// Of the fingertip's height at contact, m.
    pub height_m: f64,
    /// Of an encoder, rad; `None`: encoders are not logged, which makes a servo that gives way
    /// look like a bracket that does.
    pub encoder_rad: Option<f64>,
}

impl Default for Noise {
    /// 1 mm in the plane, 0.5 mm in height, one step of an encoder.
    fn default() -> Self {
        Self { in_plane_m: 1e-3, height_m: 0.5e-3, encoder_rad: Some(TICK_RAD) }
    }
}

/// How well the plan shows one effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EffectVisibility {
    /// Name of the effect.
    pub id: String,
    /// Joint, link, `tip`, `base` or `screen`.
    pub site: String,
    /// What it is and where, for people.
    pub title: String,
    /// How far an effect of usual size stands out of the noise, all other effects absent, in
    /// standard deviations.
    pub sigmas: f64,
    /// How much of the doubt about it is left when every other effect may be there, too: standard
    /// deviation after the touches over the one before, 0–1. Near 1 the plan cannot pin it down.
    pub doubt_left: f64,
}

impl EffectVisibility {
    /// Whether an effect of usual size would be noticed.
    pub fn is_seen(&self) -> bool {
        self.sigmas >= SEEN_SIGMAS
    }
}

/// What a plan will be able to tell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanScore {
    /// Independent directions, among all mixtures of effects, that stand out of the noise by
    /// [`SEEN_SIGMAS`] and more.
    pub directions: usize,
    /// Number of candidate effects.
    pub candidates: usize,
    /// All candidates, the best seen first.
    pub seen: Vec<EffectVisibility>,
    /// Effects (id, site) that are seen but do the same to all touches, within
    /// [`ALIKE_COSINE`]; the best seen of each class first.
    pub alike: Vec<Vec<(String, String)>>,
    /// What would bring more, the best first.
    pub advice: Vec<Advice>,
    /// Largest over smallest singular value of the directions that are seen; 1 with none.
    pub condition: f64,
    /// What the touches tell about the effects, bit: ½ log₂ det(1 + JᵀJ), the Bayesian
    /// D-criterion. Compares plans.
    pub information_bits: f64,
}

impl PlanScore {
    /// What the plan will tell, in a sentence.
    pub fn sentence(&self) -> String {
        let seen = self.seen.iter().filter(|effect| effect.is_seen()).count();
        let alike = match self.alike.len() {
            0 => "each looks different".to_owned(),
            1 => "one group of them looks alike".to_owned(),
            count => format!("{count} groups of them look alike"),
        };
        format!(
            "{} independent directions; {seen} of {} possible effects would be noticed, {alike}.",
            self.directions, self.candidates
        )
    }

    /// What an effect is and where, for people.
    pub fn title(&self, id: &str, site: &str) -> Option<&str> {
        self.seen
            .iter()
            .find(|effect| effect.id == id && effect.site == site)
            .map(|effect| effect.title.as_str())
    }
}

/// Why a plan was not scored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScoreError {
    /// No touch.
    #[error("the plan has no touch that the arm can make: choose an area that it reaches")]
    Empty,
    /// The tip is unknown.
    #[error(transparent)]
    Tip(#[from] DescriptionError),
    /// Nothing moves the tip.
    #[error("no joint moves {tip}: choose a tip of an arm")]
    NoJoints {
        /// The tip.
        tip: String,
    },
    /// A touch for another arm.
    #[error(
        "touch {number} has {angles} angles and {directions} directions, the chain has {joints} joints: plan the touches again for this tip"
    )]
    Size {
        /// Which, counted from 1.
        number: usize,
        /// Angles that it has.
        angles: usize,
        /// Directions that it has.
        directions: usize,
        /// Joints of the chain.
        joints: usize,
    },
    /// A value that is not a number.
    #[error("touch {number} holds a value that is not a number: plan the touches again")]
    NotFinite {
        /// Which, counted from 1.
        number: usize,
    },
    /// Noise of nothing.
    #[error("the noise of a touch must be greater than zero: take 1 mm if it is not known")]
    Noise,
}

/// Scores a plan.
///
/// # Errors
/// When there is nothing to score, or touches do not belong to this arm.
pub fn score(
    rig: &Rig,
    tip: &str,
    contacts: &[PlannedContact],
    noise: &Noise,
) -> Result<PlanScore, ScoreError> {
    let arm = Arm::of_rig(rig, tip)?;
    if arm.is_empty() {
        return Err(ScoreError::NoJoints { tip: tip.to_owned() });
    }
    check(&arm, contacts, noise)?;
    let surface = Surface::of(&rig.touchscreen);
    let effects = Effect::all(&arm);
    let information = Information::of(&arm, &surface, &effects, contacts, noise);
    let spectrum = information.spectrum();
    let advice = advice::advice(
        &advice::Scene { rig, arm: &arm, surface: &surface, effects: &effects, noise },
        contacts,
        &information,
    );
    Ok(PlanScore {
        directions: spectrum.directions(),
        candidates: effects.len(),
        seen: spectrum.visibility(&effects),
        alike: spectrum.alike(&effects),
        advice,
        condition: spectrum.condition(),
        information_bits: spectrum.bits(),
    })
}

fn check(arm: &Arm, contacts: &[PlannedContact], noise: &Noise) -> Result<(), ScoreError> {
    let encoder_rad = noise.encoder_rad.unwrap_or(1.0);
    if ![noise.in_plane_m, noise.height_m, encoder_rad].iter().all(|sd| *sd > 0.0 && sd.is_finite()) {
        return Err(ScoreError::Noise);
    }
    if contacts.is_empty() {
        return Err(ScoreError::Empty);
    }
    for (i, contact) in contacts.iter().enumerate() {
        let (angles, directions, joints) = (contact.angles_rad.len(), contact.direction.len(), arm.len());
        if angles != joints || directions != joints {
            return Err(ScoreError::Size { number: i + 1, angles, directions, joints });
        }
        let numbers = contact.angles_rad.iter().chain(&contact.direction);
        if !numbers.chain([&contact.screen_height_m, &contact.payload_kg]).all(|n| n.is_finite()) {
            return Err(ScoreError::NotFinite { number: i + 1 });
        }
    }
    Ok(())
}
