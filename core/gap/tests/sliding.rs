//! An arm one of whose joints slides: a boom that runs out of a turning column. Made up by the model itself and read
//! from files, so that what was hidden has to be found again.
#![allow(clippy::print_stdout, reason = "figures are read from the test's output")]

mod common;

use std::fmt::Write as _;
use std::path::Path;

use common::{normal, present};
use nalgebra::{Isometry3, Vector3};
use plumbline_effects::rig_model::{Addition, ModelEffect, PlacedExternal, predict_session_with};
use plumbline_effects::{Assumed, Effect, Measurements, MeasurementsError, Present, RigModel};
use plumbline_gap::{Finding, GapError, Options, Turns, find};
use plumbline_model::predict::predict_session;
use plumbline_model::robot::Rig;
use plumbline_model::{Session, Unattended};
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

const NOISE_M: f64 = 3e-4;
/// The boom is the second joint.
const JOINTS: [&str; 5] = ["column", "boom", "lift", "bend", "roll"];
const BOOM: usize = 1;

fn urdf() -> String {
    let joints = [
        ("revolute", "0 0 0.4", "0 0 1"),
        ("prismatic", "0.1 0 0.2", "1 0 0"),
        ("revolute", "0.1 0.05 0", "0 1 0"),
        ("revolute", "0.3 0 0.05", "0 1 0"),
        ("revolute", "0.2 0 0", "1 0 0"),
    ];
    let mut text = "<robot name=\"boomer\"><link name=\"l0\"/>".to_owned();
    for (k, (kind, origin, axis)) in joints.iter().enumerate() {
        let (joint, next) = (JOINTS[k], k + 1);
        let _ = write!(
            text,
            "<joint name=\"{joint}\" type=\"{kind}\"><parent link=\"l{k}\"/><child link=\"l{next}\"/>\
             <origin xyz=\"{origin}\"/><axis xyz=\"{axis}\"/><limit lower=\"-3\" upper=\"3\" effort=\"1\" velocity=\"1\"/>\
             </joint><link name=\"l{next}\"><inertial><origin xyz=\"0.1 0 0\"/><mass value=\"2\"/>\
             <inertia ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial></link>"
        );
    }
    text + "<joint name=\"end\" type=\"fixed\"><parent link=\"l5\"/><child link=\"tool\"/>\
            <origin xyz=\"0.05 0.1 0.02\"/></joint><link name=\"tool\"/></robot>"
}

/// Writes a session; `units`: of the column of each joint.
fn write(folder: &Path, units: [&str; 5], rows: &[[f64; 5]], measured: &[Vector3<f64>]) {
    let file = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("writable");
    file("boomer.urdf", &urdf());
    file(
        "session.toml",
        &format!(
            "format = 1\nrig_file = \"boomer.urdf\"\nstarted = 2026-01-01T00:00:00Z\n[chain]\ntip = \"tool\"\n\
             joints = {JOINTS:?}\n"
        ),
    );
    let columns: Vec<String> =
        JOINTS.iter().zip(units).map(|(joint, unit)| format!("cmd_{joint}_{unit}")).collect();
    let mut text = format!("group,approach,meas_x_m,meas_y_m,meas_z_m,{}", columns.join(","));
    for (i, (row, at)) in rows.iter().zip(measured).enumerate() {
        let side = ["plus", "minus"][i % 2];
        let _ = write!(text, "\ng{i},{side},{},{},{}", at.x, at.y, at.z);
        row.iter().for_each(|value| text += &format!(",{value}"));
    }
    file("poses.csv", &(text + "\n"));
}

const RIGHT: [&str; 5] = ["rad", "m", "rad", "rad", "rad"];

fn rows(seed: u64) -> Vec<[f64; 5]> {
    let mut random = StdRng::seed_from_u64(seed);
    let mut draw = |j: usize| random.random_range(if j == BOOM { 0.0..0.5 } else { -0.9..0.9 });
    (0..60).map(|_| std::array::from_fn(&mut draw)).collect()
}

fn rig(folder: &Path) -> Rig {
    Rig::read_measured(&folder.join("boomer.urdf")).expect("a description")
}

fn read(folder: &Path) -> Result<Measurements, MeasurementsError> {
    let session = Session::read(folder).expect("well formed");
    Measurements::of_sessions(&[("boom".to_owned(), session)], &rig(folder))
}

fn placement() -> Isometry3<f64> {
    Isometry3::new(Vector3::new(0.5, -0.2, 0.1), Vector3::new(0.1, 0.2, -0.7))
}

