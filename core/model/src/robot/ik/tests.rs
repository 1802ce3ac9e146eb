//! Laws: what was reached is where forward kinematics says; limits hold; a solution stays; near
//! targets have near solutions; and every way to fail is told apart.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

use super::*;
use crate::frame::{Point, Pose};
use crate::robot::{Chain, Limits, Posture, Rig};

struct Arm {
    rig: Rig,
    solver: Solver,
    chain: Chain,
}

fn arm(tip: &str) -> Arm {
    let rig = Rig::built_in("nico").expect("a valid rig");
    Arm { solver: Solver::of_rig(&rig, tip).expect("a tip"), chain: rig.chain(tip).expect("a tip"), rig }
}

impl Arm {
    fn home(&self) -> Vec<f64> {
        self.rig.home().of(self.solver.joints())
    }

    /// Angles spread over the whole range, away from the limits by `margin` of the span.
    fn spread(&self, count: usize, margin: f64) -> Vec<Vec<f64>> {
        let mut state = 7u64;
        let mut uniform = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut angles = || {
            let within =
                |l: &Limits, u: f64| l.lower_rad + l.span_rad() * (margin + (1.0 - 2.0 * margin) * u);
            self.solver.limits().iter().map(|l| within(l, uniform())).collect()
        };
        (0..count).map(|_| angles()).collect()
    }

    fn place(&self, angles: &[f64]) -> Isometry3<f64> {
        self.chain.robot_from_tip(angles).isometry
    }

    fn solve(&self, target: &Target) -> Answer {
        self.solver.solve(target, &self.home(), &Options::default()).expect("a proper question")
    }

    fn assert_inside(&self, angles: &[f64]) {
        for (angle, limits) in angles.iter().zip(self.solver.limits()) {
            assert!(limits.contain(*angle), "{angle} outside of {limits:?}");
        }
    }
}

fn point(place: &Isometry3<f64>) -> Point<crate::frame::Robot> {
    Point::from(Point3::from(place.translation.vector))
}

fn targets(place: &Isometry3<f64>) -> [Target; 3] {
    let yaw_rad = place.rotation.euler_angles().2;
    [
        Target::Position(point(place)),
        Target::PositionYaw { point: point(place), yaw_rad },
        Target::Pose(Pose::new(*place)),
    ]
}

#[test]
fn what_is_reached_is_where_forward_kinematics_says() {
    for tip in ["right_palm_center", "left_palm_center", "right_index_tip", "left_index_tip"] {
        let arm = arm(tip);
        for place in arm.spread(250, 0.0).iter().map(|angles| arm.place(angles)) {
            for (target, upright) in targets(&place).into_iter().flat_map(|t| [(t, false), (t, true)]) {
                let options = if upright { Options::upright() } else { Options::default() };
                let answer = arm.solver.solve(&target, &arm.home(), &options).expect("proper");
                let Answer::Reached(solution) = answer else { panic!("{tip} {target:?}: {answer:?}") };
                arm.assert_inside(&solution.joints);
                let there = arm.place(&solution.joints);
                assert!((there.translation.vector - place.translation.vector).norm() < 1e-5);
                match target {
                    Target::Position(_) => {}
                    Target::PositionYaw { yaw_rad, .. } => {
                        let x = there.rotation * Vector3::x();
                        let across = Vector3::new(-yaw_rad.sin(), yaw_rad.cos(), 0.0).dot(&x);
                        assert!(across.abs() < 1e-4, "{across}");
                    }
                    Target::Pose(_) => assert!(there.rotation.angle_to(&place.rotation) < 1.1e-4),
                }
            }
        }
    }
}

#[test]
fn at_the_solution_nothing_is_computed_and_nothing_moves() {
    let arm = arm("right_palm_center");
    for angles in arm.spread(50, 0.05) {
        let place = arm.place(&angles);
        let yaw_rad = place.rotation.euler_angles().2;
        let heading = Target::PositionYaw { point: point(&place), yaw_rad };
        for target in [Target::Position(point(&place)), heading, Target::Pose(Pose::new(place))] {
            let answer = arm.solver.solve(&target, &angles, &Options::default()).expect("proper");
            assert!(answer.is_reached());
            assert_eq!((answer.best().iterations, &*answer.best().joints), (0, &angles[..]));
        }
    }
}

