//! Calibrating the eyes from the first pair to the accepted result, on synthetic pairs.

use crate::common::{Desk, WALL_M, board, board_pairs, eyes, resized, swapped, wall_pair};
use plumbline_engine::ground::stage::Stage;
use plumbline_engine::jobs::Outcome;
use plumbline_engine::view::{CaptureEnded, CaptureHint, JobState, Origin, StepState};
use plumbline_engine::{
    Action, ExportFormat, Exported, EyesCommand, FileLength, LiveCommand, NoticeLevel, ProbePoint, Products,
};
use plumbline_model::Eye;

fn choose_board() -> EyesCommand {
    let (columns, rows) = board().squares();
    EyesCommand::ChooseBoard { columns, rows, square_m: board().square_m }
}

fn corners_wanted() -> LiveCommand {
    LiveCommand::Want(Products { corners: true, ..Products::default() })
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("temporary folder")
}

/// All pairs captured by hand.
fn collected(data_dir: &std::path::Path) -> Desk {
    let mut desk = Desk::new(data_dir);
    desk.apply(choose_board());
    for pair in board_pairs() {
        desk.show(pair);
        desk.apply(EyesCommand::Capture);
    }
    desk
}

#[test]
fn from_capture_to_acceptance_and_over_a_restart() {
    let folder = folder();
    let mut desk = collected(folder.path());
    let view = desk.view();
    assert_eq!(view.eyes.collected.len(), board_pairs().len(), "{:?}", view.notices);
    assert_eq!(view.eyes.step, StepState::NotDone);

    desk.apply(EyesCommand::MinutesSinceOn(Some(12.0)));
    desk.apply(EyesCommand::Solve);
    let view = desk.view();
    let proposal = view.eyes.proposal.as_ref().expect("solved");
    assert_eq!((&proposal.origin, &proposal.stale), (&Origin::Solved, &None));
    let error_m = (proposal.calibration.cameras.baseline_m() - eyes().baseline_m()).abs();
    assert!(error_m < 2e-4, "baseline off by {error_m} m");
    let evidence = proposal.calibration.evidence.as_ref().expect("its evidence");
    assert_eq!((evidence.minutes_since_on, evidence.source.as_str()), (Some(12.0), "synthetic pairs"));
    assert!(proposal.depth_per_px_m.expect("stated") > 0.005);
    assert!(view.eyes.in_use.is_none(), "a proposal is not in use");
    assert!(view.live.aim.is_none() && !view.eyes.is_solved_in_use);

    desk.apply(EyesCommand::Accept);
    let view = desk.view();
    let accepted = view.eyes.in_use.as_ref().expect("accepted").clone();
    assert!(view.eyes.is_solved_in_use, "these pairs need not be solved again");
    let pair = view.eyes.collected[0].name.clone();
    desk.apply(EyesCommand::DropPair { pair: pair.clone() });
    assert!(!desk.view().eyes.is_solved_in_use, "others of them may be");
    desk.apply(EyesCommand::RestorePair { pair });
    assert!(view.eyes.proposal.is_none());
    assert_eq!(view.eyes.step, StepState::Done);
    assert!(view.live.aim.is_some(), "the live views are rectified with it");

    let restarted = Desk::new(folder.path()).view();
    let restored = restarted.eyes.in_use.as_ref().expect("restored");
    assert_eq!(restored.id, accepted.id);
    assert_eq!(*restored.calibration, *accepted.calibration);
    assert_eq!(restarted.eyes.board, board(), "the board of the laboratory is known");
}

#[test]
fn capturing_by_itself_takes_what_is_new_and_nothing_twice() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.apply(choose_board());
    desk.apply(corners_wanted());
    desk.show(&board_pairs()[0]);
    assert_eq!(desk.view().eyes.hint, Some(CaptureHint::Ready), "not captured without being asked");
    assert!(desk.view().eyes.collected.is_empty());
    assert!(desk.view().eyes.ghost.is_some(), "somewhere to begin");

    desk.apply(EyesCommand::AutoCapture(true));
    assert_eq!(desk.view().eyes.collected.len(), 1, "what stands there is captured at once");
    desk.apply(LiveCommand::Want(Products::default()));
    for pair in board_pairs().iter().chain(board_pairs()) {
        desk.show(pair);
    }
    let view = desk.view();
    let count = view.eyes.collected.len();
    assert!((6..=board_pairs().len()).contains(&count), "{count} pairs");
    assert!(view.eyes.coverage.left.filled_fraction() > 0.2);
    assert!(view.eyes.coverage.by_tilt.iter().filter(|&&n| n > 0).count() >= 4);

    desk.show(&wall_pair());
    assert_eq!(desk.view().eyes.hint, Some(CaptureHint::NotSeen { eyes: vec![Eye::Left, Eye::Right] }));
}

