//! How far servos lag, apart from what encoders happen to read.
//!
//! What a reading is off by stands in the lag (commanded less encoder angle) and in the prediction that starts
//! from the encoder: rows would prefer the command to the encoder just because encoders are noisy. So the lag
//! that effects see is its expectation without the row's own reading (regression calibration; Carroll,
//! Ruppert, Stefanski and Crainiceanu 2006, chapter 4): what follows from direction, torque and angle,
//! and as much of what the other repeats of its cell say beyond that as stands out of their spread. Where repeats spread
//! further than readings of any encoder do, servos do stop here and there, and the row's own reading counts for all of
//! it but the noise of a reading.

use std::collections::BTreeMap;

use nalgebra::{Cholesky, DMatrix, DVector, Vector3};

use super::{Apparatus, Observation};
use crate::library::Situation;

/// What a servo's lag may follow: nothing, direction, torque, angle, and angle by direction.
const COLUMNS: usize = 5;
/// All of them; the place of the torque among them; and what a lag is held against to tell what goes with the load, which
/// stands last.
const ALL: [usize; COLUMNS] = [0, 1, 2, 3, 4];
const OF_TORQUE: usize = 2;
const BESIDE_LOAD: [usize; 4] = [0, 1, 4, OF_TORQUE];
/// Fewer rows for each column follow nothing.
const ROWS_PER_COLUMN: usize = 8;
/// Readings of an encoder of 4096 steps (1.5 mrad) spread by so much, rad, and at most by so much.
const USUAL_NOISE_RAD: f64 = 0.6e-3;
const MOST_NOISE_RAD: f64 = 1.5e-3;
/// Degrees of freedom that tell a spread, and a standard deviation over the median distance.
const FEWEST_FREE: usize = 20;
const NORMAL: f64 = 1.4826;
/// Keeps columns that do not vary from being solved for.
const RIDGE: f64 = 1e-6;

/// A row of a cell with repeats.
struct Lag {
    row: usize,
    cell: usize,
    follows: [f64; COLUMNS],
    lag_rad: f64,
}

/// Sum and number of a cell's lags.
type Cells = BTreeMap<usize, (f64, f64)>;

/// Fills in the usual lag of every row that has repeats, and what of it goes with the load.
pub(super) fn complete(rows: &mut [Observation], apparatuses: &[Apparatus]) {
    rows.iter_mut().for_each(|row| {
        (row.usual_lag_rad, row.given_way_rad, row.has_own_lag) = (None, None, false);
    });
    for (session, apparatus) in apparatuses.iter().enumerate() {
        let Some(arm) = &apparatus.arm else { continue };
        let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
        let has_lag = |row: &Observation| row.session == session && row.lag_rad().is_some();
        rows.iter().filter(|row| has_lag(row)).for_each(|row| *counts.entry(row.cell).or_default() += 1);
        let repeated: Vec<usize> =
            (0..rows.len()).filter(|&i| has_lag(&rows[i]) && counts[&rows[i].cell] > 1).collect();
        let torques_nm: Vec<Vec<f64>> = repeated
            .iter()
            .map(|&i| {
                let (row, up) = (&rows[i], Vector3::z());
                let at = Situation::new(arm, row.angles_rad(), &row.direction, row.payload_kg, &up);
                at.during(row).torques_nm().to_vec()
            })
            .collect();
        for j in 0..arm.len() {
            let lags: Vec<Lag> = repeated
                .iter()
                .zip(&torques_nm)
                .filter_map(|(&i, torques_nm)| {
                    let row = &rows[i];
                    let direction = row.direction.get(j).copied().unwrap_or_default();
                    let angle_rad = *row.commanded_rad.as_ref()?.get(j)?;
                    let follows = [1.0, direction, torques_nm[j], angle_rad, direction * angle_rad];
                    Some(Lag { row: i, cell: row.cell, follows, lag_rad: *row.lag_rad()?.get(j)? })
                })
                .collect();
            let by_load = by_load(&lags);
            let differs = differs(&lags);
            for (i, lag_rad) in usual(&lags, differs) {
                rows[i].usual_lag_rad.get_or_insert_with(|| vec![0.0; arm.len()])[j] = lag_rad;
                rows[i].has_own_lag |= differs > 0.0;
            }
            for lag in &lags {
                let given_way = rows[lag.row].given_way_rad.get_or_insert_with(|| vec![0.0; arm.len()]);
                given_way[j] = by_load * lag.follows[OF_TORQUE];
            }
        }
    }
}

