//! Robots that were only measured: an industrial arm of six axes with a made-up description.

use std::fmt::Write as _;
use std::path::Path;

use plumbline_model::Session;
use plumbline_model::robot::Rig;

use crate::arm::{Arm, Deviation};
use crate::forward::Assumed;
use crate::library::Present;
use crate::library::{Effect, Kind};
use crate::measurements::{Measurements, MeasurementsError, What};

/// Origins and axes of six joints, a flange and nothing else: continuous, no limits, no masses.
fn urdf(masses: bool) -> String {
    let joints = [
        ("0 0 0.40", "0 0 1"),
        ("0.025 0 0", "0 1 0"),
        ("0 0 0.455", "0 1 0"),
        ("0.42 0 0.035", "1 0 0"),
        ("0 0 0", "0 1 0"),
        ("0.08 0 0", "1 0 0"),
    ];
    let mut text = "<robot name=\"six_axes\"><link name=\"link0\"/>".to_owned();
    for (i, (origin, axis)) in joints.iter().enumerate() {
        let (parent, number) = (i, i + 1);
        let kind = if i == 3 { "continuous" } else { "revolute" };
        write!(
            text,
            "<joint name=\"a{number}\" type=\"{kind}\"><origin xyz=\"{origin}\"/><axis xyz=\"{axis}\"/>\
             <parent link=\"link{parent}\"/><child link=\"link{number}\"/></joint>"
        )
        .expect("text");
        let mass = if masses {
            "<inertial><origin xyz=\"0.05 0 0.05\"/><mass value=\"4\"/>\
             <inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial>"
        } else {
            ""
        };
        write!(text, "<link name=\"link{number}\">{mass}</link>").expect("text");
    }
    text + "</robot>"
}

fn wave(i: usize, j: usize) -> f64 {
    (0.3 + 12.9898 * (i + 1) as f64 + 78.233 * (j + 1) as f64).sin()
}

/// A session folder with its own rig; torques as the device gives them: what the joint holds.
fn write_session(folder: &Path, masses: bool, torques: Option<f64>, eyes: bool) {
    let file = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("writable");
    file("robot.urdf", &urdf(masses));
    file("rig.toml", "name = \"six axes\"\ndescription = \"robot.urdf\"\n");
    file(
        "session.toml",
        "format = 1\nrig_file = \"rig.toml\"\nstarted = 2026-01-01T00:00:00Z\noperator = \"\"\nnotes = \"\"\n\
         [chain]\ntip = \"link6\"\njoints = [\"a1\", \"a2\", \"a3\", \"a4\", \"a5\", \"a6\"]\n",
    );
    if eyes {
        file("localizations.csv", "true_x_m,true_y_m,true_z_m,est_x_m,est_y_m,est_z_m\n1,0,0,1,0,0\n");
        return;
    }
    let rig = Rig::read_measured(&folder.join("rig.toml")).expect("readable");
    let arm = Arm::of_rig(&rig, "link6").expect("the last link");
    let mut text = String::new();
    let names = |prefix: &str, unit: &str| {
        (1..=6).map(|j| format!("{prefix}_a{j}_{unit}")).collect::<Vec<_>>().join(",")
    };
    text += &names("enc", "rad");
    text += ",meas_x_m,meas_y_m,meas_z_m";
    if torques.is_some() {
        text = text + "," + &names("tau", "nm");
    }
    text += "\n";
    for i in 0..40 {
        let angles: Vec<f64> = (0..6).map(|j| 1.2 * wave(i, j)).collect();
        let tip = arm.tip_m(&angles, &Deviation::none(6));
        let mut cells: Vec<String> = angles.iter().map(|angle| format!("{angle}")).collect();
        cells.extend(tip.iter().map(|place| format!("{place}")));
        if let Some(sign) = torques {
            let frames = arm.frames(&angles);
            let moments = arm.gravity_moments_nm(&frames, 0.0);
            let about = moments.iter().zip(&frames.axes).map(|(m, axis)| sign * m.dot(axis));
            cells.extend(about.map(|torque| format!("{torque}")));
        }
        text += &cells.join(",");
        text += "\n";
    }
    file("poses.csv", &text);
}

