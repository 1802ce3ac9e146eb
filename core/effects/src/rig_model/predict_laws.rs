//! Sessions are predicted with the effects of a model.

use nalgebra::{Isometry3, Vector3};
use plumbline_model::predict::{SessionPrediction, TipPlace, predict_session};
use plumbline_model::robot::Rig;
use plumbline_model::session::{
    Chain, LocalizationRow, LocalizationTable, Manifest, PoseRow, PoseTable, RigReference, Session, TouchRow,
    TouchTable, Touchscreen,
};
use plumbline_model::{Pixel, Point, Robot};

use super::tests::{TIP, effect, nico, with};
use super::*;
use crate::{Assumed, Measurements};

const POINTING_RAD: [f64; 6] = [0.02, 0.33, 0.42, 1.62, 1.05, 0.74];

fn joints() -> Vec<String> {
    ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"]
        .map(str::to_owned)
        .into()
}

fn head() -> Vec<String> {
    vec!["head_z".to_owned(), "head_y".to_owned()]
}

fn places() -> [Point<Robot>; 3] {
    [Point::new(0.42, -0.11, 0.05), Point::new(0.35, 0.2, 0.12), Point::new(0.55, 0.0, 0.02)]
}

/// Touches, poses and localizations; some were not measured.
fn session(rig: &Rig) -> Session {
    let touch = |k: usize| TouchRow {
        commanded_rad: POINTING_RAD.map(|angle| Some(angle + 0.01 * k as f64)).into(),
        encoder_rad: if k == 1 { POINTING_RAD.map(Some).into() } else { vec![None; 6] },
        touch: (k != 2).then(|| Pixel::new(900.0, 500.0)),
        screen_height_m: Some(0.03 * (k % 2) as f64),
        approach: Some(if k.is_multiple_of(2) { "plus" } else { "minus" }.to_owned()),
        t_secs: Some(100.0 * k as f64),
        ..TouchRow::default()
    };
    let pose = |k: usize| PoseRow {
        encoder_rad: POINTING_RAD.map(|angle| Some(angle - 0.02 * k as f64)).into(),
        measured: (k != 1).then(|| Point::new(1.0, 2.0, 3.0)),
        ..PoseRow::default()
    };
    let seen = |place: &Point<Robot>| LocalizationRow {
        truth: Some(*place),
        left: Some(Pixel::new(320.0, 240.0)),
        right: Some(Pixel::new(310.0, 240.0)),
        head_rad: vec![Some(0.1), Some(-0.6)],
        t_secs: Some(500.0),
        background_m: Some(1.5),
        ..LocalizationRow::default()
    };
    Session {
        manifest: Manifest {
            rig: RigReference::Named("nico".to_owned()),
            started: jiff::Timestamp::UNIX_EPOCH,
            operator: String::new(),
            notes: String::new(),
            touchscreen: Some(rig.touchscreen.clone()),
            chain: Some(Chain { tip: TIP.to_owned(), joints: joints() }),
            extra: toml::Table::new(),
        },
        touches: Some(TouchTable::from_rows(joints(), &[0, 1, 2, 3].map(touch))),
        localizations: Some(LocalizationTable::from_rows(head(), &places().each_ref().map(seen))),
        poses: Some(PoseTable::from_rows(joints(), &[0, 1].map(pose))),
        stereo: Default::default(),
        log: None,
    }
}

#[test]
fn without_effects_predictions_are_nominal_to_the_last_bit() {
    let (rig, model) = (nico(), RigModel::nominal(&nico()));
    let session = session(&rig);
    let moved = rig.touchscreen.moved(&Isometry3::translation(0.01, 0.0, 0.0));
    for screen in [None, Some(&moved)] {
        let nominal = predict_session(&session, &rig, screen).expect("predicted");
        assert_eq!(predict_session_with(&session, &rig, screen, &model).expect("predicted"), nominal);
    }
}

