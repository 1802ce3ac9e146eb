//! The world against the description, and against what hands and things do.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::sync::Arc;

use nalgebra::{Isometry3, Vector3};
use plumbline_model::Point;
use plumbline_model::robot::ik::{Options, Solver, Target};
use plumbline_model::robot::{LinkIndex, Posture, Rig};

use super::*;
use crate::scenario::Scenario;
use crate::toys::Toy;

fn rig() -> Arc<Rig> {
    Arc::new(Rig::built_in("nico").expect("valid"))
}

fn world(scenario: &str) -> World {
    World::new(rig(), &Scenario::built_in(scenario).expect("valid"), 1).expect("a world")
}

/// A scenario as described but for some lines.
fn scenario(lines: &str) -> Scenario {
    let text = format!("format = 1\nname = \"x\"\ntitle = \"X\"\nabout = \"x\"\n{lines}");
    Scenario::from_toml("x", &text).expect("valid")
}

/// Largest distance (m) and turn (rad) of a link from where the description has it.
fn miss(world: &mut World, posture: &Posture) -> (f64, f64) {
    world.refresh();
    let rig = world.rig().clone();
    let nominal = rig.description.forward(posture);
    let mut worst = (0.0, 0.0);
    for i in 0..rig.description.links().len() {
        let Some(place) = world.true_link(LinkIndex(i)) else { continue };
        let difference = nominal.of(LinkIndex(i)).isometry.inverse() * place;
        worst = (
            f64::max(worst.0, difference.translation.vector.norm()),
            f64::max(worst.1, difference.rotation.angle()),
        );
    }
    worst
}

#[test]
fn every_link_is_where_the_description_has_it_when_nothing_is_hidden() {
    let mut world = world("perfect");
    let rig = world.rig().clone();
    for name in ["home", "touch-ready", "close-hand", "point", "look-table"] {
        let posture = rig.pose(name).expect("a pose").applied_to(&rig.home());
        world.stand(&posture);
        let (distance_m, turn_rad) = miss(&mut world, &posture);
        assert!(distance_m < 1e-9 && turn_rad < 1e-9, "{name}: {distance_m} m, {turn_rad} rad");
    }
    // Marks on links have a place too.
    let tip = rig.description.find_link("right_index_tip").expect("a link");
    assert!(world.true_link(tip).is_some());
}

#[test]
fn servos_without_droop_end_where_they_are_sent() {
    let mut world = world("perfect");
    let rig = world.rig().clone();
    for name in ["touch-ready", "home"] {
        let arm = &rig.arm("right").expect("an arm").joints;
        let pose = rig.pose(name).expect("a pose").applied_to(&rig.home());
        let goal = rig.home().with(arm, &pose.of(arm));
        world.send(&goal, Some(1.0));
        world.run(6.0);
        let (distance_m, _) = miss(&mut world, &goal);
        assert!(distance_m < 1e-4, "{name}: {distance_m} m");
    }
}

#[test]
fn real_servos_droop_and_their_encoders_show_it() {
    let mut world = World::new(rig(), &scenario(""), 1).expect("a world");
    let rig = world.rig().clone();
    let mut goal = rig.home();
    let shoulder = rig.description.find_joint("r_shoulder_y").expect("a joint");
    let elbow = rig.description.find_joint("r_elbow_y").expect("a joint");
    goal[shoulder] = 1.2;
    goal[elbow] = 3.0;
    world.send(&goal, Some(0.8));
    world.run(5.0);
    let droop = goal[shoulder] - world.encoders()[shoulder];
    assert!((0.003..0.08).contains(&droop), "the stretched arm pulls down: {droop} rad");
    // The encoder tells the droop: with its angles the description is right again.
    let encoders = world.encoders();
    let (distance_m, _) = miss(&mut world, &encoders);
    assert!(distance_m < 5e-4, "{distance_m}");
}

