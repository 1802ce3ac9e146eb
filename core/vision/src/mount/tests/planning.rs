//! Planned head poses.

use nalgebra::Isometry3;
use plumbline_model::{Chessboard, Pose};

use super::world::{World, board};
use crate::mount::{PlannedTarget, expected_sigma, plan_head_views};

#[test]
fn planned_head_poses_keep_the_limits_and_beat_poses_in_a_row() {
    let world = World::new(33);
    let (pan, tilt) = (world.rig.eyes.pan, world.rig.eyes.tilt);
    let poses = world.planned(12);
    assert_eq!(poses.len(), 12);
    for (pan_rad, tilt_rad) in &poses {
        let posture = world.rig.home().with(&[pan, tilt], &[*pan_rad, *tilt_rad]);
        assert!(world.rig.limits_in(tilt, &posture).contain(*tilt_rad));
        assert!(world.rig.limits_in(pan, &posture).contain(*pan_rad));
    }
    // The way from each to the next stays within the limits too.
    for pair in poses.windows(2) {
        for step in 0..=10 {
            let part = f64::from(step) / 10.0;
            let (pan_rad, tilt_rad) =
                (pair[0].0 + part * (pair[1].0 - pair[0].0), pair[0].1 + part * (pair[1].1 - pair[0].1));
            let posture = world.rig.home().with(&[pan, tilt], &[pan_rad, tilt_rad]);
            assert!(world.rig.limits_in(pan, &posture).contain(pan_rad), "{pair:?}");
        }
    }
    let sigma = |poses: &[(f64, f64)]| {
        let mut world = World { pixel_px: 0.15, ..World::new(33) };
        let corners = world.corners();
        let views: Vec<_> =
            poses.iter().enumerate().map(|(i, p)| world.view(&format!("{i}"), *p, &corners)).collect();
        let solved = world.solve(&views).expect("solvable");
        solved.covariance.determinant().powf(1.0 / 12.0)
    };
    let row: Vec<_> =
        (0..12).map(|i| (0.1 * f64::from(i % 6) - 0.25, -0.55 + 0.1 * f64::from(i / 6))).collect();
    assert!(sigma(&poses) < 0.5 * sigma(&row), "{} {}", sigma(&poses), sigma(&row));
}

#[test]
fn a_board_out_of_view_cannot_be_planned_for() {
    let world = World::new(34);
    let behind = Isometry3::translation(-0.6, 0.0, 0.054) * world.robot_from_board.rotation;
    let what = PlannedTarget::board(&Chessboard::new(8, 5, 0.03).expect("usable"), &Pose::new(behind));
    let refused = plan_head_views(&world.rig, &world.rig.eyes.cameras, &world.rig.home(), &what, 10);
    let message = refused.expect_err("behind the robot").to_string();
    assert!(message.contains("move the board"), "{message}");
}

#[test]
fn the_expected_uncertainty_is_the_one_that_comes_out() {
    let mut world = World { pixel_px: 0.15, ..World::new(38) };
    let poses = world.planned(12);
    let place = Pose::new(world.robot_from_board);
    let what = PlannedTarget::board(&board(), &place);
    let cameras = world.rig.eyes.cameras;
    let home = world.rig.home();
    let (turn, shift) = expected_sigma(&world.rig, &cameras, &home, &what, &poses).expect("determined");
    let corners = world.corners();
    let views: Vec<_> =
        poses.iter().enumerate().map(|(i, p)| world.view(&format!("{i}"), *p, &corners)).collect();
    let solved = world.solve(&views).expect("solvable");
    let ratios =
        [turn.component_div(&solved.turned_sigma_rad()), shift.component_div(&solved.moved_sigma_m())];
    assert!(ratios.iter().flat_map(|r| r.iter()).all(|r| (0.8..1.25).contains(r)), "{ratios:?}");
    // One pose alone says nothing about a board at an unknown place.
    assert!(expected_sigma(&world.rig, &cameras, &home, &what, &poses[..1]).is_none());
}
