//! What can go wrong, and the words it is answered with.

use nalgebra::{Isometry3, Vector3};
use plumbline_model::{Cancelled, JobContext, Unattended};

use super::world::{World, board};
use crate::mount::{HeadView, MountError, MountOptions, Target, calibrate_mount};

fn refusal(world: &World, views: &[HeadView]) -> String {
    world.solve(views).map(|_| ()).expect_err("must be refused").to_string()
}

#[test]
fn too_few_views_and_unseen_boards_are_refused() {
    let mut world = World::new(3);
    let mut views = world.board_views(6);
    let message = refusal(&world, &views[..3]);
    assert!(message.contains("seen in 3 usable view(s), at least 4"), "{message}");
    for view in &mut views {
        (view.left, view.right) = (None, None);
    }
    let message = refusal(&world, &views);
    assert!(message.contains("neither eye sees the target in any of the 6"), "{message}");
    assert!(refusal(&world, &[]).contains("neither eye"), "nothing at all");
}

#[test]
fn a_view_without_the_board_is_left_out_by_name() {
    let mut world = World::new(4);
    let mut views = world.board_views(9);
    (views[2].left, views[2].right) = (None, None);
    views[5].right = None;
    let solved = world.solve(&views).expect("seven views in both eyes, one in the left");
    assert_eq!(solved.rejected.len(), 1);
    assert_eq!(solved.rejected[0].name, views[2].name);
    assert!(solved.rejected[0].reason.contains("neither eye"), "{}", solved.rejected[0].reason);
    assert_eq!(solved.per_view.len(), 8);
    assert!(solved.per_view.iter().any(|fit| fit.name == views[5].name && fit.right_px.is_none()));
}

#[test]
fn a_head_that_stands_still_is_refused() {
    let mut world = World::new(5);
    let corners = world.corners();
    let views: Vec<_> = (0..8).map(|i| world.view(&format!("{i}"), (0.0, -0.5), &corners)).collect();
    let message = refusal(&world, &views);
    assert!(message.contains("only 1 different pose"), "{message}");
}

#[test]
fn turning_about_one_axis_only_names_the_other_joint() {
    for (axis, poses) in [
        ("\"Head left–right\"", (0..8).map(|i| (-0.4 + 0.1 * f64::from(i), -0.5)).collect::<Vec<_>>()),
        ("\"Head down–up\"", (0..8).map(|i| (0.0, -0.75 + 0.1 * f64::from(i))).collect()),
    ] {
        let mut world = World::new(6);
        let corners = world.corners();
        let views: Vec<_> = (0..8).map(|i| world.view(&format!("{i}"), poses[i], &corners)).collect();
        let error = world.solve(&views).map(|_| ()).expect_err("must be refused");
        let MountError::OneAxis { turned, missing } = &error else { panic!("{error}") };
        assert_eq!(turned, axis);
        assert_ne!(missing, axis);
        let words = format!("Take views with {missing} changed");
        assert!(error.to_string().contains(&words), "{error}");
    }
}

#[test]
fn the_view_in_which_the_board_had_moved_is_named_and_the_result_is_not_bent() {
    for shift_m in [0.003, 0.02, 0.15] {
        let mut world = World::new(7);
        let mut views = world.board_views(10);
        let truth = world.mount();
        let kept = world.robot_from_board;
        world.robot_from_board = Isometry3::translation(0.6 * shift_m, -0.8 * shift_m, 0.0) * kept;
        let (pan, tilt) = (world.rig.eyes.pan, world.rig.eyes.tilt);
        let stood = (views[4].posture[pan], views[4].posture[tilt]);
        let corners = world.corners();
        views[4] = world.view("view 4", stood, &corners);
        let solved = world.solve(&views).expect("nine views agree");
        assert_eq!(solved.rejected.len(), 1, "{shift_m}: {:?}", solved.rejected);
        assert_eq!(solved.rejected[0].name, "view 4");
        let stated: f64 = solved.rejected[0]
            .reason
            .split_whitespace()
            .find_map(|word| word.parse().ok())
            .expect("a distance in millimeters");
        assert!((stated - shift_m * 1e3).abs() < 1.5, "{}", solved.rejected[0].reason);
        let off = solved.head_from_left.translation_m() - truth.translation_m();
        assert!(off.norm() < 0.0015, "{off:?}");
    }
}

#[test]
fn a_board_pushed_halfway_is_found_by_the_majority() {
    let mut world = World::new(8);
    let mut views = world.board_views(12);
    world.robot_from_board =
        Isometry3::new(Vector3::new(0.01, 0.005, 0.0), Vector3::z() * 0.05) * world.robot_from_board;
    let corners = world.corners();
    let (pan, tilt) = (world.rig.eyes.pan, world.rig.eyes.tilt);
    for view in &mut views[8..] {
        let stood = (view.posture[pan], view.posture[tilt]);
        *view = world.view(&view.name, stood, &corners);
    }
    let solved = world.solve(&views).expect("eight views agree");
    let mut named: Vec<&str> = solved.rejected.iter().map(|r| r.name.as_str()).collect();
    named.sort_unstable();
    assert_eq!(named, ["view 10", "view 11", "view 8", "view 9"]);
}

