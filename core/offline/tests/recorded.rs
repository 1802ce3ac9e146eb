//! Work on recorded pairs without a window.
#![allow(missing_docs, clippy::print_stdout)]

#[path = "../../engine/tests/workflows/common.rs"]
#[allow(dead_code, reason = "what the tests of the engine share, of which these need a part")]
mod common;
#[path = "recorded/lab.rs"]
mod lab;

use std::path::{Path, PathBuf};

use image::RgbImage;
use image::codecs::jpeg::JpegEncoder;
use plumbline_model::camera::ModelKind;
use plumbline_model::formats::native;
use plumbline_model::{InnerCorners, StereoCalibration, Unattended};
use plumbline_offline::{
    CalibrateArgs, CheckArgs, DisparityArgs, HealthArgs, LocateArgs, LocateEyes, LocateReport, LocateRobot,
    OfflineError, Stood, calibrate_stereo, check, disparity, health, locate,
};
use plumbline_recording::{About, Jpeg, RecordingWriter};

use serde_json::Value;

use common::{WALL_M, board, board_pairs, eyes, wall_pair, write_pairs};
use lab::{NOD_RAD, nodding};

fn args(folder: &Path, exclude: &[&str]) -> CalibrateArgs {
    CalibrateArgs {
        left: folder.join("left"),
        right: folder.join("right"),
        board: InnerCorners { columns: board().inner_columns, rows: board().inner_rows },
        square_m: board().square_m,
        model: ModelKind::Fisheye,
        exclude: exclude.iter().map(PathBuf::from).collect(),
        out: Some(folder.join("eyes.yaml")),
    }
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("temporary folder");
    write_pairs(folder.path(), board_pairs());
    folder
}

fn keys(value: &Value, keys: &[&str]) {
    for key in keys {
        assert!(value.get(key).is_some(), "no key {key} in {value}");
    }
}

#[test]
fn calibrate_check_locate_disparity() {
    let folder = folder();
    std::fs::write(folder.path().join("left/notes.txt"), "not an image").expect("written");
    let held_out = ["03.png", "07.png"];
    let report = calibrate_stereo(&args(folder.path(), &held_out), &Unattended).expect("solved");
    assert_eq!((report.pairs_found, report.pairs_used), (10, 10));
    assert_eq!(report.pairs_excluded, held_out);
    assert!((report.baseline_mm - eyes().baseline_m() * 1000.0).abs() < 0.3, "{}", report.baseline_mm);
    assert!((report.square_mm_mean - board().square_m * 1000.0).abs() < 0.5, "{}", report.square_mm_mean);
    let json = serde_json::to_value(&report).expect("serializable");
    keys(
        &json,
        &[
            "pairs_found",
            "pairs_used",
            "pairs_rejected",
            "rms_left_px",
            "rms_right_px",
            "rms_stereo_px",
            "cross_validated_px",
            "baseline_mm",
            "per_pair",
        ],
    );
    keys(&json["per_pair"][0], &["name", "left_px", "right_px"]);

    let others = report.per_pair.iter().map(|pair| PathBuf::from(&pair.name)).collect();
    let calibrated = args(folder.path(), &[]);
    let cameras = vec![folder.path().join("eyes.yaml")];
    let checked = check(
        &CheckArgs {
            cameras: cameras.clone(),
            left: calibrated.left,
            right: calibrated.right,
            board: calibrated.board,
            square_m: calibrated.square_m,
            exclude: others,
        },
        &Unattended,
    )
    .expect("checked");
    assert_eq!(checked.pairs, held_out.len());
    assert!(checked.reprojection_px < 2.0 * report.rms_stereo_px, "{checked:?}");
    let json = serde_json::to_value(&checked).expect("serializable");
    keys(&json, &["pairs", "reprojection_px", "epipolar_px", "square_mm_mean", "square_mm_sd"]);

    write_pairs(&folder.path().join("wall"), &[wall_pair()]);
    let [left, right] = ["left", "right"].map(|eye| folder.path().join("wall").join(eye).join("wall.png"));
    let points = folder.path().join("points.csv");
    std::fs::write(&points, "u_px,v_px\n165,125\n140,110\n-5,3\n").expect("written");
    let eyes = LocateEyes::Calibrated { cameras: cameras.clone(), robot: None };
    let args = LocateArgs { eyes, left: left.clone(), right: right.clone(), points };
    let located = locate(&args, &Unattended).expect("located");
    in_the_robots_frame(&args, &cameras, &located, folder.path());
    let json = serde_json::to_value(&located).expect("serializable");
    keys(
        &json["points"][0],
        &["u_px", "v_px", "x_m", "y_m", "z_m", "sigma_m", "match_u_px", "match_v_px", "reason"],
    );
    for point in &located.points[..2] {
        let z_m = point.z_m.expect("found");
        assert!((z_m - WALL_M).abs() < 0.01, "{point:?}");
        assert_eq!(point.reason, None);
    }
    assert_eq!(json["points"][2]["x_m"], Value::Null);
    assert!(located.points[2].reason.as_ref().expect("a reason").contains("outside"));

    let out = folder.path().join("wall.pfm");
    let mapped = disparity(
        &DisparityArgs { left, right, cameras, max_disparity_px: 64, out: Some(out.clone()) },
        &Unattended,
    )
    .expect("matched");
    assert!(mapped.valid_fraction > 0.5, "{mapped:?}");
    keys(&serde_json::to_value(&mapped).expect("serializable"), &["valid_fraction", "milliseconds"]);
    let pixels = u64::from(mapped.width_px) * u64::from(mapped.height_px);
    assert!(std::fs::metadata(out).expect("written").len() > 4 * pixels);
}

