//! NICO on its table: what is clear, what collides, and where.

use std::time::Instant;

use super::*;
use crate::frame::{Point, Robot};
use crate::robot::ik::{Options, Target};
use crate::robot::{JointIndex, Posture, Reach, ReachError, ReachOptions, Refusal, Rig};

const TIP: &str = "right_palm_center";

fn nico() -> (Rig, CollisionModel) {
    let rig = Rig::built_in("nico").expect("a valid rig");
    let model = CollisionModel::of_rig(&rig);
    (rig, model)
}

fn at(rig: &Rig, posture: &Posture, angles: &[(&str, f64)]) -> Posture {
    let mut posture = posture.clone();
    for (name, angle_rad) in angles {
        posture[rig.description.find_joint(name).expect("a joint")] = *angle_rad;
    }
    posture
}

fn smallest(check: &PostureCheck) -> f64 {
    match check {
        PostureCheck::Clear { smallest_m, .. } => *smallest_m,
        PostureCheck::Collides { depth_m, .. } => -depth_m,
    }
}

fn random_postures(rig: &Rig, count: usize) -> Vec<Posture> {
    let mut state = 7u64;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let joints = rig.description.movable_count();
    let mut angle = |i| {
        let limits = rig.limits(JointIndex(i));
        limits.lower_rad + limits.span_rad() * uniform()
    };
    (0..count).map(|_| Posture::new((0..joints).map(&mut angle).collect())).collect()
}

#[test]
fn whole_poses_of_the_rig_are_clear() {
    let (rig, model) = nico();
    for pose in ["home", "touch-ready"] {
        let posture = rig.pose(pose).expect("a pose").applied_to(&rig.home());
        let check = model.check_posture(&posture, &[]).expect("a proper posture");
        assert!(smallest(&check) > 0.005, "{pose}: {check:?}");
    }
}

#[test]
fn among_surroundings_that_were_moved_everything_is_as_far_away_as_they_were_moved() {
    let (rig, model) = nico();
    let ready = rig.pose("touch-ready").expect("a pose").applied_to(&rig.home());
    let by = nalgebra::Vector3::new(0.0, 0.0, 0.013);
    let moved = rig.with_surroundings_moved(by);
    let raised = model.among(&moved);
    assert_eq!(
        raised.check_posture(&ready, &[]).expect("a posture"),
        CollisionModel::of_rig(&moved).check_posture(&ready, &[]).expect("a posture")
    );
    let corner = |rig: &Rig| rig.touchscreen.corners()[0].coords.coords;
    assert!((corner(&moved) - corner(&rig) - by).norm() < 1e-12);
    assert!((moved.table.height_m - rig.table.height_m - by.z).abs() < 1e-12);
    assert!((moved.gate.floor_m - rig.gate.floor_m - by.z).abs() < 1e-12);
    // Over the middle of the table a point is deeper in it by as much.
    let table = &rig.table;
    let [x, y] = [table.x_range_m, table.y_range_m].map(|range| 0.5 * (range[0] + range[1]));
    let inside = Point::<Robot>::new(x, y, table.height_m - 0.02);
    let depth_m = |model: &CollisionModel| model.body_around(inside, &ready, &[]).expect("in the table").1;
    assert!((depth_m(&raised) - depth_m(&model) - by.z).abs() < 2e-3, "{}", depth_m(&raised));
}

#[test]
fn shapes_that_touch_at_home_are_reported_and_near_the_trunk_only() {
    let (_, model) = nico();
    let always: Vec<String> =
        model.always_in_contact().iter().map(|c| format!("{} – {}", c.a_name, c.b_name)).collect();
    let expected = [
        "torso – right collarbone",
        "torso – left collarbone",
        "neck – right shoulder",
        "neck – left shoulder",
    ];
    assert_eq!(always, expected);
}