/// A session in a folder, with effects hidden in what was measured.
fn made(hidden: &[(&str, &str, &[f64])], seed: u64) -> (tempfile::TempDir, Measurements) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rows = rows(seed);
    write(folder.path(), RIGHT, &rows, &vec![Vector3::zeros(); rows.len()]);
    let exact = read(folder.path()).expect("usable");
    let effects: Vec<Present> =
        hidden.iter().map(|(id, site, values)| present(&exact, id, site, values)).collect();
    let truth = Assumed { effects, placements: vec![placement()], ..Assumed::default() };
    let mut random = StdRng::seed_from_u64(seed + 100);
    let mut at = |row| {
        let exact = exact.predict(row, &truth).expect("an arm");
        Vector3::from_fn(|c, _| exact[c] + NOISE_M * normal(&mut random))
    };
    let measured: Vec<Vector3<f64>> = exact.rows.iter().map(&mut at).collect();
    write(folder.path(), RIGHT, &rows, &measured);
    let made = read(folder.path()).expect("usable");
    (folder, made)
}

fn looked_at(measurements: &Measurements) -> Result<Finding, GapError> {
    let found =
        find(measurements, &Options { show: false, advise: false, ..Options::default() }, &Unattended);
    if let Ok(finding) = &found {
        println!("{:?} {}", finding.verdict, finding.sentence);
    }
    found
}

#[test]
fn what_is_wrong_with_a_joint_that_slides_is_found_in_meters() {
    for (id, parameter, value) in
        [("joint-zero", "offset_m", 0.008), ("joint-scale", "scale", 0.02), ("backlash", "width_m", 0.004)]
    {
        let (_keep, measurements) = made(&[(id, "boom", &[value])], 1);
        let found = looked_at(&measurements).expect("can be looked at");
        let has = |effect: &plumbline_gap::finding::NamedEffect| {
            effect.class.iter().any(|member| member.id == id && member.site == "boom")
        };
        let effect = found.effects.iter().find(|effect| has(effect));
        let effect = effect.unwrap_or_else(|| panic!("{id} was hidden: {}", found.sentence));
        if effect.id == id {
            let one = &effect.parameters[0];
            assert_eq!(one.name, parameter);
            assert!(one.low <= value && value <= one.high, "{one:?}");
        }
        let unit = if parameter == "scale" { "%" } else { "mm" };
        assert!(effect.id != id || found.sentence.contains(unit), "{}", found.sentence);
    }
    // An elbow beside it is found as ever.
    let (_keep, measurements) = made(&[("joint-zero", "bend", &[0.02])], 2);
    let found = looked_at(&measurements).expect("can be looked at");
    assert!(
        found.effects.iter().any(|effect| effect.id == "joint-zero" && effect.site == "bend"),
        "{}",
        found.sentence
    );
}

#[test]
fn a_boom_has_no_zero_of_an_angle_and_no_torque() {
    let (_keep, measurements) = made(&[], 3);
    let at_boom: Vec<Effect> =
        Effect::candidates(&measurements).into_iter().filter(|effect| effect.site == "boom").collect();
    let mut kinds: Vec<&str> = at_boom.iter().map(Effect::id).collect();
    kinds.dedup();
    assert_eq!(kinds, ["joint-zero", "joint-scale", "backlash", "sideways-give", "axis-skew"]);
    let found = looked_at(&measurements).expect("can be looked at");
    assert!(found.effects.is_empty(), "{}", found.sentence);
}

#[test]
fn tangents_are_the_slope_of_the_prediction() {
    let (_keep, measurements) = made(&[], 4);
    let candidates = Effect::candidates(&measurements);
    let start = Assumed { placements: vec![placement()], ..Assumed::default() };
    for row in measurements.rows.iter().step_by(17) {
        let tangents = measurements.tangents(row, &start, &candidates).expect("predictable");
        let mut column = 0;
        for effect in &candidates {
            for (k, parameter) in effect.parameters().iter().enumerate() {
                let with = |share: f64| {
                    let mut values = vec![0.0; effect.parameters().len()];
                    values[k] = share * parameter.typical;
                    let effects = vec![Present { effect: effect.clone(), values }];
                    measurements.predict(row, &Assumed { effects, ..start.clone() }).expect("predictable")
                };
                let (ahead, back) = (with(1e-4), with(-1e-4));
                for c in 0..3 {
                    let slope = (ahead[c] - back[c]) / 2e-4;
                    let off = (slope - tangents.effects[(c, column)]).abs();
                    assert!(off < 1e-6, "{} {k}: {slope} {}", effect.name(), tangents.effects[(c, column)]);
                }
                column += 1;
            }
        }
    }
}

