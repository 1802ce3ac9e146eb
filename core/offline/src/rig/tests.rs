//! Exported robots read again, by the parser of descriptions and by MuJoCo.

use std::sync::Arc;

use nalgebra::Isometry3;
use plumbline_effects::RobotModel;
use plumbline_effects::rig_model::{Conditions, Contents, ModelEffect};
use plumbline_model::Unattended;
use plumbline_model::robot::Posture;
use plumbline_twin::places_of_bodies;

use super::*;

/// Largest distance of what is exported from the model's own prediction, m, and angle between them, rad.
const MOST: [f64; 2] = [1e-4, 1e-3];

fn effect(id: &str, site: &str, tip: Option<&str>, values: &[f64]) -> ModelEffect {
    ModelEffect {
        id: id.to_owned(),
        site: site.to_owned(),
        title: String::new(),
        tip: tip.map(str::to_owned),
        shape: None,
        reference_s: 0.0,
        values: values.to_vec(),
        covariance: vec![],
        probability: None,
        parameters: vec![],
    }
}

/// Every constant geometry at once, found on several tips of both arms and on the eyes.
fn constant() -> Vec<ModelEffect> {
    let (index, palm, left) = (Some("right_index_tip"), Some("right_palm_center"), Some("left_palm_center"));
    vec![
        effect("joint-zero", "r_elbow_y", index, &[0.04]),
        effect("joint-zero", "r_shoulder_z", palm, &[-0.02]),
        effect("joint-zero", "l_wrist_x", left, &[0.03]),
        effect("axis-skew", "r_arm_x", index, &[0.02, -0.01]),
        effect("link-length", "right_upper_arm", palm, &[0.004]),
        effect("tip-offset", "tip", index, &[0.003, -0.002, 0.004]),
        effect("base-tilt", "base", index, &[0.01, -0.02, 0.03, 0.005, 0.002, -0.004]),
        effect("camera-mount", "eyes", None, &[0.004, -0.003, 0.002, 0.02, -0.01, 0.015]),
        effect("head-joint", "head_y", None, &[0.02]),
        effect("eye-yaw", "right", None, &[0.008]),
    ]
}

fn model(rig: &Arc<Rig>, effects: Vec<ModelEffect>) -> RobotModel {
    let added = RigModel { contents: Contents { effects, ..Contents::default() }, ..RigModel::nominal(rig) };
    RobotModel::new(rig.clone(), Arc::new(added)).expect("effects of this rig")
}

/// Postures all over the joints' ranges, by Halton's sequence.
fn postures(rig: &Rig, count: u32) -> Vec<Posture> {
    let primes = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59, 61, 67, 71, 73, 79, 83, 89];
    let halton = |mut i: u32, base: u32| {
        let (mut share, mut value) = (1.0, 0.0);
        while i > 0 {
            share /= f64::from(base);
            value += share * f64::from(i % base);
            i /= base;
        }
        value
    };
    let joints: Vec<_> =
        (0..rig.description.movable_count()).map(plumbline_model::robot::JointIndex).collect();
    let angles = |i: u32| -> Vec<f64> {
        let at = |(joint, prime): (&plumbline_model::robot::JointIndex, u32)| {
            let limits = rig.description.limits(*joint);
            limits.lower_rad + halton(i, prime) * (limits.upper_rad - limits.lower_rad)
        };
        joints.iter().zip(primes).map(at).collect()
    };
    assert!(joints.len() <= primes.len());
    (1..=count).map(|i| rig.home().with(&joints, &angles(i))).collect()
}

fn export(rig: &Arc<Rig>, effects: Vec<ModelEffect>, format: RigFormat) -> (String, RigExportReport) {
    let folder = tempfile::tempdir().expect("a folder");
    let (file, out) = (folder.path().join("rig-model.toml"), folder.path().join("robot"));
    model(rig, effects).added().write(&file, rig).expect("written");
    let args = RigExportArgs { rig: "nico".to_owned(), rig_model: Some(file), format, out: out.clone() };
    let report = rig_export(&args, &Unattended).expect("exported");
    (std::fs::read_to_string(out).expect("written"), report)
}

/// How far two places are from each other: distance (m) and angle (rad).
fn off(a: &Isometry3<f64>, b: &Isometry3<f64>) -> [f64; 2] {
    [(a.translation.vector - b.translation.vector).norm(), a.rotation.angle_to(&b.rotation)]
}

/// The greatest differences over postures, tips of both arms, and the left eye.
fn worst(rig: &Arc<Rig>, own: &RobotModel, place: impl Fn(&Posture, &str) -> Isometry3<f64>) -> [f64; 2] {
    let tips = ["right_palm_center", "right_index_tip", "left_palm_center", "left_index_tip"];
    let arms = tips.map(|tip| own.arm(tip).expect("a tip"));
    let mut worst = [0.0f64; 2];
    for posture in postures(rig, 200) {
        let conditions = Conditions::default();
        let eye = (own.robot_from_left(&posture).isometry, "left_camera");
        let ends = arms.iter().zip(tips);
        let ends = ends.map(|(arm, tip)| (arm.robot_from_tip(&posture, &conditions).isometry, tip));
        for (predicted, link) in ends.chain([eye]) {
            let [off_m, off_rad] = off(&predicted, &place(&posture, link));
            worst = [worst[0].max(off_m), worst[1].max(off_rad)];
        }
    }
    worst
}

fn by_urdf(text: &str) -> impl Fn(&Posture, &str) -> Isometry3<f64> {
    let description = Description::from_urdf(text).expect("a URDF");
    move |posture, link| {
        let link = description.find_link(link).expect("a link");
        description.forward(posture).of(link).isometry
    }
}

