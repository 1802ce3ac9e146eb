//! The arm with effects gets to where it is sent.

use nalgebra::Vector3;
use plumbline_model::robot::Rig;
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::{Pixel, Point, Robot};

use super::tests::{TIP, effect, nico, with};
use super::*;
use crate::arm::Arm;
use crate::library::{Effect, Kind};

/// Places over the table that the right arm gets to, spread by a fixed sequence.
fn targets(rig: &Rig, count: usize) -> Vec<Point<Robot>> {
    let patch = &rig.work_patch;
    let spread = |k: usize, step: f64, [low, high]: [f64; 2]| low + (high - low) * (k as f64 * step).fract();
    (0..count)
        .map(|k| {
            let x_m = spread(k, 0.618_034, patch.x_range_m);
            let y_m = spread(k, 0.754_878, [patch.y_range_m[0], 0.0]);
            Point::new(x_m, y_m, rig.table.height_m + spread(k, 0.569_840, [0.03, 0.2]))
        })
        .collect()
}

fn usual_shape(kind: Kind) -> Option<f64> {
    match kind {
        Kind::ToothRipple => Some(12.0),
        Kind::TorqueLimit => Some(0.2),
        Kind::ServoWarmUp | Kind::Creep | Kind::SlippedHorn | Kind::ScreenBumped => Some(300.0),
        _ => None,
    }
}

fn conditions(direction: f64) -> Conditions {
    Conditions { direction: vec![direction; 6], payload_kg: 0.1, t_secs: Some(900.0) }
}

/// A model with this effect in usual size.
fn usual(rig: &Rig, of_library: &Effect, sign: f64) -> RigModel {
    let shape = usual_shape(of_library.kind);
    let values: Vec<f64> = of_library.parameters().iter().map(|parameter| sign * parameter.typical).collect();
    with(rig, vec![ModelEffect { shape, ..effect(of_library.id(), &of_library.site, &values) }])
}

#[test]
fn the_tip_gets_to_its_target_with_every_effect_of_usual_size() {
    let rig = nico();
    let solver = Solver::of_rig(&rig, TIP).expect("a tip");
    let arm = Arm::of_rig(&rig, TIP).expect("a tip");
    let start = rig.home().of(solver.joints());
    let (mut moved, mut reached) = (0, 0);
    for of_library in Kind::ALL.iter().flat_map(|kind| Effect::sites(*kind, Some(&arm), None)) {
        for (k, target) in targets(&rig, 4).into_iter().enumerate() {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let here = usual(&rig, &of_library, sign).arm(&rig, TIP).expect("a tip");
            let target = Target::Position(target);
            let conditions = conditions(sign);
            let answer = here
                .reach(&solver, &target, &start, &Options::default(), &conditions)
                .expect("a sound question");
            if !answer.answer.is_reached() {
                continue;
            }
            let there = here.tip(&answer.answer.best().joints, &conditions);
            let off_m = there.distance_m(&target.point());
            assert!(off_m < 5e-5, "{} {k}: {:.3} mm", of_library.name(), off_m * 1e3);
            assert!(answer.is_reached() && (answer.error_m - off_m).abs() < 1e-12);
            for (angle, limits) in answer.answer.best().joints.iter().zip(solver.limits()) {
                assert!(limits.contain(*angle));
            }
            reached += 1;
            moved += usize::from(answer.sent.distance_m(&target.point()) > 1e-4);
        }
    }
    assert!(reached > 200 && moved > reached / 2, "{moved} of {reached} shifted");
}

#[test]
fn several_effects_together_are_undone_too() {
    let rig = nico();
    let effects = vec![
        effect("joint-zero", "r_elbow_y", &[0.05]),
        effect("joint-sag", "r_arm_x", &[0.02]),
        effect("servo-droop", "r_shoulder_y", &[0.03]),
        effect("backlash", "r_arm_x", &[0.01]),
        effect("tip-offset", "tip", &[0.006, -0.004, 0.01]),
        effect("base-tilt", "base", &[0.02, -0.02, 0.01, 0.005, 0.0, -0.01]),
    ];
    let here = with(&rig, effects).arm(&rig, TIP).expect("a tip");
    let solver = Solver::of_rig(&rig, TIP).expect("a tip");
    let start = rig.home().of(solver.joints());
    let mut reached = 0;
    for target in targets(&rig, 30) {
        let answer = here
            .reach(&solver, &Target::Position(target), &start, &Options::upright(), &conditions(1.0))
            .expect("a sound question");
        if answer.answer.is_reached() {
            let there = here.tip(&answer.answer.best().joints, &conditions(1.0));
            assert!(there.distance_m(&target) < 5e-5, "{:?}", answer.status());
            assert!(answer.sent.distance_m(&target) > 5e-3, "the effects are not small");
            reached += 1;
        }
    }
    assert!(reached >= 20, "{reached} of 30");
}

