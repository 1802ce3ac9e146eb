//! Laws of eyes that were calibrated warm: what has grown until then is in the calibration, and only the rest is
//! corrected.

use nalgebra::Matrix3;
use plumbline_model::robot::Rig;
use plumbline_model::{LeftCamera, Point};

use super::*;
use crate::library::{Effect, Growth};
use crate::rig_model::ModelEffect;

/// As near as places are found again, m.
const SAME_M: f64 = 1e-8;
/// Twelve minutes.
const CALIBRATED_S: f64 = 720.0;
const LAW: Growth = Growth { time_constant_s: 301.0, delay_s: 0.0, late_s: 60.0 };
/// Each effect of the eyes that grows: its values, and those of the same effect where it does not grow.
const GROWING: [(&str, &str, &[f64], &[f64]); 4] = [
    ("eye-yaw", "right", &[0.006], &[0.006]),
    ("eye-roll", "right", &[0.004, -0.003], &[0.004, -0.003]),
    ("image-shift", "right", &[1.2], &[1.2, 0.0]),
    ("camera-mount", "eyes", &[0.003, -0.005, 0.002], &[0.0, 0.0, 0.0, 0.003, -0.005, 0.002]),
];

fn nico() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("comes with the program"))
}

fn effect(id: &str, site: &str, values: &[f64]) -> ModelEffect {
    ModelEffect {
        id: id.to_owned(),
        site: site.to_owned(),
        title: String::new(),
        tip: None,
        shape: None,
        reference_s: 0.0,
        values: values.to_vec(),
        covariance: vec![],
        probability: None,
        parameters: vec![],
    }
}

fn growing(id: &str, site: &str, values: &[f64], reference_s: f64) -> ModelEffect {
    let shape = Effect::late_growth(LAW.time_constant_s, LAW.late_s);
    ModelEffect { shape: Some(shape), reference_s, ..effect(id, site, values) }
}

fn model(rig: &Arc<Rig>, effects: Vec<ModelEffect>) -> RobotModel {
    let mut added = RigModel::nominal(rig);
    added.contents.effects = effects;
    RobotModel::new(rig.clone(), Arc::new(added)).expect("they fit")
}

fn places() -> [Point<LeftCamera>; 3] {
    [[0.02, 0.03, 0.4], [-0.12, -0.05, 0.55], [0.15, 0.1, 0.6]].map(|[x, y, z]| Point::new(x, y, z))
}

/// How far two models put what is seen at a time (s) from each other, the largest of some places, m.
fn apart_m(a: &RobotModel, b: &RobotModel, t_secs: Option<f64>) -> f64 {
    let (posture, seen) = (a.rig().home(), SeenUnder { t_secs, ..SeenUnder::default() });
    let put = |model: &RobotModel, in_left: &Point<LeftCamera>| {
        model.place(in_left, &Matrix3::zeros(), &posture, &seen).expect("a place").point
    };
    places().iter().map(|at| put(a, at).distance_m(&put(b, at))).fold(0.0, f64::max)
}

#[test]
fn when_the_eyes_are_as_warm_as_they_were_the_calibration_holds_as_it_is() {
    let rig = nico();
    let calibrated = RobotModel::nominal(rig.clone());
    for (id, site, values, _) in GROWING {
        let here = model(&rig, vec![growing(id, site, values, CALIBRATED_S)]);
        let off_m = apart_m(&here, &calibrated, Some(CALIBRATED_S));
        assert!(off_m < SAME_M, "{id}: {off_m}");
        // Colder and warmer it does not, and where nobody knows how warm they are it is taken as it is.
        for minutes in [0.0, 3.0, 60.0] {
            let off_m = apart_m(&here, &calibrated, Some(60.0 * minutes));
            assert!(off_m > 1e-4, "{id} after {minutes} min: {off_m}");
        }
        assert!(apart_m(&here, &calibrated, None) < SAME_M, "{id}");
    }
}

#[test]
fn what_is_corrected_is_what_has_grown_since_the_calibration() {
    let rig = nico();
    for (id, site, values, constant) in GROWING {
        for reference_s in [0.0, 120.0, CALIBRATED_S] {
            let here = model(&rig, vec![growing(id, site, values, reference_s)]);
            for t_secs in [0.0, 60.0, 300.0, 1500.0] {
                let part = LAW.share(t_secs) - LAW.share(reference_s);
                let scaled: Vec<f64> = constant.iter().map(|value| value * part).collect();
                let should = model(&rig, vec![effect(id, site, &scaled)]);
                let off_m = apart_m(&here, &should, Some(t_secs));
                assert!(off_m < 1e-7, "{id} at {t_secs} s beside {reference_s} s: {off_m}");
            }
        }
    }
}

#[test]
fn a_file_of_before_that_was_kept_holds_for_cold_eyes_and_a_time_that_is_none_is_refused() {
    let (rig, folder) = (nico(), tempfile::tempdir().expect("a temporary folder"));
    let file = folder.path().join("rig-model.toml");
    let mut added = RigModel::nominal(&rig);
    added.contents.effects = vec![growing("eye-yaw", "right", &[0.006], CALIBRATED_S)];
    added.write(&file, &rig).expect("written");
    assert_eq!(RigModel::read(&file, &rig).expect("readable"), added);
    let text = std::fs::read_to_string(&file).expect("readable");
    let line = text.lines().find(|line| line.starts_with("reference_s")).expect("it is kept").to_owned();
    std::fs::write(&file, text.replace(&format!("{line}\n"), "")).expect("writable");
    let before = RigModel::read(&file, &rig).expect("readable");
    assert_eq!(before.effects()[0].reference_s, 0.0);
    let cold = model(&rig, vec![growing("eye-yaw", "right", &[0.006], 0.0)]);
    let read = RobotModel::new(rig.clone(), Arc::new(before)).expect("it fits");
    assert!(apart_m(&read, &cold, Some(300.0)) < SAME_M);
    for wrong in ["-60.0", "nan", "inf"] {
        std::fs::write(&file, text.replace(&line, &format!("reference_s = {wrong}"))).expect("writable");
        let refused = RigModel::read(&file, &rig).expect_err("no such time").to_string();
        assert!(refused.contains("after switching on"), "{refused}");
    }
}