#[test]
fn a_board_that_moves_all_the_time_is_refused() {
    let mut world = World::new(9);
    let poses = world.planned(8);
    let still = world.robot_from_board;
    let mut views = vec![];
    for (i, pose) in poses.into_iter().enumerate() {
        let (x, y) = (world.noise.between(-0.03, 0.03), world.noise.between(-0.03, 0.03));
        let yaw = world.noise.between(-0.3, 0.3);
        world.robot_from_board =
            Isometry3::translation(x, y, 0.0) * still * Isometry3::rotation(Vector3::z() * yaw);
        let corners = world.corners();
        views.push(world.view(&format!("view {i}"), pose, &corners));
    }
    let message = refusal(&world, &views);
    assert!(message.contains("do not agree on where the board lies"), "{message}");
}

#[test]
fn single_bad_corners_do_not_matter() {
    let mut world = World::new(10);
    let mut views = world.board_views(10);
    for (view, corner) in [(1, 3), (6, 20), (6, 21)] {
        let corners = views[view].left.as_mut().expect("seen");
        corners[corner].as_mut().expect("seen").u_px += 4.0;
    }
    let solved = world.solve(&views).expect("solvable");
    let left_out = solved.per_view.iter().flat_map(|fit| &fit.residuals).filter(|r| r.left_out).count();
    assert_eq!(left_out, 3);
    assert!(solved.rejected.is_empty());
    assert!(solved.rms_px < 0.3, "{}", solved.rms_px);
}

#[test]
fn numbers_that_are_none_are_refused_by_name() {
    let mut world = World::new(11);
    let good = world.board_views(6);
    let mut views = good.clone();
    views[3].posture[world.rig.eyes.pan] = f64::NAN;
    assert!(refusal(&world, &views).contains("a joint angle of view \"view 3\" is not a number"));
    let mut views = good.clone();
    views[1].right.as_mut().expect("seen")[0].as_mut().expect("seen").v_px = f64::NAN;
    assert!(
        refusal(&world, &views).contains("a pixel in the right image of view \"view 1\" is not a number")
    );
    let mut views = good.clone();
    views[2].left.as_mut().expect("seen").pop();
    let message = refusal(&world, &views);
    assert!(message.contains("39 points in the left image, the target has 40"), "{message}");
    let mut views = good.clone();
    views[2].posture = plumbline_model::robot::Posture::new(vec![0.0; 3]);
    assert!(refusal(&world, &views).contains("has 3 joint angles"));

    let target = Target::UnknownBoard(board());
    let mut cameras = world.rig.eyes.cameras;
    cameras.right_from_left.isometry.translation.vector.x = f64::NAN;
    let options = MountOptions::default();
    let refused = calibrate_mount(&world.rig, &cameras, &good, &target, &options, &Unattended).map(|_| ());
    let message = refused.expect_err("NaN").to_string();
    assert!(message.contains("eyes' calibration is not a number"), "{message}");
    let options = MountOptions { encoder_tick_rad: 0.0, ..MountOptions::default() };
    let message = world.solve_with(&good, &target, &options).expect_err("must be refused").to_string();
    assert!(message.contains("encoder_tick_rad is 0"), "{message}");
    let target = Target::Fingertip { tip: "right_toe".to_owned() };
    let message =
        world.solve_with(&good, &target, &MountOptions::default()).expect_err("no such tip").to_string();
    assert!(message.contains("no link called right_toe"), "{message}");
    let points = vec![plumbline_model::Point::new(0.3, f64::NAN, 0.05)];
    let message = world
        .solve_with(&good, &Target::KnownPoints(points), &MountOptions::default())
        .expect_err("NaN")
        .to_string();
    assert!(message.contains("known point 1"), "{message}");
}

#[test]
fn eyes_of_different_moments_are_left_out_by_name() {
    let mut world = World::new(12);
    let mut views = world.board_views(8);
    for corner in views[5].right.as_mut().expect("seen").iter_mut().flatten() {
        corner.v_px += 6.0;
    }
    let solved = world.solve(&views).expect("seven views agree");
    assert_eq!(solved.rejected.len(), 1);
    assert_eq!(solved.rejected[0].name, "view 5");
    assert!(solved.rejected[0].reason.contains("same moment"), "{}", solved.rejected[0].reason);
}

#[test]
fn cancelling_stops_at_once() {
    struct Stop;
    impl JobContext for Stop {
        fn checkpoint(&self) -> Result<(), Cancelled> {
            Err(Cancelled)
        }
        fn report(&self, _: f64, _: &str) {}
    }
    let mut world = World::new(13);
    let views = world.board_views(6);
    let target = Target::UnknownBoard(board());
    let cameras = world.rig.eyes.cameras;
    let result = calibrate_mount(&world.rig, &cameras, &views, &target, &MountOptions::default(), &Stop);
    assert_eq!(result, Err(MountError::Cancelled(Cancelled)));
}
