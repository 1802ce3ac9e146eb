//! A made-up session that the model measured itself is predicted exactly.
#![allow(clippy::print_stdout, reason = "a skipped test says why")]

use super::*;
use crate::measured_data;
use crate::session::{LocalizationRow, Manifest, PoseRow, PoseTable, TouchRow};

fn nico() -> Rig {
    Rig::built_in("nico").expect("the rig that comes with the program is tested")
}

fn arm_joints() -> Vec<String> {
    // Another order than the chain's: columns are found by name.
    ["r_wrist_x", "r_wrist_z", "r_elbow_y", "r_arm_x", "r_shoulder_y", "r_shoulder_z"]
        .map(str::to_owned)
        .into()
}

fn empty(rig: &Rig) -> Session {
    Session::new(Manifest {
        touchscreen: Some(rig.touchscreen.clone()),
        chain: Some(SessionChain { tip: "right_index_tip".to_owned(), joints: arm_joints() }),
        ..Manifest::of_rig("nico", jiff::Timestamp::UNIX_EPOCH)
    })
}

fn touched(commanded_rad: [f64; 6], encoder_rad: Option<[f64; 6]>, screen_height_m: f64) -> TouchRow {
    TouchRow {
        commanded_rad: commanded_rad.map(Some).into(),
        encoder_rad: encoder_rad.map_or(vec![None; 6], |angles| angles.map(Some).into()),
        touch: Some(Pixel::new(900.0, 500.0)),
        screen_height_m: Some(screen_height_m),
        ..TouchRow::default()
    }
}

const POINTING_RAD: [f64; 6] = [0.74, 1.05, 1.62, 0.42, 0.33, 0.02];

fn tip_at(rig: &Rig, reversed_rad: [f64; 6]) -> Point<Robot> {
    let chain = rig.chain("right_index_tip").expect("a tip");
    let angles: Vec<f64> = reversed_rad.into_iter().rev().collect();
    chain.robot_from_tip(&angles) * Point::<Tip>::new(0.0, 0.0, 0.0)
}

#[test]
fn touches_land_where_the_fingertip_stands_over_the_glass() {
    let rig = nico();
    let moved_rad = POINTING_RAD.map(|angle| angle + 0.02);
    let rows = [
        touched(POINTING_RAD, None, 0.0),
        touched(POINTING_RAD, Some(moved_rad), 0.0),
        touched(POINTING_RAD, None, 0.03),
    ];
    let mut session = empty(&rig);
    session.touches = Some(TouchTable::from_rows(arm_joints(), &rows));
    let predicted = predict_session(&session, &rig, None).expect("predicted").touches;
    assert_eq!(
        predicted.iter().map(|p| p.angles).collect::<Vec<_>>(),
        [Angles::Commanded, Angles::Encoder, Angles::Commanded]
    );
    for (prediction, tip) in
        predicted.iter().zip([POINTING_RAD, moved_rad].map(|angles| tip_at(&rig, angles)))
    {
        let normal = rig.touchscreen.normal().vector();
        let foot = rig.touchscreen.point_at(prediction.touch);
        let back = Point::from(foot.coords + normal * prediction.above_glass_m);
        assert!(back.distance_m(&tip) < 1e-12, "{prediction:?}");
    }
    assert!((predicted[0].above_glass_m - predicted[2].above_glass_m - 0.03).abs() < 1e-12, "the block");
    let moved = rig.touchscreen.moved(&nalgebra::Isometry3::translation(0.01, 0.0, 0.0));
    let on_moved = predict_session(&session, &rig, Some(&moved)).expect("predicted").touches[0];
    // v grows toward the robot: a screen that lies 10 mm farther away is touched 10 mm lower.
    let shift_px = 0.01 / rig.touchscreen.pitch_m()[1];
    assert!((on_moved.touch.v_px - predicted[0].touch.v_px - shift_px).abs() < 1e-9);
}

