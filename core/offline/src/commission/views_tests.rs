//! How many views of the board are enough: eyes and mounts from fewer and from more of them, held against
//! boards at places that none of them was solved with.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use plumbline_engine::eyes::work::gray;
use plumbline_model::{Board, CalibrationOptions, PairObservation, Pose, Robot as RobotFrame, Unattended};
use plumbline_twin::{board_presets, default_board, few_board_presets};
use plumbline_vision::calibrate::solve;
use plumbline_vision::chessboard::find_in_pair;
use plumbline_vision::mount::{
    HeadView, MountOptions, PlannedTarget, Target, calibrate_mount, plan_head_views,
};

use super::eyes::{length_error_mm, lying_board};
use super::mount::wander_mm;
use super::robot::Robot;
use super::*;

/// Where the board lies as it is looked at for the mount, and for judging it, robot frame, m.
const LIES_AT_M: [f64; 3] = [0.36, 0.0, 0.10];
const JUDGED_AT_M: [f64; 3] = [0.40, 0.08, 0.05];

/// Seen in one moment.
fn see(robot: &mut Robot, name: String) -> (HeadView, [(u32, u32); 2]) {
    let sight = robot.look().expect("eyes are rendered");
    let sizes_px = [sight.left.dimensions(), sight.right.dimensions()];
    let found = find_in_pair(&name, &gray(&sight.left), &gray(&sight.right), &default_board());
    (HeadView::new(found.observation, sight.posture), sizes_px)
}

/// From so many head poses.
fn tour(lab: &Lab, robot: &mut Robot, lying: Pose<RobotFrame, Board>, count: usize) -> Vec<HeadView> {
    robot.hold_board(Some(lying));
    let target = PlannedTarget::board(&default_board(), &lying);
    let poses = plan_head_views(&lab.rig, &lab.rig.eyes.cameras, &lab.rig.home(), &target, count);
    let views = poses.expect("it is seen").into_iter().enumerate().map(|(k, (pan_rad, tilt_rad))| {
        let head = [lab.rig.eyes.pan, lab.rig.eyes.tilt];
        robot.go(&lab.rig.home().with(&head, &[pan_rad, tilt_rad]));
        see(robot, format!("table {count} {k:02}")).0
    });
    let views = views.collect();
    robot.go(&lab.rig.home());
    views
}

/// Elsewhere than where it was shown: turned and shifted a little.
fn beside(place: &Pose<RobotFrame, Board>) -> Pose<RobotFrame, Board> {
    let turn = UnitQuaternion::from_euler_angles(0.15, -0.12, 0.2);
    let by = Isometry3::from_parts(Translation3::from(Vector3::new(0.01, -0.01, 0.02)), turn);
    Pose::new(place.isometry * by)
}

#[test]
#[ignore = "some minutes: figures for choosing how often the board is looked at"]
fn how_many_views_of_the_board_are_enough() {
    let scenarios = std::env::var("PLUMBLINE_SCENARIO").unwrap_or_else(|_| "lab".to_owned());
    for name in scenarios.split(',') {
        let folder = tempfile::tempdir().expect("a folder");
        let rig = Arc::new(Rig::built_in("nico").expect("comes with the program"));
        let scenario = scenario(name).expect("there is one");
        let lab = Lab { folder: folder.path().to_owned(), rig, scenario, seed: 1 };
        let mut robot = Robot::new(&lab, 20.0 * 60.0, None).expect("a twin");
        let mut sizes_px = [(0, 0); 2];
        let mut held = |robot: &mut Robot, places: Vec<Pose<RobotFrame, Board>>, of: &str| {
            let seen = places.into_iter().enumerate().map(|(k, place)| {
                robot.hold_board(Some(place));
                let (view, sizes) = see(robot, format!("{of} {k:02}"));
                sizes_px = sizes;
                PairObservation { name: view.name, left: view.left, right: view.right }
            });
            seen.collect::<Vec<PairObservation>>()
        };
        let all = held(&mut robot, board_presets(&lab.rig), "held");
        let few = held(&mut robot, few_board_presets(&lab.rig), "few");
        let judged: Vec<_> = board_presets(&lab.rig).iter().map(beside).collect();
        let judged = held(&mut robot, judged, "judged");
        let lying = lying_board(&default_board(), LIES_AT_M);
        let tours = [8, 14].map(|count| tour(&lab, &mut robot, lying, count));
        let of_judge = tour(&lab, &mut robot, lying_board(&default_board(), JUDGED_AT_M), 12);

        let board = default_board();
        let options = CalibrationOptions::default();
        for (title, pairs, tour) in [
            ("22 held, mount from 14", &all, &tours[1]),
            ("22 held, mount from 8", &all, &tours[0]),
            ("12 held, mount from 14", &few, &tours[1]),
            ("12 held, mount from 8", &few, &tours[0]),
            ("12 held and 8 lying, mount from these 8", &few, &tours[0]),
        ] {
            let pair = |view: &HeadView| PairObservation {
                name: view.name.clone(),
                left: view.left.clone(),
                right: view.right.clone(),
            };
            let lying = title.contains("lying").then(|| tour.iter().map(pair));
            let pairs: Vec<PairObservation> =
                pairs.iter().cloned().chain(lying.into_iter().flatten()).collect();
            let solved = solve(&board, &pairs, sizes_px, &options, &[], &Unattended).expect("solved");
            let target = Target::UnknownBoard(board);
            let mount =
                calibrate_mount(&lab.rig, &solved, tour, &target, &MountOptions::default(), &Unattended)
                    .expect("solved");
            let lengths_mm = length_error_mm(&solved.cameras, &board, &judged).unwrap_or(f64::NAN);
            let with_eyes = mount.applied_to(&lab.rig);
            let wander_mm = wander_mm(&with_eyes, &solved.cameras, &of_judge, &of_judge).unwrap_or(f64::NAN);
            println!(
                "{name}: {title}: {} pairs; lengths on other boards {lengths_mm:.2} mm; a lying board from 12 \
                 other head poses wanders by {wander_mm:.2} mm",
                pairs.len()
            );
            assert!(lengths_mm < 2.0 && wander_mm < 5.0);
        }
    }
}
