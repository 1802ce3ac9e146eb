//! Known points, the fingertip, encoder zeros, far-off starts, boards counted from either end.

use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use plumbline_model::robot::EyeMount;
use plumbline_model::{Eye, Point, Robot};

use super::honesty::{coverage, error};
use super::world::{World, board};
use crate::mount::{HeadView, LocatedPoint, MountOptions, Target, localization_improvement};

/// Corners of the touchscreen: at its far left, far right, near right and near left end.
fn screen(world: &World) -> Vec<Point<Robot>> {
    let Target::KnownPoints(points) = Target::touchscreen(&world.rig.touchscreen) else { panic!("points") };
    assert!(points[0].distance_m(&Point::new(0.545, 0.2375, 0.056)) < 1e-9);
    assert!(points[2].distance_m(&Point::new(0.278, -0.2375, 0.056)) < 1e-9);
    points
}

fn exact() -> MountOptions {
    MountOptions { known_place_sd_m: 0.0, known_turn_sd_rad: 0.0, ..MountOptions::default() }
}

#[test]
fn the_corners_of_the_touchscreen_give_the_mount_with_errors_of_the_stated_size() {
    let options =
        MountOptions { known_place_sd_m: 0.002, known_turn_sd_rad: 0.004, ..MountOptions::default() };
    let (chi_square, within) = coverage(40, |seed| {
        let mut world = World::new(100 + seed);
        let nominal = screen(&world);
        // Where it really lies, as well as the options say.
        let mut vector =
            |sd: f64| Vector3::new(world.noise.normal(), world.noise.normal(), world.noise.normal()) * sd;
        let (shift, turn) = (vector(0.002), UnitQuaternion::from_scaled_axis(vector(0.004)));
        let middle = nominal.iter().map(|p| p.coords.coords).sum::<Vector3<f64>>() / 4.0;
        let real: Vec<_> = nominal
            .iter()
            .map(|p| Point::from(nalgebra::Point3::from(turn * (p.coords.coords - middle) + middle + shift)))
            .collect();
        let views: Vec<_> = (0..10)
            .map(|i| {
                let pose = (0.08 * f64::from(i - 5), -0.35 - 0.05 * f64::from(i % 4));
                world.view(&format!("{i}"), pose, &real)
            })
            .collect();
        let solved = world.solve_with(&views, &Target::KnownPoints(nominal), &options);
        (world, solved)
    });
    assert!((4.5..7.5).contains(&chi_square), "{chi_square}");
    assert!(within >= 0.95, "{within}");
}

#[test]
fn the_fingertip_gives_the_mount_with_errors_of_the_stated_size() {
    let (chi_square, within) = coverage(40, |seed| {
        let mut world = World::new(200 + seed);
        let tip = world.rig.chain("right_index_tip").expect("a tip");
        let arm = world.rig.arm("right").expect("an arm").joints.clone();
        let ready = world.rig.pose("touch-ready").expect("a pose").clone();
        let views: Vec<HeadView> = (0..30)
            .map(|i| {
                let (mut posture, mut truth) =
                    world.stand(0.06 * f64::from(i % 6) - 0.3, -0.6 + 0.1 * f64::from(i % 5));
                let mut arms = ready.applied_to(&posture);
                for joint in &arm {
                    let limits = world.rig.limits(*joint);
                    arms[*joint] = (arms[*joint] + world.noise.between(-0.35, 0.35))
                        .clamp(limits.lower_rad, limits.upper_rad);
                }
                for joint in &arm {
                    posture[*joint] = arms[*joint];
                    truth[*joint] = arms[*joint];
                }
                let off =
                    Vector3::new(world.noise.normal(), world.noise.normal(), world.noise.normal()) * 0.004;
                let place = tip.robot_from_tip_in(&posture).translation_m() + off;
                let point = [Point::new(place.x, place.y, place.z)];
                let [left, right] = Eye::BOTH.map(|eye| Some(world.pixels(&truth, &point, eye)));
                HeadView { name: format!("{i}"), posture, left, right }
            })
            .filter(|view| view.pixels(Eye::Left).into_iter().flatten().all(Option::is_some))
            .collect();
        let target = Target::Fingertip { tip: "right_index_tip".to_owned() };
        let solved = world.solve_with(&views, &target, &MountOptions::default());
        (world, solved)
    });
    assert!((4.5..7.5).contains(&chi_square), "{chi_square}");
    assert!(within >= 0.95, "{within}");
}