/// How much of what a row lags beyond the others of its cell is there, 0–1. No reading is off so far that repeats spread by
/// more than a step or so: what does lags differently indeed. By the median, since one reading may be far off.
fn differs(lags: &[Lag]) -> f64 {
    let mut cells = BTreeMap::<usize, Vec<f64>>::new();
    lags.iter().for_each(|lag| cells.entry(lag.cell).or_default().push(lag.lag_rad));
    cells.retain(|_, own| own.len() > 1);
    let mut off: Vec<f64> = cells
        .values()
        .flat_map(|own| {
            let count = own.len() as f64;
            let mean = own.iter().sum::<f64>() / count;
            own.iter().map(move |lag_rad| (lag_rad - mean).abs() * (count / (count - 1.0)).sqrt())
        })
        .collect();
    if off.len() < cells.len() + FEWEST_FREE {
        return 0.0;
    }
    off.sort_by(f64::total_cmp);
    let spread_rad = NORMAL * off[off.len() / 2];
    if spread_rad > MOST_NOISE_RAD { 1.0 - (USUAL_NOISE_RAD / spread_rad).powi(2) } else { 0.0 }
}

/// The expected lag of each row of one joint; `differs`: how much its own reading says.
fn usual(lags: &[Lag], differs: f64) -> Vec<(usize, f64)> {
    let fit = fit(lags, if is_few(lags) { &ALL[..1] } else { &ALL });
    let of_fit =
        |lag: &Lag| ALL.iter().zip(&fit).map(|(&column, fit)| lag.follows[column] * fit).sum::<f64>();
    let follows: Vec<f64> = lags.iter().map(of_fit).collect();
    let mut cells: Cells = BTreeMap::new();
    for (lag, follows) in lags.iter().zip(&follows) {
        let (sum, count) = cells.entry(lag.cell).or_default();
        *sum += lag.lag_rad - follows;
        *count += 1.0;
    }
    // Spread of readings about the means of cells, and of these means about what the lag follows.
    let mut within = 0.0;
    for (lag, follows) in lags.iter().zip(&follows) {
        let (sum, count) = cells[&lag.cell];
        within += (lag.lag_rad - follows - sum / count).powi(2);
    }
    let free = (lags.len() as f64 - cells.len() as f64).max(1.0);
    let noise = within / free;
    let count = cells.len().max(1) as f64;
    let between = cells.values().map(|(sum, count)| (sum / count).powi(2)).sum::<f64>() / count;
    let of_noise = cells.values().map(|(_, count)| noise / count).sum::<f64>() / count;
    let own = (between - of_noise).max(0.0);
    let expected = |(lag, follows): (&Lag, &f64)| {
        let (sum, count) = cells[&lag.cell];
        let of_others = (sum - (lag.lag_rad - follows)) / (count - 1.0);
        let told = own / (own + noise / (count - 1.0)).max(f64::MIN_POSITIVE);
        let expected = told * of_others;
        (lag.row, follows + expected + differs * (lag.lag_rad - follows - expected))
    };
    lags.iter().zip(&follows).map(expected).collect()
}

fn is_few(lags: &[Lag]) -> bool {
    lags.len() < ROWS_PER_COLUMN * COLUMNS
}

/// How the lag follows some of what it may, by least squares: one number per column.
fn fit(lags: &[Lag], columns: &[usize]) -> Vec<f64> {
    let design = DMatrix::from_fn(lags.len(), columns.len(), |r, c| lags[r].follows[columns[c]]);
    let values = DVector::from_iterator(lags.len(), lags.iter().map(|lag| lag.lag_rad));
    let normal = design.tr_mul(&design) + DMatrix::identity(columns.len(), columns.len()) * RIDGE;
    let fit = Cholesky::new(normal).map(|normal| normal.solve(&design.tr_mul(&values)));
    fit.map_or_else(|| vec![0.0; columns.len()], |fit| fit.iter().copied().collect())
}

