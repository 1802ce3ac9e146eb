//! Starts spread over the whole range of a chain, ordered by how near their tip is to a target.

use super::kernel::{Angles, Kernel, MAX_JOINTS};
use super::task::Task;
use crate::robot::Limits;

/// How many starts are kept.
const COUNT: usize = 1024;
/// A radian away from the present posture counts as much as this many meters away from the
/// target: of two equally promising starts the nearer one is taken.
const LENGTH_PER_JOINT_RAD_M: f64 = 0.02;

/// Postures with the place of their tip.
#[derive(Clone, Debug)]
pub(super) struct Seeds {
    seeds: Vec<(Angles, super::kernel::Reading)>,
}

impl Seeds {
    /// Evenly spread inside the limits, by Halton's sequence: the same ones every time.
    pub fn new(kernel: &Kernel, limits: &[Limits; MAX_JOINTS]) -> Self {
        const BASES: [u32; MAX_JOINTS] = [2, 3, 5, 7, 11, 13, 17];
        let seed = |k: u32| {
            let mut angles = [0.0; MAX_JOINTS];
            for i in 0..kernel.len() {
                // The first numbers of the larger bases are correlated: leave them out.
                angles[i] = limits[i].lower_rad + limits[i].span_rad() * halton(k + 40, BASES[i]);
            }
            (angles, kernel.read(&angles))
        };
        Self { seeds: (0..COUNT as u32).map(seed).collect() }
    }

    /// The `count` most promising ones, best first.
    pub fn promising(&self, task: &Task, present: &Angles, joints: usize, count: usize) -> Vec<Angles> {
        let mut ranks: Vec<(f64, usize)> = self
            .seeds
            .iter()
            .enumerate()
            .map(|(i, (angles, reading))| {
                let away: f64 = (0..joints).map(|j| (angles[j] - present[j]).powi(2)).sum();
                (task.remaining(reading).cost() + LENGTH_PER_JOINT_RAD_M.powi(2) * away, i)
            })
            .collect();
        let count = count.min(ranks.len());
        if count == 0 {
            return vec![];
        }
        ranks.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0));
        ranks.truncate(count);
        ranks.sort_by(|a, b| a.0.total_cmp(&b.0));
        ranks.into_iter().map(|(_, i)| self.seeds[i].0).collect()
    }
}

/// The `index`-th number of Halton's sequence, 0 to 1: the digits of `index` mirrored.
fn halton(mut index: u32, base: u32) -> f64 {
    let (mut sum, mut digit) = (0.0, 1.0);
    while index > 0 {
        digit /= f64::from(base);
        sum += digit * f64::from(index % base);
        index /= base;
    }
    sum
}