#[test]
fn give_and_slack_do_not_show_in_the_encoder() {
    let lines = "[joint.r_shoulder_y]\ncompliance_rad_per_nm = 0.02\nslack_rad = 0.01";
    let mut world = World::new(rig(), &scenario(lines), 1).expect("a world");
    let rig = world.rig().clone();
    let mut goal = rig.home();
    goal[rig.description.find_joint("r_elbow_y").expect("a joint")] = 3.0;
    goal[rig.description.find_joint("r_shoulder_y").expect("a joint")] = 1.2;
    world.send(&goal, Some(0.8));
    world.run(5.0);
    let encoders = world.encoders();
    let (distance_m, turn_rad) = miss(&mut world, &encoders);
    assert!(distance_m > 2e-3, "{distance_m}");
    assert!((0.005..0.05).contains(&turn_rad), "{turn_rad}");
}

#[test]
fn an_encoder_zero_turns_the_joint_and_nothing_else() {
    let lines = "[servo]\nholding = \"exact\"\n[joint.r_shoulder_z]\nencoder_zero_rad = 0.05";
    let mut world = World::new(rig(), &scenario(lines), 1).expect("a world");
    let rig = world.rig().clone();
    let mut real = rig.home();
    real[rig.description.find_joint("r_shoulder_z").expect("a joint")] += 0.05;
    assert!(miss(&mut world, &real).0 < 1e-9);
    assert!(miss(&mut world, &rig.home()).0 > 5e-3);
}

#[test]
fn the_same_seed_gives_the_same_course() {
    let course = || {
        let mut world = world("lab");
        let goal = world.rig().pose("touch-ready").expect("a pose").applied_to(&world.rig().home());
        world.send(&goal, Some(1.0));
        world.run(1.0);
        world.snapshot()
    };
    assert_eq!(course(), course());
}

#[test]
fn toys_come_to_rest_on_the_table() {
    let mut world = world("lab");
    world.run(6.0);
    let before: Vec<_> = Toy::ALL.iter().map(|toy| world.toy(*toy).expect("out")).collect();
    world.run(1.0);
    for (toy, before) in Toy::ALL.into_iter().zip(before) {
        let now = world.toy(toy).expect("out");
        let moved = (now.translation.vector - before.translation.vector).norm();
        assert!(moved < 2e-3, "{toy:?} moves {moved} m in a second");
        assert!((0.04..0.12).contains(&now.translation.z), "{toy:?} is at {}", now.translation.vector);
    }
}

/// What nobody touches stands where it stood, however long the robot works beside it.
#[test]
fn a_toy_at_rest_stays_on_the_table_and_on_the_glass() {
    // Beside the screen, on it, and on it while it stands on a block.
    for (off_m, raised_m) in [(0.42, 0.0), (0.12, 0.0), (0.12, 0.05)] {
        let mut world = world("lab");
        world.raise_screen(raised_m).expect("not too high");
        stays(&mut world, off_m);
    }
}

fn stays(world: &mut World, off_m: f64) {
    for (i, toy) in Toy::ALL.into_iter().enumerate() {
        let y_m = if i % 2 == 0 { off_m } else { -off_m };
        let from_m = if off_m > 0.3 { 0.25 } else { 0.32 };
        world.place_toy(toy, from_m + 0.08 * (i / 2) as f64, y_m).expect("on the table");
    }
    world.run(10.0);
    let before: Vec<_> = Toy::ALL.iter().map(|toy| world.toy(*toy).expect("out")).collect();
    world.run(60.0);
    for (toy, before) in Toy::ALL.into_iter().zip(before) {
        let now = world.toy(toy).expect("out");
        let moved_mm = 1e3 * (now.translation.vector - before.translation.vector).norm();
        println!("{toy:?}, {off_m} m to the side: {moved_mm:.3} mm in a minute");
        assert!(moved_mm < 0.05, "{toy:?} moves {moved_mm} mm in a minute");
    }
}

#[test]
fn what_stands_on_the_screen_rises_and_falls_with_it() {
    let mut world = world("lab");
    Toy::ALL.iter().filter(|other| **other != Toy::Tomato).for_each(|other| world.remove_toy(*other));
    world.place_toy(Toy::Tomato, 0.40, 0.1).expect("on the screen");
    world.run(6.0);
    let height_m = |world: &World| world.toy(Toy::Tomato).expect("out").translation.z;
    let low_m = height_m(&world);
    world.raise_screen(0.05).expect("not too high");
    world.run(3.0);
    assert!((height_m(&world) - low_m - 0.05).abs() < 2e-3, "{} m from {low_m} m", height_m(&world));
    world.raise_screen(0.0).expect("back");
    world.run(3.0);
    assert!((height_m(&world) - low_m).abs() < 2e-3, "{} m from {low_m} m", height_m(&world));
}