/// Lag per torque, rad/N m; nothing where rows are few. Nothing of a servo goes with the angle alone, and the angle goes with
/// the torque, so it has no part in this. A servo gives way to where its load pulls, so that its command is ahead on the
/// other side; what goes the other way is something else.
fn by_load(lags: &[Lag]) -> f64 {
    let known = (!is_few(lags)).then(|| fit(lags, &BESIDE_LOAD));
    known.and_then(|fit| fit.last().copied()).unwrap_or_default().min(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sixty cells of three rows; each cell lags by an own amount beside what follows the direction.
    fn lags(own_rad: f64, noise_rad: f64, seed: u64) -> (Vec<Lag>, Vec<f64>, Vec<f64>) {
        // Knuth's linear congruential generator; even numbers of spread one.
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1;
        let mut even = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            1.732 * (2.0 * (state >> 11) as f64 / (1_u64 << 53) as f64 - 1.0)
        };
        let (mut lags, mut truth, mut noise) = (vec![], vec![], vec![]);
        for cell in 0..60 {
            let direction = if cell % 2 == 0 { 1.0 } else { -1.0 };
            let (angle, torque, own) = (even(), even(), own_rad * even());
            for _ in 0..3 {
                let lag = 0.01 * direction + own;
                let off = noise_rad * even();
                let follows = [1.0, direction, torque, angle, angle * direction];
                lags.push(Lag { row: lags.len(), cell, follows, lag_rad: lag + off });
                truth.push(lag);
                noise.push(off);
            }
        }
        (lags, truth, noise)
    }

    #[test]
    fn the_usual_lag_knows_nothing_of_the_rows_own_reading_and_is_near_the_truth() {
        for (own_rad, noise_rad) in [(0.0, 1e-3), (2e-3, 1e-3), (4e-3, 1e-3)] {
            let (mut alike, mut off, mut of_mean) = (0.0, 0.0, 0.0);
            for seed in 0..40 {
                let (lags, truth, noise) = lags(own_rad, noise_rad, seed);
                for (i, lag_rad) in usual(&lags, differs(&lags)) {
                    alike += (lag_rad - truth[i]) * noise[i];
                    off += (lag_rad - truth[i]).powi(2);
                    of_mean += noise_rad * noise_rad / 2.0;
                }
            }
            let count = 40.0 * 180.0;
            assert!((alike / count / (noise_rad * noise_rad)).abs() < 0.06, "{own_rad} {noise_rad} {alike}");
            // No worse than the mean of the two others.
            assert!(off < 1.05 * of_mean, "{own_rad} {noise_rad}: {off} {of_mean}");
        }
    }

    #[test]
    fn servos_that_stop_here_and_there_lag_as_they_are_read() {
        // Three milliradians within a cell are no noise of a reading: nearly all of it is there.
        let (lags, truth, off) = lags(2e-3, 3e-3, 1);
        for (i, lag_rad) in usual(&lags, differs(&lags)) {
            assert!(
                (lag_rad - truth[i] - off[i]).abs() < 0.1 * off[i].abs() + 4e-4,
                "{lag_rad} {}",
                truth[i] + off[i]
            );
        }
    }

    #[test]
    fn a_reading_that_is_far_off_says_nothing_of_the_others() {
        let (mut lags, ..) = lags(2e-3, 1e-3, 2);
        lags[40].lag_rad += 0.1;
        assert_eq!(differs(&lags), 0.0);
        lags.truncate(12);
        assert_eq!(differs(&lags), 0.0, "few rows tell nothing");
    }

    #[test]
    fn what_a_servo_gives_way_by_is_told_from_the_way_that_was_left() {
        for compliance in [0.0, 0.03] {
            let (mut lags, ..) = lags(1e-3, 1e-3, 3);
            // The command is ahead to the other side than the load pulls.
            lags.iter_mut().for_each(|lag| lag.lag_rad -= compliance * lag.follows[OF_TORQUE]);
            assert!((by_load(&lags) + compliance).abs() < 1e-3, "{}", by_load(&lags));
        }
        let (mut lags, ..) = lags(1e-3, 1e-3, 3);
        lags.iter_mut().for_each(|lag| lag.lag_rad += 0.03 * lag.follows[OF_TORQUE]);
        assert_eq!(by_load(&lags), 0.0, "nothing gives way against its load");
        lags.truncate(20);
        assert_eq!(by_load(&lags), 0.0, "few rows tell nothing");
    }
}