#[test]
fn near_targets_have_near_solutions() {
    let arm = arm("right_palm_center");
    let step_m = 0.001;
    let mut largest: f64 = 0.0;
    for angles in arm.spread(100, 0.2) {
        // From the place itself along a line, always from the solution before: as a hand is jogged.
        let place = arm.place(&angles);
        for (i, along) in [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().enumerate() {
            let mut at = angles.clone();
            for k in 1..=10 {
                let moved = Translation3::from(along * (step_m * f64::from(k))) * place;
                let target = targets(&moved)[i];
                let Answer::Reached(next) =
                    arm.solver.solve(&target, &at, &Options::default()).expect("proper")
                else {
                    break;
                };
                let jump = at.iter().zip(&*next.joints).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                largest = largest.max(jump);
                at = next.joints.to_vec();
            }
        }
    }
    assert!(largest > 1e-4 && largest < 0.15, "{largest}");
}

#[test]
fn narrower_limits_hold_exactly() {
    let arm = arm("right_palm_center");
    let narrower: Vec<Limits> = arm
        .solver
        .limits()
        .iter()
        .map(|l| Limits {
            lower_rad: l.lower_rad + 0.2 * l.span_rad(),
            upper_rad: l.upper_rad - 0.2 * l.span_rad(),
        })
        .collect();
    let options = Options { limits: Some(narrower.clone()), ..Options::default() };
    let mut reached = 0;
    for angles in arm.spread(200, 0.0) {
        let target = Target::Position(point(&arm.place(&angles)));
        let answer = arm.solver.solve(&target, &arm.home(), &options).expect("proper");
        reached += usize::from(answer.is_reached());
        let joints = answer.best().joints;
        assert!(joints.iter().zip(&narrower).all(|(angle, limits)| limits.contain(*angle)), "{joints:?}");
    }
    assert!(reached > 50 && reached < 200, "{reached}");
}

#[test]
fn a_rest_posture_draws_the_free_joints_and_costs_no_accuracy() {
    let arm = arm("right_palm_center");
    let rest: Vec<f64> = arm.solver.limits().iter().map(Limits::middle_rad).collect();
    let rested = Options { rest: Some(rest.clone()), ..Options::default() };
    let half = Options { pull: 0.5, ..rested.clone() };
    let away = |joints: &[f64]| joints.iter().zip(&rest).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let mut sums = [0.0; 3];
    for angles in arm.spread(100, 0.1) {
        let target = Target::Position(point(&arm.place(&angles)));
        for (sum, options) in sums.iter_mut().zip([&Options::default(), &half, &rested]) {
            let answer = arm.solver.solve(&target, &arm.home(), options).expect("proper");
            assert!(answer.is_reached() && answer.best().position_error_m < 1e-5);
            *sum += away(&answer.best().joints);
        }
    }
    assert!(sums[2] < 0.9 * sums[0] && sums[1] < sums[0], "{sums:?}");
}

#[test]
fn a_rest_posture_gives_the_same_solution_from_wherever_the_arm_is() {
    let arm = arm("right_palm_center");
    let rest: Vec<f64> = arm.solver.limits().iter().map(Limits::middle_rad).collect();
    let options = Options { rest: Some(rest.clone()), ..Options::default() };
    // Targets near the rest posture: far away the solution nearest to it need not be unique.
    for offset in [[0.1, -0.1, 0.1, 0.2, 0.3, 0.1], [-0.2, 0.1, 0.1, -0.1, 0.1, 0.2]] {
        let near: Vec<f64> = rest.iter().zip(offset).map(|(angle, o)| angle + o).collect();
        let target = Target::Position(point(&arm.place(&near)));
        let from = |start: &[f64]| arm.solver.solve(&target, start, &options).expect("proper").best().joints;
        let (a, b) = (from(&near), from(&rest));
        let apart = a.iter().zip(&*b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.02, "{a:?} {b:?}");
    }
}

#[test]
fn a_top_grasp_keeps_the_palm_as_level_as_the_arm_can() {
    let arm = arm("right_palm_center");
    let at = Point::new(0.3, -0.2, 0.15);
    let tilt = |target: &Target, options: &Options| {
        let answer = arm.solver.solve(target, &arm.home(), options).expect("proper");
        assert!(answer.is_reached(), "{answer:?}");
        (arm.place(&answer.best().joints).rotation * Vector3::z()).angle(&Vector3::z())
    };
    for target in [Target::Position(at), Target::PositionYaw { point: at, yaw_rad: 0.3 }] {
        let (level, any) = (tilt(&target, &Options::upright()), tilt(&target, &Options::default()));
        assert!(level < 0.8 * any, "{level} {any}");
    }
}

#[test]
fn too_far_is_out_of_reach_by_the_missing_length() {
    let arm = arm("right_palm_center");
    let toward = Vector3::new(1.0, -0.6, 0.1).normalize();
    let shoulder = Vector3::new(0.0, -0.14, 0.24);
    let at = |distance_m: f64| {
        let answer = arm.solve(&Target::Position(Point::from(Point3::from(shoulder + toward * distance_m))));
        match answer {
            Answer::OutOfReach { by_m, best } => (by_m, best.position_error_m),
            other => panic!("{other:?}"),
        }
    };
    let ((near_m, best_m), (far_m, _)) = (at(0.8), at(1.8));
    assert_eq!(near_m, best_m);
    // One meter farther along the same ray is (nearly) one meter farther out of reach.
    assert!((far_m - near_m - 1.0).abs() < 0.01, "{near_m} {far_m}");
    assert!(near_m > 0.2 && near_m < 0.5, "{near_m}");
}

#[test]
fn a_limit_that_stands_in_the_way_is_named() {
    let arm = arm("right_palm_center");
    let open: Vec<f64> = arm.solver.limits().iter().map(Limits::middle_rad).collect();
    let target = Target::Pose(Pose::new(arm.place(&open)));
    for i in 0..open.len() {
        // All joints could go there, but one may not go all the way.
        let mut limits = arm.solver.limits().to_vec();
        limits[i].upper_rad = open[i] - 0.05;
        let options = Options { limits: Some(limits.clone()), ..Options::default() };
        let answer = arm.solver.solve(&target, &arm.home(), &options).expect("proper");
        let Answer::LimitedBy { name, limit_rad, best, .. } = &answer else { panic!("{i}: {answer:?}") };
        assert!(*limit_rad == limits[i].upper_rad && *name == arm.solver.names()[i], "{i}: {answer:?}");
        assert_eq!(answer.status(), format!("limited-by:{name}"));
        assert!(best.position_error_m + best.orientation_error_rad > 1e-3);
        assert!(limits.iter().zip(&*best.joints).all(|(limits, angle)| limits.contain(*angle)));
    }
}

#[test]
fn nonsense_is_refused_with_a_sentence() {
    let arm = arm("right_palm_center");
    let good = Target::Position(Point::new(0.3, -0.2, 0.2));
    let bad = Target::Position(Point::new(f64::NAN, 0.0, 0.2));
    let turned = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(f64::NAN, 0.0, 0.0, 0.0));
    let bad_pose = Target::Pose(Pose::new(Isometry3::from_parts(Translation3::identity(), turned)));
    let bad_yaw = Target::PositionYaw { point: good.point(), yaw_rad: f64::INFINITY };
    let refused = |target: &Target, start: &[f64], options: &Options| {
        arm.solver.solve(target, start, options).expect_err("must be refused").to_string()
    };
    let plain = Options::default();
    for target in [bad, bad_pose, bad_yaw] {
        assert!(refused(&target, &arm.home(), &plain).contains("target holds a value that is not a number"));
    }
    assert!(refused(&good, &[f64::NAN; 6], &plain).contains("start posture"));
    assert!(refused(&good, &[0.0; 5], &plain).contains("5 values for the 6 joints"));
    let rest = Options { rest: Some(vec![f64::NAN; 6]), ..plain.clone() };
    assert!(refused(&good, &arm.home(), &rest).contains("rest posture"));
    let pulled = Options { pull: f64::NAN, ..plain.clone() };
    assert!(refused(&good, &arm.home(), &pulled).contains("from 0 (none) to 1"));
    let mut limits = arm.solver.limits().to_vec();
    limits[2] = Limits { lower_rad: 5.0, upper_rad: 6.0 };
    let nowhere = Options { limits: Some(limits), ..plain };
    assert!(refused(&good, &arm.home(), &nowhere).contains("r_arm_x"));
    assert!(
        Solver::of_rig(&arm.rig, "right_toe").expect_err("no such tip").to_string().contains("right_toe")
    );
    assert!(Solver::of_rig(&arm.rig, "torso").expect_err("no joints").to_string().contains("0 joints"));
}

