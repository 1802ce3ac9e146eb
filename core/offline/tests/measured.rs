//! Calibrating on what the robot's own eyes saw.
#![allow(missing_docs, clippy::print_stdout)]

use std::path::PathBuf;

use plumbline_model::camera::ModelKind;
use plumbline_model::formats::CalibrationFormat;
use plumbline_model::{InnerCorners, Unattended, measured_data};
use plumbline_offline::{
    CalibrateArgs, CheckArgs, GridArgs, HealthArgs, OfflineError, calibrate_stereo, check, grid, health,
};
use plumbline_vision::calibration_file;
use plumbline_vision::health::turned;

fn args(exclude: Vec<PathBuf>, out: Option<PathBuf>) -> Option<CalibrateArgs> {
    let folder = measured_data::folder("nico-chessboard").map_err(|reason| println!("{reason}")).ok()?;
    Some(CalibrateArgs {
        left: folder.join("left"),
        right: folder.join("right"),
        board: InnerCorners { columns: 8, rows: 5 },
        square_m: 0.03,
        model: ModelKind::Fisheye,
        exclude,
        out,
    })
}

#[test]
fn all_pairs_of_the_robot_are_found_and_the_one_bad_corner_is_left_out() {
    let Some(args) = args(Vec::new(), None) else { return };
    let report = calibrate_stereo(&args, &Unattended).expect("solved");
    let files = std::fs::read_dir(&args.left).expect("there").count();
    assert_eq!((report.pairs_found, report.pairs_used), (files, files));
    assert!(report.rms_stereo_px <= 0.096, "{}", report.rms_stereo_px);
    let bad =
        report.corners_left_out.iter().any(|corner| corner.pair == "frame_09.png" && corner.eye == "right");
    assert!(
        bad || report.per_pair.iter().all(|pair| pair.right_px < Some(0.2)),
        "{:?}",
        report.corners_left_out
    );
}

#[test]
fn pairs_kept_aside_are_met_as_well() {
    let all = args(Vec::new(), None);
    let Some(all) = all else { return };
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("eyes.yaml");
    let mut names: Vec<PathBuf> = std::fs::read_dir(&all.left)
        .expect("there")
        .flatten()
        .map(|entry| entry.file_name().into())
        .collect();
    names.sort();
    // Every third pair is kept aside.
    let (aside, used): (Vec<_>, Vec<_>) = names.into_iter().enumerate().partition(|(i, _)| i % 3 == 1);
    let [aside, used] = [aside, used].map(|part| part.into_iter().map(|(_, name)| name).collect::<Vec<_>>());
    let solved = calibrate_stereo(
        &CalibrateArgs { exclude: aside, out: Some(file.clone()), ..all.clone() },
        &Unattended,
    );
    solved.expect("solved");
    let judged = check(
        &CheckArgs {
            cameras: vec![file],
            left: all.left,
            right: all.right,
            board: all.board,
            square_m: all.square_m,
            exclude: used,
        },
        &Unattended,
    )
    .expect("judged");
    println!("{} px, epipolar {} px on {} pairs", judged.reprojection_px, judged.epipolar_px, judged.pairs);
    assert_eq!(judged.pairs, 10);
    assert!(judged.reprojection_px <= 0.100 && judged.epipolar_px <= 0.118, "{judged:?}");
}

/// The measured pairs as a session of ordinary pairs.
fn session_of_pairs(args: &CalibrateArgs, folder: &std::path::Path) -> HealthArgs {
    for (eye, from) in [("left", &args.left), ("right", &args.right)] {
        let to = folder.join("stereo").join(eye);
        std::fs::create_dir_all(&to).expect("folder");
        for entry in std::fs::read_dir(from).expect("there").flatten() {
            std::fs::copy(entry.path(), to.join(entry.file_name())).expect("copied");
        }
    }
    let manifest =
        "format = 1\nrig = \"nico\"\nstarted = 2026-01-01T00:00:00Z\noperator = \"\"\nnotes = \"\"\n";
    std::fs::write(folder.join("session.toml"), manifest).expect("written");
    HealthArgs { session: folder.to_path_buf(), cameras: None, proposed: None }
}

