//! How far off a hand may be and still lift what it closes around: physics decides, on a robot that is
//! exactly as described, with the place of the object known.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use std::sync::Arc;

use nalgebra::Vector3;
use plumbline_effects::RobotModel;
use plumbline_grasp::body::{GRIP_RAD_S, grip_force, is_thumb};
use plumbline_grasp::plan::{GraspPlanner, Standing};
use plumbline_grasp::{PLACES_M, PalmArm};
use plumbline_model::robot::{JointIndex, Posture, Rig};
use plumbline_twin::{Lockstep, Scenario, Toy};

/// What is still in the hand after this long is held, s.
const HOLDS_S: f64 = 10.0;

fn planner(rig: &Arc<Rig>) -> GraspPlanner {
    GraspPlanner::new(PalmArm::new(&RobotModel::nominal(rig.clone()), "right").expect("an arm"))
}

/// A robot that is exactly as described, with toys of this friction and mass.
fn robot() -> Scenario {
    let of = |name: &str| number(name).unwrap_or(1.0);
    let (friction, mass, size) = (of("PLUMBLINE_FRICTION"), of("PLUMBLINE_MASS"), of("PLUMBLINE_SIZE"));
    let text = format!(
        "format = 1\nname = \"toys\"\ntitle = \"Toys\"\nabout = \"Other toys.\"\n[contact]\n\
         toy_friction = {friction}\ntoy_mass = {mass}\ntoy_size = {size}\n"
    );
    Scenario::from_toml("toys", &text).expect("valid")
}

/// How hard a joint of the hand presses, as a share of its torque: as a grip does, or `PLUMBLINE_FORCE` ("0.4 0.8",
/// fingers and thumb).
fn force(rig: &Rig, joint: JointIndex) -> f64 {
    let asked = std::env::var("PLUMBLINE_FORCE").unwrap_or_default();
    let asked: Vec<f64> = asked.split(' ').filter_map(|text| text.parse().ok()).collect();
    match asked[..] {
        [_, thumb] if is_thumb(rig, joint) => thumb,
        [finger, _] => finger,
        _ => grip_force(rig, joint),
    }
}

/// `PLUMBLINE_OFF_MM` ("0 0 -3"): how far the hand is sent beside where it belongs, along the fingers, across, up; m.
fn off_m() -> [f64; 3] {
    let off_mm = std::env::var("PLUMBLINE_OFF_MM").unwrap_or_default();
    let off_mm: Vec<f64> = off_mm.split(' ').filter_map(|text| text.parse().ok()).collect();
    if let [x, y, z] = off_mm[..] { [x, y, z].map(|mm| mm * 1e-3) } else { [0.0; 3] }
}

/// A number of this name in the environment.
fn number(name: &str) -> Option<f64> {
    std::env::var(name).ok()?.parse().ok()
}

/// Holds on for ten seconds, or `PLUMBLINE_HOLDS_S`; with `PLUMBLINE_EASED` then as long once more with this share of
/// the force, as a hand that got warm does.
fn hold(twin: &mut Lockstep, rig: &Rig) {
    let holds_s = number("PLUMBLINE_HOLDS_S").unwrap_or(HOLDS_S);
    twin.wait(holds_s);
    let Some(share) = number("PLUMBLINE_EASED") else { return };
    for finger in rig.arms.iter().flat_map(|arm| arm.hand.iter().copied()) {
        twin.limit(finger, share * force(rig, finger));
    }
    twin.wait(holds_s);
}

/// Closes the hand as a grip does, the thumb first; the posture in which all is closed.
fn closed(twin: &mut Lockstep, rig: &Rig, closing: &Posture) -> Posture {
    let close = rig.pose("close-hand").expect("a pose").applied_to(closing);
    let joint = |name: &str| rig.description.find_joint(name).expect("a joint");
    let thumb = [joint("r_thumb_x"), joint("r_thumb_z")];
    for finger in rig.arms.iter().flat_map(|arm| arm.hand.iter().copied()) {
        twin.limit(finger, force(rig, finger));
    }
    twin.follow(&[closing.with(&thumb, &close.of(&thumb))], GRIP_RAD_S);
    twin.follow(std::slice::from_ref(&close), GRIP_RAD_S);
    twin.wait(0.3);
    close
}