#[test]
fn an_arm_turned_into_the_table_collides_with_it() {
    let (rig, model) = nico();
    let low = at(&rig, &rig.home(), &[("r_shoulder_y", 0.6), ("r_arm_x", 0.0), ("r_elbow_y", 2.8)]);
    match model.check_posture(&low, &[]).expect("proper") {
        PostureCheck::Collides { contact, depth_m } => {
            assert_eq!(contact.b, Body::Table, "{contact:?}");
            assert!(contact.a_name.starts_with("right") && depth_m > 0.02, "{contact:?} {depth_m}");
        }
        clear => panic!("{clear:?}"),
    }
}

#[test]
fn beside_the_table_the_lowest_height_allowed_holds() {
    let (rig, model) = nico();
    let hanging = at(&rig, &rig.home(), &[("r_shoulder_y", -0.5), ("r_arm_x", 0.0), ("r_elbow_y", 3.1)]);
    let check = model.check_posture(&hanging, &[]).expect("proper");
    let PostureCheck::Collides { contact, .. } = check else { panic!("{check:?}") };
    assert_eq!(contact.b, Body::Floor);
}

/// What `check_path` must find, by brute force in very small steps.
fn first_contact(model: &CollisionModel, from: &Posture, to: &Posture) -> Option<f64> {
    let steps = 4000;
    let moving = from.angles_rad().iter().zip(to.angles_rad()).enumerate();
    let bits = moving.fold(0u128, |bits, (i, (a, b))| if a == b { bits } else { bits | 1 << i });
    let pairs: Vec<usize> = (0..model.pairs.len()).filter(|k| model.pairs[*k].moved_by & bits != 0).collect();
    let none = vec![0.0; pairs.len()];
    (0..=steps).map(|k| f64::from(k) / f64::from(steps)).find(|fraction| {
        let solids = model.solids(&from.toward(to, *fraction));
        model.worst(&solids, &pairs, &none).is_some_and(|worst| worst.collides)
    })
}

#[test]
fn a_path_is_stopped_where_a_search_in_tiny_steps_finds_the_first_contact() {
    let (rig, model) = nico();
    let joints = &rig.arm("right").expect("an arm").joints;
    let mut found = 0;
    for other in random_postures(&rig, 40) {
        let to = rig.home().with(joints, &other.of(joints));
        let check = model.check_path(&rig.home(), &to, &[]).expect("proper");
        match (check, first_contact(&model, &rig.home(), &to)) {
            (PathCheck::Collides { at_fraction, .. }, Some(searched)) => {
                assert!((at_fraction - searched).abs() < 0.02, "{at_fraction} {searched}");
                found += 1;
            }
            (PathCheck::Clear { smallest_m, .. }, None) => assert!(smallest_m > 0.0),
            // Grazes shallower than the step may go unseen, nothing else.
            (PathCheck::Clear { .. }, Some(searched)) => {
                let depth =
                    -smallest(&model.check_posture(&rig.home().toward(&to, searched), &[]).expect("proper"));
                assert!(depth < 0.005, "{searched} {depth}");
            }
            (other, searched) => panic!("{other:?} {searched:?}"),
        }
    }
    assert!(found > 5, "{found}");
}

#[test]
fn contact_at_the_start_may_be_left_but_not_deepened() {
    let (rig, model) = nico();
    let touching = at(&rig, &rig.home(), &[("r_shoulder_y", 0.6), ("r_arm_x", 0.0), ("r_elbow_y", 2.35)]);
    let start = model.check_posture(&touching, &[]).expect("proper");
    assert!(smallest(&start) < 0.0, "{start:?}");
    match model.check_path(&touching, &at(&rig, &touching, &[("r_elbow_y", 1.2)]), &[]).expect("proper") {
        PathCheck::Clear { leaves, .. } => assert!(!leaves.is_empty()),
        stopped => panic!("{stopped:?}"),
    }
    let deeper =
        model.check_path(&touching, &at(&rig, &touching, &[("r_elbow_y", 2.8)]), &[]).expect("proper");
    assert!(matches!(deeper, PathCheck::Collides { .. }), "{deeper:?}");
}