#[test]
fn image_points_are_predicted_and_triangulated_to_the_place_they_show() {
    let rig = nico();
    let truth = Point::<Robot>::new(0.42, -0.11, 0.05);
    let row = LocalizationRow {
        truth: Some(truth),
        left: Some(Pixel::new(320.0, 240.0)),
        right: Some(Pixel::new(310.0, 240.0)),
        head_rad: vec![Some(-0.6), None],
        ..LocalizationRow::default()
    };
    let joints = vec!["head_y".to_owned(), "head_z".to_owned()];
    let mut session = empty(&rig);
    session.localizations = Some(LocalizationTable::from_rows(joints.clone(), std::slice::from_ref(&row)));
    let first = predict_session(&session, &rig, None).expect("predicted").localizations[0];
    assert_eq!(first.estimate, Some(truth));
    let (left, right) = first.pixels.expect("the table has image points");
    // Had the eyes measured that, the place would have been found.
    let measured = LocalizationRow { left: Some(left), right: Some(right), ..row };
    session.localizations = Some(LocalizationTable::from_rows(joints, &[measured]));
    let again = predict_session(&session, &rig, None).expect("predicted").localizations[0];
    assert!(again.corrected.expect("triangulated").distance_m(&truth) < 1e-6);
    assert!(first.corrected != again.corrected);
}

#[test]
fn an_estimate_without_image_points_is_what_the_model_infers() {
    let rig = nico();
    let (truth, estimate) = (Point::new(0.4, 0.1, 0.05), Point::new(0.43, 0.12, 0.07));
    let row = LocalizationRow { truth: Some(truth), estimate: Some(estimate), ..LocalizationRow::default() };
    let mut session = empty(&rig);
    session.localizations = Some(LocalizationTable::from_rows(vec![], &[row]));
    let predicted = predict_session(&session, &rig, None).expect("predicted").localizations[0];
    assert_eq!(
        (predicted.estimate, predicted.pixels, predicted.corrected),
        (Some(truth), None, Some(estimate))
    );
}

#[test]
fn poses_are_where_the_kinematics_put_the_tip() {
    let rig = nico();
    let row = PoseRow {
        encoder_rad: POINTING_RAD.map(Some).into(),
        measured: Some(Point::new(1.0, 2.0, 3.0)),
        ..PoseRow::default()
    };
    let mut session = empty(&rig);
    session.poses = Some(PoseTable::from_rows(arm_joints(), &[row]));
    let predicted = predict_session(&session, &rig, None).expect("predicted").poses;
    assert!(predicted[0].expect("there").tip.distance_m(&tip_at(&rig, POINTING_RAD)) < 1e-12);
}

/// The pointing arm, measured at this tip.
fn pointing_at(tip: Option<&str>) -> PoseRow {
    PoseRow {
        encoder_rad: POINTING_RAD.map(Some).into(),
        measured: Some(Point::new(1.0, 2.0, 3.0)),
        tip: tip.map(str::to_owned),
        ..PoseRow::default()
    }
}

#[test]
fn a_pose_of_another_marker_is_where_the_kinematics_put_that_one() {
    let rig = nico();
    let rows =
        [pointing_at(None), pointing_at(Some("right_palm_center")), pointing_at(Some("right_index_tip"))];
    let mut session = empty(&rig);
    session.poses = Some(PoseTable::from_rows(arm_joints(), &rows));
    let predicted = predict_session(&session, &rig, None).expect("predicted").poses;
    let predicted: Vec<PosePrediction> = predicted.into_iter().map(|pose| pose.expect("a frame")).collect();
    let palm = rig.chain("right_palm_center").expect("a frame of the hand");
    let angles: Vec<f64> = POINTING_RAD.into_iter().rev().collect();
    let palm = palm.robot_from_tip(&angles) * Point::<Tip>::new(0.0, 0.0, 0.0);
    assert!(predicted[1].tip.distance_m(&palm) < 1e-12);
    for of_chain in [predicted[0], predicted[2]] {
        assert!(of_chain.tip.distance_m(&tip_at(&rig, POINTING_RAD)) < 1e-12);
        assert!(of_chain.tip.distance_m(&palm) > 0.03, "another place");
    }
}