fn by_mujoco(rig: &Arc<Rig>, text: String) -> impl Fn(&Posture, &str) -> Isometry3<f64> {
    let names: Vec<String> = rig.description.movable().map(|joint| joint.name.clone()).collect();
    move |posture, link| {
        let joints = names.iter().enumerate();
        let angle =
            |(i, name): (usize, &'_ String)| (name.clone(), posture[plumbline_model::robot::JointIndex(i)]);
        let angles: Vec<(String, f64)> = joints.map(angle).collect();
        let angles: Vec<(&str, f64)> = angles.iter().map(|(name, angle)| (name.as_str(), *angle)).collect();
        places_of_bodies(&text, &angles).expect("MuJoCo accepts it")[link]
    }
}

#[test]
fn other_programs_put_everything_where_the_model_has_it() {
    let rig = plumbline_model::robot::default_rig();
    for effects in [vec![], constant()] {
        let own = model(&rig, effects.clone());
        let (urdf, report) = export(&rig, effects.clone(), RigFormat::Urdf);
        assert_eq!((report.inside.len(), &report.left_out[..]), (effects.len(), &[][..]));
        let [off_m, off_rad] = worst(&rig, &own, by_urdf(&urdf));
        eprintln!("URDF, {} effects: {off_m:.2e} m, {off_rad:.2e} rad", effects.len());
        assert!(off_m < MOST[0] && off_rad < MOST[1], "URDF: {off_m} m, {off_rad} rad");
        let (mjcf, report) = export(&rig, effects.clone(), RigFormat::Mjcf);
        assert_eq!((report.inside.len(), &report.left_out[..]), (effects.len(), &[][..]));
        let [off_m, off_rad] = worst(&rig, &own, by_mujoco(&rig, mjcf));
        eprintln!("MJCF, {} effects: {off_m:.2e} m, {off_rad:.2e} rad", effects.len());
        assert!(off_m < MOST[0] && off_rad < MOST[1], "MJCF: {off_m} m, {off_rad} rad");
    }
}

#[test]
fn the_right_camera_is_where_it_sees_what_the_model_says() {
    let rig = plumbline_model::robot::default_rig();
    let (urdf, _) = export(&rig, vec![effect("eye-yaw", "right", None, &[0.008])], RigFormat::Urdf);
    let place = by_urdf(&urdf);
    let (left, right) = (place(&rig.home(), "left_camera"), place(&rig.home(), "right_camera"));
    // Turned to its right by the yaw: the left eye seen from it turns the other way.
    let nominal = rig.eyes.cameras.right_from_left.isometry;
    let yaw = nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::new(0.0, 0.008, 0.0));
    let [off_m, off_rad] = off(&(right.inverse() * left), &(yaw.inverse() * nominal));
    assert!(off_m < 1e-9 && off_rad < 1e-9, "{off_m} {off_rad}");
}

#[test]
fn what_no_description_can_hold_is_left_out_with_the_reason() {
    let rig = plumbline_model::robot::default_rig();
    let tip = Some("right_index_tip");
    let effects = vec![
        effect("joint-zero", "r_elbow_y", tip, &[0.04]),
        effect("joint-sag", "r_elbow_y", tip, &[0.02]),
        effect("backlash", "r_arm_x", tip, &[0.01]),
        effect("image-shift", "right", None, &[1.0, 0.5]),
        ModelEffect { shape: Some(300.0), ..effect("eye-yaw", "right", None, &[0.008]) },
        ModelEffect { shape: Some(300.0), ..effect("camera-mount", "eyes", None, &[0.0, 0.004, 0.0]) },
    ];
    for format in [RigFormat::Urdf, RigFormat::Mjcf] {
        let (_, report) = export(&rig, effects.clone(), format);
        assert_eq!(report.inside, ["joint-zero@r_elbow_y"]);
        let told: Vec<(&str, &str)> =
            report.left_out.iter().map(|left| (left.effect.as_str(), left.reason.as_str())).collect();
        let expected = [
            ("joint-sag@r_elbow_y", "load"),
            ("backlash@r_arm_x", "direction"),
            ("image-shift@right", "image"),
            ("eye-yaw@right", "time"),
            ("camera-mount@eyes", "time"),
        ];
        for ((effect, reason), (name, word)) in told.iter().zip(expected) {
            assert!(*effect == name && reason.contains(word), "{told:?}");
        }
        assert_eq!(told.len(), expected.len());
    }
}

#[test]
fn what_is_read_is_never_written_over_and_files_of_rigs_are_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let [rig, urdf] = Rig::built_in_files("nico").expect("comes with the program");
    let file = folder.path().join("rig.toml");
    std::fs::write(&file, rig).expect("written");
    std::fs::write(folder.path().join("nico.urdf"), urdf).expect("written");
    let report = rig_check(&file).expect("read");
    assert!(report.ok && report.problems.is_empty());
    let args = |out: &str| RigExportArgs {
        rig: file.display().to_string(),
        rig_model: None,
        format: RigFormat::Urdf,
        out: folder.path().join(out),
    };
    assert!(rig_export(&args("nico.urdf"), &Unattended).is_err(), "its own description");
    let report = rig_export(&args("out.urdf"), &Unattended).expect("exported");
    assert!(report.inside.is_empty() && report.left_out.is_empty());
    std::fs::write(&file, rig.replacen("baud", "bauds", 1)).expect("written");
    let report = rig_check(&file).expect("read");
    let json = serde_json::to_value(&report).expect("JSON");
    assert_eq!(json["ok"], false);
    let problem = &json["problems"][0];
    assert!(problem["line"].is_number() && problem["what"].is_string() && problem["fix"].is_string());
}
