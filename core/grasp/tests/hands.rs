//! The left hand is the mirror image of the right one, and so is what it does.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::sync::Arc;

use nalgebra::Vector3;
use plumbline_effects::RobotModel;
use plumbline_grasp::plan::{GraspPlan, GraspPlanner, NoPlan, Standing};
use plumbline_grasp::{Hand, PLACES_M, PalmArm};
use plumbline_model::robot::{Posture, Rig};

fn rig() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("valid"))
}

fn planner(rig: &Arc<Rig>, hand: Hand) -> GraspPlanner {
    GraspPlanner::new(PalmArm::new(&RobotModel::nominal(rig.clone()), hand.name()).expect("an arm"))
}

fn plan(planner: &GraspPlanner, [x_m, y_m]: [f64; 2], from: &Posture) -> Result<GraspPlan, NoPlan> {
    let standing = Standing { xy_m: [x_m, y_m], support_m: 0.056, height_m: 0.054, lower_m: 0.0 };
    planner.plan(&standing, &Vector3::zeros(), from)
}

/// The same angles make the other arm its mirror image.
fn mirrored(rig: &Rig, posture: &Posture) -> Posture {
    let [right, left] = Hand::BOTH.map(|hand| {
        let arm = rig.arm(hand.name()).expect("an arm");
        [arm.joints.clone(), arm.hand.clone()].concat()
    });
    posture.with(&right, &posture.of(&left)).with(&left, &posture.of(&right))
}

/// Wherever a thing was grasped and lifted, the arm gets down there again.
#[test]
fn what_was_lifted_is_put_down_again_at_every_place() {
    let rig = rig();
    let bent = [("joint-zero", "r_elbow_y", 0.03), ("joint-zero", "r_shoulder_y", -0.02)];
    let described = PalmArm::new(&RobotModel::nominal(rig.clone()), "right").expect("an arm");
    let known = PalmArm::new(&with_effects(&rig, &bent), "right").expect("an arm");
    for (name, arm) in [("as described", described), ("with effects", known)] {
        let planner = GraspPlanner::new(arm);
        let (mut lifted_at, mut turned_round) = (0, 0);
        for place_m in PLACES_M {
            let Ok(plan) = plan(&planner, place_m, &rig.home()) else { continue };
            let closed = planner.closed(plan.down.last().expect("a way down"));
            let lifted =
                planner.lift(&closed, plan.heading_rad, GraspPlanner::LIFT_M).pop().expect("it gets up");
            let was_m = planner.arm().palm(&closed).coords.coords;
            let way = planner.put_back(&lifted, was_m.into()).expect("free");
            let way = way.unwrap_or_else(|| panic!("{name}: {place_m:?} is not reached from above"));
            let low = way.last().expect("a way");
            let off_m = planner.arm().palm(low).coords.coords - was_m;
            assert!(off_m.norm() < 5e-3, "{name}: {place_m:?}: {off_m:?}");
            assert_eq!(low.of(planner.arm().hand()), closed.of(planner.arm().hand()), "fingers as they are");
            for pair in way.windows(2) {
                assert!(pair[0].distance_rad(&pair[1]) < 0.5, "{name}: {place_m:?} jumps");
            }
            let sinks = way.windows(2).all(|pair| {
                let height_m = |posture: &Posture| planner.arm().palm(posture).coords.z;
                height_m(&pair[1]) < height_m(&pair[0])
            });
            assert!(sinks, "{name}: {place_m:?} does not go straight down");
            lifted_at += 1;
            let straight =
                planner.vertical(planner.arm().heading_rad(&lifted), &lifted, -GraspPlanner::LIFT_M);
            turned_round += usize::from(straight.len() < way.len());
        }
        println!("{name}: {lifted_at} of 22 lifted and put down, {turned_round} by the way up turned round");
        assert!(lifted_at >= 20, "{name}: {lifted_at}");
        let far = planner.lowered(&rig.home(), -0.5);
        assert!(matches!(far, Ok(None) | Err(_)), "half a meter under the table is not reached");
    }
}