#[test]
fn effects_of_size_zero_change_nothing() {
    let rig = nico();
    let session = session(&rig);
    let effects = vec![
        effect("joint-zero", "r_elbow_y", &[0.0]),
        effect("screen-scale", "screen", &[0.0, 0.0]),
        ModelEffect { tip: None, ..effect("camera-mount", "eyes", &[0.0; 6]) },
    ];
    let nominal = predict_session(&session, &rig, None).expect("predicted");
    let same = predict_session_with(&session, &rig, None, &with(&rig, effects)).expect("predicted");
    for (a, b) in nominal.touches.iter().zip(&same.touches) {
        assert!(a.touch.distance_px(&b.touch) < 1e-9 && (a.above_glass_m - b.above_glass_m).abs() < 1e-12);
        assert_eq!(a.angles, b.angles);
    }
    for (a, b) in nominal.poses.iter().flatten().zip(same.poses.iter().flatten()) {
        assert!(a.tip.distance_m(&b.tip) < 1e-12);
    }
    for (a, b) in nominal.localizations.iter().zip(&same.localizations) {
        let near = |a: Option<Point<Robot>>, b: Option<Point<Robot>>| {
            a.expect("there").distance_m(&b.expect("there")) < 1e-6
        };
        assert!(near(a.estimate, b.estimate) && near(a.corrected, b.corrected));
        let ((left, right), (same_left, same_right)) = (a.pixels.expect("there"), b.pixels.expect("there"));
        assert!(left.distance_px(&same_left) < 1e-9 && right.distance_px(&same_right) < 1e-9);
    }
}

/// A wrong zero is a wrong angle: the nominal robot with other angles is predicted the same.
#[test]
fn a_wrong_zero_is_the_nominal_robot_with_another_angle() {
    let rig = nico();
    let session = session(&rig);
    let model = with(&rig, vec![effect("joint-zero", "r_elbow_y", &[0.04])]);
    let predicted = predict_session_with(&session, &rig, None, &model).expect("predicted");
    let mut turned = session.clone();
    let turn = |angles: &mut Vec<Option<f64>>| angles[3] = angles[3].map(|angle| angle + 0.04);
    let rows: Vec<TouchRow> = session.touches.iter().flat_map(TouchTable::rows).collect();
    let rows: Vec<TouchRow> = rows
        .into_iter()
        .map(|mut row| {
            turn(&mut row.commanded_rad);
            turn(&mut row.encoder_rad);
            row
        })
        .collect();
    turned.touches = Some(TouchTable::from_rows(joints(), &rows));
    let nominal = predict_session(&turned, &rig, None).expect("predicted");
    assert_eq!(predicted.touches.len(), 4, "also rows in which nothing was touched");
    for (a, b) in predicted.touches.iter().zip(&nominal.touches) {
        assert!(a.touch.distance_px(&b.touch) < 1e-6 && (a.above_glass_m - b.above_glass_m).abs() < 1e-9);
    }
    let plain = predict_session(&session, &rig, None).expect("predicted");
    let mut poses = plain.poses.iter().flatten().zip(predicted.poses.iter().flatten());
    assert!(poses.all(|(a, b)| a.tip.distance_m(&b.tip) > 1e-3));
}

#[test]
fn effects_follow_the_columns_of_their_row() {
    let rig = nico();
    let session = session(&rig);
    let nominal = predict_session(&session, &rig, None).expect("predicted").touches;
    let off = |effect: ModelEffect| -> Vec<bool> {
        let model = with(&rig, vec![effect]);
        let predicted = predict_session_with(&session, &rig, None, &model).expect("predicted").touches;
        nominal.iter().zip(&predicted).map(|(a, b)| a.touch.distance_px(&b.touch) > 1.0).collect()
    };
    let slipped = ModelEffect { shape: Some(150.0), ..effect("slipped-horn", "r_elbow_y", &[0.05]) };
    assert_eq!(off(slipped), [false, false, true, true], "rows at 0, 100, 200 and 300 s");
    // The second row has encoders, which see what the servo gives way by.
    assert_eq!(off(effect("servo-droop", "r_elbow_y", &[0.2])), [true, false, true, true]);
    assert_eq!(off(effect("joint-sag", "r_elbow_y", &[0.2])), [true; 4]);
}

fn placed(session: &str, frame: Option<&str>, external_from_robot: Isometry3<f64>) -> PlacedExternal {
    PlacedExternal {
        session: session.to_owned(),
        frame: frame.map(str::to_owned),
        external_from_robot,
        tip_from_marker: Isometry3::identity(),
    }
}

