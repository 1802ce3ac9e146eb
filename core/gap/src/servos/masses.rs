//! All joints at once, with masses that are not quite those of the description.
//!
//! lag = k + s · direction + c · Σ (1 + μ) τ: offset, friction and compliance of every joint, and one μ per
//! link for all joints. Where a weight is known, or several joints give way, the rows tell masses from
//! compliances; where they do not, the doubt about masses stands in the intervals of what gives way.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::cells::Cell;
use super::lag::{Lag, Slope};
use crate::beforehand::MASS_SD;

/// Steps of Gauss and Newton: compliance times mass is not linear.
const ROUNDS: usize = 12;
/// A step smaller than this ends them.
const STILL: f64 = 1e-7;
/// What an offset, a friction and a compliance can be beforehand: nothing is ruled out, rad and rad/N m.
const WIDE: f64 = 1.0;

/// What a fit of all joints says.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    /// Compliance of each joint that was fitted, rad/N m.
    pub gives: Vec<Option<Slope>>,
    /// Friction of each, full width, rad.
    pub sticks: Vec<Option<Slope>>,
    /// Mass of each link over that of the description, less one.
    pub masses: Vec<Slope>,
}

/// Where the parameters of a joint stand among all.
#[derive(Clone, Copy)]
struct Place {
    first: usize,
    gives: Option<usize>,
    sticks: Option<usize>,
}

/// The fit, starting from what each joint says alone; `None` where no joint can be fitted.
pub(super) fn fit(cells: &[Cell], alone: &[Option<Lag>]) -> Option<Fit> {
    let links = cells.first().and_then(|cell| cell.of_links_nm.first()).map_or(0, Vec::len);
    let mut count = links;
    let mut next = || {
        count += 1;
        count - 1
    };
    let places: Vec<Option<Place>> = alone
        .iter()
        .map(|lag| {
            let lag = lag.as_ref()?;
            let first = next();
            Some(Place { first, gives: lag.gives.map(|_| next()), sticks: lag.sticks.map(|_| next()) })
        })
        .collect();
    if count == links {
        return None;
    }
    let mut at = DVector::zeros(count);
    for (place, lag) in places.iter().zip(alone) {
        let (Some(place), Some(lag)) = (place, lag) else { continue };
        at[place.first] = lag.offset_rad;
        place.gives.into_iter().zip(lag.gives).for_each(|(k, slope)| at[k] = slope.value);
        place.sticks.into_iter().zip(lag.sticks).for_each(|(k, slope)| at[k] = slope.value);
    }
    let prior = DVector::from_fn(count, |k, _| if k < links { MASS_SD.powi(-2) } else { WIDE.powi(-2) });
    let mut inverse = DMatrix::zeros(0, 0);
    for _ in 0..ROUNDS {
        let (mut normal, mut right) = (DMatrix::from_diagonal(&prior), -prior.component_mul(&at));
        for (j, (place, lag)) in places.iter().zip(alone).enumerate() {
            let (Some(place), Some(lag)) = (place, lag) else { continue };
            for &cell in &lag.used {
                let (slope, left) = line(&cells[cell], j, *place, &at, links);
                let weight = lag.sd_rad.powi(-2);
                for &(r, a) in &slope {
                    right[r] += weight * a * left;
                    for &(c, b) in &slope {
                        normal[(r, c)] += weight * a * b;
                    }
                }
            }
        }
        let cholesky = Cholesky::new(normal)?;
        let step = cholesky.solve(&right);
        at += &step;
        inverse = cholesky.inverse();
        if step.amax() < STILL {
            break;
        }
    }
    let slope = |k: usize| Slope { value: at[k], sd: inverse[(k, k)].max(0.0).sqrt() };
    Some(Fit {
        gives: places.iter().map(|place| place.and_then(|place| place.gives).map(slope)).collect(),
        sticks: places.iter().map(|place| place.and_then(|place| place.sticks).map(slope)).collect(),
        masses: (0..links).map(slope).collect(),
    })
}

