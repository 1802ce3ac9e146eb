// What was measured is printed.
#![allow(clippy::print_stdout)]

use std::time::Instant;

use nalgebra::Matrix3xX;
use plumbline_model::robot::Posture;
use plumbline_model::robot::ik::{Answer, Options, Solver, Target};
use plumbline_model::{PlanOptions, Point, Robot, Side, Sides, TouchArea, TouchPlan};

use super::tangent::{ContactTangent, STEP};
use super::*;
use crate::library::Kind;

const TIP: &str = "right_index_tip";

struct World {
    rig: Rig,
    arm: Arm,
    surface: Surface,
    effects: Vec<Effect>,
}

impl World {
    fn new() -> Self {
        let rig = Rig::built_in("nico").expect("comes with the program");
        let arm = Arm::of_rig(&rig, TIP).expect("a tip of the rig");
        let surface = Surface::of(&rig.touchscreen);
        let effects = Effect::all(&arm);
        Self { rig, arm, surface, effects }
    }

    /// The arm's poses for a plan; touches that it does not reach are left out.
    fn contacts(&self, options: &PlanOptions) -> Vec<PlannedContact> {
        let plan = TouchPlan::make(options, &self.rig.touchscreen).expect("a proper plan");
        let solver = Solver::of_rig(&self.rig, TIP).expect("a tip of the rig");
        let start = self.rig.home();
        let contact = |touch: &plumbline_model::PlannedTouch| {
            let goal = self.rig.touchscreen.raised(touch.screen_height_m).point_at(touch.target);
            let (dy, dz) = match touch.side {
                Side::Above => (0.0, 0.05),
                Side::Left => (0.05, 0.02),
                Side::Right => (-0.05, 0.02),
            };
            let at = solve(&solver, goal, &start)?;
            let from = Point::new(goal.coords.x, goal.coords.y + dy, goal.coords.z + dz);
            let before = solve(&solver, from, &start.with(solver.joints(), &at))?;
            let sign = |(a, b): (&f64, &f64)| if (a - b).abs() < 1e-3 { 0.0 } else { (a - b).signum() };
            Some(PlannedContact {
                direction: at.iter().zip(&before).map(sign).collect(),
                angles_rad: at,
                screen_height_m: touch.screen_height_m,
                payload_kg: touch.payload_kg,
                group: touch.group.clone(),
            })
        };
        plan.touches.iter().filter_map(contact).collect()
    }

    fn score(&self, contacts: &[PlannedContact]) -> PlanScore {
        score(&self.rig, TIP, contacts, &Noise::default()).expect("a proper plan")
    }

    fn tangent(&self, contact: &PlannedContact, step: f64) -> Matrix3xX<f64> {
        ContactTangent::of(&self.arm, &self.surface, &self.effects, contact, false, step).effects
    }
}

fn solve(solver: &Solver, goal: Point<Robot>, from: &Posture) -> Option<Vec<f64>> {
    match solver.solve_from(&Target::Position(goal), from, &Options::default()).expect("proper") {
        Answer::Reached(solution) => Some(solution.joints.to_vec()),
        _ => None,
    }
}

/// The part of the screen that the right arm reaches well.
fn area() -> TouchArea {
    TouchArea { u_px: [400.0, 1700.0], v_px: [450.0, 1000.0] }
}

fn visibility<'a>(score: &'a PlanScore, id: &str, site: &str) -> &'a EffectVisibility {
    score.seen.iter().find(|effect| effect.id == id && effect.site == site).expect("a candidate")
}

/// Whether the plan counts two effects as one class.
fn are_alike(score: &PlanScore, a: (&str, &str), b: (&str, &str)) -> bool {
    let holds = |class: &[(String, String)], name: (&str, &str)| {
        class.iter().any(|(id, site)| (id.as_str(), site.as_str()) == name)
    };
    score.alike.iter().any(|class| holds(class, a) && holds(class, b))
}

#[test]
fn tangents_do_not_depend_on_the_step() {
    let world = World::new();
    for contact in world.contacts(&PlanOptions::quick(area())) {
        let (coarse, fine) = (world.tangent(&contact, 10.0 * STEP), world.tangent(&contact, STEP));
        let difference = (&coarse - &fine).amax();
        // Central differences err with the square of the step: 0.1 of a usual size is 0.005 rad.
        assert!(difference < 1e-4 * fine.amax() + 1e-9, "{difference} of {}", fine.amax());
        assert!(fine.iter().all(|value| value.is_finite()));
    }
}