/// Out of a tilted hand things creep.
#[test]
fn a_stretched_arm_brings_what_it_lifts_nearer_instead_of_tilting_it() {
    let rig = rig();
    let planner = planner(&rig, Hand::Right);
    let arm = planner.arm();
    let shoulder_m =
        |posture: &Posture| (arm.palm(posture).coords.coords - arm.shoulder_m(posture)).xy().norm();
    let (mut straight_ones, mut nearer_ones) = (0, 0);
    for place_m in PLACES_M {
        let Ok(plan) = plan(&planner, place_m, &rig.home()) else { continue };
        let closed = planner.closed(plan.down.last().expect("a way down"));
        let straight = planner.vertical(plan.heading_rad, &closed, GraspPlanner::LIFT_M);
        let way = planner.lift(&closed, plan.heading_rad, GraspPlanner::LIFT_M);
        let (top, straight_top) = (way.last().expect("a way"), straight.last().expect("a way"));
        let rise_m = arm.palm(top).coords.z - arm.palm(&closed).coords.z;
        assert!(rise_m > 0.05, "{place_m:?}: lifted by {rise_m} m");
        assert!(arm.level(top) >= arm.level(straight_top), "{place_m:?} tilts more");
        for posture in &way {
            assert_eq!(posture.of(arm.hand()), closed.of(arm.hand()), "{place_m:?}: fingers as they are");
        }
        if way == straight {
            straight_ones += 1;
            continue;
        }
        nearer_ones += 1;
        assert!(arm.level(straight_top) < 0.9985, "{place_m:?} was level");
        assert!(shoulder_m(top) < shoulder_m(&closed), "{place_m:?} goes away from the shoulder");
        // Straight up at first, until it is clear of the table.
        assert_eq!(way[..4], straight[..4], "{place_m:?}");
        println!("{place_m:?}: level {:.4} instead of {:.4}", arm.level(top), arm.level(straight_top));
    }
    assert!(straight_ones >= 15 && nearer_ones >= 1, "{straight_ones} straight, {nearer_ones} nearer");
}

/// A robot whose right arm errs: effect, joint, value.
fn with_effects(rig: &Arc<Rig>, effects: &[(&str, &str, f64)]) -> RobotModel {
    use plumbline_effects::RigModel;
    use plumbline_effects::rig_model::{Addition, ModelEffect};
    let effect = |(id, site, value): &(&str, &str, f64)| ModelEffect {
        id: (*id).to_owned(),
        site: (*site).to_owned(),
        title: String::new(),
        tip: Some("right_index_tip".to_owned()),
        shape: None,
        reference_s: 0.0,
        values: vec![*value],
        covariance: vec![],
        probability: None,
        parameters: vec![],
    };
    let addition = Addition {
        effects: effects.iter().map(effect).collect(),
        screens: vec![],
        externals: vec![],
        eyes: vec![],
        together: vec![],
        replaces: false,
        at: jiff::Timestamp::UNIX_EPOCH,
        sentence: String::new(),
        sessions: vec![],
        version: String::new(),
        gap: None,
    };
    let mut model = RigModel::nominal(rig);
    model.add(rig, addition).expect("they fit");
    RobotModel::new(rig.clone(), Arc::new(model)).expect("it fits")
}

