//! Noise of encoders is no reading that was taken too early.

mod common;

use common::{Plan, elbow_zero, normal, present, touches};
use plumbline_effects::{Assumed, Measurements};
use plumbline_gap::{Options, find};
use plumbline_model::Unattended;
use rand::SeedableRng;
use rand::rngs::StdRng;

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
fn touched(made: &Measurements, i: usize, there: &[f64]) -> plumbline_effects::measurements::Observation {
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