fn measured(masses: bool, torques: Option<f64>) -> Measurements {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write_session(folder.path(), masses, torques, false);
    let session = Session::read(folder.path()).expect("a session");
    let rig = Rig::read_measured(&folder.path().join("rig.toml")).expect("readable");
    Measurements::of_sessions(&[("poses".to_owned(), session)], &rig).expect("usable")
}

#[test]
fn poses_of_another_robot_are_predicted_and_have_candidates() {
    let measurements = measured(true, None);
    assert_eq!(measurements.rows.len(), 40);
    assert!(measurements.remarks().is_empty());
    let nominal = Assumed::nominal(&measurements);
    for row in &measurements.rows {
        assert_eq!(row.what, What::Pose);
        let predicted = measurements.predict(row, &nominal).expect("predictable");
        assert!(predicted.iter().zip(&row.measured).all(|(a, b)| (a - b).abs() < 1e-9));
    }
    let candidates = Effect::candidates(&measurements);
    let has = |kind: Kind| candidates.iter().any(|effect| effect.kind == kind);
    assert!(has(Kind::JointZero) && has(Kind::JointSag) && has(Kind::AxisSkew) && has(Kind::LinkLength));
    assert!(!has(Kind::ServoDroop), "encoders see it");
    assert!(!has(Kind::ScreenScale) && !has(Kind::CameraMount));
    for row in &measurements.rows {
        let tangents = measurements.tangents(row, &nominal, &candidates).expect("predictable");
        assert!(tangents.effects.iter().all(|value| value.is_finite()));
    }
}

#[test]
fn without_masses_loads_have_a_shape_and_a_remark() {
    let measurements = measured(false, None);
    let arm = measurements.apparatuses[0].arm.as_ref().expect("poses have an arm");
    assert!(arm.masses_made_up);
    assert_eq!(measurements.remarks().len(), 1);
    let candidates = Effect::candidates(&measurements);
    let sag = candidates.iter().find(|effect| effect.kind == Kind::JointSag && effect.site == "a2");
    let present = Present { effect: sag.expect("a candidate").clone(), values: vec![0.01] };
    let nominal = Assumed::nominal(&measurements);
    let with = Assumed { effects: vec![present], ..nominal.clone() };
    let row = &measurements.rows[0];
    assert_ne!(measurements.predict(row, &nominal), measurements.predict(row, &with));
}

#[test]
fn measured_torques_take_the_place_of_masses_whatever_their_sign() {
    let (held, borne) = (measured(true, Some(-1.0)), measured(true, Some(1.0)));
    for (a, b) in held.rows.iter().zip(&borne.rows) {
        let (a, b) = (a.torque_nm.as_ref().expect("logged"), b.torque_nm.as_ref().expect("logged"));
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}

#[test]
fn eyes_of_a_robot_without_eyes_are_refused_in_words() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write_session(folder.path(), true, None, true);
    let session = Session::read(folder.path()).expect("a session");
    let rig = Rig::read_measured(&folder.path().join("rig.toml")).expect("readable");
    let error = Measurements::of_sessions(&[("eyes".to_owned(), session)], &rig).expect_err("no eyes");
    assert!(matches!(error, MeasurementsError::Lacks { .. }));
    assert!(error.to_string().contains("eyes"), "{error}");
}

#[test]
fn the_order_of_poses_tells_the_last_motion_of_each_joint() {
    let measurements = measured(true, None);
    assert_eq!(measurements.rows[0].direction, vec![0.0; 6], "nobody knows how it began");
    for pair in measurements.rows.windows(2) {
        for j in 0..6 {
            let turned = pair[1].angles_rad()[j] - pair[0].angles_rad()[j];
            if turned.abs() > 0.01 {
                assert_eq!(pair[1].direction[j], turned.signum());
            }
        }
    }
    let kinds = Effect::candidates(&measurements);
    assert!(kinds.iter().any(|effect| effect.kind == Kind::Backlash));
}
