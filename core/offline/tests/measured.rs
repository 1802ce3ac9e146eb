//! Calibrating on what the robot's own eyes saw.
#![allow(missing_docs, clippy::print_stdout)]

use std::path::PathBuf;

use plumbline_model::camera::ModelKind;
use plumbline_model::{InnerCorners, Unattended, measured_data};
use plumbline_offline::{CalibrateArgs, CheckArgs, calibrate_stereo, check};

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