#[test]
fn a_toy_at_rest_falls_again_where_it_is_put() {
    let mut world = world("lab");
    world.run(5.0);
    let at = Isometry3::translation(0.45, -0.2, 0.3);
    world.put_toy(Toy::Tomato, at);
    world.run(2.0);
    let place = world.toy(Toy::Tomato).expect("out").translation.vector;
    assert!(place.z < 0.12, "{place}");
    world.place_toy(Toy::Orange, 0.2, -0.3).expect("on the table");
    world.run(2.0);
    let place = world.toy(Toy::Orange).expect("out").translation.vector;
    assert!((place - Vector3::new(0.2, -0.3, 0.07)).norm() < 0.02, "{place}");
}

#[test]
fn a_toy_beside_the_table_is_refused() {
    let mut world = world("lab");
    let error = world.place_toy(Toy::Duck, 3.0, 0.0).expect_err("not on the table").to_string();
    assert!(error.contains("table"), "{error}");
    world.remove_toy(Toy::Duck);
    assert_eq!(world.toy(Toy::Duck), None);
    world.run(0.1);
    assert_eq!(world.toy(Toy::Duck), None);
}

#[test]
fn unknown_parts_in_a_scenario_are_named() {
    for (lines, part) in [
        ("[joint.r_knee]\nslack_rad = 0.01", "r_knee"),
        ("[fingertip.r_toe]\noffset_m = [0.0, 0.0, 0.0]", "r_toe"),
    ] {
        let error = World::new(rig(), &scenario(lines), 1).expect_err(part).to_string();
        assert!(error.contains(part), "{error}");
    }
}

/// Slack between gears is no motor: what stands comes to rest.
#[test]
fn an_arm_with_slack_stands_still() {
    for name in ["lab", "wide-101"] {
        let scenario = Scenario::named_or_file(name).expect("a robot");
        let mut world = World::new(rig(), &scenario, 1).expect("a world");
        let palm = world.rig().description.find_link("right_palm_center").expect("a tip");
        world.send(&world.rig().home(), Some(1.0));
        world.run(4.0);
        let places: Vec<Vector3<f64>> = (0..250)
            .map(|_| {
                world.step();
                world.refresh();
                world.true_link(palm).expect("there").translation.vector
            })
            .collect();
        let sways_mm = 1e3 * places.iter().map(|place| (place - places[0]).norm()).fold(0.0, f64::max);
        println!("{name}: the palm sways by {sways_mm:.4} mm in half a second");
        assert!(sways_mm < 0.03, "{name}: {sways_mm} mm");
    }
}

#[test]
fn pace() {
    let mut world = world("lab");
    world.run(0.5);
    let started = std::time::Instant::now();
    world.run(10.0);
    let factor = 10.0 / started.elapsed().as_secs_f64();
    println!("physics: {factor:.1} times real time on one core");
    assert!(factor > 2.0, "{factor}");
}

