//! The first hour of an operator without a robot, by clicks in a window over the real engine and
//! the real twin: its eyes are calibrated from a board that is shown to them, its arm is moved
//! through the servo bus, and STOP stops it.

use std::sync::Arc;
use std::time::Duration;

use plumbline_engine::view::{MotionState, Preview, RobotView};
use plumbline_model::robot::{JointIndex, Rig};
use plumbline_tests::{Window, click_containing, for_a_while, until, view, window};

fn robot(window: &Window) -> Arc<RobotView> {
    view(window).robot.clone()
}

/// Largest distance of the pose's joints to where they are, rad.
fn away_rad(robot: &RobotView, joints: &[(JointIndex, f64)]) -> Option<f64> {
    let measured = robot.measured.as_ref()?;
    Some(joints.iter().map(|(joint, angle)| (measured[*joint] - angle).abs()).fold(0.0, f64::max))
}

fn connect(window: &mut Window) {
    until(window, "the twin's joints", |window| robot(window).measured.is_some());
    assert!(robot(window).connection.is_connected());
    until(window, "the twin's eyes", |window| view(window).live.raw.is_some());
    until(window, "a rectified pair through the nominal lenses", |window| {
        let live = view(window).live.clone();
        live.rectified.is_some() && live.nominal_lenses
    });
}

fn calibrate_the_eyes(window: &mut Window) {
    click_containing(window, "Calibrate the eyes");
    click_containing(window, "Show the board at all places");
    until(window, "ten pairs, captured by themselves", |window| {
        view(window).eyes.collected.len() >= 10 && view(window).twin.board.is_none()
    });
    let pairs = view(window).eyes.collected.len();
    click_containing(window, &format!("Solve {pairs} pairs"));
    until(window, "the verdict", |window| view(window).eyes.proposal.is_some());
    let proposal = view(window).eyes.proposal.clone().expect("just seen");
    let summary = proposal.calibration.summary.clone().expect("a solution has figures");
    assert!(summary.rms_stereo_px < 0.1, "{summary:?}");
    click_containing(window, "Accept calibration");
    until(window, "the calibration in use", |window| view(window).eyes.in_use.is_some());
    until(window, "a pair through the calibrated lenses", |window| !view(window).live.nominal_lenses);
}

fn move_the_arm(window: &mut Window, rig: &Rig) {
    let pose = rig.pose("touch-ready").expect("a pose of NICO");
    click_containing(window, "Robot");
    click_containing(window, &pose.title);
    until(window, "the ghost", |window| robot(window).preview.is_some());
    let shown = robot(window);
    let preview = shown.preview.as_ref().expect("just seen");
    assert!(preview.path.is_ok(), "{:?}", preview.path);
    assert!(away_rad(&shown, &pose.joints).expect("measured") > 0.2, "showing a move moves nothing");
    click_containing(window, "Move there");
    until(window, "the arm on its way", |window| matches!(robot(window).motion, MotionState::Moving { .. }));
    until(window, "the arm at its goal", |window| {
        matches!(robot(window).motion, MotionState::Holding { .. })
    });
    // Servos that hold a weight hang below their goal by what their gain lets them.
    let away_rad = away_rad(&robot(window), &pose.joints).expect("measured");
    assert!(away_rad < 0.06, "{away_rad} rad from its goal: {:?}", robot(window).refusal);
}

fn stop_it(window: &mut Window, rig: &Rig) {
    let home = rig.pose("home").expect("a pose of NICO");
    click_containing(window, &home.title);
    // "Move there" goes where the ghost stands, so it is pressed when the ghost is the new one.
    until(window, "the ghost at home", |window| {
        let shown = robot(window);
        let there = |preview: &Preview| {
            home.joints.iter().all(|(joint, angle_rad)| (preview.end[*joint] - angle_rad).abs() < 0.01)
        };
        shown.preview.as_ref().is_some_and(|preview| there(preview) && preview.path.is_ok())
    });
    click_containing(window, "Move there");
    let on_its_way = |window: &Window| matches!(robot(window).motion, MotionState::Moving { fraction: Some(part), .. } if part > 0.15);
    until(window, "the arm on its way home", on_its_way);
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    until(window, "STOP", |window| {
        robot(window).stopped && matches!(robot(window).motion, MotionState::Holding { .. })
    });
    let stood = robot(window).measured.clone().expect("measured");
    assert!(away_rad(&robot(window), &home.joints).expect("measured") > 0.1, "it stopped on the way");

    // Nothing moves until STOP is released, and releasing moves nothing.
    for_a_while(window, Duration::from_secs(1));
    assert!(robot(window).measured.as_ref().expect("measured").distance_rad(&stood) < 0.05);
    click_containing(window, "Release STOP");
    until(window, "the release", |window| !robot(window).stopped);
    for_a_while(window, Duration::from_secs(1));
    assert!(robot(window).measured.as_ref().expect("measured").distance_rad(&stood) < 0.05);
}

#[test]
fn the_twin_is_calibrated_moved_and_stopped() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rig = Rig::built_in("nico").expect("the rig that comes with the program");
    let mut window = window(&folder.path().join("data"), Some("lab"));
    connect(&mut window);
    calibrate_the_eyes(&mut window);
    move_the_arm(&mut window, &rig);
    stop_it(&mut window, &rig);
}
