//! What was fitted, as a model takes it.

use plumbline_effects::rig_model::{ModelEffect, PlacedScreen, Together};
use plumbline_effects::{Effect, Kind, Present};
use plumbline_model::robot::Rig;
use plumbline_model::session::Touchscreen;

use crate::fit::Fit;

/// Effects of a fit of the arm with this tip; `probability`: that a name is right, of those that were named.
pub fn arm_effects(
    tip: &str,
    fitted: &Fit,
    probability: impl Fn(&Effect) -> Option<f64>,
) -> Vec<ModelEffect> {
    let mut at = 0;
    let of_fit = |present: &Present| {
        let width = present.values.len();
        let covariance = fitted.covariance.view((at, at), (width, width));
        at += width;
        let probability = probability(&present.effect);
        ModelEffect { probability, ..effect_of(tip, present, covariance.iter().copied().collect()) }
    };
    fitted.assumed.effects.iter().map(of_fit).collect()
}

/// An effect with its values, whose covariance is given row by row.
pub fn effect_of(tip: &str, present: &Present, covariance: Vec<f64>) -> ModelEffect {
    let Present { effect, values } = present;
    ModelEffect {
        id: effect.id().to_owned(),
        site: effect.site.clone(),
        title: effect.title.clone(),
        tip: Some(tip.to_owned()),
        shape: effect.shape,
        reference_s: effect.reference_s,
        values: values.clone(),
        covariance,
        probability: None,
        parameters: vec![],
    }
}

/// The zero of the neck's turn that a fit found; `None`: nothing told it.
pub fn neck_effect(rig: &Rig, fitted: &Fit) -> Option<ModelEffect> {
    let (zero_rad, sd_rad) = fitted.neck_rad?;
    let joint = rig.description.joint(rig.eyes.pan).name.clone();
    let title = rig.servo_of(rig.eyes.pan).map_or(joint.as_str(), |servo| servo.title.as_str());
    Some(ModelEffect {
        id: Kind::HeadJoint.id().to_owned(),
        title: format!("{title}: {}", Kind::HeadJoint.about()),
        site: joint,
        tip: None,
        shape: None,
        reference_s: 0.0,
        values: vec![zero_rad],
        covariance: vec![sd_rad * sd_rad],
        probability: None,
        parameters: vec![],
    })
}

/// How well the effects of a fit are known together; none where `effects` lacks some of them.
pub fn together(tip: &str, fitted: &Fit, effects: &[ModelEffect]) -> Vec<Together> {
    let of_model = |present: &Present| {
        let is_it = |effect: &&ModelEffect| {
            (effect.id.as_str(), &effect.site) == (present.effect.id(), &present.effect.site)
        };
        effects.iter().filter(|effect| effect.tip.as_deref() == Some(tip)).find(is_it).cloned()
    };
    let fitted_effects: Option<Vec<ModelEffect>> = fitted.assumed.effects.iter().map(of_model).collect();
    fitted_effects.and_then(|effects| Together::new(&effects, &fitted.covariance)).into_iter().collect()
}

/// Where the fit places the screen that a session of touches takes to lie at `nominal`.
pub fn placed(session: &str, nominal: &Touchscreen, fitted: &Fit) -> Option<PlacedScreen> {
    Some(PlacedScreen::moved(session, nominal, fitted.assumed.placements.first()?))
}