#[test]
fn the_same_day_says_that_the_calibration_is_good_and_a_turned_eye_is_seen() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let Some(args) = args(Vec::new(), Some(folder.path().join("cameras.yaml"))) else { return };
    calibrate_stereo(&args, &Unattended).expect("solved");
    let session = session_of_pairs(&args, folder.path());
    let report = health(&session, &Unattended).expect("judged");
    assert!(report.in_use.ok, "{report:?}");
    assert!(report.in_use.turn_deg < 0.1, "{report:?}");
    // Whoever stands before the robot waits for it: 2 s on two cores.
    assert!(report.seconds <= 10.0, "{report:?}");

    // A calibration of an eye that has turned by half a degree to the side, and the good one proposed.
    let mut bad =
        calibration_file::load(std::slice::from_ref(&folder.path().join("cameras.yaml"))).expect("read");
    bad.cameras = turned(&bad.cameras, &nalgebra::Vector3::new(0.0, 0.5_f64.to_radians(), 0.0));
    let file = folder.path().join("turned.yaml");
    calibration_file::save(&bad, std::slice::from_ref(&file), CalibrationFormat::Native).expect("written");
    let good = Some(folder.path().join("cameras.yaml"));
    let report =
        health(&HealthArgs { cameras: Some(file), proposed: good, ..session }, &Unattended).expect("judged");
    assert!(!report.in_use.ok && report.in_use.far_mm > 20.0, "{report:?}");
    assert!((report.in_use.turn_deg - 0.5).abs() < 0.1, "{report:?}");
    assert!(report.proposed.is_some_and(|proposed| proposed.ok));
    assert_eq!(report.better, "proposed");
}

#[test]
fn a_session_without_pairs_is_told_where_they_belong() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let manifest = "format = 1\nrig = \"nico\"\nstarted = 2026-01-01T00:00:00Z\n";
    std::fs::write(folder.path().join("session.toml"), manifest).expect("written");
    let table = "true_x_m,true_y_m,true_z_m,est_x_m,est_y_m,est_z_m\n0.4,0,0.05,0.4,0,0.05\n";
    std::fs::write(folder.path().join("localizations.csv"), table).expect("written");
    let args = HealthArgs { session: folder.path().to_path_buf(), cameras: None, proposed: None };
    let error = health(&args, &Unattended).expect_err("nothing to look at");
    assert!(matches!(error, OfflineError::NoPairs(_)), "{error}");
}

#[test]
fn a_grid_of_the_real_robot_is_judged_with_the_published_correction() {
    let Ok(folder) = measured_data::folder("nico-vision/grid-z5").map_err(|reason| println!("{reason}"))
    else {
        return;
    };
    let report = grid(&GridArgs { session: folder, rig_model: None }, &Unattended).expect("judged");
    let of = |name: &str| report.corrections.iter().find(|one| one.correction == name).expect("made");
    assert_eq!(of("none").places.len(), 36);
    assert!((of("none").mean_mm - 36.8).abs() < 0.1, "{}", of("none").mean_mm);
    assert!((of("pivot-published").mean_mm - 8.4).abs() < 0.1, "{}", of("pivot-published").mean_mm);
    assert!(of("pivot-fitted").mean_mm <= of("pivot-held-out").mean_mm);
    let empty = tempfile::tempdir().expect("temporary folder");
    let manifest = "format = 1\nrig = \"nico\"\nstarted = 2026-01-01T00:00:00Z\n";
    std::fs::write(empty.path().join("session.toml"), manifest).expect("written");
    let args = GridArgs { session: empty.path().to_owned(), rig_model: None };
    assert!(grid(&args, &Unattended).is_err());
}
