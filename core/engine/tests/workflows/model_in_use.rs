//! What was accepted is used: live places, what the arm is told, touches; and taken back it is gone.

use std::path::Path;
use std::sync::Arc;

use jiff::Timestamp;
use nalgebra::Matrix3;
use plumbline_effects::rig_model::{Conditions, ModelEffect, numbers_of_eyes};
use plumbline_effects::{RigModel, RobotModel, SeenUnder};
use plumbline_engine::eyes::store::Store;
use plumbline_engine::robot::RobotControl;
use plumbline_engine::view::ProbeReading;
use plumbline_engine::{Correction, GapCommand, LiveCommand, ProbePoint, rig_models};
use plumbline_model::robot::ik::{Options, Target};
use plumbline_model::robot::{Rig, default_rig};
use plumbline_model::{Eye, Point, StereoCalibration};

use crate::common::{Desk, eyes, wall_pair};

const TIP: &str = "right_palm_center";
const NOD_RAD: f64 = 0.03;
const ELBOW_RAD: f64 = 0.08;

fn effect(id: &str, site: &str, value: f64) -> ModelEffect {
    ModelEffect {
        id: id.to_owned(),
        site: site.to_owned(),
        title: String::new(),
        tip: Some("right_index_tip".to_owned()),
        shape: None,
        reference_s: 0.0,
        values: vec![value],
        covariance: vec![1e-4],
        probability: None,
        parameters: vec![],
    }
}

/// The zeros of elbow and neck are off, as a search of the gap would have found.
fn accept(folder: &Path, rig: &Rig) {
    let tilt = &rig.description.joint(rig.eyes.tilt).name;
    let mut model = RigModel::nominal(rig);
    model.contents.effects =
        vec![effect("joint-zero", "r_elbow_y", ELBOW_RAD), effect("head-joint", tilt, NOD_RAD)];
    rig_models::save(folder, &model, rig).expect("written");
}

/// The point in the middle of the left image.
fn measured(desk: &mut Desk) -> ProbeReading {
    desk.show(&wall_pair());
    desk.apply(LiveCommand::Probe(ProbePoint::Raw { eye: Eye::Left, u_px: 160.0, v_px: 120.0 }));
    let probe = desk.view().live.probe.clone().expect("asked for");
    probe.reading.unwrap_or_else(|why| panic!("{why}"))
}

fn told(desk: &Desk) -> Arc<RobotModel> {
    let model = desk.to_robot.iter().rev().find_map(|control| match control {
        RobotControl::UseModel(model) => Some(model.clone()),
        _ => None,
    });
    model.expect("the arm was told what is known of it")
}