#[test]
fn poses_are_in_the_frame_of_their_label_and_of_the_marker_that_was_mounted_anew() {
    let rig = nico();
    let (hall, yard) = (Isometry3::translation(1.0, 0.0, 0.0), Isometry3::translation(0.0, 5.0, 0.0));
    let mount = Isometry3::new(Vector3::new(0.01, 0.02, -0.03), Vector3::new(0.0, 0.0, 0.4));
    let mut model = with(&rig, vec![effect("joint-zero", "r_elbow_y", &[0.04])]);
    let in_hall = PlacedExternal { tip_from_marker: mount, ..placed("first", Some("hall"), hall) };
    model.contents.externals = vec![in_hall, placed("second", Some("yard"), yard)];
    let of = |keys: &str| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut session = session(&rig);
        (session.touches, session.localizations) = (None, None);
        session.write(folder.path()).expect("written");
        let file = folder.path().join("session.toml");
        let text = std::fs::read_to_string(&file).expect("readable");
        std::fs::write(&file, text.replace("[chain]\n", keys)).expect("written");
        let read = Session::read(folder.path()).expect("a session");
        predict_session_with(&read, &rig, None, &model).expect("predicted")
    };
    let plain = of("[external]\nframe = \"yard\"\n[chain]\n");
    let anew = of("[external]\nframe = \"hall\"\n[chain]\ntip_place = \"unknown\"\n");
    for (plain, anew) in plain.poses.iter().flatten().zip(anew.poses.iter().flatten()) {
        let tip = yard.inverse() * plain.tip.coords;
        let robot_from_tip = Isometry3::from_parts(tip.coords.into(), plain.turn);
        let marker = hall * robot_from_tip * mount;
        assert!((marker.translation.vector - anew.tip.coords.coords).norm() < 1e-9);
        assert!(marker.rotation.angle_to(&anew.turn) < 1e-9);
    }
    assert!(model.external(Some("roof")).is_none(), "nobody placed that frame");
    // Which place was taken is told: the frame's, the marker's, or the frame's although the marker sits elsewhere.
    let place = |told: &SessionPrediction| told.tips.iter().map(|one| one.place.clone()).collect::<Vec<_>>();
    assert_eq!(place(&plain), [TipPlace::Description]);
    assert_eq!(place(&anew), [TipPlace::Model { session: "first".to_owned() }]);
    let elsewhere = of("[external]\nframe = \"yard\"\n[chain]\ntip_place = \"unknown\"\n");
    assert_eq!(place(&elsewhere), [TipPlace::Frame]);
    let silent = of("[external]\nframe = \"hall\"\n[chain]\n");
    assert!(silent.tips[0].words.contains("that was not used"), "{}", silent.tips[0].words);
}

/// The nominal place of such a row stands in the robot's frame, the others in the external one.
#[test]
fn rows_of_the_other_arm_are_not_predicted_with_the_model_of_this_one() {
    const OTHER: &str = "left_palm_center";
    let rig = nico();
    let model = with(&rig, vec![effect("joint-zero", "r_elbow_y", &[0.04])]);
    let both: Vec<String> =
        joints().into_iter().chain(joints().iter().map(|joint| joint.replacen('r', "l", 1))).collect();
    let row = |tip: Option<&str>| PoseRow {
        encoder_rad: [POINTING_RAD, POINTING_RAD].concat().into_iter().map(Some).collect(),
        measured: Some(Point::new(1.0, 2.0, 3.0)),
        tip: tip.map(str::to_owned),
        ..PoseRow::default()
    };
    for tips in [[None, Some(OTHER)], [Some(OTHER); 2]] {
        let mut session = session(&rig);
        (session.touches, session.localizations) = (None, None);
        session.manifest.chain = Some(Chain { tip: TIP.to_owned(), joints: both.clone() });
        session.poses = Some(PoseTable::from_rows(both.clone(), &tips.map(row)));
        let nominal = predict_session(&session, &rig, None).expect("predicted");
        assert!(nominal.poses.iter().all(Option::is_some), "its joints were logged");
        let predicted = predict_session_with(&session, &rig, None, &model).expect("predicted");
        let is_there: Vec<bool> = predicted.poses.iter().map(Option::is_some).collect();
        assert_eq!(is_there, tips.map(|tip| tip.is_none()));
        let told = predicted.tips.iter().find(|one| one.tip == OTHER).expect("told");
        assert!(told.place == TipPlace::Nowhere && told.words.starts_with("not predicted: "), "{told:?}");
        assert_eq!(predicted.tips.iter().map(|one| one.rows).sum::<usize>(), 2);
    }
}