#[test]
fn accepting_a_calibration_ends_capturing_by_itself_until_it_is_switched_on_again() {
    let folder = folder();
    let mut desk = collected(folder.path());
    desk.apply(EyesCommand::AutoCapture(true));
    desk.apply(EyesCommand::Solve);
    assert!(desk.view().eyes.auto_capture, "what is solved may be collected on");
    desk.apply(EyesCommand::Accept);
    let eyes = desk.view().eyes;
    assert!(eyes.in_use.is_some() && !eyes.auto_capture);
    assert_eq!(eyes.capture_ended, Some(CaptureEnded::Accepted));

    // The head turns for the mount: the eyes see the board where it never was, and collect nothing.
    desk.apply(EyesCommand::DeleteAll);
    desk.apply(corners_wanted());
    for pair in board_pairs() {
        desk.show(pair);
    }
    assert!(desk.view().eyes.collected.is_empty());
    desk.apply(EyesCommand::AutoCapture(true));
    let eyes = desk.view().eyes;
    assert!(eyes.auto_capture && eyes.capture_ended.is_none());
    assert_eq!(eyes.collected.len(), 1, "what stands there");

    // Nothing is said where nothing was switched off.
    desk.apply(EyesCommand::AutoCapture(false));
    desk.apply(EyesCommand::ProposeEarlier { id: eyes.earlier[0].id.clone() });
    desk.apply(EyesCommand::Accept);
    assert!(desk.view().eyes.capture_ended.is_none());
}

#[test]
fn a_failing_solution_leaves_what_was_accepted() {
    let folder = folder();
    let mut desk = collected(folder.path());
    desk.apply(EyesCommand::Solve);
    desk.apply(EyesCommand::Accept);
    let accepted = desk.view().eyes.in_use.as_ref().expect("accepted").id.clone();

    desk.apply(EyesCommand::DeleteAll);
    desk.show(&board_pairs()[0]);
    desk.apply(EyesCommand::Capture);
    desk.apply(EyesCommand::Solve);
    let view = desk.view();
    let JobState::Failed { reason } = &view.jobs.last().expect("a job").state else {
        panic!("{:?}", view.jobs)
    };
    assert!(reason.contains("collect more"), "{reason}");
    assert_eq!(view.notices.last().map(|notice| notice.level), Some(NoticeLevel::Error));
    assert_eq!(view.eyes.in_use.as_ref().expect("still there").id, accepted);
    assert!(view.eyes.proposal.is_none() && view.eyes.solving.is_none());

    // However work ends, it can be started again.
    desk.hold_work = true;
    for outcome in [Outcome::Cancelled, Outcome::Panicked("out of range".into())] {
        desk.apply(EyesCommand::Solve);
        let Some(Action::Start(id, _)) = desk.state.take_actions().pop() else { panic!("it starts") };
        assert_eq!(desk.view().eyes.solving, Some(id));
        desk.state.work_ended(id, outcome, std::time::Duration::ZERO);
        assert_eq!(desk.view().eyes.solving, None);
        assert_eq!(desk.view().eyes.in_use.as_ref().expect("still there").id, accepted);
    }
    assert_eq!(Desk::new(folder.path()).view().eyes.in_use.as_ref().expect("restored").id, accepted);
}

