//! What places rest on follows the eyes.

use std::sync::Arc;

use nalgebra::Matrix3;
use plumbline_effects::rig_model::ModelEffect;
use plumbline_effects::{Effect, Kind, RigModel, RobotModel};
use plumbline_model::Point;
use plumbline_model::robot::default_rig;

use super::LiveWorkflow;

#[test]
fn eyes_that_turn_as_they_warm_up_are_undone_by_their_clock() {
    let rig = default_rig();
    let mut added = RigModel::nominal(&rig);
    added.contents.effects.push(ModelEffect {
        id: Kind::EyeYaw.id().to_owned(),
        site: "right".to_owned(),
        title: String::new(),
        tip: None,
        shape: Some(Effect::yaw_growth(240.0, 0.0)),
        reference_s: 0.0,
        values: vec![0.01],
        covariance: vec![],
        probability: None,
        parameters: vec![],
    });
    let model = RobotModel::new(rig, Arc::new(added)).expect("fits");
    let mut live = LiveWorkflow::default();
    live.set_model(&Arc::new(model));
    live.use_nominal_lenses(true);
    let mut place = |eyes_on_s: Option<f64>| {
        live.set_eyes_on(eyes_on_s);
        let setup = live.setup().expect("nominal lenses");
        setup.place(&Point::new(0.0, 0.0, 0.5), &(Matrix3::identity() * 1e-8)).expect("a place").point
    };
    let [unknown, cold, warm] = [None, Some(0.0), Some(1200.0)].map(&mut place);
    assert!(cold.distance_m(&unknown) < 1e-9);
    assert!(warm.distance_m(&cold) > 0.01, "{warm:?} {cold:?}");
    // Eyes that were seen to have turned move no place, but widen what is said of it.
    let far = Point::new(0.0, 0.0, 0.5);
    let mut place = |apart_rad: f64| {
        live.set_seen_apart(apart_rad);
        let setup = live.setup().expect("nominal lenses");
        let place = setup.place(&far, &(Matrix3::identity() * 1e-8)).expect("a place");
        (place, setup.wide_because())
    };
    let ((held, before), (turned, because)) = (place(0.0), place(0.02));
    assert!(held.point.distance_m(&turned.point) < 1e-9);
    let more_m = (turned.sigma_m().powi(2) - held.sigma_m().powi(2)).sqrt();
    // z²/b of a turn: 0.5² / 0.0682 · 0.02.
    assert!((0.05..0.1).contains(&more_m), "{more_m}");
    assert!(because.is_some_and(|said| said.contains("does not hold any more")), "{because:?}");
    assert!(!before.is_some_and(|said| said.contains("does not hold")), "{before:?}");
}