#[test]
fn a_marker_that_nobody_declared_has_no_prediction_and_the_others_have_theirs() {
    let rig = nico();
    let mut session = empty(&rig);
    // The other hand hangs on joints that were not logged.
    let rows = [
        pointing_at(None),
        pointing_at(Some("toe")),
        pointing_at(Some("toe")),
        pointing_at(Some("left_palm_center")),
    ];
    session.poses = Some(PoseTable::from_rows(arm_joints(), &rows));
    let predicted = predict_session(&session, &rig, None).expect("predicted");
    assert!(predicted.poses[0].expect("there").tip.distance_m(&tip_at(&rig, POINTING_RAD)) < 1e-12);
    assert_eq!(predicted.poses[1..], [None; 3]);
    let told: Vec<_> =
        predicted.tips.iter().map(|one| (one.tip.as_str(), one.rows, one.place.word())).collect();
    assert_eq!(
        told,
        [("right_index_tip", 1, "description"), ("toe", 2, "none"), ("left_palm_center", 1, "none")]
    );
    assert!(
        predicted.tips[1].words.starts_with("not predicted: ") && predicted.tips[1].words.contains("toe")
    );
    assert!(predicted.tips[2].words.contains("l_"), "{}", predicted.tips[2].words);
}

#[test]
fn a_marker_that_was_mounted_anew_is_told_from_its_frame() {
    let rig = nico();
    let row = |tip: Option<&str>| PoseRow {
        encoder_rad: POINTING_RAD.map(Some).into(),
        tip: tip.map(str::to_owned),
        ..PoseRow::default()
    };
    let mut session = empty(&rig);
    session.poses = Some(PoseTable::from_rows(arm_joints(), &[row(None), row(Some("right_palm_center"))]));
    let chain = toml::Table::from_iter([("tip_place".to_owned(), toml::Value::from("unknown"))]);
    session.manifest.extra.insert("chain".to_owned(), toml::Value::Table(chain));
    let tips = predict_session(&session, &rig, None).expect("predicted").tips;
    assert_eq!(
        tips.iter().map(|one| &one.place).collect::<Vec<_>>(),
        [&TipPlace::Frame, &TipPlace::Description]
    );
    assert!(tips[0].words.contains("mounted anew") && !tips[0].place.is_comparable(), "{}", tips[0].words);
}

#[test]
fn what_does_not_fit_together_is_said() {
    let rig = nico();
    let mut session = empty(&rig);
    let mut half = touched(POINTING_RAD, None, 0.0);
    half.commanded_rad[2] = None;
    session.touches = Some(TouchTable::from_rows(arm_joints(), &[touched(POINTING_RAD, None, 0.0), half]));
    let message =
        |session: &Session| predict_session(session, &rig, None).expect_err("does not fit").to_string();
    assert!(message(&session).contains("row 2") && message(&session).contains("r_elbow_y"));
    let mut other = session.clone();
    other.manifest.chain =
        Some(SessionChain { tip: "right_index_tip".to_owned(), joints: vec!["r_elbow_y".into()] });
    assert!(message(&other).contains("r_shoulder_z"), "{}", message(&other));
    other.manifest.chain = Some(SessionChain { tip: "toe".to_owned(), joints: arm_joints() });
    assert!(message(&other).contains("toe"));
    other = session.clone();
    other.manifest.touchscreen = None;
    assert!(message(&other).contains("touchscreen"));
    let mut flat = rig.touchscreen.clone();
    flat.width_m = 0.0;
    other.manifest.touchscreen = Some(flat);
    assert!(message(&other).contains("no usable size"));
}

#[test]
fn the_real_touches_land_some_millimeters_beside_where_they_were_measured() {
    let folder = match measured_data::folder("nico-touch/touch-245") {
        Ok(folder) => folder,
        Err(skipped) => return println!("{skipped}"),
    };
    let session = Session::read(&folder).expect("readable");
    let predicted = predict_session(&session, &nico(), None).expect("predicted").touches;
    let table = session.touches.expect("touches");
    assert_eq!(predicted.len(), 245);
    let off_px = |(prediction, row): (&TouchPrediction, TouchRow)| {
        prediction.touch.distance_px(&row.touch.expect("touched"))
    };
    let mut off_px: Vec<f64> = predicted.iter().zip(table.rows()).map(off_px).collect();
    off_px.sort_by(f64::total_cmp);
    // The screen of that session was placed by hand: centimeters, not decimeters.
    assert!((4.0..200.0).contains(&off_px[122]), "median {} px", off_px[122]);
}