#[test]
fn the_models_screen_and_external_frame_are_used() {
    let rig = nico();
    let session = session(&rig);
    let motion = Isometry3::new(Vector3::new(0.02, 0.0, -0.01), Vector3::new(0.0, 0.0, 0.1));
    let mut model = with(&rig, vec![effect("joint-zero", "r_elbow_y", &[0.04])]);
    let without = predict_session_with(&session, &rig, None, &model).expect("predicted");
    model.contents.screens = vec![PlacedScreen::moved("morning", &rig.touchscreen, &motion)];
    model.contents.externals = vec![placed("morning", None, motion)];
    let placed = predict_session_with(&session, &rig, None, &model).expect("predicted");
    // The robot moved against the screen, or the screen the other way: the tip is at the same place.
    let lies = model.screen(&rig.touchscreen).expect("placed");
    for (k, (a, b)) in without.touches.iter().zip(&placed.touches).enumerate() {
        let tip = |screen: &Touchscreen, touch: Pixel<_>, above_m: f64| {
            let raised = screen.raised(0.03 * (k % 2) as f64);
            raised.point_at(touch).coords + screen.normal().vector() * above_m
        };
        let (on_nominal, on_placed) =
            (tip(&rig.touchscreen, a.touch, a.above_glass_m), tip(lies, b.touch, b.above_glass_m));
        assert!((on_nominal - on_placed).norm() < 1e-9 && a.touch.distance_px(&b.touch) > 10.0);
    }
    for (a, b) in without.poses.iter().flatten().zip(placed.poses.iter().flatten()) {
        assert!(((motion * a.tip.coords) - b.tip.coords).norm() < 1e-12);
    }
    // A screen that is given is used in any case.
    let given = predict_session_with(&session, &rig, Some(&rig.touchscreen), &model).expect("predicted");
    assert_eq!(given.touches, without.touches);
}

#[test]
fn places_are_inferred_through_the_deviating_eyes() {
    let rig = nico();
    let first = session(&rig);
    for (id, site, shape, values) in [
        ("camera-mount", "eyes", None, vec![0.01, -0.005, 0.008, 0.02, -0.02, 0.01]),
        ("head-joint", "head_y", None, vec![0.03]),
        ("image-shift", "right", None, vec![1.5, -0.5]),
        ("eye-yaw", "right", None, vec![0.008]),
        ("eye-yaw", "right", Some(crate::Effect::yaw_growth(240.0, 60.0)), vec![0.01]),
        ("focal-or-baseline", "eyes", None, vec![0.02]),
        ("background-bleed", "eyes", None, vec![0.2]),
        ("seen-surface", "eyes", None, vec![0.02]),
    ] {
        let one = ModelEffect { tip: None, shape, ..effect(id, site, &values) };
        let model = with(&rig, vec![one]);
        let predicted = predict_session_with(&first, &rig, None, &model).expect("predicted").localizations;
        let seen = |k: usize, pixels: bool| {
            let (left, right) = predicted[k].pixels.expect("in view");
            LocalizationRow {
                truth: Some(places()[k]),
                estimate: predicted[k].estimate.filter(|_| !pixels),
                left: pixels.then_some(left),
                right: pixels.then_some(right),
                head_rad: vec![Some(0.1), Some(-0.6)],
                t_secs: Some(500.0),
                background_m: Some(1.5),
                ..LocalizationRow::default()
            }
        };
        for pixels in [true, false] {
            let mut again = first.clone();
            again.localizations =
                Some(LocalizationTable::from_rows(head(), &[0, 1, 2].map(|k| seen(k, pixels))));
            let nominal = predict_session(&again, &rig, None).expect("predicted").localizations;
            let inferred = predict_session_with(&again, &rig, None, &model).expect("predicted").localizations;
            for (k, truth) in places().iter().enumerate() {
                let off_m = inferred[k].corrected.expect("inferred").distance_m(truth);
                assert!(off_m < 1e-6, "{id} {k}: {off_m}");
                let before_m = nominal[k].corrected.expect("triangulated").distance_m(truth);
                assert!(before_m > 1e-3, "{id} does something: {before_m}");
            }
        }
    }
}