#[test]
fn dropping_a_pair_makes_the_proposal_stale_until_it_is_solved_again() {
    let folder = folder();
    let mut desk = collected(folder.path());
    desk.apply(EyesCommand::Solve);
    let pair = "03.png".to_owned();
    desk.apply(EyesCommand::DropPair { pair: pair.clone() });
    let stale = desk.view().eyes.proposal.as_ref().expect("still shown").stale.clone();
    assert!(stale.expect("stale").contains("Solve again"));
    desk.apply(EyesCommand::Undo);
    assert_eq!(desk.view().eyes.proposal.as_ref().expect("shown").stale, None, "undo brings it back");

    desk.apply(EyesCommand::DropPair { pair: pair.clone() });
    desk.apply(EyesCommand::Solve);
    let view = desk.view();
    let proposal = view.eyes.proposal.as_ref().expect("solved again");
    assert_eq!(proposal.stale, None);
    assert!(proposal.calibration.per_pair.iter().all(|fit| fit.name != pair));
    assert!(proposal.calibration.rejected.iter().any(|rejected| rejected.name == pair));

    desk.apply(EyesCommand::RestorePair { pair: pair.clone() });
    desk.apply(EyesCommand::Solve);
    let view = desk.view();
    assert!(
        view.eyes.proposal.as_ref().expect("solved").calibration.per_pair.iter().any(|fit| fit.name == pair)
    );
}

#[test]
fn the_difference_to_the_calibration_in_use_is_shown_and_earlier_ones_can_be_had_back() {
    let folder = folder();
    let mut desk = collected(folder.path());
    desk.apply(EyesCommand::Solve);
    assert!(
        desk.view().eyes.proposal.as_ref().expect("solved").difference.is_none(),
        "nothing to compare with"
    );
    desk.apply(EyesCommand::Accept);
    let first = desk.view().eyes.in_use.as_ref().expect("accepted").id.clone();

    for pair in ["01.png", "05.png", "08.png"] {
        desk.apply(EyesCommand::DropPair { pair: pair.into() });
    }
    desk.apply(EyesCommand::Solve);
    let difference =
        desk.view().eyes.proposal.as_ref().expect("solved").difference.clone().expect("compared");
    let median_m = difference.median_m().expect("the table is seen");
    assert!(median_m > 1e-7 && median_m < 0.01, "{median_m}");
    desk.apply(EyesCommand::Accept);
    let second = desk.view().eyes.in_use.as_ref().expect("accepted").id.clone();
    assert_ne!(first, second);
    assert_eq!(desk.view().eyes.earlier.len(), 2);

    desk.apply(EyesCommand::ProposeEarlier { id: first.clone() });
    assert!(matches!(desk.view().eyes.proposal.as_ref().expect("read").origin, Origin::Earlier { .. }));
    assert_eq!(desk.view().eyes.in_use.as_ref().expect("in use").id, second, "until it is accepted");
    desk.apply(EyesCommand::CollectEvidence);
    assert_eq!(desk.view().eyes.collected.len(), board_pairs().len());
    assert!(desk.view().eyes.dropped.is_empty(), "the first one dropped none");
}

#[test]
fn a_calibration_goes_out_and_comes_back_in_every_format() {
    let folder = folder();
    let mut desk = collected(folder.path());
    desk.apply(EyesCommand::Solve);
    let solved = desk.view().eyes.proposal.as_ref().expect("solved").calibration.clone();
    for (format, name, files) in [
        (ExportFormat::Plumbline, "eyes.yaml", vec!["eyes.yaml"]),
        (ExportFormat::RosCameraInfo, "left.yaml", vec!["left.yaml", "right.yaml"]),
        (ExportFormat::OpenCv, "opencv.yml", vec!["opencv.yml"]),
        (ExportFormat::Kalibr, "camchain.yaml", vec!["camchain.yaml"]),
    ] {
        let file = folder.path().join(name);
        desk.apply(EyesCommand::Export { what: Exported::Proposal, format, file });
        let files = files.into_iter().map(|file| folder.path().join(file)).collect();
        desk.apply(EyesCommand::Import { files, length: FileLength::AsPrescribed });
        let read = desk.view().eyes.proposal.as_ref().expect("read").clone();
        assert!(matches!(read.origin, Origin::Imported { .. }), "{format:?}: {}", desk.last_notice());
        let pose = |c: &plumbline_model::StereoCalibration| c.cameras.right_from_left.translation_m();
        assert!((pose(&read.calibration) - pose(&solved)).norm() < 1e-12, "{format:?}");
        desk.apply(EyesCommand::Import {
            files: vec![folder.path().join("eyes.yaml")],
            length: FileLength::AsPrescribed,
        });
    }
    desk.apply(EyesCommand::Import { files: vec!["nowhere.yaml".into()], length: FileLength::AsPrescribed });
    assert!(desk.last_notice().contains("nowhere.yaml"));
    assert!(desk.view().eyes.proposal.is_some(), "a file that cannot be read takes nothing away");
}