#[test]
fn encoder_zeros_that_cannot_be_told_from_the_mount_are_said() {
    let mut world = World { zeros_rad: [0.02, -0.015], ..World::new(30) };
    let views = world.board_views(12);
    let options = MountOptions { head_zero_sd_rad: Some(0.02), ..exact() };
    let solved = world.solve_with(&views, &Target::UnknownBoard(board()), &options).expect("solvable");
    assert!(
        solved
            .not_seen
            .iter()
            .any(|s| s.contains("zero of \"Head left–right\"") && s.contains("unknown place")),
        "{:?}",
        solved.not_seen
    );
    assert!(
        solved
            .not_seen
            .iter()
            .any(|s| s.contains("zero of \"Head down–up\"") && s.contains("together they are right"))
    );
    let zeros = solved.head_zeros_rad.expect("asked for");
    assert!(zeros.iter().all(|zero| zero.sigma > 0.018), "{zeros:?}");
    // What cannot be told apart is uncertain together: the turn about y carries the zero's prior.
    assert!(solved.turned_sigma_rad().y > 0.018);

    // With known points the zero of the joint that turns the head sideways shows.
    let points = screen(&world);
    let mut views = vec![];
    for i in 0..12 {
        let pose = (0.08 * f64::from(i - 6), -0.2 - 0.1 * f64::from(i % 5));
        views.push(world.view(&format!("{i}"), pose, &points));
    }
    let solved = world.solve_with(&views, &Target::KnownPoints(points), &options).expect("solvable");
    let zeros = solved.head_zeros_rad.expect("asked for");
    assert!(zeros[0].sigma < 0.01 && (zeros[0].value - 0.02).abs() < 3.0 * zeros[0].sigma, "{zeros:?}");
    assert!(!solved.not_seen.iter().any(|s| s.contains("left–right")), "{:?}", solved.not_seen);
    assert!(solved.not_seen.iter().any(|s| s.contains("down–up")), "{:?}", solved.not_seen);
}

#[test]
fn a_nominal_mount_that_is_far_off_does_not_matter() {
    for (turn, shift) in [(0.8, 0.1), (2.5, 0.3)] {
        let mut world = World::new(31);
        let views = world.board_views(10);
        let near = world.solve(&views).expect("solvable");
        let axis = UnitQuaternion::from_scaled_axis(Vector3::new(0.5, -0.6, 0.62).normalize() * turn);
        let nominal = world.rig.eyes.head_from_left.isometry;
        let wrong = Isometry3::from_parts(
            (nominal.translation.vector.add_scalar(shift)).into(),
            axis * nominal.rotation,
        );
        world.rig.eyes =
            EyeMount { head_from_left: plumbline_model::Pose::new(wrong), ..world.rig.eyes.clone() };
        let far = world.solve(&views).expect("solvable");
        assert!((far.head_from_left.translation_m() - near.head_from_left.translation_m()).norm() < 1e-5);
        assert!(far.change.moved_m.norm() > shift);

        let points = screen(&world);
        let views: Vec<_> =
            (0..6).map(|i| world.view(&format!("{i}"), (0.1 * f64::from(i - 3), -0.4), &points)).collect();
        let far = world.solve_with(&views, &Target::KnownPoints(points), &exact()).expect("solvable");
        assert!(error(&world.mount(), &far).amax() < 0.01, "{}", error(&world.mount(), &far));
    }
}