/// How far (m) a toy is up after it was held for ten seconds, by a hand that is sent so much beside it (along the
/// fingers, across, up), and presses as a grip does.
fn lifted_m(toy: Toy, at_m: [f64; 2], off_m: [f64; 3]) -> Result<(f64, f64, f64), String> {
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let mut twin = Lockstep::new(rig.clone(), &robot(), 1).expect("a twin");
    Toy::ALL.iter().filter(|other| **other != toy).for_each(|other| twin.remove_toy(*other));
    twin.place_toy(toy, at_m[0], at_m[1]).map_err(|error| error.to_string())?;
    twin.wait(1.0);
    let place = |twin: &mut Lockstep| {
        let truth = twin.truth_for_judging();
        truth
            .toys
            .iter()
            .find(|(other, _)| *other == toy)
            .and_then(|(_, place)| *place)
            .expect("out")
            .translation
            .vector
    };
    let before = place(&mut twin);
    let half_m = 0.027;
    let standing = Standing {
        xy_m: [before.x, before.y],
        support_m: before.z - half_m,
        height_m: 2.0 * half_m,
        lower_m: 0.0,
    };
    let planner = planner(&rig);
    let from = twin.commanded().clone();
    let rough = planner.plan(&standing, &Vector3::zeros(), &from).map_err(|error| error.to_string())?;
    let (sine, cosine) = rough.heading_rad.sin_cos();
    let shift =
        Vector3::new(off_m[0] * cosine - off_m[1] * sine, off_m[0] * sine + off_m[1] * cosine, off_m[2]);
    let plan = planner.plan(&standing, &shift, &from).map_err(|error| error.to_string())?;
    let began_s = twin.now_s();
    twin.follow(&plan.approach, 0.8);
    twin.follow(&plan.down, 0.5);
    let closing = plan.closing().expect("a way down").clone();
    let close = closed(&mut twin, &rig, &closing);
    let up: Vec<Posture> = planner.lift(&close, plan.heading_rad, GraspPlanner::LIFT_M);
    twin.follow(&up, 0.4);
    let seconds = twin.now_s() - began_s;
    if std::env::var_os("PLUMBLINE_CREEP").is_some() {
        creep(&mut twin, &rig, toy);
    }
    hold(&mut twin, &rig);
    Ok((place(&mut twin).z - before.z, plan.level, seconds))
}

/// Second by second, where a toy is in the hand (mm from the middle of the palm, in its frame), and how far its
/// joints are bent.
fn creep(twin: &mut Lockstep, rig: &Rig, toy: Toy) {
    let link = rig.description.find_link("right_palm_center").expect("a tip");
    let hand = &rig.arms.iter().find(|arm| arm.name == "right").expect("an arm").hand;
    for second in 0..8 {
        let truth = twin.truth_for_judging();
        let palm = truth.robot_from_link[link.0].expect("there");
        let place =
            truth.toys.iter().find(|(other, _)| *other == toy).and_then(|(_, place)| *place).expect("out");
        let in_palm = palm.inverse_transform_point(&place.translation.vector.into()) * 1e3;
        let bent: Vec<f64> = hand.iter().map(|joint| twin.encoders()[*joint]).collect();
        println!("  {second} s: [{:.1} {:.1} {:.1}] mm, {bent:.2?} rad", in_palm.x, in_palm.y, in_palm.z);
        twin.wait(1.0);
    }
}