#[test]
fn another_board_is_recognized_and_named_in_squares() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.apply(EyesCommand::ChooseBoard { columns: 9, rows: 6, square_m: 0.03 });
    desk.show(&board_pairs()[0]);
    desk.apply(EyesCommand::Capture);
    assert!(desk.last_notice().contains("6x4 inner corners"), "{}", desk.last_notice());
    desk.apply(EyesCommand::RecognizeBoard);
    let seen = desk.view().eyes.board_seen.clone().expect("seen");
    assert!(seen.text.contains("7×5 squares (6×4 inner corners), not 9×6"), "{}", seen.text);
    desk.apply(EyesCommand::ChooseBoard { columns: 1, rows: 6, square_m: 0.03 });
    assert!(desk.last_notice().contains("for example"), "{}", desk.last_notice());
}

#[test]
fn swapped_eyes_are_told() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    desk.apply(choose_board());
    for pair in board_pairs() {
        desk.show(&swapped(pair));
        desk.apply(EyesCommand::Capture);
    }
    desk.apply(EyesCommand::Solve);
    assert!(desk.last_notice().contains("swapped"), "{}", desk.last_notice());
}

#[test]
fn images_of_another_size_do_not_mix_and_the_step_is_stale() {
    let folder = folder();
    let mut desk = collected(folder.path());
    desk.apply(EyesCommand::Solve);
    desk.apply(EyesCommand::Accept);
    desk.apply(LiveCommand::Want(Products { rectified: true, ..Products::default() }));
    assert!(desk.view().live.rectified.is_some());
    let mut larger = resized(&board_pairs()[1], (800, 600));
    larger.name = Some("larger.png".into());
    desk.show(&larger);
    let view = desk.view();
    assert!(
        matches!(&view.eyes.step, StepState::Stale { why } if why.contains("800×600")),
        "{:?}",
        view.eyes.step
    );
    let reason = view.live.no_rectified_because.clone().expect("a reason");
    assert!(reason.contains("800×600") && reason.contains("320×240"), "{reason}");
    desk.apply(EyesCommand::Capture);
    assert!(desk.last_notice().contains("800×600"), "{}", desk.last_notice());
    assert_eq!(desk.view().eyes.collected.len(), board_pairs().len());
}

#[test]
fn a_point_on_a_wall_is_measured_where_the_wall_is() {
    let folder = folder();
    let mut desk = collected(folder.path());
    desk.apply(EyesCommand::Solve);
    desk.apply(EyesCommand::Accept);
    desk.apply(LiveCommand::Want(Products {
        rectified: true,
        disparity: true,
        corners: false,
        detections: false,
    }));
    desk.apply(LiveCommand::Probe(ProbePoint::Raw { eye: Eye::Left, u_px: 165.0, v_px: 125.0 }));
    desk.show(&wall_pair());
    let view = desk.view();
    let probe = view.live.probe.as_ref().expect("probed");
    let reading = probe.reading.as_ref().expect("the wall is textured");
    let z_m = reading.point_in_left.coords.z;
    assert!(
        (z_m - WALL_M).abs() < 4.0 * reading.range_sigma_m.max(1e-3),
        "{z_m} ± {}",
        reading.range_sigma_m
    );
    let disparity = view.live.disparity.as_ref().expect("computed");
    assert_eq!(disparity.stamp, view.live.rectified.as_ref().expect("computed").stamp);
    let pixel = reading.left_rectified.expect("in the view");
    let dense_px =
        disparity.disparity_px(pixel.u_px.round() as u32, pixel.v_px.round() as u32).expect("dense");
    let sparse_px = reading.disparity_px.expect("in the view");
    assert!((dense_px - sparse_px).abs() < 0.5, "{dense_px} against {sparse_px}");

    desk.apply(LiveCommand::Probe(ProbePoint::Raw { eye: Eye::Left, u_px: 9000.0, v_px: 250.0 }));
    desk.show(&wall_pair());
    let reason = desk.view().live.probe.as_ref().expect("asked").reading.clone().expect_err("outside");
    assert!(reason.to_string().contains("outside"), "{reason}");
    desk.apply(LiveCommand::StopProbe);
    assert!(desk.view().live.probe.is_none());
}

