//! Looks through sets of effects, the most promising first.

use std::collections::{BTreeMap, HashMap, HashSet};

use plumbline_model::JobContext;

use super::field::{Field, log_sum};
use super::library::{Block, Grows, together};
use crate::error::GapError;

/// Sets whose odds against the best one are worse than this are forgotten (Occam's window).
const WINDOW: f64 = 150.0;
/// At most so many sets are looked around.
const MOST_EXPANSIONS: usize = 24;
/// Sets this much worse (log) than the best are not looked around.
const NOT_PROMISING: f64 = 4.0;
/// Variants this much worse (log) than the best one say nothing any more.
const NEGLIGIBLE: f64 = 7.0;

/// A set of blocks with what speaks for it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Model {
    /// Places of its blocks, growing.
    pub set: Vec<usize>,
    /// Evidence and prior, log, over all variants.
    pub log_score: f64,
    /// Among the sets of the window.
    pub probability: f64,
}

/// The sets that are left, the most probable first, but see [`Space::put_first`].
#[derive(Clone, Debug)]
pub(super) struct Explored {
    pub models: Vec<Model>,
    /// Probability of each variant, of the fields given.
    pub variants: Vec<f64>,
}

/// What may be looked through.
#[derive(Clone, Copy)]
pub(super) struct Space<'a> {
    pub fields: &'a [Field],
    pub blocks: &'a [Block],
    /// Blocks that may be in a set.
    pub allowed: &'a [usize],
    /// At most so many.
    pub most: usize,
    /// Divides differences of log evidence: above 1 for more doubt than the formula has.
    pub temperature: f64,
}