/// With a model of the robot the same points have a place in its frame, which the model decides.
fn in_the_robots_frame(args: &LocateArgs, cameras: &[PathBuf], bare: &LocateReport, folder: &Path) {
    let rig = plumbline_model::robot::default_rig();
    let mut model = plumbline_effects::RigModel::nominal(&rig);
    let file = folder.join("rig-model.toml");
    let with = |model: &plumbline_effects::RigModel, tilt_rad: f64| {
        model.write(&file, &rig).expect("written");
        let robot = LocateRobot {
            rig: "nico".to_owned(),
            rig_model: file.clone(),
            mount: None,
            stood: Stood { head_rad: [Some(0.1), Some(tilt_rad)], ..Stood::default() },
        };
        let eyes = LocateEyes::Calibrated { cameras: cameras.to_vec(), robot: Some(robot) };
        let located = locate(&LocateArgs { eyes, ..args.clone() }, &Unattended).expect("located");
        assert_eq!(located.points[2].robot, None, "it was not found");
        let place = located.points[0].robot.expect("found");
        (located, nalgebra::Vector3::new(place.robot_x_m, place.robot_y_m, place.robot_z_m))
    };
    let (described, nominal_m) = with(&model, -0.5);
    assert_eq!(described.model.as_deref(), Some("as described"));
    assert_eq!(bare.model, None);
    assert_eq!((described.points[0].x_m, bare.points[0].robot), (bare.points[0].x_m, None));
    let sigma_m = described.points[0].robot.expect("found").robot_sigma_m;
    // Nobody measured the mount: the place is as uncertain as mounts usually are off, and it is said.
    let seen_m = bare.points[0].sigma_m.expect("found");
    assert!(sigma_m > seen_m.max(0.02), "{sigma_m} {seen_m}");
    let told_to = |report: &LocateReport| report.notes.iter().any(|note| note.contains("--mount"));
    assert!(told_to(&described) && !told_to(bare), "{:?}", described.notes);
    let (_, nodding_m) = with(&model, -0.5 + NOD_RAD);
    model.contents.effects = nodding(&rig).contents.effects;
    let (known, place_m) = with(&model, -0.5);
    assert_eq!((known.model.as_deref(), known.effects.len()), (Some("with 1 effect"), 1));
    assert!((place_m - nodding_m).norm() < 1e-6 && (place_m - nominal_m).norm() > 5e-3);
    assert!(known.points[0].robot.expect("found").robot_sigma_m > seen_m);
}

#[test]
fn bad_input_is_told_with_what_to_do() {
    let folder = folder();
    let good = args(folder.path(), &[]);
    let fails =
        |args: &CalibrateArgs| calibrate_stereo(args, &Unattended).err().map(|error| error.to_string());

    let empty = folder.path().join("empty");
    std::fs::create_dir(&empty).expect("made");
    for (args, said) in [
        (CalibrateArgs { left: empty, ..good.clone() }, "holds no"),
        (CalibrateArgs { left: good.right.clone(), right: good.left.clone(), ..good.clone() }, "swapped"),
        (CalibrateArgs { board: InnerCorners { columns: 9, rows: 7 }, ..good.clone() }, "6x4 inner corners"),
        (CalibrateArgs { square_m: f64::NAN, ..good.clone() }, "for example 30"),
        (CalibrateArgs { exclude: vec!["99.png".into()], ..good.clone() }, "99.png"),
        (
            CalibrateArgs {
                exclude: (3..12).map(|i| format!("{i:02}.png").into()).collect(),
                ..good.clone()
            },
            "collect more",
        ),
        (
            CalibrateArgs { out: Some("/no/such/folder/eyes.yaml".into()), ..good.clone() },
            "cannot be written",
        ),
    ] {
        let message = fails(&args).unwrap_or_else(|| panic!("{said}: it passed"));
        assert!(message.contains(said), "{said}: {message}");
    }
}