#[test]
fn nothing_unwanted_is_computed_and_nothing_old_is_shown() {
    let folder = folder();
    let mut desk = collected(folder.path());
    desk.apply(EyesCommand::Solve);
    desk.apply(EyesCommand::Accept);
    assert!(desk.state.rectify_input().is_none() && desk.state.corners_input().is_none());
    desk.apply(LiveCommand::Want(Products { rectified: true, ..Products::default() }));
    let before = desk.state.rectify_input().expect("wanted");
    assert!(!before.disparity);
    // The views are aimed anew while the stage is at work: its result comes too late.
    desk.apply(LiveCommand::Aim(plumbline_engine::AimChoice::Manual {
        pitch_rad: 0.3,
        horizontal_field_of_view_rad: 1.5,
    }));
    let aim = desk.view().live.aim.expect("aimed");
    assert!((aim.pitch_rad - 0.3).abs() < 1e-9 && (aim.field_of_view_rad.0 - 1.5).abs() < 1e-9);
    desk.apply(LiveCommand::Want(Products::default()));
    desk.apply(LiveCommand::Want(Products { rectified: true, ..Products::default() }));
    desk.hold_work = true;
    let late = plumbline_engine::live::RectifyStage::default().process(before);
    let shown = desk.view().live.rectified.as_ref().expect("of the new aim").left.clone();
    let stamp = plumbline_model::Stamp { seq: 0, captured_at: std::time::Instant::now() };
    let busy = std::time::Duration::ZERO;
    desk.state.rectified(
        plumbline_engine::ground::stage::Timed { stamp, busy, result: late },
        std::time::Instant::now(),
    );
    let still = desk.view().live.rectified.as_ref().expect("shown").left.clone();
    assert!(std::sync::Arc::ptr_eq(&shown, &still));
}

#[test]
fn pairs_of_cameras_are_kept_on_disk_and_those_of_a_recording_are_not_copied() {
    let folder = folder();
    let sessions = folder.path().join("sessions");
    let mut desk = Desk::new(folder.path());
    desk.apply(choose_board());
    desk.show(&board_pairs()[0]);
    desk.apply(EyesCommand::Capture);
    assert!(!sessions.exists());
    for pair in &board_pairs()[1..3] {
        let mut live = pair.clone();
        live.name = None;
        desk.show(&live);
        desk.apply(EyesCommand::Capture);
    }
    let session = std::fs::read_dir(&sessions).expect("made").next().expect("one").expect("readable").path();
    let kept = plumbline_model::Session::read(&session).expect("a session");
    let names: Vec<&str> = kept.stereo.pairs.iter().map(|pair| pair.name.as_str()).collect();
    assert_eq!(names, ["capture 001.png", "capture 002.png"]);
    assert_eq!(desk.view().eyes.collected.len(), 3);
}

#[test]
fn a_pair_of_a_closed_source_comes_too_late() {
    let folder = folder();
    let mut desk = Desk::new(folder.path());
    let view = |opened| plumbline_engine::view::SourceView { opened, ..Default::default() };
    let now = std::time::Instant::now;
    desk.state.source_changed(view(1));
    desk.state.frame(1, board_pairs()[0].clone(), now());
    assert!(desk.view().live.raw.is_some());
    desk.state.source_changed(view(2));
    assert!(desk.view().live.raw.is_none(), "what was shown belongs to no source any more");
    desk.state.frame(1, board_pairs()[0].clone(), now());
    assert!(desk.view().live.raw.is_none());
    // A pair of the next source may overtake the news of its opening.
    desk.state.frame(3, board_pairs()[1].clone(), now());
    desk.state.source_changed(view(3));
    assert!(desk.view().live.raw.is_some());
}

#[test]
fn what_cannot_be_kept_stays_a_proposal() {
    let folder = folder();
    let file = folder.path().join("file");
    std::fs::write(&file, "in the way").expect("written");
    let mut desk = collected(&file);
    assert!(desk.view().notices[0].text.contains("cannot be used"), "{:?}", desk.view().notices[0]);
    desk.apply(EyesCommand::Solve);
    desk.apply(EyesCommand::Accept);
    let view = desk.view();
    assert!(view.eyes.proposal.is_some() && view.eyes.in_use.is_none());
    let notice = view.notices.last().expect("a reason");
    assert_eq!(notice.level, NoticeLevel::Error);
    assert!(notice.text.contains("free space"), "{}", notice.text);
}
