//! Solves a target from the present posture, then from other starts, and says what is in the way.

use super::descent::{DEMANDING, Outcome, WISHFUL, descend};
use super::kernel::{Angles, Kernel, MAX_JOINTS};
use super::seeds::Seeds;
use super::target::{Answer, ChainAngles, IkError, Options, Solution, Target};
use super::task::Task;
use crate::robot::{Chain, DescriptionError, JointIndex, Limits, Posture, Rig};

/// Two solutions are different ones when a joint differs by more, rad.
const DISTINCT_RAD: f64 = 0.05;

/// Inverse kinematics of one chain. Made once, used for many targets.
#[derive(Clone, Debug)]
pub struct Solver {
    tip: String,
    pub(super) joints: Vec<JointIndex>,
    pub(super) names: Vec<String>,
    pub(super) kernel: Kernel,
    limits: [Limits; MAX_JOINTS],
    seeds: Seeds,
}

/// A checked question.
pub(super) struct Question {
    pub task: Task,
    pub limits: [Limits; MAX_JOINTS],
    pub start: Angles,
}

impl Solver {
    /// For a chain inside the given limits, one per joint.
    ///
    /// # Errors
    /// When the chain has no joint or more than seven, or when the limits do not fit to it.
    pub fn new(chain: &Chain, limits: &[Limits]) -> Result<Self, IkError> {
        let kernel = Kernel::new(chain)
            .ok_or_else(|| IkError::Joints { tip: chain.tip().to_owned(), joints: chain.len() })?;
        let own = checked_limits(limits, None, chain.names())?;
        let seeds = Seeds::new(&kernel, &own);
        Ok(Self {
            tip: chain.tip().to_owned(),
            joints: chain.joints().to_vec(),
            names: chain.names().to_vec(),
            kernel,
            limits: own,
            seeds,
        })
    }

    /// For a tip of a rig, inside the limits of joints and servos. Limits that depend on other
    /// joints are the matter of [`crate::robot::collision`].
    ///
    /// # Errors
    /// When there is no such tip, or when its chain cannot be solved.
    pub fn of_rig(rig: &Rig, tip: &str) -> Result<Self, SolverError> {
        let chain = rig.chain(tip)?;
        let limits: Vec<Limits> = chain.joints().iter().map(|joint| rig.limits(*joint)).collect();
        Ok(Self::new(&chain, &limits)?)
    }

    /// Name of the tip.
    pub fn tip(&self) -> &str {
        &self.tip
    }

    /// The chain's joints, from the base on.
    pub fn joints(&self) -> &[JointIndex] {
        &self.joints
    }

    /// Names of the chain's joints.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Limits of the chain's joints.
    pub fn limits(&self) -> &[Limits] {
        &self.limits[..self.kernel.len()]
    }

    /// Solves from a whole posture. See [`Self::solve`].
    pub fn solve_from(&self, target: &Target, from: &Posture, options: &Options) -> Result<Answer, IkError> {
        self.solve(target, &from.of(&self.joints), options)
    }

    /// Solves from `start_rad` (one angle per joint; angles outside of the limits are moved onto
    /// them first). The solution is the one that the motion from the start leads to, so nearby
    /// targets have nearby solutions; other starts are tried only when it leads nowhere.
    ///
    /// # Errors
    /// When something is not a number, or does not fit to the chain. A target that cannot be
    /// reached is no error but an [`Answer`].
    pub fn solve(&self, target: &Target, start_rad: &[f64], options: &Options) -> Result<Answer, IkError> {
        let question = self.question(target, start_rad, options)?;
        let (mut iterations, mut starts) = (0, 0);
        let mut best: Option<Outcome> = None;
        let mut seeds: Option<std::vec::IntoIter<Angles>> = None;
        loop {
            let start = match &mut seeds {
                None => question.start,
                Some(seeds) => match seeds.next() {
                    Some(seed) => inside(&seed, &question.limits, self.kernel.len()),
                    None => break,
                },
            };
            let outcome = self.attempt(&question, &start, options);
            iterations += outcome.iterations;
            starts += 1;
            if best.as_ref().is_none_or(|best| outcome.remaining.cost() < best.remaining.cost()) {
                best = Some(outcome);
            }
            if outcome.meets(options) {
                return Ok(Answer::Reached(self.solution(&outcome, iterations, starts)));
            }
            if seeds.is_none() {
                seeds = Some(self.promising(&question, options.other_starts).into_iter());
            }
        }
        let best = best.expect("the start was tried");
        Ok(self.explain(&question, &best, self.solution(&best, iterations, starts), options))
    }