#[test]
fn a_wanted_contact_is_allowed_to_its_depth_only() {
    let (rig, model) = nico();
    let posture = at(&rig, &rig.home(), &[("r_shoulder_y", 0.6), ("r_arm_x", 0.0), ("r_elbow_y", 2.35)]);
    let PostureCheck::Collides { depth_m, .. } = model.check_posture(&posture, &[]).expect("proper") else {
        panic!("the arm is in the table")
    };
    let all: Vec<_> = (0..rig.description.links().len()).map(crate::robot::LinkIndex).collect();
    let allow = |depth_m| {
        [Body::Table, Body::Touchscreen, Body::Floor].map(|body| Allowance {
            links: all.clone(),
            body,
            depth_m,
        })
    };
    assert!(smallest(&model.check_posture(&posture, &allow(depth_m + 0.001)).expect("proper")) > 0.0);
    assert!(smallest(&model.check_posture(&posture, &allow(depth_m - 0.001)).expect("proper")) < 0.0);
}

#[test]
fn a_lowered_head_cannot_turn_into_the_counterweights() {
    let (rig, model) = nico();
    let from = at(&rig, &rig.home(), &[("head_y", -0.8), ("head_z", 0.0)]);
    match model.check_path(&from, &at(&rig, &from, &[("head_z", 0.6)]), &[]).expect("proper") {
        PathCheck::BeyondLimit { at_fraction, name, why, .. } => {
            assert_eq!(name, "head_z");
            assert!(why.contains("counterweights"));
            // −0.8 rad of tilt allows about 0.23 rad of pan.
            assert!((at_fraction - 0.23 / 0.6).abs() < 0.03, "{at_fraction}");
        }
        other => panic!("{other:?}"),
    }
    let beyond = model.check_path(&from, &at(&rig, &from, &[("r_elbow_y", 4.0)]), &[]).expect("proper");
    assert!(matches!(beyond, PathCheck::BeyondLimit { ref name, .. } if name == "r_elbow_y"), "{beyond:?}");
}

#[test]
fn no_point_moves_farther_than_the_reach_says() {
    let (rig, model) = nico();
    for posture in random_postures(&rig, 60) {
        for (i, reach_m) in model.reach_m.iter().enumerate() {
            let turn_rad = 1e-4;
            let mut turned = posture.clone();
            turned[JointIndex(i)] += turn_rad;
            for (a, b) in model.solids(&posture).iter().zip(model.solids(&turned)) {
                let moved = (a.ball.0 - b.ball.0).norm();
                assert!(moved <= turn_rad * reach_m + 1e-12, "{i}: {moved}");
            }
        }
    }
}

#[test]
fn nonsense_is_refused_with_a_sentence() {
    let (rig, model) = nico();
    let short = Posture::new(vec![0.0; 3]);
    let mut broken = rig.home();
    broken[JointIndex(4)] = f64::NAN;
    assert!(model.check_posture(&short, &[]).expect_err("short").to_string().contains("3 angles"));
    assert!(
        model.check_path(&rig.home(), &broken, &[]).expect_err("NaN").to_string().contains("not a number")
    );
}

fn reach() -> (Rig, Reach) {
    let rig = Rig::built_in("nico").expect("a valid rig");
    let reach = Reach::new(&rig, TIP).expect("a tip");
    (rig, reach)
}

fn refused(target: Point<Robot>) -> String {
    let (rig, reach) = reach();
    let plan = reach.plan(&rig.home(), &Target::Position(target), &ReachOptions::default()).expect("proper");
    plan.refusal.expect("must be refused").to_string()
}