#[test]
fn effects_of_the_other_arm_and_of_another_tip_stay_there() {
    let rig = nico();
    let session = session(&rig);
    let nominal = predict_session(&session, &rig, None).expect("predicted");
    let left =
        ModelEffect { tip: Some("left_index_tip".into()), ..effect("joint-zero", "l_elbow_y", &[0.04]) };
    let palm = ModelEffect {
        tip: Some("right_palm_center".into()),
        ..effect("tip-offset", "tip", &[0.01, 0.0, 0.0])
    };
    let model = with(&rig, vec![left, palm]);
    let predicted = predict_session_with(&session, &rig, None, &model).expect("predicted");
    for (a, b) in nominal.touches.iter().zip(&predicted.touches) {
        assert!(a.touch.distance_px(&b.touch) < 1e-9);
    }
}

/// What a search starts with is what the model predicts.
#[test]
fn a_search_for_more_starts_with_the_models_effects() {
    let rig = nico();
    let session = session(&rig);
    let model = with(
        &rig,
        vec![
            effect("joint-zero", "r_elbow_y", &[0.04]),
            ModelEffect { tip: None, ..effect("eye-yaw", "right", &[0.008]) },
        ],
    );
    let nominal = Measurements::of_sessions(&[("one".to_owned(), session)], &rig).expect("usable");
    let measurements = model.put_into(nominal.clone());
    let assumed = Assumed { effects: model.present_in(&nominal), ..Assumed::nominal(&nominal) };
    for row in &measurements.rows {
        let here = measurements.predict(row, &Assumed::nominal(&measurements)).expect("predictable");
        assert_eq!(Some(&here), nominal.predict(row, &assumed).as_ref());
        let tangents =
            measurements.tangents(row, &Assumed::nominal(&measurements), &[]).expect("predictable");
        for (a, b) in tangents.predicted.iter().zip(&here) {
            assert!((a - b).abs() < 1e-9, "{a} {b}");
        }
        assert_ne!(Some(here), nominal.predict(row, &Assumed::nominal(&nominal)));
    }
}

/// Another program that reads the exported description has the robot with its effects.
#[test]
fn a_description_holds_the_effects_that_are_origins() {
    let rig = nico();
    let urdf = include_str!("../../../../assets/robots/nico/nico.urdf");
    let geometric = vec![
        effect("joint-zero", "r_elbow_y", &[0.04]),
        effect("axis-skew", "r_arm_x", &[0.02, -0.01]),
        effect("link-length", "right_upper_arm", &[0.004]),
        effect("tip-offset", "tip", &[0.003, -0.002, 0.004]),
        effect("base-tilt", "base", &[0.01, -0.02, 0.03, 0.005, 0.002, -0.004]),
    ];
    let sag = effect("joint-sag", "r_elbow_y", &[0.02]);
    let exported =
        with(&rig, [geometric.clone(), vec![sag]].concat()).urdf_with(&rig, urdf).expect("written");
    assert_eq!(exported.inside.len(), 5);
    let [left_out] = &exported.left_out[..] else { panic!("{:?}", exported.left_out) };
    assert!(left_out.effect == "joint-sag@r_elbow_y" && left_out.reason.contains("load"), "{left_out:?}");
    let description = plumbline_model::robot::Description::from_urdf(&exported.urdf).expect("a URDF");
    let other = Rig { description: std::sync::Arc::new(description), ..rig.clone() };
    let arm = with(&rig, geometric).arm(&rig, TIP).expect("a tip");
    for k in 0..5 {
        let angles: Vec<f64> = POINTING_RAD.iter().map(|angle| angle + 0.1 * f64::from(k)).collect();
        let tip = other.chain(TIP).expect("a tip").robot_from_tip(&angles).translation_m();
        let off_m = (tip - arm.tip(&angles, &Conditions::default()).coords.coords).norm();
        assert!(off_m < 1e-9, "{off_m}");
    }
    let nominal = RigModel::nominal(&rig).urdf_with(&rig, urdf).expect("written").urdf;
    let cameras = nominal.find("  <link name=\"left_camera\"").expect("added");
    assert_eq!(format!("{}</robot>", &nominal[..cameras]), urdf.trim_end(), "nothing else is changed");
    let twice = RigModel::nominal(&rig).urdf_with(&rig, &nominal).expect_err("they are there").to_string();
    assert!(twice.contains("left_camera"), "{twice}");
    let moved = urdf.replacen("xyz=\"0 0 ", "xyz=\"0.5 0 ", 400);
    let refused = elsewhere(&rig, &moved);
    assert!(refused.contains("give the URDF of this robot"), "{refused}");
    assert!(elsewhere(&rig, "<robot>").contains("give the URDF of this robot"));
}

