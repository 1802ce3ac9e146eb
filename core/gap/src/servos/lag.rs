//! What one joint lags by, regressed on torque and direction.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::cells::Cell;
use crate::compare::robust_sd;

/// Fewer cells than this say nothing.
pub(super) const FEWEST_CELLS: usize = 12;
/// Cells further off than this many robust standard deviations do not count.
const FAR: f64 = 5.0;
/// Rounds of leaving out what is far off.
const ROUNDS: usize = 8;

/// A slope with its standard deviation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    pub value: f64,
    pub sd: f64,
}

/// A joint by itself.
#[derive(Clone, Debug)]
pub(super) struct Lag {
    /// Where torque and direction are nothing, rad.
    pub offset_rad: f64,
    /// By torque, rad/N m; `None` where the torque does not vary.
    pub gives: Option<Slope>,
    /// By direction, full width, rad; `None` from one side.
    pub sticks: Option<Slope>,
    /// By torque, had it no offset.
    pub in_proportion: Slope,
    /// Of encoder less command, root mean square, rad.
    pub rms_rad: f64,
    /// What is left of it, one standard deviation, rad.
    pub sd_rad: f64,
    /// How far masses that are each off by a share, independently, change the torque: as a share of it, per
    /// share.
    pub mass_share: f64,
    /// Cells that are not far off.
    pub used: Vec<usize>,
}

/// A joint's lag by torque and, where rows come from both sides, direction.
pub(super) fn lag(cells: &[Cell], j: usize, sided: bool) -> Option<Lag> {
    let value = |cell: usize, k: usize| match k {
        0 => 1.0,
        1 => cells[cell].torque_nm[j],
        _ => cells[cell].back[j],
    };
    let mut used: Vec<usize> = (0..cells.len()).collect();
    for round in 1..=ROUNDS {
        if used.len() < FEWEST_CELLS {
            return None;
        }
        let varies = robust_sd(used.iter().map(|&cell| value(cell, 1))) > 1e-6;
        // Directions are two, so their spread about the median may be nothing.
        let columns: Vec<usize> =
            [Some(0), varies.then_some(1), sided.then_some(2)].into_iter().flatten().collect();
        let design = DMatrix::from_fn(used.len(), columns.len(), |r, c| value(used[r], columns[c]));
        let lags = DVector::from_iterator(used.len(), used.iter().map(|&cell| cells[cell].lag_rad[j]));
        let inverse = Cholesky::new(design.tr_mul(&design))?.inverse();
        let fit = &inverse * design.tr_mul(&lags);
        let left = &lags - &design * &fit;
        let spread = robust_sd(left.iter().copied());
        let inside: Vec<usize> = used
            .iter()
            .zip(left.iter())
            .filter(|(_, left)| left.abs() <= FAR * spread)
            .map(|(cell, _)| *cell)
            .collect();
        if inside.len() == used.len() || spread == 0.0 || round == ROUNDS {
            let variance = left.norm_squared() / (used.len() - columns.len()) as f64;
            let slope = |k: usize| {
                let place = columns.iter().position(|column| *column == k)?;
                Some(Slope { value: fit[place], sd: (variance * inverse[(place, place)]).sqrt() })
            };
            return Some(Lag {
                offset_rad: fit[0],
                gives: slope(1),
                sticks: slope(2),
                in_proportion: in_proportion(cells, &used, j),
                rms_rad: (lags.norm_squared() / used.len() as f64).sqrt(),
                sd_rad: variance.sqrt().max(1e-6),
                mass_share: mass_share(cells, &used, j),
                used,
            });
        }
        used = inside;
    }
    None
}