#[test]
fn a_board_that_looks_the_same_upside_down_may_be_counted_from_either_end() {
    let mut world = World::new(32);
    let mut views = world.board_views(8);
    for i in [1, 4, 5] {
        let view = &mut views[i];
        for corners in [&mut view.left, &mut view.right] {
            corners.as_mut().expect("seen").reverse();
        }
    }
    let solved = world.solve(&views).expect("solvable");
    assert!(solved.rejected.is_empty() && solved.rms_px < 0.4, "{:?}", solved.rejected);
    assert!(error(&world.mount(), &solved).amax() < 0.003);
}

#[test]
fn a_calibrated_mount_localizes_better() {
    let mut world = World::new(35);
    let views = world.board_views(12);
    let solved = world.solve(&views).expect("solvable");
    let mut points = vec![];
    for (x, y) in [(0.3, -0.1), (0.4, 0.1), (0.45, 0.0), (0.35, 0.2)] {
        let truth = Point::new(x, y, 0.06);
        let (encoder, real) = world.stand(0.1, -0.5);
        let [left, right] = Eye::BOTH.map(|eye| world.pixels(&real, &[truth], eye)[0].expect("in view"));
        points.push(LocatedPoint { posture: encoder, left, right, truth });
    }
    let cameras = world.rig.eyes.cameras;
    let better =
        localization_improvement(&world.rig, &cameras, &solved.head_from_left, &points).expect("rays meet");
    assert!(better.before_rms_m > 0.004, "{better:?}");
    // What is left is the match itself: a millimeter or two of depth.
    assert!(better.after_rms_m < 0.4 * better.before_rms_m, "{better:?}");
    let rig = solved.applied_to(&world.rig);
    assert_eq!(rig.eyes.head_from_left, solved.head_from_left);
    assert!((0.0001..0.002).contains(&solved.point_sigma_m(Point::new(0.0, 0.0, 0.4))));
}

#[test]
fn known_points_that_are_elsewhere_and_slack_are_remarked() {
    let mut world = World { slack_rad: 0.004, ..World::new(36) };
    let nominal = screen(&world);
    let real: Vec<_> = nominal.iter().map(|p| Point::from(p.coords + Vector3::new(0.02, 0.0, 0.0))).collect();
    let views: Vec<_> = (0..14)
        .map(|i| {
            world.view(&format!("{i}"), (0.08 * f64::from(i - 7), -0.3 - 0.08 * f64::from(i % 4)), &real)
        })
        .collect();
    let solved =
        world.solve_with(&views, &Target::KnownPoints(nominal), &MountOptions::default()).expect("solvable");
    assert!(solved.remarks.iter().any(|r| r.contains("known points lie")), "{:?}", solved.remarks);
    assert!(
        solved.remarks.iter().any(|r| r.contains("\"Head left–right\" stands") && r.contains("slack")),
        "{:?}",
        solved.remarks
    );
    assert!(
        solved.remarks.iter().any(|r| r.contains("own calibration is not known")),
        "{:?}",
        solved.remarks
    );
}

#[test]
fn too_few_known_points_say_what_they_do_not_show() {
    let mut world = World::new(37);
    let point = vec![Point::new(0.4, 0.0, 0.06)];
    let views: Vec<_> = (0..4).map(|i| world.view(&format!("{i}"), (0.1, -0.5), &point)).collect();
    let solved =
        world.solve_with(&views, &Target::KnownPoints(point), &exact()).expect("a solution, of sorts");
    assert!(solved.not_seen.iter().any(|s| s.contains("turn about")), "{:?}", solved.not_seen);
    assert!(solved.not_seen.iter().any(|s| s.contains("place along")), "{:?}", solved.not_seen);
    assert!(solved.not_seen.iter().all(|s| s.contains("look at more points")), "{:?}", solved.not_seen);
}