#[test]
fn a_session_is_predicted_through_the_slide_and_through_the_model() {
    let (folder, _) = made(&[("joint-zero", "boom", &[0.008])], 5);
    let (session, rig) = (Session::read(folder.path()).expect("a session"), rig(folder.path()));
    let nominal = predict_session(&session, &rig, None).expect("predicted").poses;
    // Column and boom alone, by hand: the boom runs out along the turned x.
    let first = rows(5)[0];
    let mut still = first;
    still[BOOM] = 0.0;
    let other = tempfile::tempdir().expect("a temporary folder");
    write(other.path(), RIGHT, &[still], &[Vector3::zeros()]);
    let drawn_in =
        predict_session(&Session::read(other.path()).expect("a session"), &rig, None).expect("predicted");
    let [out_there, at_rest] = [nominal[0], drawn_in.poses[0]].map(|pose| pose.expect("a frame").tip);
    let out = out_there.coords.coords - at_rest.coords.coords;
    let along = Vector3::new(first[0].cos(), first[0].sin(), 0.0) * first[BOOM];
    assert!((out - along).norm() < 1e-12, "{out} {along}");
    let mut model = RigModel::nominal(&rig);
    let effect = ModelEffect {
        id: "joint-zero".to_owned(),
        site: "boom".to_owned(),
        title: String::new(),
        tip: Some("tool".to_owned()),
        shape: None,
        reference_s: 0.0,
        values: vec![0.008],
        covariance: vec![],
        probability: Some(0.9),
        parameters: vec![],
    };
    let external = PlacedExternal {
        session: "boom".to_owned(),
        frame: None,
        external_from_robot: placement(),
        tip_from_marker: Isometry3::identity(),
    };
    let addition = Addition {
        effects: vec![effect],
        screens: vec![],
        externals: vec![external],
        eyes: vec![],
        together: vec![],
        replaces: false,
        at: jiff::Timestamp::UNIX_EPOCH,
        sentence: String::new(),
        sessions: vec!["boom".to_owned()],
        version: String::new(),
        gap: None,
    };
    model.add(&rig, addition).expect("the boom is a place of this robot");
    let predicted = predict_session_with(&session, &rig, None, &model).expect("predicted").poses;
    let table = session.poses.as_ref().expect("poses");
    for (row, predicted) in table.rows().zip(predicted) {
        let predicted = predicted.expect("a frame");
        let off: Vector3<f64> = row.measured.expect("measured").coords - predicted.tip.coords;
        assert!(off.norm() < 5.0 * NOISE_M, "{off:?}");
    }
}

#[test]
fn columns_in_the_unit_of_another_motion_are_refused_in_words() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rows = rows(6);
    let places = vec![Vector3::zeros(); rows.len()];
    for (units, words) in [
        (["rad"; 5], ["boom slides", "cmd_boom_m"]),
        (["rad", "m", "m", "rad", "rad"], ["lift turns", "cmd_lift_rad"]),
    ] {
        write(folder.path(), units, &rows, &places);
        let error = read(folder.path()).expect_err("another unit").to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
    let millimeters: Vec<[f64; 5]> = rows
        .iter()
        .map(|row| std::array::from_fn(|j| if j == BOOM { 1e3 * (0.05 + row[j]) } else { row[j] }))
        .collect();
    write(folder.path(), RIGHT, &millimeters, &places);
    let error = Session::read(folder.path()).expect_err("in millimeters").to_string();
    assert!(error.contains("cmd_boom_m") && error.contains("millimeters"), "{error}");
}

#[test]
fn a_boom_that_runs_the_other_way_is_refused_by_name() {
    let (_keep, mut measurements) = made(&[("joint-zero", "bend", &[0.01])], 7);
    for row in &mut measurements.rows {
        row.commanded_rad.iter_mut().for_each(|values| values[BOOM] *= -1.0);
    }
    match looked_at(&measurements) {
        Err(GapError::OtherTurn { joint, turns, .. }) => {
            assert_eq!((&*joint, turns), ("boom", Turns::TheOtherWay))
        }
        other => panic!("a joint is wrong, not {:?}", other.map(|finding| finding.sentence)),
    }
}
