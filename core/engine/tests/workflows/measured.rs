//! The command line's work on measured pairs of the real robot, where they are at hand.

use std::path::PathBuf;
use std::sync::Arc;

use plumbline_engine::EyesCommand;
use plumbline_engine::offline::{CalibrateArgs, CheckArgs, calibrate_stereo, check};
use plumbline_engine::view::CaptureHint;
use plumbline_model::camera::ModelKind;
use plumbline_model::{InnerCorners, Stamp, StereoFrame, Unattended, measured_data};

use crate::common::Desk;

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

#[test]
fn capturing_by_itself_works_on_what_the_robot_sees() {
    let Some(all) = args(Vec::new(), None) else { return };
    let folder = plumbline_hardware::PairFolder::open_two(&all.left, &all.right).expect("there");
    let data = tempfile::tempdir().expect("temporary folder");
    let mut desk = Desk::new(data.path());
    desk.apply(EyesCommand::AutoCapture(true));
    let mut blurred = 0;
    for files in folder.pairs() {
        let images = folder.load(files).expect("readable");
        desk.show(&StereoFrame {
            stamp: Stamp { seq: 0, captured_at: std::time::Instant::now() },
            left: Arc::new(images.left),
            right: Arc::new(images.right),
            time_difference_s: None,
            name: Some(files.name.clone()),
        });
        let view = desk.view();
        println!("{}: {:?}", files.name, view.eyes.hint);
        blurred += usize::from(matches!(view.eyes.hint, Some(CaptureHint::Blurred { .. })));
    }
    let view = desk.view();
    let coverage = &view.eyes.coverage;
    println!(
        "{} of {} pairs; {:.2} {:.2} {:?} {:?}",
        view.eyes.collected.len(),
        folder.pairs().len(),
        coverage.left.filled_fraction(),
        coverage.right.filled_fraction(),
        coverage.by_distance,
        coverage.by_tilt
    );
    println!("ghost {:?}", view.eyes.ghost.as_ref().map(|ghost| ghost.reason.clone()));
    assert_eq!(blurred, 0, "these pictures are as sharp as these eyes are");
    assert!(view.eyes.collected.len() >= 8, "{} pairs are somewhere new", view.eyes.collected.len());
    desk.apply(EyesCommand::Solve);
    let view = desk.view();
    let proposal = view.eyes.proposal.as_ref().expect("solved");
    let rms_px = proposal.calibration.summary.as_ref().expect("figures").rms_stereo_px;
    println!(
        "{rms_px} px; at {} m one pixel is {:?} m; doubts {:?}",
        proposal.stated_at_m, proposal.depth_per_px_m, proposal.doubts
    );
    println!(
        "uncertainty median {:?} greatest {:?}",
        proposal.uncertainty.as_ref().and_then(|map| map.median_m()),
        proposal.uncertainty.as_ref().and_then(|map| map.greatest_m())
    );
    assert!(rms_px < 0.12, "{rms_px}");
}