/// Slope by torque of cells whose lag is nothing without a load.
fn in_proportion(cells: &[Cell], used: &[usize], j: usize) -> Slope {
    let sum = |of: &dyn Fn(&Cell) -> f64| used.iter().map(|&cell| of(&cells[cell])).sum::<f64>();
    let torques = sum(&|cell| cell.torque_nm[j].powi(2)).max(1e-12);
    let value = sum(&|cell| cell.lag_rad[j] * cell.torque_nm[j]) / torques;
    let left = sum(&|cell| (cell.lag_rad[j] - value * cell.torque_nm[j]).powi(2));
    Slope { value, sd: (left / (used.len() as f64 - 1.0).max(1.0) / torques).sqrt() }
}

/// Root of the sum of squares of what each link has of the torque.
fn mass_share(cells: &[Cell], used: &[usize], j: usize) -> f64 {
    let links = cells.first().and_then(|cell| cell.of_links_nm.get(j)).map_or(0, Vec::len);
    let square = used.iter().map(|&cell| cells[cell].torque_nm[j].powi(2)).sum::<f64>().max(1e-12);
    let part = |l: usize| {
        let along = used.iter().map(|&cell| cells[cell].torque_nm[j] * cells[cell].of_links_nm[j][l]);
        along.sum::<f64>() / square
    };
    (0..links).map(|l| part(l).powi(2)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::*;

    /// A slope counts from so many standard deviations on.
    const SURE: f64 = 8.0;

    /// Cells from both sides with a servo that gives way (rad/N m) and sticks (rad).
    fn cells(gives: f64, sticks: f64, seed: u64) -> Vec<Cell> {
        let mut random = StdRng::seed_from_u64(seed);
        (0..80)
            .map(|i| {
                let torque = random.random_range(-0.5..1.5);
                let back = if i % 2 == 0 { -0.5 } else { 0.5 };
                let noise = 1e-3 * random.random_range(-1.7..1.7);
                Cell {
                    lag_rad: vec![gives * torque + sticks * back + 0.002 + noise],
                    back: vec![back],
                    torque_nm: vec![torque],
                    of_links_nm: vec![],
                }
            })
            .collect()
    }

    fn both(cells: &[Cell]) -> (Slope, Slope) {
        let lag = lag(cells, 0, true).expect("enough cells");
        (lag.gives.expect("torques differ"), lag.sticks.expect("both sides"))
    }

    #[test]
    fn what_gives_way_and_what_sticks_are_told_apart() {
        for seed in 0..10 {
            let (gives, sticks) = both(&cells(0.03, 0.01, seed));
            assert!((gives.value - 0.03).abs() < 4.0 * gives.sd, "{gives:?}");
            assert!((sticks.value - 0.01).abs() < 4.0 * sticks.sd, "{sticks:?}");
            assert!(gives.value > SURE * gives.sd && sticks.value > SURE * sticks.sd);
        }
    }

    #[test]
    fn a_servo_that_holds_has_no_slope() {
        let sure = |slope: Slope| slope.value.abs() > SURE * slope.sd;
        let alarms = (0..200).map(|seed| both(&cells(0.0, 0.0, 500 + seed)));
        assert_eq!(alarms.filter(|(gives, sticks)| sure(*gives) || sure(*sticks)).count(), 0);
    }

    #[test]
    fn cells_that_are_far_off_do_not_hide_the_rest() {
        // One far cell after the other comes out from behind the next.
        let mut cells = cells(0.03, 0.01, 4);
        for (k, cell) in cells.iter_mut().step_by(8).enumerate() {
            cell.lag_rad[0] += 0.03 * 3.0_f64.powi(k as i32);
        }
        let (gives, sticks) = both(&cells);
        assert!((gives.value - 0.03).abs() < 4.0 * gives.sd, "{gives:?}");
        assert!((sticks.value - 0.01).abs() < 4.0 * sticks.sd, "{sticks:?}");
    }

    #[test]
    fn from_one_side_friction_is_not_looked_for() {
        assert!(lag(&cells(0.03, 0.01, 3), 0, false).expect("enough cells").sticks.is_none());
    }
}