#[test]
fn from_the_moment_effects_are_accepted_everybody_uses_them() {
    let (rig, folder) = (default_rig(), tempfile::tempdir().expect("temporary folder"));
    let store = Store::of_world(folder.path());
    store.accept(&StereoCalibration::bare(eyes()), Timestamp::now()).expect("kept");
    let nominal = measured(&mut Desk::new(folder.path()));
    assert_eq!(&*nominal.model, "as described");

    accept(folder.path(), &rig);
    let mut desk = Desk::new(folder.path());
    let with = measured(&mut desk);
    assert_eq!(&*with.model, "with 2 effects");
    assert_eq!(with.point_in_left, nominal.point_in_left, "the same is seen");
    // Where it is when the head stands as the effect says.
    let home = rig.home();
    let nodding = home.with(&[rig.eyes.tilt], &[home[rig.eyes.tilt] + NOD_RAD]);
    let should = rig.robot_from_left(&nodding) * nominal.point_in_left;
    assert!(with.point_in_robot.distance_m(&should) < 1e-6);
    assert!(with.point_in_robot.distance_m(&nominal.point_in_robot) > 5e-3);
    // Nobody measured the mount: what the model says of that is in what is shown.
    let known = told(&desk);
    let place = known.place(&with.point_in_left, &Matrix3::zeros(), &home, &SeenUnder::default());
    let by_model_m = place.expect("a place").sigma_m();
    assert!(by_model_m > 0.02 && with.sigma_m >= by_model_m, "{} {by_model_m}", with.sigma_m);
    assert!(nominal.sigma_m > 0.02 && with.range_sigma_m < with.sigma_m, "{nominal:?}");
    let told_to =
        |reading: &ProbeReading| reading.wide_because.is_some_and(|why| why.contains("step 2, Mount"));
    assert!(told_to(&nominal) && told_to(&with), "an effect of one joint is no mount");

    assert_eq!(known.title(), "with 2 effects");
    let accepted = rig_models::in_use(folder.path(), &rig).expect("it can be used");
    assert_eq!((accepted.rig(), accepted.added().effects()), (known.rig(), known.added().effects()));
    let target = Point::new(0.3, -0.2, 0.2);
    let missed_m = |model: &RobotModel| {
        let (arm, conditions) = (model.arm(TIP).expect("a tip"), Conditions::default());
        let to = Target::Position(target);
        let found = arm.reach(&to, &home, &Options::default(), &conditions).expect("sound");
        let commanded = home.with(arm.joints(), &found.answer.best().joints);
        known.arm(TIP).expect("a tip").tip(&commanded, &conditions).distance_m(&target)
    };
    assert!(missed_m(&known) < 1e-4 && missed_m(&RobotModel::nominal(rig.clone())) > 5e-3);
    assert_eq!(desk.view().touch.correct_with, Some(Correction::Effects));

    desk.apply(GapCommand::UseNominal);
    assert_eq!(measured(&mut desk), nominal, "to the last bit");
    let known = told(&desk);
    assert!(known.is_nominal());
    assert_eq!(commanded_rad(&known, target), commanded_rad(&RobotModel::nominal(rig), target));
    assert_eq!(desk.view().touch.correct_with, None);
}

#[test]
fn effects_on_the_eyes_found_with_another_calibration_are_not_in_force_and_it_is_said() {
    let (rig, folder) = (default_rig(), tempfile::tempdir().expect("temporary folder"));
    let store = Store::of_world(folder.path());
    store.accept(&StereoCalibration::bare(eyes()), Timestamp::now()).expect("kept");
    accept(folder.path(), &rig);
    let mut seen_with = Rig::clone(&rig);
    seen_with.eyes.cameras = eyes();
    let mut model = rig_models::load(folder.path(), &rig).expect("readable");
    model.contents.eyes = numbers_of_eyes(&seen_with);
    rig_models::save(folder.path(), &model, &rig).expect("written");
    assert_eq!(told(&Desk::new(folder.path())).title(), "with 2 effects");

    let mut turned = eyes();
    turned.right_from_left.isometry.translation.vector.x -= 0.001;
    store.accept(&StereoCalibration::bare(turned), Timestamp::now()).expect("kept");
    let mut desk = Desk::new(folder.path());
    let known = told(&desk);
    assert_eq!(known.title(), "with 1 effect");
    assert_eq!(known.added().effects()[0].id, "joint-zero");
    let notices = desk.view().notices.clone();
    let said = notices.iter().filter(|notice| notice.text.contains("found with others: ")).count();
    assert_eq!(said, 1, "{notices:?}");
    let accepted = rig_models::in_use(folder.path(), &rig).expect("it can be used");
    assert_eq!(accepted.added().effects(), known.added().effects());

    // The calibration that they were found with comes back, and they with it.
    store.accept(&StereoCalibration::bare(eyes()), Timestamp::now()).expect("kept");
    assert_eq!(told(&Desk::new(folder.path())).title(), "with 2 effects");
}

/// What is commanded without effects.
fn commanded_rad(model: &RobotModel, target: Point<plumbline_model::Robot>) -> Vec<f64> {
    let arm = model.arm(TIP).expect("a tip");
    let (home, to) = (model.rig().home(), Target::Position(target));
    let found = arm.reach(&to, &home, &Options::default(), &Conditions::default()).expect("sound");
    found.answer.best().joints.to_vec()
}
