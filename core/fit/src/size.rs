//! An arm as it is sized: which effects, with which values, and under which names.

use plumbline_effects::arm::Arm;
use plumbline_effects::measurements::What;
use plumbline_effects::rig_model::{ModelEffect, PlacedScreen, Together};
use plumbline_effects::{Effect, Kind, Measurements, Present, RigModel, Surface};
use plumbline_model::robot::{DescriptionError, Rig};
use plumbline_model::session::Touchscreen;
use plumbline_model::{Cancelled, JobContext, Session};

use crate::added::{arm_effects, effect_of, placed, together};
use crate::choose::{Chosen, Which, choose, share_by_hands};
use crate::fit::{Fit, Known, fit};
use crate::lag::lag;
use crate::seen::SeenHands;
use crate::usual::{measurements, moves_palm, usual};

/// Fewer touches tell nothing of eighty effects.
pub const LEAST_TOUCHES: usize = 12;

/// A name that a search gave to an effect, or to a family of joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    /// Of the effect, as the command line has it.
    pub id: String,
    /// Where it sits; empty: at every joint.
    pub site: String,
    /// What of it is no matter of degree: see [`Effect::shape`].
    pub shape: Option<f64>,
    /// Probability that it is right.
    pub probability: f64,
}

impl Name {
    /// Names of effects that a model has of the arm with this tip.
    pub fn of_model(model: &RigModel, tip: &str) -> Vec<Self> {
        let of_arm = |effect: &&ModelEffect| effect.tip.as_deref() == Some(tip) && model.is_named(effect);
        let named = |effect: &ModelEffect| Self {
            id: effect.id.clone(),
            site: effect.site.clone(),
            shape: effect.shape,
            probability: effect.probability.unwrap_or(1.0),
        };
        model.effects().iter().filter(of_arm).map(named).collect()
    }

    /// The effect in the library of an arm. `None`: the arm has none, or encoders see it, so that rows have it
    /// already.
    pub fn effect(&self, arm: &Arm) -> Option<Effect> {
        let is_seen = Kind::of_id(&self.id).is_some_and(Kind::is_seen_by_encoder);
        if is_seen {
            return None;
        }
        Effect::find(&self.id, &self.site, self.shape, Some(arm), None)
    }

    /// Whether an effect has this name. A family of joints is sized joint by joint.
    pub fn is_of(&self, effect: &Effect) -> bool {
        self.id == effect.id() && (self.site == effect.site || self.site.is_empty())
    }

    /// Whether an effect of this name is among those that are sized together: else it would be lost.
    pub fn is_sized(&self, arm: &Arm) -> bool {
        match Kind::of_id(&self.id) {
            Some(Kind::ServoDroop | Kind::Stiction) => true,
            _ => self.effect(arm).is_some(),
        }
    }
}

fn probability(names: &[Name], effect: &Effect) -> Option<f64> {
    names.iter().find(|name| name.is_of(effect)).map(|name| name.probability)
}

/// Touches of one session with one finger, from which an arm can be sized.
pub struct ArmTouches<'a> {
    /// Its rows.
    pub measurements: &'a Measurements,
    /// The arm that touched.
    pub arm: &'a Arm,
    /// The finger.
    pub tip: &'a str,
    /// Where the session takes the screen to lie; `None`: where the robot's description has it.
    pub touched_screen: Option<&'a Touchscreen>,
}

impl<'a> ArmTouches<'a> {
    /// `None`: the rows are of several sessions, of something else than touches, or too few.
    pub fn of(sessions: &'a [Session], measurements: &'a Measurements) -> Option<Self> {
        let ([session], [apparatus]) = (sessions, measurements.apparatuses.as_slice()) else { return None };
        let are_touches = measurements.rows.iter().all(|row| row.what == What::Touch);
        let (arm, tip) = (apparatus.arm.as_ref()?, apparatus.tip.as_deref()?);
        let touched_screen = session.manifest.touchscreen.as_ref();
        (are_touches && measurements.rows.len() >= LEAST_TOUCHES && apparatus.surface.is_some())
            .then_some(Self { measurements, arm, tip, touched_screen })
    }