#[test]
fn the_same_angles_make_one_hand_the_mirror_image_of_the_other() {
    let rig = rig();
    let description = &rig.description;
    let arm = rig.arm("right").expect("an arm");
    let links = [
        ("right_palm_center", "left_palm_center"),
        ("right_index_tip", "left_index_tip"),
        ("r_indexfinger", "l_indexfinger"),
        ("r_littlefinger", "l_littlefinger"),
        ("right_thumb", "left_thumb"),
    ];
    let joints = [arm.joints.clone(), arm.hand.clone()].concat();
    let bent = rig.home().with(&joints, &[0.3, 0.4, 0.5, 1.9, 0.7, -0.3, -0.4, -1.5, -0.9, -1.7]);
    for posture in [rig.home(), bent] {
        let other = mirrored(&rig, &posture);
        let (right, left) = (description.forward(&posture), description.forward(&other));
        for (of_right, of_left) in links {
            let link = |name: &str| description.find_link(name).expect("a link");
            let (a, b) = (right.of(link(of_right)).isometry, left.of(link(of_left)).isometry);
            // A point on the link's own z axis tells where it points, too: along a finger or thumb.
            for z_m in [0.0, -0.05] {
                let on_axis = nalgebra::Point3::new(0.0, 0.0, z_m);
                let (a, b) = (a * on_axis, b * on_axis);
                let off_m = (a - nalgebra::Point3::new(b.x, -b.y, b.z)).norm();
                assert!(off_m < 2e-3, "{of_right}: {a} against {b}");
            }
        }
    }
}

#[test]
fn the_left_plan_is_the_mirror_image_of_the_right_one() {
    let rig = rig();
    let [right, left] = Hand::BOTH.map(|hand| planner(&rig, hand));
    assert_eq!((right.arm().which(), left.arm().which()), (Hand::Right, Hand::Left));
    let from = rig.home();
    for [x_m, y_m] in [[0.3, -0.2], [0.4, -0.1], [0.25, 0.0]] {
        let of_right = plan(&right, [x_m, y_m], &from).expect("in reach");
        let of_left = plan(&left, [x_m, -y_m], &from).expect("in reach");
        assert_eq!((of_right.hand, of_left.hand), (Hand::Right, Hand::Left));
        let turned = (of_right.heading_rad + of_left.heading_rad).abs();
        assert!(turned < 1e-9, "{} against {}", of_right.heading_rad, of_left.heading_rad);
        assert!((of_right.level - of_left.level).abs() < 0.01, "{} {}", of_right.level, of_left.level);
        let (a, b) = (of_right.palm_m, of_left.palm_m);
        let off_m = (a - Vector3::new(b.x, -b.y, b.z)).norm();
        assert!(off_m < 2e-3, "{a:?} against {b:?}");
        // Nothing of the other arm moves.
        for (plan, other) in [(&of_right, "left"), (&of_left, "right")] {
            let still = &rig.arm(other).expect("an arm").joints;
            assert!(plan.approach.iter().chain(&plan.down).all(|at| at.of(still) == from.of(still)));
        }
    }
}

#[test]
fn an_arm_that_is_in_the_way_is_parked_and_one_at_home_stays() {
    let rig = rig();
    let left = planner(&rig, Hand::Left);
    assert_eq!(left.parked(&rig.home()), Ok(None));
    let over = plan(&left, [0.3, 0.1], &rig.home()).expect("in reach").above().expect("a posture").clone();
    let way = left.parked(&over).expect("free").expect("it is not at home");
    let arm = rig.arm("left").expect("an arm");
    let last = way.last().expect("a posture");
    assert_eq!(last.of(&arm.joints), rig.home().of(&arm.joints));
    assert_eq!(last.of(&arm.hand), over.of(&arm.hand), "fingers stay as they are");
}

#[test]
#[ignore = "figures for who chooses the hand"]
fn at_every_place() {
    let rig = rig();
    let planners = Hand::BOTH.map(|hand| planner(&rig, hand));
    for at_m in PLACES_M {
        let of = planners.each_ref().map(|planner| match plan(planner, at_m, &rig.home()) {
            Ok(plan) => format!("level {:.3} effort {:.2}", plan.level, plan.effort_rad),
            Err(why) => why.to_string().chars().take(40).collect(),
        });
        println!("{at_m:?}: right {} | left {}", of[0], of[1]);
    }
}
