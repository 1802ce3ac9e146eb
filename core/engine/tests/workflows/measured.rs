//! Work on measured pairs of the real robot, where they are at hand.

use std::sync::Arc;

use plumbline_engine::EyesCommand;
use plumbline_engine::view::CaptureHint;
use plumbline_model::{Stamp, StereoFrame, measured_data};

use crate::common::Desk;

#[test]
fn capturing_by_itself_works_on_what_the_robot_sees() {
    let pairs = measured_data::folder("nico-chessboard").map_err(|reason| println!("{reason}"));
    let Ok(pairs) = pairs else { return };
    let (left, right) = (pairs.join("left"), pairs.join("right"));
    let folder = plumbline_hardware::PairFolder::open_two(&left, &right).expect("there");
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
            beside: Default::default(),
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
