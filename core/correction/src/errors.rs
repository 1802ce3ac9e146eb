//! How far answers are from what was sent: numbers with intervals.

use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};
use serde::{Deserialize, Serialize};

use crate::blocks::Blocks;

/// Draws of the bootstrap.
const DRAWS: usize = 1000;

/// Errors over a set of touches. A residual is predicted − sent, m.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Number of touches.
    pub count: usize,
    /// Mean distance in the plane, m.
    pub mean_2d_m: f64,
    /// Root of the mean squared distance in the plane, m.
    pub rms_2d_m: f64,
    /// Root of the mean squared error of the height, m.
    pub rms_z_m: f64,
}

impl Errors {
    /// Of these residuals; `None` when there is none.
    pub fn of(residuals_m: &[[f64; 3]]) -> Option<Self> {
        if residuals_m.is_empty() {
            return None;
        }
        let count = residuals_m.len() as f64;
        let distances = residuals_m.iter().map(distance_2d_m);
        Some(Self {
            count: residuals_m.len(),
            mean_2d_m: distances.clone().sum::<f64>() / count,
            rms_2d_m: (distances.map(|distance| distance * distance).sum::<f64>() / count).sqrt(),
            rms_z_m: (residuals_m.iter().map(|residual| residual[2].powi(2)).sum::<f64>() / count).sqrt(),
        })
    }
}

/// Length of a residual in the plane, m.
pub fn distance_2d_m(residual_m: &[f64; 3]) -> f64 {
    residual_m[0].hypot(residual_m[1])
}

/// 95 % interval of the mean of one value per touch, from drawing whole blocks with replacement
/// (block bootstrap, percentiles).
pub(crate) fn interval_95(values: &[f64], blocks: &Blocks, seed: u64) -> [f64; 2] {
    let mut sums = vec![(0.0, 0.0); blocks.len()];
    for (value, block) in values.iter().zip(&blocks.of_touch) {
        sums[*block].0 += value;
        sums[*block].1 += 1.0;
    }
    let mut random = StdRng::seed_from_u64(seed);
    let mut means: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let drawn = (0..sums.len()).map(|_| sums[random.random_range(0..sums.len())]);
            let (sum, count) = drawn.fold((0.0, 0.0), |all, one| (all.0 + one.0, all.1 + one.1));
            sum / count
        })
        .collect();
    means.sort_by(f64::total_cmp);
    let at = |part: f64| means[((means.len() - 1) as f64 * part).round() as usize];
    [at(0.025), at(0.975)]
}