#[test]
fn a_joint_zero_moves_the_touch_like_the_joint_itself() {
    let world = World::new();
    let chain = world.rig.chain(TIP).expect("a tip of the rig");
    let contact = &world.contacts(&PlanOptions::quick(area()))[3];
    let (_, jacobian) = chain.jacobian(&contact.angles_rad);
    let tangent = world.tangent(contact, STEP);
    let screen = &world.rig.touchscreen;
    for joint in 0..world.arm.len() {
        let zero = tangent.column(joint) / Kind::JointZero.parameters()[0].typical;
        let velocity = jacobian.fixed_view::<3, 1>(0, joint);
        let expected = nalgebra::Vector3::new(
            velocity.dot(&screen.u_axis.vector()),
            velocity.dot(&screen.v_axis.vector()),
            velocity.dot(&screen.normal().vector()),
        );
        assert!((zero - expected).norm() < 1e-6, "joint {joint}: {zero:?} against {expected:?}");
    }
}

#[test]
fn what_the_screens_place_hides_is_not_seen() {
    let world = World::new();
    let score = world.score(&world.contacts(&PlanOptions::rich(area())));
    // The first joint turns everything about the vertical, as a turned screen would.
    let hidden = [
        ("joint-zero", "r_shoulder_z"),
        ("axis-skew", "r_shoulder_z"),
        ("base-tilt", "base"),
        ("screen-tilt", "screen"),
    ];
    for (id, site) in hidden {
        let effect = visibility(&score, id, site);
        assert!(effect.sigmas < 1e-3 && effect.doubt_left > 0.999, "{effect:?}");
        assert!(!effect.is_seen());
    }
    for (id, site) in [("joint-zero", "r_elbow_y"), ("screen-scale", "screen"), ("backlash", "r_elbow_y")] {
        assert!(visibility(&score, id, site).is_seen(), "{id} at {site}");
    }
}

#[test]
fn richer_plans_tell_more() {
    let world = World::new();
    let plain = PlanOptions::first(area());
    let sides = PlanOptions { sides: Sides::LeftAndRight, ..plain.clone() };
    let heights = PlanOptions { screen_heights_m: vec![0.0, 0.06, 0.12], ..sides.clone() };
    let weights = PlanOptions { payloads_kg: vec![0.0, 0.25], ..heights.clone() };
    let plans = [
        ("from above", plain),
        ("from two sides", sides),
        ("at three heights", heights),
        ("with a weight", weights),
    ];
    let mut before: Option<PlanScore> = None;
    for (name, options) in plans {
        // As many touches in every plan, so that only their kind counts.
        let all = world.contacts(&options);
        let contacts: Vec<PlannedContact> = (0..80).map(|i| all[i * all.len() / 80].clone()).collect();
        let score = world.score(&contacts);
        println!(
            "80 touches {name}: {} directions of {} candidates, {:.0} bit, condition {:.0}",
            score.directions, score.candidates, score.information_bits, score.condition
        );
        if let Some(before) = before {
            assert!(score.directions > before.directions, "{name}");
            assert!(score.information_bits > before.information_bits, "{name}");
        } else {
            assert!((6..=13).contains(&score.directions), "{}", score.directions);
        }
        before = Some(score);
    }
    let rich = before.expect("four plans");
    println!("{}", rich.sentence());
    assert!(rich.sentence().starts_with(&format!("{} independent", rich.directions)));
    for (id, site) in rich.alike.iter().flatten() {
        assert!(rich.title(id, site).is_some(), "{id} at {site}");
    }
    assert!((18..=30).contains(&rich.directions), "{}", rich.directions);
}

#[test]
fn more_touches_never_tell_less() {
    let world = World::new();
    let contacts = world.contacts(&PlanOptions::first(area()));
    let mut bits = 0.0;
    for count in [1, 2, 3, 5, 10, 20, 40, contacts.len()] {
        let score = world.score(&contacts[..count]);
        assert!(score.information_bits >= bits - 1e-6, "{count} touches");
        bits = score.information_bits;
    }
    // One touch only places the screen; of two, their distance is left.
    assert_eq!(world.score(&contacts[..1]).directions, 0);
    assert!(world.score(&contacts[..2]).directions <= 1);
}

