//! Repeats of an arm that was measured from outside, before and after a horn slipped: the joint has turned, which moves the
//! flange here this way and there that way, so that the spread along x, y and z only looks wider.

use super::levers::{column, rest_of};
use super::spread::{SIGNIFICANT, Spread};
use super::structure::{LEAST_WITHIN, Repeat, Structure, moments};
use crate::statistics::f_tail;

/// One joint that turned at one moment, beyond doubt. `fits`: all that is tried beside it; `when`: what [`Repeat::when`] is,
/// for people.
pub fn by_slips(
    rows: &[Repeat],
    spread: &Spread,
    joints: usize,
    fits: usize,
    when: &str,
) -> Option<Structure> {
    let moments = moments(rows);
    let off = spread.whitened();
    let fits = (fits + joints * moments.len()) as f64;
    let free = (spread.free() * spread.counted.len() as f64 - 1.0).max(1.0);
    let mut best: Option<Structure> = None;
    for joint in 0..joints {
        for &from in &moments {
            let turned = |row: &Repeat, c: usize| {
                row.levers.get(joint).map_or(0.0, |lever| if row.when >= from { lever[c] } else { 0.0 })
            };
            let Some(column) = column(rows, spread, LEAST_WITHIN, &turned) else { continue };
            let Some(rest) = rest_of(&off, &[&column]) else { continue };
            let lost = off.norm_squared() - rest.norm_squared();
            let p_value = f_tail(lost / (rest.norm_squared() / free).max(1e-300), 1.0, free) * fits;
            if p_value <= SIGNIFICANT && best.as_ref().is_none_or(|best| p_value < best.p_value) {
                let shares = spread.shares_of(&rest, 1.0 / spread.counted.len() as f64);
                best = Some(Structure::new(when.to_owned(), p_value, shares));
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::super::structure::structure;
    use super::*;

    /// Eighty poses twice, in the same order; from row 95 on the second of three joints has turned by so much.
    fn laps(seed: u64, step: f64) -> Vec<Repeat> {
        let mut random = StdRng::seed_from_u64(seed);
        let lever =
            |random: &mut StdRng| (0..3).map(|_| random.random_range(-1.0..1.0)).collect::<Vec<f64>>();
        let levers: Vec<Vec<Vec<f64>>> =
            (0..80).map(|_| (0..3).map(|_| lever(&mut random)).collect()).collect();
        let mut all: Vec<Repeat> = (0..160)
            .map(|i| {
                let cell = i % 80;
                let turned = if i >= 95 { step } else { 0.0 };
                let mut noise = || (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
                let off = levers[cell][1].iter().map(|lever| noise() + turned * lever).collect();
                Repeat {
                    cell,
                    when: i as f64,
                    turned_rad: vec![0.0; 3],
                    temperature_c: None,
                    at: None,
                    off,
                    levers: levers[cell].clone(),
                    lagged: vec![],
                }
            })
            .collect();
        for cell in 0..80 {
            for c in 0..3 {
                let mean = 0.5 * (all[cell].off[c] + all[cell + 80].off[c]);
                [cell, cell + 80].into_iter().for_each(|r| all[r].off[c] -= mean);
            }
        }
        all
    }

    fn found(rows: &[Repeat]) -> Option<Structure> {
        structure(rows, 80.0, "time", &["waist", "shoulder", "elbow"].map(str::to_owned))
    }

    #[test]
    fn a_horn_that_slips_between_two_laps_is_no_noise() {
        for seed in 0..10 {
            let rows = laps(seed, 5.0);
            let structure = found(&rows).expect("three standard deviations");
            assert_eq!(structure.on, "time");
            // What it leaves is the noise alone.
            let spread: f64 = rows.iter().map(|row| row.off[0] * row.off[0]).sum();
            let noise = (spread * structure.left[0] / 80.0).sqrt();
            assert!((noise - 1.0).abs() < 0.35, "{noise}");
        }
    }

    #[test]
    fn noise_has_no_horn_that_slips() {
        let alarms = (0..200).filter(|&seed| found(&laps(1000 + seed, 0.0)).is_some()).count();
        assert_eq!(alarms, 0);
    }
}
