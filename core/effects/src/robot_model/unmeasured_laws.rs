//! Laws of what nobody measured of the eyes: places drawn with it lie where the uncertainty says, what was measured
//! takes its place, and it is as large as the world is.

use nalgebra::{Matrix3, Matrix6, Vector3};
use plumbline_model::robot::{Posture, Rig, default_rig};
use plumbline_model::{LeftCamera, Point};

use super::drawn::{model, share_inside};
use super::laws::Noise;
use super::*;
use crate::library::Kind;
use crate::rig_model::ModelEffect;

const MOUNT: Unmeasured = Unmeasured { mount: true, lenses: false, neck: false };
/// Mean error over the table with a mount that nobody measured, as published, m.
const PUBLISHED_M: f64 = 0.0368;

fn effect(kind: Kind, site: &str, shape: Option<f64>, values: Vec<f64>) -> ModelEffect {
    super::drawn::effect(kind.id(), site, shape, values)
}

fn neck(rig: &Rig) -> [String; 2] {
    [rig.eyes.pan, rig.eyes.tilt].map(|joint| rig.description.joint(joint).name.clone())
}

/// A robot of which nobody measured that: every effect of the library on it, in its usual size.
fn drawn(rig: &Arc<Rig>, of: Unmeasured, noise: &mut Noise) -> RobotModel {
    let [pan, tilt] = neck(rig);
    let mount =
        [(Kind::CameraMount, "eyes", None), (Kind::HeadJoint, &pan, None), (Kind::HeadJoint, &tilt, None)];
    let lenses = [
        (Kind::EyeYaw, "right", None),
        (Kind::EyeRoll, "right", None),
        (Kind::ImageShift, "right", None),
        (Kind::FocalOrBaseline, "eyes", None),
        (Kind::FocalOrBaseline, "eyes", Some(1.0)),
    ];
    let lenses = if of.lenses { &lenses[..] } else { &[] };
    let effects = mount.iter().chain(lenses).map(|(kind, site, shape)| {
        let values = kind.parameters().iter().map(|parameter| parameter.typical * noise.normal());
        effect(*kind, site, *shape, values.collect())
    });
    model(rig, effects.collect())
}

fn place(by: &RobotModel, in_left: &Point<LeftCamera>, posture: &Posture) -> PlaceInRobot {
    by.place(in_left, &Matrix3::zeros(), posture, &SeenUnder::default()).expect("a place")
}

#[test]
fn the_true_place_lies_inside_the_stated_95_percent_whatever_is_drawn() {
    let rig = default_rig();
    for of in [MOUNT, Unmeasured::ALL] {
        let here = RobotModel::nominal(rig.clone()).with_not_calibrated(of);
        let mut noise = Noise(3);
        let share = share_inside(&here, &SeenUnder::default(), || drawn(&rig, of, &mut noise));
        assert!((0.90..=0.99).contains(&share), "{of:?}: {share}");
    }
}

#[test]
fn a_mount_that_nobody_measured_is_off_by_about_what_was_published() {
    let rig = default_rig();
    let posture = rig.home();
    let here = RobotModel::nominal(rig.clone()).with_not_calibrated(MOUNT);
    let (mut noise, mut errors_m) = (Noise(5), vec![]);
    for _ in 0..200 {
        let left_from_robot = drawn(&rig, MOUNT, &mut noise).robot_from_left(&posture).inverse();
        for (i, j) in (0..4).flat_map(|i| (0..9).map(move |j| (i, j))) {
            let point = Point::new(0.2 + 0.1 * f64::from(i), -0.4 + 0.1 * f64::from(j), 0.05);
            let found = place(&here, &(left_from_robot * point), &posture);
            errors_m.push((found.point.coords.coords - point.coords.coords).xy().norm());
        }
    }
    let mean_m = errors_m.iter().sum::<f64>() / errors_m.len() as f64;
    // Published is with the errors of its stereo.
    assert!((0.7 * PUBLISHED_M..PUBLISHED_M).contains(&mean_m), "{mean_m}");
}