#[test]
fn without_effects_the_answer_is_the_solvers_own() {
    let rig = nico();
    let here = RigModel::nominal(&rig).arm(&rig, TIP).expect("a tip");
    let solver = Solver::of_rig(&rig, TIP).expect("a tip");
    let start = rig.home().of(solver.joints());
    for point in targets(&rig, 10).into_iter().chain([Point::new(3.0, 0.0, 0.0)]) {
        for target in [Target::Position(point), Target::PositionYaw { point, yaw_rad: 0.3 }] {
            let own = solver.solve(&target, &start, &Options::default()).expect("a sound question");
            let answer = here
                .reach(&solver, &target, &start, &Options::default(), &Conditions::default())
                .expect("a sound question");
            assert_eq!(answer.status(), own.status());
            assert_eq!((answer.answer, answer.sent), (own, point));
        }
    }
}

#[test]
fn what_is_out_of_reach_is_said_so() {
    let rig = nico();
    let here = with(&rig, vec![effect("joint-zero", "r_elbow_y", &[0.05])]).arm(&rig, TIP).expect("a tip");
    let solver = Solver::of_rig(&rig, TIP).expect("a tip");
    let start = rig.home().of(solver.joints());
    let far = Target::Position(Point::new(3.0, 0.0, 0.0));
    let answer =
        here.reach(&solver, &far, &start, &Options::default(), &Conditions::default()).expect("answered");
    assert_eq!((answer.is_reached(), answer.status().as_str()), (false, "out-of-reach"));
    assert!(answer.error_m > 2.0);
    let nowhere = Target::Position(Point::new(f64::NAN, 0.0, 0.0));
    assert!(here.reach(&solver, &nowhere, &start, &Options::default(), &Conditions::default()).is_err());
}

#[test]
fn a_touch_lands_on_its_pixel() {
    let rig = nico();
    let solver = Solver::of_rig(&rig, TIP).expect("a tip");
    let start = rig.home().of(solver.joints());
    let effects = vec![
        effect("joint-zero", "r_elbow_y", &[0.04]),
        effect("screen-scale", "screen", &[0.05, -0.03]),
        effect("finger-roll", "tip", &[0.004]),
    ];
    let mut model = with(&rig, effects);
    let motion = nalgebra::Isometry3::new(Vector3::new(0.01, 0.004, -0.003), Vector3::new(0.0, 0.01, 0.03));
    model.contents.screens = vec![PlacedScreen::moved("morning", &rig.touchscreen, &motion)];
    let here = model.arm(&rig, TIP).expect("a tip");
    let screen = model.screen(&rig.touchscreen).expect("placed").clone();
    for (height_m, target) in [(0.0, Pixel::new(900.0, 700.0)), (0.03, Pixel::new(1300.0, 820.0))] {
        let solve = |sent: Point<Robot>| {
            let options = Options::upright();
            let answer = solver.solve(&Target::Position(sent), &start, &options).expect("a sound question");
            assert!(answer.is_reached());
            Ok::<_, ()>((answer.best().joints.to_vec(), vec![1.0; 6]))
        };
        let sent = here.sent_for(&screen, target, height_m, 0.1, solve).expect("solved").expect("settled");
        let (angles, direction) = solve(sent).expect("solved");
        let conditions = Conditions { direction, payload_kg: 0.1, t_secs: None };
        let at = here.touch_m(&angles, height_m, &conditions);
        let ([u_m, v_m], middle) = (screen.pitch_m(), screen.middle());
        let off =
            Vector3::new((target.u_px - middle.u_px) * u_m, (target.v_px - middle.v_px) * v_m, 0.0) - at;
        assert!(off.norm() < 5e-5, "{off}");
        assert!(sent.distance_m(&screen.raised(height_m).point_at(target)) > 3e-3);
    }
}