#[test]
fn damaged_images_cost_only_their_own_pair() {
    let folder = folder();
    let left = folder.path().join("left");
    std::fs::write(left.join("02.png"), "this is text").expect("written");
    let whole = std::fs::read(left.join("05.png")).expect("there");
    std::fs::write(left.join("05.png"), &whole[..whole.len() / 3]).expect("written");
    std::fs::remove_file(folder.path().join("right/09.png")).expect("removed");
    let report = calibrate_stereo(&args(folder.path(), &[]), &Unattended).expect("solved from the others");
    assert_eq!(report.pairs_used, 9);
    let rejected: Vec<&str> = report.pairs_rejected.iter().map(|pair| pair.name.as_str()).collect();
    assert_eq!(rejected, ["02.png", "05.png"]);
    assert!(report.notes.iter().any(|note| note.contains("09.png")), "{:?}", report.notes);
}

#[test]
fn a_calibration_of_other_images_is_refused() {
    let folder = folder();
    calibrate_stereo(&args(folder.path(), &[]), &Unattended).expect("solved");
    let wall = crate::common::resized(&wall_pair(), (640, 480));
    write_pairs(&folder.path().join("wall"), &[wall]);
    let [left, right] = ["left", "right"].map(|eye| folder.path().join("wall").join(eye).join("wall.png"));
    let cameras = vec![folder.path().join("eyes.yaml")];
    let error =
        disparity(&DisparityArgs { left, right, cameras, max_disparity_px: 64, out: None }, &Unattended);
    assert!(matches!(error, Err(OfflineError::OtherSize { .. })), "{error:?}");
}

/// A session of one pair of a wall, as images under `stereo/` or as a recording.
fn session(folder: &Path, as_recording: bool) {
    let manifest = "format = 1\nrig = \"nico\"\nstarted = 2026-05-01T10:00:00Z\n";
    std::fs::create_dir_all(folder).expect("a folder");
    std::fs::write(folder.join("session.toml"), manifest).expect("written");
    let calibration = StereoCalibration::bare(eyes());
    let wall = wall_pair();
    if !as_recording {
        native::write(&calibration, &folder.join("cameras.yaml")).expect("written");
        return write_pairs(&folder.join("stereo"), &[wall]);
    }
    native::write(&calibration, &folder.join("rig-cameras.yaml")).expect("written");
    let jpeg = |image: &RgbImage| {
        let mut bytes = vec![];
        JpegEncoder::new_with_quality(&mut bytes, 98).encode_image(image).expect("an image");
        Jpeg(bytes)
    };
    let at: jiff::Timestamp = "2026-05-01T10:00:01Z".parse().expect("a time");
    let mut writer = RecordingWriter::create(&folder.join("log.mcap"), at, &About::default()).expect("begun");
    writer.pair(at, 0, [jpeg(&wall.left), jpeg(&wall.right)], None).expect("written");
    writer.finish().expect("ended");
}

#[test]
fn the_eyes_of_a_recording_are_judged_as_those_of_images() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let judged = |name: &str, as_recording: bool| {
        let session_folder = folder.path().join(name);
        session(&session_folder, as_recording);
        let args = HealthArgs { session: session_folder, cameras: None, proposed: None };
        health(&args, &Unattended).expect("judged")
    };
    let (images, recording) = (judged("images", false), judged("recording", true));
    assert!(images.in_use.ok && recording.in_use.ok, "{images:?} {recording:?}");
    assert_eq!((images.pairs, recording.pairs), (1, 1));
    assert!(recording.matches > images.matches / 2, "{} {}", recording.matches, images.matches);
    // What JPEG changes is little against how well one pair tells a turn.
    assert!(recording.in_use.turn_deg < 0.1, "{:?}", recording.in_use);

    let nothing = folder.path().join("nothing");
    session(&nothing, false);
    std::fs::remove_dir_all(nothing.join("stereo")).expect("removed");
    std::fs::write(nothing.join("touches.csv"), "").expect("written");
    let args = HealthArgs { session: nothing, cameras: None, proposed: None };
    assert!(health(&args, &Unattended).is_err(), "nothing to look at");
}