/// Slopes of what a joint lags by in a cell, by parameter, and what the parameters leave of it.
fn line(cell: &Cell, j: usize, place: Place, at: &DVector<f64>, links: usize) -> (Vec<(usize, f64)>, f64) {
    let mut slope = vec![(place.first, 1.0)];
    let mut left = cell.lag_rad[j] - at[place.first];
    if let Some(k) = place.sticks {
        slope.push((k, cell.back[j]));
        left -= at[k] * cell.back[j];
    }
    if let Some(k) = place.gives {
        let more: f64 = (0..links).map(|l| at[l] * cell.of_links_nm[j][l]).sum();
        let torque_nm = cell.torque_nm[j] + more;
        slope.push((k, torque_nm));
        slope.extend((0..links).map(|l| (l, at[k] * cell.of_links_nm[j][l])));
        left -= at[k] * torque_nm;
    }
    (slope, left)
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{Rng, SeedableRng};

    use super::super::lag::lag;
    use super::*;

    /// Two joints and two links, whose masses are off by these shares; a known weight hangs on every other
    /// cell.
    fn cells(gives: [f64; 2], masses: [f64; 2], weight: bool, seed: u64) -> Vec<Cell> {
        let mut random = StdRng::seed_from_u64(seed);
        (0..120)
            .map(|i| {
                let of_links_nm: Vec<Vec<f64>> = vec![
                    vec![random.random_range(0.3..1.0), random.random_range(0.2..1.2)],
                    vec![0.0, random.random_range(0.1..0.8)],
                ];
                let held_nm = if weight && i % 2 == 0 { [0.9, 0.5] } else { [0.0; 2] };
                let back = if i % 4 < 2 { -0.5 } else { 0.5 };
                let torque = |j: usize, factor: &dyn Fn(usize) -> f64| -> f64 {
                    held_nm[j] + (0..2).map(|l| factor(l) * of_links_nm[j][l]).sum::<f64>()
                };
                let lag_rad = (0..2)
                    .map(|j| {
                        let noise = 5e-4 * random.random_range(-1.7..1.7);
                        0.002 + 0.004 * back + gives[j] * torque(j, &|l| 1.0 + masses[l]) + noise
                    })
                    .collect();
                let torque_nm = (0..2).map(|j| torque(j, &|_| 1.0)).collect();
                Cell { lag_rad, back: vec![back; 2], torque_nm, of_links_nm }
            })
            .collect()
    }

    fn fitted(cells: &[Cell]) -> Fit {
        let alone: Vec<Option<Lag>> = (0..2).map(|j| lag(cells, j, true)).collect();
        fit(cells, &alone).expect("two joints")
    }

    #[test]
    fn a_known_weight_tells_masses_from_compliances() {
        for seed in 0..20 {
            let fit = fitted(&cells([0.03, 0.02], [0.3, -0.2], true, seed));
            for (found, truth) in fit.gives.iter().flatten().zip([0.03, 0.02]) {
                assert!((found.value - truth).abs() < 4.0 * found.sd && found.sd < 0.1 * truth, "{found:?}");
            }
            for (found, truth) in fit.masses.iter().zip([0.3, -0.2]) {
                assert!((found.value - truth).abs() < 4.0 * found.sd && found.sd < 0.05, "{found:?}");
            }
        }
    }

    #[test]
    fn without_a_weight_the_doubt_about_masses_stands_in_the_interval() {
        let mut inside = 0;
        let mut random = StdRng::seed_from_u64(3);
        for seed in 0..100 {
            // As a description may be off.
            let masses = [0.0; 2].map(|_: f64| MASS_SD * random.random_range(-1.73..1.73));
            let fit = fitted(&cells([0.03, 0.02], masses, false, 100 + seed));
            let found = fit.gives[0].expect("fitted");
            assert!(found.sd > 0.04 * 0.03, "{found:?}");
            inside += usize::from((found.value - 0.03).abs() < 1.96 * found.sd);
        }
        assert!(inside >= 90, "{inside} of 100");
    }

    #[test]
    fn masses_as_described_stay() {
        let fit = fitted(&cells([0.03, 0.02], [0.0; 2], true, 7));
        assert!(fit.masses.iter().all(|mass| mass.value.abs() < 4.0 * mass.sd), "{:?}", fit.masses);
    }
}