#[test]
fn the_zero_of_the_necks_turn_stays_unknown_beside_a_mount_until_something_says_it() {
    let rig = default_rig();
    let posture = rig.home();
    let in_left = Point::new(0.05, 0.02, 0.5);
    let mounted = Mounted { covariance: Matrix6::identity() * 1e-6, rest_sigma_rad: [0.001; 2] };
    let of_neck = Unmeasured { neck: true, ..Unmeasured::default() };
    let with = |effects, of| {
        place(&model(&rig, effects).with_mounted(Some(mounted)).with_not_calibrated(of), &in_left, &posture)
    };
    let (known, unknown) = (with(vec![], Unmeasured::default()), with(vec![], of_neck));
    // 1.5° at the half meter and more that it is from the axis: to the side, and nothing upward.
    let more_m2 = unknown.covariance_m2 - known.covariance_m2;
    assert!((0.008..0.016).contains(&more_m2.trace().sqrt()), "{}", more_m2.trace().sqrt());
    assert!(more_m2[(2, 2)] < 1e-9 && unknown.point == known.point);
    assert_eq!(unknown.by_mount_m2 - known.by_mount_m2, more_m2, "it moves all alike");
    let [pan, _] = neck(&rig);
    let told = || vec![effect(Kind::HeadJoint, &pan, None, vec![0.02])];
    assert_eq!(with(told(), of_neck), with(told(), Unmeasured::default()));
    // All of a mount that nobody measured holds it once.
    let all = RobotModel::nominal(rig.clone()).with_not_calibrated(Unmeasured { neck: true, ..MOUNT });
    let mount = RobotModel::nominal(rig.clone()).with_not_calibrated(MOUNT);
    assert_eq!(place(&all, &in_left, &posture), place(&mount, &in_left, &posture));
}

#[test]
fn what_is_measured_takes_the_place_of_what_is_usual() {
    let rig = default_rig();
    let posture = rig.home();
    let in_left = Point::new(0.05, 0.02, 0.5);
    let nominal = RobotModel::nominal(rig.clone());
    assert_eq!(nominal.unmeasured(), Unmeasured::default(), "what is not named counts as known");
    let unmeasured = nominal.clone().with_not_calibrated(MOUNT);
    let sigma_m = |by: &RobotModel| place(by, &in_left, &posture).sigma_m();
    assert!((0.022..0.034).contains(&sigma_m(&unmeasured)), "{}", sigma_m(&unmeasured));

    let mounted = Mounted { covariance: Matrix6::identity() * 1e-6, rest_sigma_rad: [0.001; 2] };
    let measured = nominal.clone().with_mounted(Some(mounted));
    let of_both = unmeasured.clone().with_mounted(Some(mounted));
    assert_eq!(of_both.unmeasured(), Unmeasured::default());
    assert_eq!(place(&of_both, &in_left, &posture), place(&measured, &in_left, &posture), "to the last bit");

    // A mount that a search found is known as well as it says, with the neck on which it was found.
    let with = |effects| model(&rig, effects).with_not_calibrated(MOUNT);
    let found = with(vec![effect(Kind::CameraMount, "eyes", None, vec![0.001; 6])]);
    assert_eq!((found.unmeasured(), found.not_calibrated()), (Unmeasured::default(), MOUNT));
    assert!(sigma_m(&found) < 1e-6);
    // What grows says nothing of what was there; one joint of the neck says nothing of the rest.
    let growing = with(vec![effect(Kind::CameraMount, "eyes", Some(240.0), vec![0.001; 3])]);
    assert_eq!(growing.unmeasured(), MOUNT);
    let [_, tilt] = neck(&rig);
    let nodding = with(vec![effect(Kind::HeadJoint, &tilt, None, vec![0.01])]);
    assert_eq!(nodding.unmeasured(), MOUNT);
    let spread_m2 = |by: &RobotModel| place(by, &in_left, &posture).covariance_m2.trace();
    // A zero of 1.5° at half a meter is 13 mm.
    assert!(spread_m2(&nodding) < spread_m2(&unmeasured) - 1e-4 && sigma_m(&nodding) > 0.02);
}

#[test]
fn the_mount_makes_no_distance_uncertain_and_the_lenses_do() {
    let rig = default_rig();
    let posture = rig.home();
    let in_left: Point<LeftCamera> = Point::new(0.05, 0.02, 0.5);
    let eye_m: Vector3<f64> = rig.robot_from_left(&posture).translation_m();
    let range = |of| {
        let here = RobotModel::nominal(rig.clone()).with_not_calibrated(of);
        place(&here, &in_left, &posture).range_m(&eye_m)
    };
    let (range_m, sigma_m) = range(MOUNT);
    assert!((range_m - in_left.coords.coords.norm()).abs() < 1e-9);
    assert!(sigma_m < 1e-6, "{sigma_m}");
    // 14 mrad between the rays are 0.5² · 0.014 / 0.07 m, and a twentieth of the scale twice.
    let (_, sigma_m) = range(Unmeasured::ALL);
    assert!((0.05..0.08).contains(&sigma_m), "{sigma_m}");
}
