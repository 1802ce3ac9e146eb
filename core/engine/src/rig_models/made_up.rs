//! A made-up model with effects, for tests of this package and of the command line's.

use jiff::Timestamp;
use plumbline_effects::RigModel;
use plumbline_effects::rig_model::{Addition, ModelEffect};
use plumbline_model::robot::Rig;

/// A model with effects of the right arm: kind, site, values.
pub fn model_with(rig: &Rig, effects: &[(&str, &str, &[f64])]) -> RigModel {
    let effects = effects.iter().map(|(id, site, values)| ModelEffect {
        id: (*id).to_owned(),
        site: (*site).to_owned(),
        title: String::new(),
        tip: Some("right_index_tip".to_owned()),
        shape: None,
        reference_s: 0.0,
        values: values.to_vec(),
        covariance: vec![],
        probability: None,
        parameters: vec![],
    });
    let addition = Addition {
        effects: effects.collect(),
        screens: vec![],
        externals: vec![],
        eyes: vec![],
        together: vec![],
        replaces: false,
        at: Timestamp::UNIX_EPOCH,
        sentence: String::new(),
        sessions: vec![],
        version: String::new(),
        gap: None,
    };
    let mut model = RigModel::nominal(rig);
    model.add(rig, addition).expect("they fit");
    model
}