#[test]
#[ignore = "minutes of physics; figures for who chooses how the hand closes"]
fn at_every_place() {
    for at_m in PLACES_M {
        match lifted_m(Toy::Tomato, at_m, off_m()) {
            Ok((up_m, level, seconds)) => {
                println!("{at_m:?}: lifted {:.0} mm, level {level:.2}, {seconds:.1} s", up_m * 1e3)
            }
            Err(why) => println!("{at_m:?}: {why}"),
        }
    }
}

#[test]
#[ignore = "minutes of physics; figures for who chooses how exact a grasp has to be"]
fn off_by() {
    for at_m in [[0.3, -0.2], [0.3, 0.1], [0.4, -0.1]] {
        for (axis, name) in ["along", "across", "up"].iter().enumerate() {
            let steps = if axis == 2 { -2..=4 } else { -4..=4 };
            let row: Vec<String> = steps
                .map(|step| {
                    let mut off_m = [0.0; 3];
                    off_m[axis] = f64::from(step) * 0.006;
                    let up = lifted_m(Toy::Tomato, at_m, off_m).map_or(f64::NAN, |(up_m, ..)| up_m * 1e3);
                    format!("{:+.0}:{up:.0}", off_m[axis] * 1e3)
                })
                .collect();
            println!("{at_m:?} {name}: {}", row.join("  "));
        }
    }
}

#[test]
#[ignore = "for who looks for why a grasp failed"]
fn step_by_step() {
    for at_m in PLACES_M {
        let rig = Arc::new(Rig::built_in("nico").expect("valid"));
        let mut twin =
            Lockstep::new(rig.clone(), &Scenario::built_in("perfect").expect("valid"), 1).expect("a twin");
        Toy::ALL.iter().filter(|other| **other != Toy::Tomato).for_each(|other| twin.remove_toy(*other));
        twin.place_toy(Toy::Tomato, at_m[0], at_m[1]).expect("on the table");
        twin.wait(1.0);
        let place = |twin: &mut Lockstep| twin.truth_for_judging().toys[0].1.expect("out").translation.vector;
        let palm = |twin: &mut Lockstep| {
            let link = rig.description.find_link("right_palm_center").expect("a tip");
            twin.truth_for_judging().robot_from_link[link.0].expect("there").translation.vector
        };
        let before = place(&mut twin);
        let standing = Standing {
            xy_m: [before.x, before.y],
            support_m: before.z - 0.027,
            height_m: 0.054,
            lower_m: 0.0,
        };
        let planner = planner(&rig);
        let from = twin.commanded().clone();
        let Ok(plan) = planner.plan(&standing, &Vector3::zeros(), &from) else { continue };
        twin.follow(&plan.approach, 0.8);
        let above = place(&mut twin);
        let off = |twin: &mut Lockstep, posture: &Posture| {
            (palm(twin) - planner.arm().palm(posture).coords.coords) * 1e3
        };
        let above_off = off(&mut twin, plan.above().expect("above"));
        twin.follow(&plan.down, 0.5);
        let down = place(&mut twin);
        let closing = plan.closing().expect("down").clone();
        let down_off = off(&mut twin, &closing);
        println!(
            "{at_m:?} heading {:.2} support {:.1} way {} pushed above {:.0} down {:.0} mm, palm off above [{:.1} {:.1} {:.1}] down [{:.1} {:.1} {:.1}], joints {:.2?}",
            plan.heading_rad,
            (before.z - 0.027) * 1e3,
            plan.approach.len(),
            (above - before).norm() * 1e3,
            (down - before).norm() * 1e3,
            above_off.x,
            above_off.y,
            above_off.z,
            down_off.x,
            down_off.y,
            down_off.z,
            closing.of(planner.arm().joints()),
        );
    }
}

