//! Why a target was not reached: whose limit is in the way, if any.

use super::descent::{DEMANDING, Outcome, descend};
use super::solver::{Question, Solver};
use super::target::{Answer, Options, Solution};
use crate::robot::Limits;

/// Part of the remaining error that freeing a joint must take away for the joint to be named.
const RELIEF: f64 = 0.05;
/// How far beyond its limits a joint may turn when it is asked whether a limit is in the way, rad.
const BEYOND_RAD: f64 = std::f64::consts::PI;
impl Solver {
    /// Whether a limit is in the way, and whose.
    pub(super) fn explain(
        &self,
        question: &Question,
        best: &Outcome,
        solution: Solution,
        options: &Options,
    ) -> Answer {
        let demands = question.task.demands();
        let count = self.kernel.len();
        let normal = demands.normal(&best.reading, &best.angles, count);
        let stuck = (0..count).filter_map(|i| {
            let limits = &question.limits[i];
            let (low, high) = (best.angles[i] <= limits.lower_rad, best.angles[i] >= limits.upper_rad);
            let pushed = (low && normal.right[i] < 0.0) || (high && normal.right[i] > 0.0);
            pushed.then(|| {
                let mut freed = question.limits;
                freed[i] = widened(limits);
                let relieved = descend(&self.kernel, &demands, &freed, &best.angles, DEMANDING);
                (i, relieved.remaining.cost())
            })
        });
        let most = stuck.min_by(|a, b| a.1.total_cmp(&b.1));
        let worth = |cost: f64| cost.sqrt() < (1.0 - RELIEF) * best.remaining.cost().sqrt();
        let joint = most.filter(|(_, cost)| worth(*cost)).map(|(i, _)| i);
        match joint.or_else(|| self.farthest_beyond(question, best, options)) {
            Some(i) => {
                let limits = &question.limits[i];
                let nearer_upper = best.angles[i] > limits.middle_rad();
                Answer::LimitedBy {
                    joint: self.joints[i],
                    name: self.names[i].clone(),
                    limit_rad: if nearer_upper { limits.upper_rad } else { limits.lower_rad },
                    best: solution,
                }
            }
            None => Answer::OutOfReach { by_m: solution.position_error_m, best: solution },
        }
    }

    /// When no single limit is to blame but the target is reached without any: the joint that then
    /// is farthest beyond its own.
    fn farthest_beyond(&self, question: &Question, best: &Outcome, options: &Options) -> Option<usize> {
        let demands = question.task.demands();
        let free = question.limits.map(|limits| widened(&limits));
        let starts = std::iter::once(best.angles).chain(self.promising(question, 8));
        let reached = starts
            .map(|start| descend(&self.kernel, &demands, &free, &start, DEMANDING))
            .find(|outcome| outcome.meets(options))?;
        let excess = |i: &usize| question.limits[*i].excess_rad(reached.angles[*i]).abs();
        (0..self.kernel.len()).max_by(|a, b| excess(a).total_cmp(&excess(b))).filter(|i| excess(i) > 0.0)
    }
}

fn widened(limits: &Limits) -> Limits {
    Limits { lower_rad: limits.lower_rad - BEYOND_RAD, upper_rad: limits.upper_rad + BEYOND_RAD }
}
