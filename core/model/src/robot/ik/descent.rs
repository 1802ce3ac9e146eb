//! Damped least squares inside limits, from one start.

use super::kernel::{Angles, Kernel, MAX_JOINTS, Reading};
use super::target::Options;
use super::task::{Normal, Remaining, Task};
use crate::robot::Limits;

/// Precision that a descent aims at (well below any tolerance, reached by quadratic
/// convergence in one more step).
const GOAL_M: f64 = 1e-9;
const GOAL_RAD: f64 = 1e-8;
/// Largest turn of a joint in one step, rad: farther, the linear picture is void.
const LARGEST_STEP_RAD: f64 = 1.0;
/// Damping relative to the cost: first value, and the smallest damping at all.
const FIRST_DAMPING: f64 = 0.3;
const LEAST_DAMPING: f64 = 1e-11;
/// Damping above which no step helps.
const LARGEST_DAMPING: f64 = 1e9;

/// When a descent ends short of its goal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patience {
    /// Steps.
    pub iterations: u32,
    /// Relative gain of a step below which it counts as idle; two in a row end the descent.
    pub least_gain: f64,
}

/// For what is demanded: until it is met or clearly will not be.
pub(super) const DEMANDING: Patience = Patience { iterations: 40, least_gain: 0.02 };
/// For wishes: roughly.
pub(super) const WISHFUL: Patience = Patience { iterations: 20, least_gain: 1e-3 };

/// Where a descent ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outcome {
    pub angles: Angles,
    pub reading: Reading,
    pub remaining: Remaining,
    pub iterations: u32,
}

impl Outcome {
    /// Whether the demands are met within the tolerances.
    pub fn meets(&self, options: &Options) -> bool {
        self.remaining.within(options.position_tolerance_m, options.orientation_tolerance_rad)
    }
}

/// From `start`, which must lie inside the limits, down to a place where no small step inside
/// the limits comes nearer. `limits` has one entry per joint.
pub(super) fn descend(
    kernel: &Kernel,
    task: &Task,
    limits: &[Limits; MAX_JOINTS],
    start: &Angles,
    patience: Patience,
) -> Outcome {
    let count = kernel.len();
    let mut angles = *start;
    let mut reading = kernel.read(&angles);
    let mut cost = task.cost(&reading, &angles, count);
    let mut damping = FIRST_DAMPING;
    let mut idle = 0;
    let mut iterations = 0;
    let wishes = task.has_wishes();
    'steps: while iterations < patience.iterations && idle < 2 {
        if !wishes && task.remaining(&reading).within(GOAL_M, GOAL_RAD) {
            break;
        }
        let normal = task.normal(&reading, &angles, count);
        loop {
            iterations += 1;
            let step = bounded_step(&normal, damping * cost + LEAST_DAMPING, &angles, limits, count);
            let largest = step.iter().fold(0.0, |largest: f64, s| largest.max(s.abs()));
            if largest < 1e-13 {
                break 'steps;
            }
            let scale = (LARGEST_STEP_RAD / largest).min(1.0);
            let mut there = angles;
            for i in 0..count {
                // Rounding may carry the sum past the limit that the step was cut to.
                there[i] = (angles[i] + scale * step[i]).clamp(limits[i].lower_rad, limits[i].upper_rad);
            }
            let reading_there = kernel.read(&there);
            let cost_there = task.cost(&reading_there, &there, count);
            if cost_there < cost {
                idle = if cost_there > cost * (1.0 - patience.least_gain) { idle + 1 } else { 0 };
                (angles, reading, cost) = (there, reading_there, cost_there);
                damping = (damping * 0.2).max(1e-6);
                break;
            }
            damping *= 6.0;
            if damping > LARGEST_DAMPING || iterations >= patience.iterations {
                break 'steps;
            }
        }
    }
    let remaining = task.remaining(&reading);
    Outcome { angles, reading, remaining, iterations }
}

/// Solves (matrix + damping · 1) step = right with every joint inside its limits: joints that
/// would leave are set onto their limit and the others are solved again.
fn bounded_step(
    normal: &Normal,
    damping: f64,
    angles: &Angles,
    limits: &[Limits; MAX_JOINTS],
    count: usize,
) -> Angles {
    let mut step = [0.0; MAX_JOINTS];
    let mut free = [false; MAX_JOINTS];
    free[..count].fill(true);
    for _ in 0..=count {
        solve_free(normal, damping, &free, &mut step, count);
        let mut left = false;
        for i in 0..count {
            let wanted = angles[i] + step[i];
            if free[i] && !limits[i].contain(wanted) {
                step[i] = wanted.clamp(limits[i].lower_rad, limits[i].upper_rad) - angles[i];
                free[i] = false;
                left = true;
            }
        }
        if !left {
            break;
        }
    }
    step
}

/// Cholesky on the rows and columns of the free joints; the others keep their step.
fn solve_free(normal: &Normal, damping: f64, free: &[bool; MAX_JOINTS], step: &mut Angles, count: usize) {
    let mut index = [0; MAX_JOINTS];
    let mut size = 0;
    for i in (0..count).filter(|i| free[*i]) {
        index[size] = i;
        size += 1;
    }
    let mut factor = [[0.0; MAX_JOINTS]; MAX_JOINTS];
    let mut solved = [0.0; MAX_JOINTS];
    for a in 0..size {
        let row = &normal.matrix[index[a]];
        for b in 0..a {
            let product: f64 = (0..b).map(|k| factor[a][k] * factor[b][k]).sum();
            factor[a][b] = (row[index[b]] - product) / factor[b][b];
        }
        let product: f64 = (0..a).map(|k| factor[a][k] * factor[a][k]).sum();
        // The matrix has no negative eigenvalues; rounding may leave less than the damping.
        factor[a][a] = (row[index[a]] + damping - product).max(0.5 * damping).sqrt();
        let held: f64 = (0..count).filter(|j| !free[*j]).map(|j| row[j] * step[j]).sum();
        let known: f64 = (0..a).map(|k| factor[a][k] * solved[k]).sum();
        solved[a] = (normal.right[index[a]] - held - known) / factor[a][a];
    }
    for a in (0..size).rev() {
        let known: f64 = (a + 1..size).map(|k| factor[k][a] * solved[k]).sum();
        solved[a] = (solved[a] - known) / factor[a][a];
        step[index[a]] = solved[a];
    }
}