#[test]
fn what_cannot_be_reached_is_said_in_a_sentence() {
    assert!(refused(Point::new(-0.01, 0.0, 0.15)).contains("inside the torso"));
    assert!(refused(Point::new(0.2, -0.3, 0.03)).contains("inside the table"));
    assert!(refused(Point::new(1.5, -0.2, 0.4)).contains("out of reach"));
    let (rig, reach) = reach();
    let nan = Target::Position(Point::new(0.3, f64::NAN, 0.2));
    let error = reach.plan(&rig.home(), &nan, &ReachOptions::default()).expect_err("NaN");
    assert!(matches!(error, ReachError::Ik(_)) && error.to_string().contains("not a number"));
    let error = reach.plan(&Posture::default(), &nan, &ReachOptions::default()).expect_err("no posture");
    assert!(matches!(error, ReachError::Posture(_)), "{error}");
}

#[test]
fn a_limit_in_the_way_is_said_in_a_sentence() {
    let (rig, reach) = reach();
    let place = rig.chain(TIP).expect("a tip").robot_from_tip_in(&rig.home());
    let mut limits = reach.solver().limits().to_vec();
    limits[3].upper_rad = rig.home()[reach.solver().joints()[3]] - 0.2;
    let options = ReachOptions {
        ik: Options { limits: Some(limits), ..Options::default() },
        ..ReachOptions::default()
    };
    let plan = reach.plan(&rig.home(), &Target::Pose(place), &options).expect("proper");
    let Some(Refusal::Limited { joint, .. }) = &plan.refusal else { panic!("{plan:?}") };
    assert_eq!(joint, "r_elbow_y");
    assert!(plan.refusal.expect("seen").to_string().contains("stands at its limit"));
}

#[test]
fn a_clear_plan_arrives_and_its_way_is_clear() {
    let (rig, reach) = reach();
    let chain = rig.chain(TIP).expect("a tip");
    let mut clear = 0;
    for (x, y) in
        (0..5).flat_map(|i| (0..5).map(move |j| (0.2 + 0.05 * f64::from(i), -0.3 + 0.06 * f64::from(j))))
    {
        let target = Point::new(x, y, 0.25);
        let plan =
            reach.plan(&rig.home(), &Target::Position(target), &ReachOptions::default()).expect("proper");
        if plan.is_clear() {
            clear += 1;
            let there =
                Point::from(nalgebra::Point3::from(chain.robot_from_tip_in(&plan.posture).translation_m()));
            assert!(target.distance_m(&there) < 1e-5);
            assert!(first_contact(reach.model(), &rig.home(), &plan.posture).is_none());
        }
    }
    assert!(clear > 15, "{clear}");
}

#[test]
fn a_touch_of_the_screen_is_refused_unless_it_is_wanted() {
    let rig = Rig::built_in("nico").expect("a valid rig");
    let reach = Reach::new(&rig, "right_index_tip").expect("a tip");
    let ready = rig.pose("touch-ready").expect("a pose").applied_to(&rig.home());
    let target = Target::Position(Point::new(0.38, -0.1, rig.touchscreen.origin.coords.z - 0.005));
    let plain = ReachOptions { ik: Options::upright(), ..ReachOptions::default() };
    let wanted = ReachOptions { may_touch: vec![Body::Touchscreen], ..plain.clone() };
    assert!(!reach.plan(&ready, &target, &plain).expect("proper").is_clear());
    let plan = reach.plan(&ready, &target, &wanted).expect("proper");
    assert!(plan.is_clear(), "{:?}", plan.refusal);
}

#[test]
fn a_check_of_a_path_is_quick() {
    let (rig, reach) = reach();
    let target = Target::Position(Point::new(0.3, -0.2, 0.25));
    let plan = reach.plan(&rig.home(), &target, &ReachOptions::default()).expect("proper");
    let mut times: Vec<f64> = (0..30)
        .map(|_| {
            let began = Instant::now();
            let checked = reach.model().check_path(&rig.home(), &plan.posture, &[]).expect("proper");
            assert!(matches!(checked, PathCheck::Clear { .. }));
            began.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    // Far above what is typical: other work on the machine must not make this fail.
    assert!(times[15] < 0.02, "{times:?}");
}