/// The palm of a robot with errors, brought exactly to where it belongs: how far it is tilted there all the same, and
/// whether it holds. `PLUMBLINE_SCENARIO` is the robot, one of development;
/// `PLUMBLINE_OFF_MM` ("0 0 -3") how far beside where it belongs, along the fingers, across, up.
#[test]
#[ignore = "for who looks for what a tilted palm holds"]
fn brought_there_exactly_by_a_robot_with_errors() {
    let name = std::env::var("PLUMBLINE_SCENARIO").unwrap_or_else(|_| "drawn-602".to_owned());
    let scenario = Scenario::named_or_file(&name).expect("a robot");
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let link = rig.description.find_link("right_palm_center").expect("a tip");
    let planner = planner(&rig);
    let mut held = 0;
    let off_m = Vector3::from(off_m());
    for at_m in PLACES_M {
        let mut twin = Lockstep::new(rig.clone(), &scenario, 1).expect("a twin");
        Toy::ALL.iter().filter(|other| **other != Toy::Tomato).for_each(|other| twin.remove_toy(*other));
        twin.place_toy(Toy::Tomato, at_m[0], at_m[1]).expect("on the table");
        twin.wait(1.0);
        let place = |twin: &mut Lockstep| twin.truth_for_judging().toys[0].1.expect("out").translation.vector;
        let palm = |twin: &mut Lockstep| twin.truth_for_judging().robot_from_link[link.0].expect("there");
        let before = place(&mut twin);
        let standing = Standing {
            xy_m: [before.x, before.y],
            support_m: before.z - 0.027,
            height_m: 0.054,
            lower_m: 0.0,
        };
        // Without the toy it comes down beside where it belongs and learns by how much.
        twin.remove_toy(Toy::Tomato);
        let home = twin.commanded().clone();
        let Ok(rough) = planner.plan(&standing, &Vector3::zeros(), &home) else { continue };
        let beside_m = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), rough.heading_rad) * off_m;
        let mut shift = beside_m;
        for _ in 0..2 {
            let Ok(there) = planner.plan(&standing, &shift, &home) else { break };
            twin.follow(&there.approach, 0.8);
            twin.follow(&there.down, 0.5);
            let closing = there.closing().expect("a way down");
            let wanted = planner.arm().palm(closing).coords.coords - shift + beside_m;
            shift += wanted - palm(&mut twin).translation.vector;
            twin.follow(&[there.above().expect("above").clone(), home.clone()], 0.8);
        }
        twin.place_toy(Toy::Tomato, at_m[0], at_m[1]).expect("on the table");
        twin.wait(1.0);
        let Ok(plan) = planner.plan(&standing, &shift, &home) else { continue };
        twin.follow(&plan.approach, 0.8);
        twin.follow(&plan.down, 0.5);
        let closing = plan.closing().expect("a way down").clone();
        let planned = planner.arm().robot_from_palm(&closing).isometry;
        let turned_deg =
            (palm(&mut twin).rotation * planned.rotation.inverse()).scaled_axis().map(f64::to_degrees);
        let off =
            (palm(&mut twin).translation.vector - (planned.translation.vector - shift + beside_m)) * 1e3;
        let close = closed(&mut twin, &rig, &closing);
        let in_palm = |twin: &mut Lockstep| {
            (palm(twin).inverse_transform_point(&place(twin).into()).coords * 1e3).map(|mm| mm.round())
        };
        let when_closed = in_palm(&mut twin);
        let up = planner.lift(&close, plan.heading_rad, GraspPlanner::LIFT_M);
        twin.follow(&up, 0.4);
        let lifted = in_palm(&mut twin);
        let level = planner.arm().level(up.last().unwrap_or(&close));
        if std::env::var_os("PLUMBLINE_CREEP").is_some() {
            creep(&mut twin, &rig, Toy::Tomato);
        }
        twin.wait(HOLDS_S);
        let up_mm = (place(&mut twin).z - before.z) * 1e3;
        held += u32::from(up_mm > 40.0);
        println!(
            "{at_m:?}: up {up_mm:.0} mm, beside [{:.1} {:.1} {:.1}] mm, turned [{:.1} {:.1} {:.1}] deg, level {level:.3}, in the palm closed {:?} lifted {:?}",
            off.x,
            off.y,
            off.z,
            turned_deg.x,
            turned_deg.y,
            turned_deg.z,
            when_closed.as_slice(),
            lifted.as_slice()
        );
    }
    println!("{held} of {}", PLACES_M.len());
}