/// With real servos: over a toy on the table, down, hand closed, up. How far (m) it was lifted.
fn pick(toy: Toy, friction: f64) -> f64 {
    let lines = format!("[contact]\ntoy_friction = {friction}");
    let mut world = World::new(rig(), &scenario(&lines), 1).expect("a world");
    let rig = world.rig().clone();
    Toy::ALL.iter().filter(|other| **other != toy).for_each(|other| world.remove_toy(*other));
    world.place_toy(toy, 0.21, -0.17).expect("on the table");
    world.run(1.0);
    let before = world.toy(toy).expect("out").translation.vector;
    let solver = Solver::of_rig(&rig, "right_palm_center").expect("a tip");
    let chain = rig.chain("right_palm_center").expect("a tip");
    // The toy belongs 12 mm nearer to the fingers than the middle of the palm.
    let reach = |over_m: f64, yaw_rad: f64, from: &Posture| {
        let shift = -0.012 * Vector3::new(yaw_rad.cos(), yaw_rad.sin(), 0.0);
        let point = before + Vector3::z() * over_m + shift;
        let target = Target::PositionYaw { point: Point::new(point.x, point.y, point.z), yaw_rad };
        let answer = solver.solve_from(&target, from, &Options::upright()).expect("finite");
        answer.is_reached().then(|| from.with(solver.joints(), answer.best().joints.as_ref()))
    };
    let open = rig.pose("open-hand").expect("a pose").applied_to(&rig.home());
    let upright = |posture: &Posture| (chain.robot_from_tip_in(posture).isometry * Vector3::z()).z;
    let headings = (-6..6).map(|i| f64::from(i) * 0.2);
    let (yaw_rad, over) = headings
        .filter_map(|yaw_rad| Some((yaw_rad, reach(0.12, yaw_rad, &open)?)))
        .max_by(|a, b| upright(&a.1).total_cmp(&upright(&b.1)))
        .expect("in reach");
    world.send(&over, Some(1.0));
    world.run(3.0);
    let mut posture = over;
    for step in 1..=12 {
        let down = (0.12 - 0.01 * f64::from(step)).max(toy.rest_height_m() - 0.017);
        posture = reach(down, yaw_rad, &posture).unwrap_or(posture);
        world.send(&posture, Some(1.0));
        world.run(0.2);
    }
    world.run(0.5);
    let close = rig.pose("close-hand").expect("a pose").applied_to(&posture);
    // The thumb first: the fingers push against it.
    let joint = |name: &str| rig.description.find_joint(name).expect("a joint");
    let thumb = [joint("r_thumb_x"), joint("r_thumb_z")];
    world.send(&posture.with(&thumb, &close.of(&thumb)), Some(2.0));
    world.run(1.0);
    world.send(&close, Some(3.0));
    world.run(1.5);
    let up = reach(0.10, yaw_rad, &close).expect("in reach");
    world.send(&up, Some(0.5));
    world.run(2.0);
    let hold_z = world.toy(toy).expect("out").translation.z;
    hold_z - before.z
}

#[test]
fn a_closed_hand_lifts_things_by_contact_alone_and_slippery_things_slip() {
    for toy in [Toy::Tomato, Toy::Mushroom, Toy::Onion, Toy::Orange] {
        let (lifted_m, slippery_m) = (pick(toy, 1.0), pick(toy, 0.02));
        println!("{toy:?}: lifted {lifted_m:.3} m, slippery {slippery_m:.3} m");
        assert!(lifted_m > 0.06, "{toy:?} stayed behind");
        assert!(slippery_m < 0.03, "{toy:?} is held without friction");
    }
}

#[test]
fn a_raised_screen_is_touched_higher_and_a_weight_pulls_the_hand_down() {
    let rig = rig();
    let mut world = world("lab");
    let before = *world.places();
    world.raise_screen(0.06).expect("not too high");
    let rise =
        world.places().robot_from_screen.translation.vector - before.robot_from_screen.translation.vector;
    assert!((rise - Vector3::z() * 0.06).norm() < 1e-12);
    assert!(world.raise_screen(0.5).is_err() && world.raise_screen(f64::NAN).is_err());
    let ready = rig.pose("touch-ready").expect("a pose").applied_to(&rig.home());
    let tip = rig.description.find_link("right_index_tip").expect("a tip");
    world.send(&ready, Some(1.0));
    world.run(3.0);
    let height = |world: &mut World| {
        world.refresh();
        let palm = rig.description.joint_above(tip).map(|joint| joint.parent).expect("a parent");
        world.true_link(palm).or_else(|| world.true_link(tip)).map(|place| place.translation.z)
    };
    let free = height(&mut world);
    world.load_hand(0.25).expect("not too heavy");
    world.run(2.0);
    let loaded = height(&mut world);
    let sag_m = free.zip(loaded).map(|(free, loaded)| free - loaded).expect("the hand is somewhere");
    println!("a weight of 250 g: {:.1} mm lower", sag_m * 1e3);
    assert!((0.001..0.05).contains(&sag_m), "{sag_m}");
    assert!(world.load_hand(2.0).is_err() && world.load_hand(f64::NAN).is_err());
    world.reset();
    assert_eq!((world.screen_raised_m(), world.hand_load_kg()), (0.0, 0.0));
    assert_eq!(world.places().robot_from_screen, before.robot_from_screen);
}
