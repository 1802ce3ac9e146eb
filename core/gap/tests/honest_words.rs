//! What must not be said: no gap where repeats have structure or servos give way, nothing to add where a
//! part of the gap closes, a name where most of it stays open.
#![allow(clippy::print_stdout, reason = "what is said is read from the test's output")]

mod common;

use common::{Plan, elbow_zero, normal, poses, present, touches};
use plumbline_effects::{Measurements, Situation};
use plumbline_gap::{Finding, Options, Verdict, find};
use plumbline_model::Unattended;
use rand::rngs::StdRng;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};

const ELBOW: usize = 3;

fn looked_at(measurements: &Measurements, show: bool) -> Finding {
    let options = Options { show, advise: false, ..Options::default() };
    let finding = find(measurements, &options, &Unattended).expect("can be looked at");
    println!("{:?}: {}", finding.verdict, finding.sentence);
    finding
}

/// Repeats at times drawn by chance.
fn at_any_time(mut measurements: Measurements, seed: u64) -> Measurements {
    let mut moments: Vec<f64> = (0..measurements.rows.len()).map(|i| 8.0 * i as f64).collect();
    moments.shuffle(&mut StdRng::seed_from_u64(seed));
    for (row, t_secs) in measurements.rows.iter_mut().zip(moments) {
        (row.t_secs, row.hold_secs) = (Some(t_secs), None);
    }
    measurements.rows.sort_by(|a, b| a.t_secs.unwrap_or_default().total_cmp(&b.t_secs.unwrap_or_default()));
    measurements
}

#[test]
fn a_wobble_in_the_repeats_is_no_noise() {
    let mut made = at_any_time(poses(&Plan { repeats: 4, ..Plan::default() }, &[], 3), 4);
    for row in &mut made.rows {
        row.measured[0] += 5e-3 * (row.t_secs.expect("given") / 40.0).sin();
    }
    let finding = looked_at(&made, false);
    assert_ne!(finding.verdict, Verdict::NoGap);
    assert_eq!(finding.unexplained.depends_on.first().map(|on| on.on.as_str()), Some("time"));
}

#[test]
fn a_joint_that_remembers_where_it_came_from_is_no_noise() {
    let mut made = at_any_time(poses(&Plan { repeats: 4, ..Plan::default() }, &[], 5), 6);
    for i in 1..made.rows.len() {
        let turned = made.rows[i].angles_rad()[ELBOW] - made.rows[i - 1].angles_rad()[ELBOW];
        made.rows[i].measured[2] += 2e-3 * turned.signum();
    }
    let finding = looked_at(&made, false);
    assert_eq!(finding.verdict, Verdict::NotInLibrary);
    let on = &finding.unexplained.depends_on[0].on;
    assert!(on.starts_with("where ") && on.contains("elbow"), "{on}");
}

#[test]
fn repeats_at_any_time_without_structure_are_noise() {
    for seed in 0..10 {
        let made = at_any_time(poses(&Plan { repeats: 4, ..Plan::default() }, &[], 20 + seed), 40 + seed);
        assert_eq!(looked_at(&made, false).verdict, Verdict::NoGap);
    }
}