impl Space<'_> {
    fn prior(&self, set: &[usize]) -> f64 {
        set.iter().map(|&block| self.blocks[block].log_prior).sum::<f64>() + together(set, self.blocks)
    }

    /// Scores of a set by field.
    fn scores(&self, set: &[usize], fields: &[usize]) -> Vec<f64> {
        let prior = self.prior(set);
        fields.iter().map(|&f| self.fields[f].given(set, self.blocks).log_evidence + prior).collect()
    }

    /// Looks around from some sets on.
    ///
    /// # Errors
    /// Cancelled.
    pub fn explore(&self, seeds: &[Vec<usize>], context: &dyn JobContext) -> Result<Explored, GapError> {
        let all: Vec<usize> = (0..self.fields.len()).collect();
        let mut fields = all.clone();
        let mut visited: HashMap<Vec<usize>, f64> = HashMap::new();
        for seed in seeds {
            let seed = self.usable(seed);
            let score = log_sum(self.scores(&seed, &all).into_iter());
            visited.insert(seed, score);
        }
        let mut expanded: HashSet<Vec<usize>> = HashSet::new();
        for round in 0..MOST_EXPANSIONS {
            context.checkpoint()?;
            let best = visited.values().copied().fold(f64::NEG_INFINITY, f64::max);
            let next = visited
                .iter()
                .filter(|(set, score)| !expanded.contains(*set) && **score > best - NOT_PROMISING)
                .max_by(|a, b| a.1.total_cmp(b.1).then_with(|| b.0.cmp(a.0)));
            let Some((set, _)) = next else { break };
            let set = set.clone();
            self.around(&set, &fields, &mut visited, context)?;
            expanded.insert(set.clone());
            if round >= 1 {
                let scores = self.scores(&self.best(&visited), &all);
                let most = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                fields = all.iter().copied().filter(|&f| scores[f] > most - NEGLIGIBLE).collect();
            }
        }
        Ok(self.left(visited, &all))
    }

    fn usable(&self, set: &[usize]) -> Vec<usize> {
        let mut usable: Vec<usize> = vec![];
        for &block in set.iter().filter(|block| self.allowed.contains(block)) {
            let excluded = usable.iter().any(|&other| self.blocks[block].excludes(&self.blocks[other]));
            if !excluded && usable.len() < self.most {
                usable.push(block);
            }
        }
        usable.sort_unstable();
        usable
    }

    fn best(&self, visited: &HashMap<Vec<usize>, f64>) -> Vec<usize> {
        let best = visited.iter().max_by(|a, b| a.1.total_cmp(b.1).then_with(|| b.0.cmp(a.0)));
        best.map(|(set, _)| set.clone()).unwrap_or_default()
    }

    /// All sets with one block more, fewer or exchanged.
    fn around(
        &self,
        set: &[usize],
        fields: &[usize],
        visited: &mut HashMap<Vec<usize>, f64>,
        context: &dyn JobContext,
    ) -> Result<(), GapError> {
        self.additions(set, fields, visited, context)?;
        for leave in 0..set.len() {
            let mut base = set.to_vec();
            base.remove(leave);
            self.additions(&base, fields, visited, context)?;
        }
        Ok(())
    }

    fn additions(
        &self,
        base: &[usize],
        fields: &[usize],
        visited: &mut HashMap<Vec<usize>, f64>,
        context: &dyn JobContext,
    ) -> Result<(), GapError> {
        context.checkpoint()?;
        let prior = self.prior(base);
        let given: Vec<_> = fields.iter().map(|&f| self.fields[f].given(base, self.blocks)).collect();
        visited.insert(base.to_vec(), prior + log_sum(given.iter().map(|given| given.log_evidence)));
        if base.len() >= self.most {
            return Ok(());
        }
        for &block in self.allowed {
            if base.iter().any(|&other| self.blocks[block].excludes(&self.blocks[other])) {
                continue;
            }
            context.checkpoint()?;
            let own = &self.blocks[block];
            let score = log_sum(given.iter().map(|given| given.log_evidence + given.adds(own)));
            let mut set = base.to_vec();
            set.insert(set.partition_point(|&other| other < block), block);
            let prior = self.prior(&set);
            visited.insert(set, prior + score);
        }
        Ok(())
    }

    /// Sets that differ only in how eyes turn sideways, or nod, in the course of time (which time constant, turned or
    /// shifted, one eye or both) say the same: together they may be more probable than a set that is so alone, which has nothing of
    /// it. The best one of those that are the most probable together comes first.
    fn put_first(&self, models: &mut [Model]) {
        let said = |model: &Model| -> Vec<Result<usize, Grows>> {
            let of = |block: &usize| self.blocks[*block].grows.map_or(Ok(*block), Err);
            let mut said: Vec<_> = model.set.iter().map(of).collect();
            said.sort_unstable();
            said
        };
        let mut together: BTreeMap<Vec<Result<usize, Grows>>, (usize, f64)> = BTreeMap::new();
        for (place, model) in models.iter().enumerate() {
            together.entry(said(model)).or_insert((place, 0.0)).1 += model.probability;
        }
        let best = together.values().max_by(|a, b| a.1.total_cmp(&b.1).then_with(|| b.0.cmp(&a.0)));
        if let Some((place, _)) = best.copied() {
            models[..=place].rotate_right(1);
        }
    }

    fn left(&self, visited: HashMap<Vec<usize>, f64>, fields: &[usize]) -> Explored {
        // Doubt is about the evidence, not about how rare effects are.
        let tempered = |set: &[usize], score: f64| {
            let prior = self.prior(set);
            (score - prior) / self.temperature + prior
        };
        let scored: Vec<(Vec<usize>, f64, f64)> = visited
            .into_iter()
            .map(|(set, score)| {
                let own = tempered(&set, score);
                (set, score, own)
            })
            .collect();
        let best = scored.iter().map(|(.., tempered)| *tempered).fold(f64::NEG_INFINITY, f64::max);
        let mut models: Vec<Model> = scored
            .into_iter()
            .filter(|(.., tempered)| *tempered > best - WINDOW.ln())
            .map(|(set, log_score, tempered)| Model { set, log_score, probability: (tempered - best).exp() })
            .collect();
        models.sort_by(|a, b| b.probability.total_cmp(&a.probability).then_with(|| a.set.cmp(&b.set)));
        let sum: f64 = models.iter().map(|model| model.probability).sum();
        models.iter_mut().for_each(|model| model.probability /= sum);
        self.put_first(&mut models);
        let scores = models.first().map_or(vec![], |model| self.scores(&model.set, fields));
        let total = log_sum(scores.iter().copied());
        let variants: Vec<f64> =
            scores.iter().map(|score| ((score - total) / self.temperature).exp()).collect();
        let sum: f64 = variants.iter().sum();
        Explored { models, variants: variants.iter().map(|share| share / sum).collect() }
    }
}