    /// Up to `most` different solutions, the one from the start first, the others by how near they
    /// are to it; empty when the target cannot be reached. For choosing one that collides with
    /// nothing.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solutions(
        &self,
        target: &Target,
        start_rad: &[f64],
        options: &Options,
        most: usize,
    ) -> Result<Vec<Solution>, IkError> {
        let question = self.question(target, start_rad, options)?;
        let mut found: Vec<Solution> = vec![];
        let seeds = self.promising(&question, options.other_starts);
        for (i, start) in std::iter::once(question.start).chain(seeds).enumerate() {
            let outcome =
                self.attempt(&question, &inside(&start, &question.limits, self.kernel.len()), options);
            let distinct = |other: &Solution| distance_rad(&other.joints.all, &outcome.angles) > DISTINCT_RAD;
            if outcome.meets(options) && found.iter().all(distinct) {
                found.push(self.solution(&outcome, outcome.iterations, i as u32 + 1));
            }
        }
        let away = |solution: &Solution| distance_rad(&solution.joints.all, &question.start);
        // The one from the start is what `solve` gives: it stays first.
        let others = found.iter().position(|solution| solution.starts > 1).unwrap_or(found.len());
        found[others..].sort_by(|a, b| away(a).total_cmp(&away(b)));
        found.truncate(most);
        Ok(found)
    }

    fn question(&self, target: &Target, start_rad: &[f64], options: &Options) -> Result<Question, IkError> {
        if !target.is_finite() {
            return Err(IkError::NotANumber { what: "target" });
        }
        if !(0.0..=1.0).contains(&options.pull) {
            return Err(IkError::Pull(options.pull));
        }
        let limits = match &options.limits {
            Some(narrower) => checked_limits(narrower, Some(self.limits()), &self.names)?,
            None => self.limits,
        };
        let count = self.kernel.len();
        let start = inside(&self.angles("start posture", start_rad)?, &limits, count);
        let rest = match &options.rest {
            Some(rest) => {
                let rest = inside(&self.angles("rest posture", rest)?, &limits, count);
                (options.pull > 0.0)
                    .then(|| std::array::from_fn(|i| start[i] + options.pull * (rest[i] - start[i])))
            }
            None => None,
        };
        let tool_z = options.tool_z.map(|axis| axis.vector());
        Ok(Question { task: Task::new(target, tool_z, rest), limits, start })
    }

    fn angles(&self, what: &'static str, given: &[f64]) -> Result<Angles, IkError> {
        if given.len() != self.kernel.len() {
            return Err(IkError::Count { what, given: given.len(), joints: self.kernel.len() });
        }
        if !given.iter().all(|angle| angle.is_finite()) {
            return Err(IkError::NotANumber { what });
        }
        let mut angles = [0.0; MAX_JOINTS];
        angles[..given.len()].copy_from_slice(given);
        Ok(angles)
    }

    pub(super) fn promising(&self, question: &Question, count: usize) -> Vec<Angles> {
        self.seeds.promising(&question.task, &question.start, self.kernel.len(), count)
    }

    /// Demands and wishes first, then the demands alone to full precision: the second descent
    /// moves no joint farther than it has to. Where wishes lead astray, they are given up.
    fn attempt(&self, question: &Question, start: &Angles, options: &Options) -> Outcome {
        let (task, limits) = (&question.task, &question.limits);
        if !task.has_wishes() {
            return descend(&self.kernel, task, limits, start, DEMANDING);
        }
        let wished = descend(&self.kernel, task, limits, start, WISHFUL);
        let mut outcome = descend(&self.kernel, &task.demands(), limits, &wished.angles, DEMANDING);
        outcome.iterations += wished.iterations;
        if !outcome.meets(options) {
            let plain = descend(&self.kernel, &task.demands(), limits, start, DEMANDING);
            let iterations = outcome.iterations + plain.iterations;
            if plain.remaining.cost() < outcome.remaining.cost() {
                outcome = plain;
            }
            outcome.iterations = iterations;
        }
        outcome
    }

    fn solution(&self, outcome: &Outcome, iterations: u32, starts: u32) -> Solution {
        Solution {
            joints: ChainAngles::new(outcome.angles, self.kernel.len()),
            position_error_m: outcome.remaining.position_m,
            orientation_error_rad: outcome.remaining.orientation_rad,
            iterations,
            starts,
        }
    }
}

/// Why there is no solver.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolverError {
    /// No such tip.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// Its chain cannot be solved.
    #[error(transparent)]
    Chain(#[from] IkError),
}

fn inside(angles: &Angles, limits: &[Limits; MAX_JOINTS], count: usize) -> Angles {
    let mut moved = *angles;
    for i in 0..count {
        moved[i] = moved[i].clamp(limits[i].lower_rad, limits[i].upper_rad);
    }
    moved
}

fn distance_rad(a: &Angles, b: &Angles) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Limits together with the joints' `own`, one per joint; unused places hold zero.
fn checked_limits(
    given: &[Limits],
    own: Option<&[Limits]>,
    names: &[String],
) -> Result<[Limits; MAX_JOINTS], IkError> {
    if given.len() != names.len() {
        return Err(IkError::Count { what: "limits", given: given.len(), joints: names.len() });
    }
    let mut all = [Limits { lower_rad: 0.0, upper_rad: 0.0 }; MAX_JOINTS];
    for (i, limits) in given.iter().enumerate() {
        let own = own.map_or(*limits, |own| own[i]);
        let both = Limits {
            lower_rad: limits.lower_rad.max(own.lower_rad),
            upper_rad: limits.upper_rad.min(own.upper_rad),
        };
        let numbers = limits.lower_rad.is_finite() && limits.upper_rad.is_finite();
        if !numbers || both.lower_rad > both.upper_rad {
            return Err(IkError::Limits {
                joint: names[i].clone(),
                lower_rad: limits.lower_rad,
                upper_rad: limits.upper_rad,
                own_lower_rad: own.lower_rad,
                own_upper_rad: own.upper_rad,
            });
        }
        all[i] = both;
    }
    Ok(all)
}