/// Nineteen touches all over the screen by an arm that errs in every joint: the nearest of them are far from each other,
/// and what the arm errs by from one to the next is no noise.
#[test]
fn few_touches_far_apart_say_nothing_of_their_noise_and_clear_no_arm() {
    let plan = Plan { places: 19, repeats: 1, noise_m: 5e-4, ..Plan::default() };
    let some = touches(&plan, &[], 1);
    let sites = ["r_shoulder_z", "r_shoulder_y", "r_arm_x", "r_elbow_y", "r_wrist_z", "r_wrist_x"];
    for seed in 0..6 {
        let mut random = StdRng::seed_from_u64(900 + seed);
        let mut off = |id: &str, size: f64| -> Vec<plumbline_effects::Present> {
            let zeros = |site: &&str| {
                let count =
                    common::present(&some, id, site, &[0.0; 2][..if id == "axis-skew" { 2 } else { 1 }]);
                let values = count.values.iter().map(|_| size * normal(&mut random)).collect();
                plumbline_effects::Present { values, ..count }
            };
            sites.iter().map(zeros).collect()
        };
        let hidden = [off("joint-zero", 0.02), off("axis-skew", 0.015)].concat();
        let finding = looked_at(&touches(&plan, &hidden, 40 + seed), true);
        println!(
            "before {:.4}, floor {:.4}: {:?}",
            finding.shown.before, finding.shown.floor, finding.comparison.floor_source
        );
        assert_ne!(finding.comparison.floor_source, plumbline_gap::finding::FloorSource::Neighbors);
        assert!(!finding.sentence.contains("no gap to close"), "{}", finding.sentence);
        // Nothing is clear of a gap where nothing tells the noise: neither in the verdict nor in its words.
        if finding.comparison.floor_source == plumbline_gap::finding::FloorSource::Fitted {
            assert!(!finding.is_all_clear() && !finding.sentence.contains("agree"), "{}", finding.sentence);
        }
        if finding.verdict == Verdict::NoGap {
            for words in ["noise is not known", "nothing in the library explains", "repeats of one pose"] {
                assert!(finding.sentence.contains(words), "{words}: {}", finding.sentence);
            }
        }
    }
}

/// Touches whose encoders were logged, with a servo of the upper arm that gives way by so much, rad/N m.
fn with_encoders(gives: f64, seed: u64) -> Measurements {
    const ARM: usize = 2;
    let plan = Plan { payloads: vec![0.0, 0.25], ..Plan::default() };
    let mut made = touches(&plan, &[], seed);
    let arm = made.apparatuses[0].arm.clone().expect("an arm");
    let mut random = StdRng::seed_from_u64(seed);
    for row in &mut made.rows {
        let encoder_rad = row.angles_rad().to_vec();
        let up = nalgebra::Vector3::z();
        let torque_nm =
            Situation::new(&arm, &encoder_rad, &row.direction, row.payload_kg, &up).torques_nm()[ARM];
        let mut commanded_rad = encoder_rad.clone();
        commanded_rad[ARM] -= gives * torque_nm;
        commanded_rad.iter_mut().for_each(|angle| *angle += 1e-3 * normal(&mut random));
        (row.commanded_rad, row.encoder_rad) = (Some(commanded_rad), Some(encoder_rad));
    }
    made
}

#[test]
fn a_servo_that_gives_way_is_named_although_touches_agree_with_its_encoder() {
    let finding = looked_at(&with_encoders(0.06, 7), false);
    assert_eq!(finding.verdict, Verdict::Named);
    let droop = finding.effects.iter().find(|effect| effect.id == "servo-droop").expect("named");
    assert_eq!(droop.site, "r_arm_x");
    let stiffness = &droop.parameters[0];
    assert!(stiffness.low < 1.0 / 0.06 && 1.0 / 0.06 < stiffness.high, "{stiffness:?}");
    assert!((0.0..=1.0).contains(&droop.probability));
}

#[test]
fn servos_that_all_give_way_are_told_and_none_of_them_is_named() {
    let mut made = with_encoders(0.0, 8);
    let arm = made.apparatuses[0].arm.clone().expect("an arm");
    for row in &mut made.rows {
        let encoder_rad = row.encoder_rad.clone().expect("logged");
        let up = nalgebra::Vector3::z();
        let situation = Situation::new(&arm, &encoder_rad, &row.direction, row.payload_kg, &up);
        let commanded = row.commanded_rad.as_mut().expect("logged");
        commanded.iter_mut().zip(situation.torques_nm()).for_each(|(angle, nm)| *angle -= nm / 30.0);
    }
    let finding = looked_at(&made, false);
    assert_eq!(finding.verdict, Verdict::NoGap);
    assert!(finding.effects.is_empty());
    assert!(finding.sentence.contains("springs of 30 N m/rad"), "{}", finding.sentence);
}

#[test]
fn servos_that_hold_have_no_name() {
    for seed in 0..5 {
        let finding = looked_at(&with_encoders(0.0, 30 + seed), false);
        assert!(finding.effects.iter().all(|effect| effect.id != "servo-droop"), "{}", finding.sentence);
    }
}