#[test]
#[ignore = "for who looks for why a hand does not come down"]
fn room_at_the_edge() {
    let rig = Arc::new(Rig::built_in("nico").expect("valid"));
    let planner = planner(&rig);
    let standing = Standing { xy_m: [0.2, 0.3], support_m: 0.054, height_m: 0.054, lower_m: 0.0 };
    let plan = planner.plan(&standing, &Vector3::zeros(), &rig.home()).expect("in reach");
    let bodies = plumbline_model::robot::collision::CollisionModel::of_rig(&rig);
    for posture in &plan.down {
        println!(
            "level {:.2} palm {:.3?} {:?}",
            planner.arm().level(posture),
            planner.arm().palm(posture).coords.coords,
            bodies.check_posture(posture, &[])
        );
    }
}

#[test]
#[ignore = "minutes of physics; figures for who chooses how high over a thing the hand closes"]
fn a_little_off_everywhere_at_every_height() {
    const OFF_MM: [[f64; 2]; 6] =
        [[3.0, 3.0], [-3.0, 3.0], [3.0, -3.0], [-3.0, -3.0], [0.0, 5.0], [0.0, -5.0]];
    let wanted = std::env::var("PLUMBLINE_UP_MM").unwrap_or_else(|_| "-2 0 2 4 6".to_owned());
    for up_mm in wanted.split(' ').filter_map(|up| up.parse::<f64>().ok()) {
        let cases = PLACES_M.iter().flat_map(|at_m| OFF_MM.map(|off| (*at_m, off)));
        let missed: Vec<_> = cases
            .filter(|(at_m, [along, across])| {
                let off_m = [*along, *across, up_mm].map(|mm| mm * 1e-3);
                !lifted_m(Toy::Tomato, *at_m, off_m).is_ok_and(|(up_m, ..)| up_m > 0.04)
            })
            .collect();
        let all = PLACES_M.len() * OFF_MM.len();
        println!("{up_mm:+.1} mm: {} of {all}; missed {missed:?}", all - missed.len());
    }
}

#[test]
#[ignore = "many minutes of physics; figures for who chooses where in the hand a thing belongs"]
fn where_in_the_hand() {
    // Every third place; how far the hand is beside where it is sent, mm: along, across, up.
    const EVERY: usize = 3;
    const ALONG_MM: [f64; 7] = [-12.0, -8.0, -4.0, 0.0, 4.0, 8.0, 12.0];
    const ACROSS_MM: [f64; 5] = [-8.0, -4.0, 0.0, 4.0, 8.0];
    let wanted = std::env::var("PLUMBLINE_UP_MM").unwrap_or_else(|_| "-4 0 4".to_owned());
    for up_mm in wanted.split(' ').filter_map(|up| up.parse::<f64>().ok()) {
        println!("{up_mm:+.0} mm up; across {ACROSS_MM:?} mm");
        for along_mm in ALONG_MM {
            let row = ACROSS_MM.map(|across_mm| {
                let off_m = [along_mm, across_mm, up_mm].map(|mm| mm * 1e-3);
                let places = PLACES_M.iter().step_by(EVERY);
                places
                    .filter(|at_m| lifted_m(Toy::Tomato, **at_m, off_m).is_ok_and(|(up_m, ..)| up_m > 0.04))
                    .count()
            });
            println!("{along_mm:+5.0} mm along: {row:?} of {}", PLACES_M.len().div_ceil(EVERY));
        }
    }
}
