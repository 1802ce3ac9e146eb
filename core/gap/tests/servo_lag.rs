//! Noise of encoders is no reading that was taken too early, and what is fast does not stick.
#![allow(clippy::print_stdout, reason = "what is said is read from the test's output")]

mod common;

use common::{JOINTS, Plan, elbow_zero, normal, present, touches};
use nalgebra::Vector3;
use plumbline_effects::measurements::Observation;
use plumbline_effects::{Assumed, Measurements, Situation};
use plumbline_gap::{Options, find};
use plumbline_model::Unattended;
use rand::SeedableRng;
use rand::rngs::StdRng;

/// How fast the finger comes down, m per radian of the slowest joint.
const DOWN_M: f64 = 0.2;
/// By place among the joints.
const SHOULDER: usize = 1;
const WRIST: usize = 5;
/// Spread of what an encoder reads, rad.
const READING_RAD: f64 = 1.5e-3;

/// Touches from two sides of an arm whose elbow's zero is off and whose encoders are noisy and read this
/// far from where they were told to be; of that, the share `early` is gone when the finger meets the glass.
fn logged(sides: &[&'static str], lag_rad: f64, early: f64, seed: u64) -> Measurements {
    let plan = Plan { places: 80, sides: sides.to_vec(), noise_m: 0.7e-3, ..Plan::default() };
    let hidden = [elbow_zero(0.06)];
    let mut made = touches(&plan, &hidden, seed);
    let mut random = StdRng::seed_from_u64(seed + 1000);
    let truth = Assumed { effects: hidden.to_vec(), ..Assumed::nominal(&made) };
    for i in 0..made.rows.len() {
        let row = &mut made.rows[i];
        // Touches were planned for where the arm is.
        let there = row.commanded_rad.clone().expect("commanded");
        let lag = |j: usize| lag_rad * (row.direction[j] + 0.5 * (3.0 * there[j]).sin());
        let lags: Vec<f64> = (0..there.len()).map(lag).collect();
        row.commanded_rad = Some(there.iter().zip(&lags).map(|(at, lag)| at + (1.0 - early) * lag).collect());
        let read =
            there.iter().zip(&lags).map(|(at, lag)| at - early * lag + READING_RAD * normal(&mut random));
        row.encoder_rad = Some(read.collect());
        let noise = [0, 1].map(|_| plan.noise_m * normal(&mut random));
        let exact = made.predict(&touched(&made, i, &there), &truth).expect("predictable");
        made.rows[i].measured = vec![exact[0] + noise[0], exact[1] + noise[1], exact[2]];
    }
    made.complete_lags();
    made
}

/// The row with the angles that the arm really had.
fn touched(made: &Measurements, i: usize, there: &[f64]) -> Observation {
    let mut row = made.rows[i].clone();
    row.encoder_rad = Some(there.to_vec());
    row
}

#[test]
fn encoders_that_are_noisy_were_not_read_too_early() {
    let options = Options { show: false, advise: false, ..Options::default() };
    for seed in 0..4 {
        let finding = find(&logged(&[], 3e-4, 0.0, seed), &options, &Unattended).expect("can be looked at");
        assert!(finding.effects.iter().all(|effect| effect.id != "early-log"), "{}", finding.sentence);
    }
}

#[test]
fn encoders_that_were_read_too_early_are_found_through_their_noise() {
    let options = Options { show: false, advise: false, ..Options::default() };
    for seed in 10..13 {
        let made = logged(&["plus", "minus"], 1e-2, 0.9, seed);
        let hidden = present(&made, "early-log", "", &[0.9]);
        let finding = find(&made, &options, &Unattended).expect("can be looked at");
        let found = finding.effects.iter().find(|effect| effect.id == hidden.effect.id());
        let found = found.unwrap_or_else(|| panic!("{}", finding.sentence));
        assert!((found.values[0] - 0.9).abs() < 0.1, "{:?}", found.values);
        let others = finding
            .effects
            .iter()
            .filter(|effect| !["early-log", "joint-zero"].contains(&effect.id.as_str()));
        assert_eq!(others.count(), 0, "{}", finding.sentence);
    }
}

/// What one servo does more than the others.
#[derive(Clone, Copy, Default)]
struct More {
    joint: usize,
    /// Friction stops it so much farther from its goal, rad.
    stops_rad: f64,
    /// Gives way under its load, rad/N m.
    gives: f64,
}

/// How far each joint lowers the finger in a row, m/rad.
fn lowers(made: &Measurements, row: &Observation) -> Vec<f64> {
    let nominal = Assumed::nominal(made);
    let height_m = |row: &Observation| made.predict(row, &nominal).expect("predictable")[2];
    let here = height_m(row);
    let slope = |j: usize| {
        let mut ahead = row.clone();
        ahead.commanded_rad.as_mut().expect("commanded")[j] += 1e-5;
        (here - height_m(&ahead)) / 1e-5
    };
    (0..row.direction.len()).map(slope).collect()
}

/// Where touches come from.
#[derive(Clone, Copy)]
enum Sides {
    /// With a weight and without.
    BothSides,
    /// Servos that rub by a fifth of that.
    OneSide,
}

/// Touches. Every joint turns one way until the finger meets the glass; where those that lift it would win,
/// those that lower it are all faster by the same factor. Servos stay behind by a little and by their speed, some of them by
/// `more` than that.
fn moved(sides: Sides, more: &[More], seed: u64) -> Measurements {
    let (sides, payloads, rubs) = match sides {
        Sides::BothSides => (vec!["plus", "minus"], vec![0.0, 0.4], 1.0),
        Sides::OneSide => (vec!["minus"], vec![0.0], 0.2),
    };
    let plan = Plan { places: 80, sides, payloads, noise_m: 0.7e-3, ..Plan::default() };
    let mut made = touches(&plan, &[], seed);
    let mut random = StdRng::seed_from_u64(seed + 2000);
    for i in 0..made.rows.len() {
        let sinks: Vec<f64> = lowers(&made, &made.rows[i])
            .iter()
            .zip(&made.rows[i].direction)
            .map(|(lowers, side)| lowers * side)
            .collect();
        let sum = |way: f64| sinks.iter().map(|sink| (way * sink).max(0.0)).sum::<f64>();
        let faster = ((sum(-1.0) + DOWN_M) / sum(1.0).max(1e-3)).clamp(1.0, 8.0);
        let row = &mut made.rows[i];
        let there = row.commanded_rad.clone().expect("commanded");
        let arm = made.apparatuses[row.session].arm.as_ref().expect("an arm");
        let up = Vector3::z();
        let torques_nm =
            Situation::new(arm, &there, &row.direction, row.payload_kg, &up).torques_nm().to_vec();
        let lag = |j: usize| {
            let rate = if sinks[j] > 0.0 { faster } else { 1.0 };
            let own = more.iter().find(|one| one.joint == j).copied().unwrap_or_default();
            let behind_rad = (rubs * (1e-3 + 4e-3 * rate) + own.stops_rad) * row.direction[j];
            behind_rad - own.gives * torques_nm[j] + 1e-4 * normal(&mut random)
        };
        let lags: Vec<f64> = (0..there.len()).map(lag).collect();
        row.commanded_rad = Some(there.iter().zip(&lags).map(|(at, lag)| at + lag).collect());
        row.encoder_rad = Some(there);
    }
    made.complete_lags();
    made
}

/// Sites of effects of a kind, of what was found.
fn sites(made: &Measurements, id: &str) -> Vec<String> {
    let options = Options { show: false, advise: false, ..Options::default() };
    let finding = find(made, &options, &Unattended).expect("can be looked at");
    println!("{:?}: {}", finding.verdict, finding.sentence);
    let of_kind = finding.effects.iter().filter(|effect| effect.id == id);
    of_kind.map(|effect| effect.site.clone()).collect()
}

#[test]
fn servos_that_lag_by_their_speed_do_not_stick_and_one_that_stays_behind_by_more_does() {
    for seed in 0..3 {
        let none: Vec<String> = vec![];
        assert_eq!(sites(&moved(Sides::BothSides, &[], seed), "stiction"), none, "all are as they should be");
        let sticks = moved(Sides::BothSides, &[More { joint: SHOULDER, stops_rad: 15e-3, gives: 0.0 }], seed);
        assert_eq!(sites(&sticks, "stiction"), [JOINTS[SHOULDER]]);
        assert_eq!(sites(&sticks, "servo-droop"), none);
    }
}

#[test]
fn friction_stops_a_soft_servo_farther_from_its_goal_and_it_does_not_stick_for_that() {
    let wrist = |stops_rad: f64, gives: f64| More { joint: WRIST, stops_rad, gives };
    for seed in 0..3 {
        let none: Vec<String> = vec![];
        // What it gives way by alone is too little for a name, for it bears little.
        let by_load = moved(Sides::BothSides, &[wrist(0.0, 0.03)], seed);
        assert_eq!(sites(&by_load, "servo-droop"), none);
        let soft = moved(Sides::BothSides, &[wrist(15e-3, 0.03)], seed);
        assert_eq!(sites(&soft, "servo-droop"), [JOINTS[WRIST]]);
        assert_eq!(sites(&soft, "stiction"), none);
        // One that gives way by so much less would need more friction than gravity asks of any joint.
        let sticks = moved(Sides::BothSides, &[wrist(15e-3, 0.003)], seed);
        assert_eq!(sites(&sticks, "stiction"), [JOINTS[WRIST]]);
        assert_eq!(sites(&sticks, "servo-droop"), none);
    }
}

#[test]
fn from_one_side_the_soft_servo_is_told_by_those_that_hold() {
    // Friction toward the load hides most of what the shoulder gives way by, and what joints that bear nothing lag by looks as if
    // they were soft.
    let soft = |joint: usize| More { joint, stops_rad: 0.0, gives: 0.05 };
    let hidden = More { stops_rad: 5e-3, ..soft(SHOULDER) };
    for seed in 0..3 {
        let none: Vec<String> = vec![];
        assert_eq!(sites(&moved(Sides::OneSide, &[], seed), "servo-droop"), none);
        assert_eq!(sites(&moved(Sides::OneSide, &[hidden], seed), "servo-droop"), [JOINTS[SHOULDER]]);
        let all: Vec<More> = (0..JOINTS.len()).map(soft).collect();
        assert_eq!(sites(&moved(Sides::OneSide, &all, seed), "servo-droop"), none, "that is their way");
    }
}