#[test]
fn a_start_beyond_the_limits_leads_inside() {
    let arm = arm("right_palm_center");
    let answer = arm
        .solver
        .solve(
            &Target::Position(Point::new(0.3, -0.2, 0.2)),
            &[9.0, -9.0, 9.0, -9.0, 9.0, -9.0],
            &Options::default(),
        )
        .expect("proper");
    assert!(answer.is_reached());
    arm.assert_inside(&answer.best().joints);
}

#[test]
fn different_solutions_all_reach_and_the_first_is_the_usual_one() {
    let arm = arm("right_palm_center");
    let target = Target::Position(Point::new(0.3, -0.2, 0.2));
    let all = arm.solver.solutions(&target, &arm.home(), &Options::default(), 6).expect("proper");
    assert!(all.len() > 1);
    assert_eq!(all[0].joints, arm.solve(&target).best().joints);
    for solution in &all {
        let there = arm.place(&solution.joints).translation.vector;
        assert!((there - target.point().coords.coords).norm() < 1e-5);
    }
}

#[test]
fn the_head_is_a_chain_too() {
    let arm = arm("mid_eyes");
    let posture = Posture::new(vec![0.1; arm.rig.description.movable_count()]);
    let target = Target::Position(point(&arm.place(&[0.4, -0.3])));
    let answer = arm.solver.solve_from(&target, &posture, &Options::default()).expect("proper");
    assert!(answer.is_reached(), "{answer:?}");
}