#[test]
fn a_weight_splits_sag_from_off_center_encoders() {
    let world = World::new();
    let plain = PlanOptions { sides: Sides::LeftAndRight, ..PlanOptions::first(area()) };
    let weights = PlanOptions { payloads_kg: vec![0.0, 0.25], ..plain.clone() };
    let (plain, weights) = (world.score(&world.contacts(&plain)), world.score(&world.contacts(&weights)));
    let sag = ("joint-sag", "r_arm_x");
    let doubt = |score: &PlanScore| visibility(score, sag.0, sag.1).doubt_left;
    println!("doubt about the sag of the arm: {:.2}, with a weight {:.2}", doubt(&plain), doubt(&weights));
    assert!(are_alike(&plain, sag, ("joint-zero", "r_arm_x")));
    assert!(!are_alike(&weights, sag, ("joint-zero", "r_arm_x")));
    assert!(doubt(&weights) < 0.5 * doubt(&plain));
}

#[test]
fn encoders_split_a_weak_servo_from_a_weak_bracket() {
    let world = World::new();
    let contacts = world.contacts(&PlanOptions::rich(area()));
    let (servo, bracket) = (("servo-droop", "r_shoulder_y"), ("joint-sag", "r_shoulder_y"));
    let blind = Noise { encoder_rad: None, ..Noise::default() };
    let blind = score(&world.rig, TIP, &contacts, &blind).expect("a proper plan");
    assert!(are_alike(&blind, servo, bracket));
    assert!(!are_alike(&world.score(&contacts), servo, bracket));
}

#[test]
fn play_shows_from_two_sides_only() {
    let world = World::new();
    let sides = PlanOptions { sides: Sides::LeftAndRight, ..PlanOptions::quick(area()) };
    let both = world.contacts(&sides);
    let one: Vec<PlannedContact> =
        both.iter().filter(|contact| contact.group.contains("left")).cloned().collect();
    let doubt = |contacts: &[PlannedContact]| {
        visibility(&world.score(contacts), "backlash", "r_shoulder_y").doubt_left
    };
    assert!(doubt(&both) < 0.3 && doubt(&one) > 0.8, "{} and {}", doubt(&both), doubt(&one));
    let advice = world.score(&one).advice;
    let other = advice.iter().find(|advice| advice.addition == Addition::OtherSide).expect("advised");
    println!("{}", other.sentence);
    assert!(other.directions_after > world.score(&one).directions);
}

#[test]
fn advice_comes_true() {
    let world = World::new();
    let options = PlanOptions::quick(area());
    let contacts = world.contacts(&options);
    let score = world.score(&contacts);
    for advice in &score.advice {
        println!("{}", advice.sentence);
        assert!(advice.directions_after > score.directions);
    }
    let weight = score.advice.iter().find(|advice| advice.addition == Addition::Weight).expect("advised");
    let both = world.contacts(&PlanOptions { payloads_kg: vec![0.0, 0.25], ..options });
    assert_eq!(world.score(&both).directions, weight.directions_after);
    let raised = score.advice.iter().find(|advice| advice.addition == Addition::RaisedScreen);
    assert!(raised.is_some());
}

#[test]
fn three_hundred_touches_are_scored_at_once() {
    let world = World::new();
    let options = PlanOptions {
        screen_heights_m: vec![0.0, 0.06],
        sides: Sides::LeftAndRight,
        ..PlanOptions::first(area())
    };
    let contacts = world.contacts(&options);
    let contacts = &contacts[..300];
    let timed = || {
        let start = Instant::now();
        world.score(contacts);
        start.elapsed()
    };
    // The machine may be busy with something else for a moment.
    let took = (0..3).map(|_| timed()).min().expect("three times");
    println!("300 touches are scored in {took:.1?}");
    assert!(took.as_secs_f64() < 0.3, "{took:?}");
}

#[test]
fn what_cannot_be_scored_says_what_to_do() {
    let world = World::new();
    let contact = world.contacts(&PlanOptions::quick(area()))[0].clone();
    let says = |contacts: &[PlannedContact], tip: &str, noise: &Noise, words: &str| {
        let message = score(&world.rig, tip, contacts, noise).expect_err("refused").to_string();
        assert!(message.contains(words), "\"{words}\" is not in: {message}");
    };
    let noise = Noise::default();
    says(&[], TIP, &noise, "no touch");
    says(std::slice::from_ref(&contact), "nose_tip", &noise, "nose_tip");
    says(std::slice::from_ref(&contact), "torso", &noise, "no joint moves");
    let short = PlannedContact { angles_rad: vec![0.0; 3], ..contact.clone() };
    says(&[contact.clone(), short], TIP, &noise, "touch 2 has 3 angles");
    let lost = PlannedContact { payload_kg: f64::NAN, ..contact.clone() };
    says(&[lost], TIP, &noise, "not a number");
    says(&[contact], TIP, &Noise { in_plane_m: 0.0, ..noise }, "greater than zero");
}