/// Every place is off by an amount of its own, up to this far in u and v.
fn with_places_off(mut made: Measurements, most_m: f64, seed: u64) -> Measurements {
    let mut random = StdRng::seed_from_u64(seed);
    let cells = 1 + made.rows.iter().map(|row| row.cell).max().unwrap_or(0);
    let off: Vec<[f64; 2]> =
        (0..cells).map(|_| [0, 1].map(|_| most_m * (2.0 * random.random::<f64>() - 1.0))).collect();
    for row in &mut made.rows {
        (0..2).for_each(|c| row.measured[c] += off[row.cell][c]);
    }
    made
}

#[test]
fn what_may_be_added_is_offered_beside_a_fit_that_may_not() {
    // The tip is further off than any that was measured.
    let plan = Plan { places: 90, ..Plan::default() };
    let some = touches(&Plan { places: 1, repeats: 1, ..Plan::default() }, &[], 1);
    let far = present(&some, "tip-offset", "tip", &[0.06, 0.0, 0.0]);
    let made = with_places_off(touches(&plan, &[elbow_zero(0.1), far], 9), 3e-3, 10);
    let finding = looked_at(&made, true);
    assert_eq!(finding.verdict, Verdict::NotInLibrary);
    let barred = finding.effects.iter().filter(|effect| effect.not_addable.is_some()).count();
    assert_eq!((barred, finding.effects.len()), (1, 2));
    let part = finding.shown.part.as_ref().expect("judged by itself");
    assert!(part.after < finding.shown.before && part.after != finding.shown.after, "{:?}", finding.shown);
    assert!(finding.warnings.iter().all(|words| !words.contains("do not add it")), "{:?}", finding.warnings);
    assert!(finding.partial && finding.addable().len() == 1);
    assert!(finding.sentence.contains("the rest of it cannot be added"), "{}", finding.sentence);
}

#[test]
fn what_is_larger_than_plausible_is_offered_where_it_surely_helps() {
    let plan = Plan { places: 90, ..Plan::default() };
    let made = with_places_off(touches(&plan, &[elbow_zero(0.2)], 9), 2e-3, 10);
    let finding = looked_at(&made, true);
    assert_eq!(finding.verdict, Verdict::NotInLibrary);
    assert!(finding.partial && !finding.addable().is_empty(), "{:?}", finding.shown);
    let warned = finding.warnings.iter().any(|words| words.contains("by more than is plausible"));
    assert!(warned, "{:?}", finding.warnings);
}

#[test]
fn what_closes_a_part_beside_something_unknown_can_be_added_as_a_part() {
    let plan = Plan { places: 90, ..Plan::default() };
    let made = with_places_off(touches(&plan, &[elbow_zero(0.1)], 9), 3e-3, 10);
    let finding = looked_at(&made, true);
    assert_eq!(finding.verdict, Verdict::NotInLibrary);
    assert!(finding.partial, "{:?}", finding.shown);
    assert!(!finding.addable().is_empty());
    assert!(finding.sentence.contains("A part of it can be added"), "{}", finding.sentence);
    for effect in &finding.effects {
        assert!(
            effect.probability > 0.0 && effect.probability < 0.8,
            "{}: {}",
            effect.title,
            effect.probability
        );
    }
}

#[test]
fn every_link_wrong_by_centimeters_is_no_name() {
    let plan = Plan { places: 60, heights: vec![0.0, 0.06], ..Plan::default() };
    let every = |by_m: f64| {
        let some = touches(&plan, &[], 1);
        let signs = [1.0, -1.0, 1.0, -1.0, 1.0, -1.0].map(|sign: f64| sign * by_m);
        let sites = present(&some, "link-length", "", &[]).effect.parameters().len();
        let hidden = present(&some, "link-length", "", &signs[..sites]);
        looked_at(&touches(&plan, &[hidden], 3), false)
    };
    let plausible = every(0.008);
    assert_ne!(plausible.verdict, Verdict::NotInLibrary, "{}", plausible.sentence);
    let far = every(0.018);
    assert_eq!(far.verdict, Verdict::NotInLibrary, "{}", far.sentence);
    assert!(far.effects.iter().all(|effect| effect.probability < 0.5), "{}", far.sentence);
}