/// Effects found on two tips of one arm and on the eyes: all are in one description, where the model has
/// them.
#[test]
fn a_description_has_both_tips_and_the_cameras_where_the_model_has_them() {
    let rig = std::sync::Arc::new(nico());
    let urdf = include_str!("../../../../assets/robots/nico/nico.urdf");
    let palm = |id, site, values: &[f64]| ModelEffect {
        tip: Some("right_palm_center".to_owned()),
        ..effect(id, site, values)
    };
    let of_eyes = |id, site, values: &[f64]| ModelEffect { tip: None, ..effect(id, site, values) };
    let effects = vec![
        effect("joint-zero", "r_elbow_y", &[0.04]),
        palm("joint-zero", "r_elbow_y", &[-0.015]),
        palm("axis-skew", "r_arm_x", &[0.02, -0.01]),
        effect("axis-skew", "r_arm_x", &[-0.005, 0.03]),
        palm("link-length", "right_upper_arm", &[0.004]),
        effect("tip-offset", "tip", &[0.003, -0.002, 0.004]),
        effect("base-tilt", "base", &[0.01, -0.02, 0.03, 0.005, 0.002, -0.004]),
        of_eyes("camera-mount", "eyes", &[0.004, -0.003, 0.002, 0.02, -0.01, 0.015]),
        of_eyes("head-joint", "head_y", &[0.02]),
        of_eyes("eye-yaw", "right", &[0.008]),
    ];
    let added = with(&rig, effects.clone());
    let exported = added.urdf_with(&rig, urdf).expect("written");
    assert_eq!((exported.inside.len(), &exported.left_out[..]), (effects.len(), &[][..]));
    let description = plumbline_model::robot::Description::from_urdf(&exported.urdf).expect("a URDF");
    let own = crate::RobotModel::new(rig.clone(), std::sync::Arc::new(added)).expect("of this rig");
    let joints: Vec<_> = rig.description.movable().map(|joint| joint.name.clone()).collect();
    for k in 1..40u32 {
        // Angles all over the ranges, another stride for each joint.
        let mut posture = rig.home();
        for (i, name) in joints.iter().enumerate() {
            let joint = rig.description.find_joint(name).expect("it is there");
            let limits = rig.description.limits(joint);
            let share = (f64::from(k) * (0.618 + 0.37 * i as f64)).fract();
            posture[joint] = limits.lower_rad + share * (limits.upper_rad - limits.lower_rad);
        }
        let poses = description.forward(&posture);
        let place = |link: &str| poses.of(description.find_link(link).expect("a link")).isometry;
        let mut wanted = vec![("left_camera", own.robot_from_left(&posture).isometry)];
        for tip in [TIP, "right_palm_center", "left_palm_center"] {
            let arm = own.arm(tip).expect("a tip");
            wanted.push((tip, arm.robot_from_tip(&posture, &Conditions::default()).isometry));
        }
        for (link, wanted) in wanted {
            let found = place(link);
            let off_m = (found.translation.vector - wanted.translation.vector).norm();
            let off_rad = found.rotation.angle_to(&wanted.rotation);
            assert!(off_m < 1e-9 && off_rad < 1e-7, "{link}: {off_m} m, {off_rad} rad");
        }
        let yaw = nalgebra::UnitQuaternion::from_scaled_axis(nalgebra::Vector3::new(0.0, 0.008, 0.0));
        let right_from_left = yaw.inverse() * rig.eyes.cameras.right_from_left.isometry;
        let found = place("right_camera").inverse() * place("left_camera");
        assert!((found.translation.vector - right_from_left.translation.vector).norm() < 1e-9);
        assert!(found.rotation.angle_to(&right_from_left.rotation) < 1e-7);
    }
}

fn elsewhere(rig: &Rig, urdf: &str) -> String {
    RigModel::nominal(rig).urdf_with(rig, urdf).expect_err("refused").to_string()
}