    /// Nothing, the effects of these names, or all usual ones: whatever errs least on touches held out.
    ///
    /// # Errors
    /// When it is cancelled.
    pub fn choose(
        &self,
        names: &[Name],
        known: &Known<'_>,
        context: &dyn JobContext,
    ) -> Result<Chosen, Cancelled> {
        let named: Vec<Effect> = names.iter().filter_map(|name| name.effect(self.arm)).collect();
        let mut chosen = choose(self.measurements, self.arm, named.clone(), known, context)?;
        if chosen.which == Which::All {
            // One that was named in another shape than the usual one is sized in its own.
            for effect in named.into_iter().filter(|effect| !effect.is_of_every_site()) {
                chosen.effects.retain(|usual| (usual.kind, &usual.site) != (effect.kind, &effect.site));
                chosen.effects.push(effect);
            }
        }
        Ok(chosen)
    }

    /// The same choice with the share of the usual sizes that the hands tell, which the eyes saw (`known`).
    pub fn seen_by_hands(&self, chosen: &Chosen, known: &Known<'_>) -> Chosen {
        let mut chosen = chosen.clone();
        if chosen.which == Which::All {
            let known = Known { share: chosen.share, ..*known };
            chosen.share = share_by_hands(self.measurements, &chosen.effects, &known);
        }
        chosen
    }

    /// Sizes what was chosen; `known` with the hands that the eyes saw, where they did. `None`: the rows cannot
    /// be predicted. `rig`: the robot, whose screen the session has touched where the session does not say.
    pub fn sized(&self, names: &[Name], chosen: &Chosen, known: &Known<'_>, rig: &Rig) -> Option<SizedArm> {
        let Self { measurements, arm, tip, touched_screen } = self;
        let known = Known { share: chosen.share, ..*known };
        let rows: Vec<_> = measurements.rows.iter().collect();
        let fitted = fit(measurements, &rows, &chosen.effects, &known)?;
        let mut effects = arm_effects(tip, &fitted, |effect| probability(names, effect));
        let together = together(tip, &fitted, &effects);
        effects.extend(lags(tip, measurements, arm, names));
        let title = &measurements.apparatuses[0].title;
        let nominal = touched_screen.unwrap_or(&rig.touchscreen);
        let screen = placed(title, nominal, &fitted);
        Some(SizedArm { fitted, effects, together, screen })
    }
}

/// How far servos of an arm stop from where they are sent, as effects.
fn lags(tip: &str, measurements: &Measurements, arm: &Arm, names: &[Name]) -> Vec<ModelEffect> {
    let of_model = |(present, covariance): (Present, Vec<f64>)| ModelEffect {
        probability: probability(names, &present.effect),
        ..effect_of(tip, &present, covariance)
    };
    lag(measurements, arm).into_iter().map(of_model).collect()
}

/// An arm that was sized.
pub struct SizedArm {
    /// The fit.
    pub fitted: Fit,
    /// Its effects and those of its servos, as a model takes them.
    pub effects: Vec<ModelEffect>,
    /// How well they are known together.
    pub together: Vec<Together>,
    /// Where it places the screen.
    pub screen: Option<PlacedScreen>,
}

/// Sizes an arm that touched nothing by the hands alone that the eyes saw, and by where its servos stopped
/// (`lags`): all usual effects, each drawn to zero. `None`: the hands cannot be predicted.
///
/// # Errors
/// When the robot has no such arm.
pub fn sized_by_hands(
    rig: &Rig,
    tip: &str,
    hands: &SeenHands,
    lags_of: &Measurements,
    known: &Known<'_>,
) -> Result<Option<SizedArm>, DescriptionError> {
    let arm = Arm::of_rig(rig, tip)?;
    let library: Vec<Effect> = usual(&arm).into_iter().filter(moves_palm).collect();
    let known = Known { hands: Some(hands), screen: None, ..*known };
    let nothing = measurements(rig, arm.clone(), Some(Surface::of(&rig.touchscreen)), vec![]);
    let known = Known { share: share_by_hands(&nothing, &library, &known), ..known };
    let Some(fitted) = fit(&nothing, &[], &library, &known) else { return Ok(None) };
    let mut effects = arm_effects(tip, &fitted, |_| None);
    let together = together(tip, &fitted, &effects);
    effects.extend(lags(tip, lags_of, &arm, &[]));
    Ok(Some(SizedArm { fitted, effects, together, screen: None }))
}
