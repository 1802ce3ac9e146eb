//! One look at the data: everything linear at the present model.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::measurements::Measurements;
use plumbline_effects::{Assumed, Kind};
use plumbline_model::JobContext;

use super::explore::{Explored, Space};
use super::field::{Dirtied, Field, Framed, Variant};
use super::free::{Rival, Rivals, rivals};
use super::library::{Block, Library};
use super::linear::Linear;
use super::many::Ground;
use super::variants::variants;
use crate::covariates::Covariates;
use crate::error::GapError;
use crate::floor::Floor;

/// Effects are looked for that reach this size (floors) at this many usual sizes.
const SMALLEST: f64 = 0.3;
const LARGEST_VALUE: f64 = 3.0;
/// And whose usual size stands out of the noise by so many standard deviations.
const SEEN_SIGMAS: f64 = 1.5;
/// Members of a family stand out from so many standard deviations on.
const STANDS_OUT: f64 = 2.0;
/// A family is exchanged for so many of them at most.
const MOST_SPLIT: usize = 3;
/// Steps that explain less (log evidence) are not looked at more closely.
const LEAST_STEP: f64 = 3.0;
/// So many of the best sets are looked around again.
const KEPT: usize = 2;
/// No fingertip is a point: its pad is round by so much or less, m.
const PAD_SD_M: f64 = 0.3e-3;
/// Shapes of one effect whose columns have this cosine do the same.
const ALIKE: f64 = 0.99;
/// Keeps columns that are alike from being solved for, share of each.
const RIDGE: f64 = 1e-6;
/// Divides log odds: see the README's section on calibration.
pub(super) const TEMPERATURE: f64 = 2.0;

/// Everything at one linearization.
pub(super) struct Look {
    /// With their columns in [`Self::plain`].
    pub blocks: Vec<Block>,
    /// With their columns in the fields; only those allowed.
    pub packed: Vec<Block>,
    pub rivals: Vec<Rival>,
    /// Number of library blocks; rivals come after.
    pub effects: usize,
    pub fields: Vec<Field>,
    /// Frames integrated out, rows independent.
    pub plain: Framed,
    /// What a usual size of each column does, in floors.
    pub sizes: Vec<f64>,
    /// Blocks that are looked through.
    pub allowed: Vec<usize>,
    /// Sum of the weights of all coordinates, and sum of squares about the cells' means.
    pub total: f64,
    pub within: (f64, f64),
    pub gauge: usize,
    /// What evidence is made of.
    pub ground: Ground,
}

/// Blocks that are looked through, without the further shapes of play that gravity closes where the load turns over nowhere
/// (or in the same rows): there they do what the first one does, which is then as probable as all of them.
fn without_doubles(
    blocks: &mut [Block],
    allowed: &[usize],
    present: &DVector<f64>,
    library: &Library,
    plain: &Framed,
) -> Vec<usize> {
    let is_play = |block: usize| blocks[block].kind == Some(Kind::GravityBacklash);
    let first = |block: usize| {
        let same = |other: &usize| blocks[*other].name == blocks[block].name;
        (0..library.effects.len()).find(same).unwrap_or(block)
    };
    let is_double = |block: usize, of: usize| {
        let [own, other] = [block, of].map(|block| blocks[block].start);
        plain.a[(own, other)].abs() > ALIKE * (plain.a[(own, own)] * plain.a[(other, other)]).sqrt()
    };
    let (mut kept, mut doubles) = (vec![], vec![]);
    for &block in allowed {
        let of = first(block);
        let is_further = block < library.effects.len() && is_play(block) && block != of;
        // What is in the model already is taken out of the residual by its own column.
        let is_present = || blocks[block].columns().any(|c| present[c] != 0.0);
        let double = is_further && !is_present() && allowed.contains(&of) && is_double(block, of);
        if double { doubles.push((block, of)) } else { kept.push(block) }
    }
    for (block, of) in doubles {
        let [own, all] = [block, of].map(|block| blocks[block].log_prior.exp());
        blocks[of].log_prior = (own + all).ln();
    }
    kept
}

impl Look {
    /// At a model.
    ///
    /// # Errors
    /// Cancelled.
    pub fn at(
        measurements: &Measurements,
        floor: &Floor,
        assumed: &Assumed,
        library: &Library,
        covariates: &Covariates,
        weights: &[f64],
        context: &dyn JobContext,
    ) -> Result<Self, GapError> {
        let mut linear = Linear::of(measurements, floor, assumed, &library.effects, context)?;
        let Rivals { rivals, blocks: more, columns } =
            rivals(measurements, covariates, library, &linear, context)?;
        linear.append(&columns);
        let mut blocks = library.blocks.clone();
        blocks.extend(more);
        context.checkpoint()?;
        let sums = linear.sums(weights, context)?;
        let count = linear.effects();
        let mut present = DVector::zeros(count);
        for one in &assumed.effects {
            let place = library.effects.iter().position(|effect| *effect == one.effect);
            let Some(place) = place else { continue };
            for ((k, value), parameter) in
                library.blocks[place].columns().zip(&one.values).zip(one.effect.parameters())
            {
                present[k] = value / parameter.typical;
            }
        }
        let nothing =
            || GapError::TooFew { rows: measurements.rows.len(), needed: measurements.rows.len() + 10 };
        let plain = Framed::of(&sums, 0.0, &present, context)?.ok_or_else(nothing)?;
        let sizes = plain.sizes();
        let allowed: Vec<usize> = (0..blocks.len())
            .filter(|&block| {
                let size = blocks[block].columns().map(|c| sizes[c] * sizes[c]).sum::<f64>().sqrt();
                let seen = size * sums.total.sqrt();
                let present = blocks[block].columns().any(|c| present[c] != 0.0);
                present || LARGEST_VALUE * size >= SMALLEST && seen >= SEEN_SIGMAS
            })
            .collect();
        let allowed = without_doubles(&mut blocks, &allowed, &present, library, &plain);
        // Only what is looked through takes part from here on.
        let mut packed = blocks.clone();
        let mut kept: Vec<usize> = vec![];
        for &block in &allowed {
            packed[block].start = kept.len();
            kept.extend(blocks[block].columns());
        }
        let of_allowed: Vec<Block> = allowed.iter().map(|&block| packed[block].clone()).collect();
        let mut dirty = vec![false; kept.len()];
        let mut names = std::collections::HashSet::new();
        let single = |block: usize| library.effects.get(block).is_some_and(|e| !e.is_of_every_site());
        for &block in allowed.iter().filter(|&&block| single(block)) {
            if names.insert(blocks[block].name) {
                packed[block].columns().for_each(|c| dirty[c] = true);
            }
        }
        let mut always = vec![0.0; kept.len()];
        for &block in allowed.iter().filter(|&&block| blocks[block].kind == Some(Kind::FingerRoll)) {
            let parameters = library.effects[block].parameters();
            packed[block].columns().zip(parameters).for_each(|(c, pad)| always[c] = PAD_SD_M / pad.typical);
        }
        let ground = Ground {
            sums: sums.only(&kept),
            present: DVector::from_iterator(kept.len(), kept.iter().map(|&c| present[c])),
            sizes: kept.iter().map(|&c| sizes[c]).collect(),
            dirty,
            always,
        };
        let mut fields: Vec<Field> = vec![];
        let mut framed: Option<(f64, Framed)> = None;
        let mut shared: Option<(Variant, Arc<Dirtied>)> = None;
        let gap = (plain.square / sums.total - 1.0).max(0.0).sqrt();
        for variant in variants(floor.source, gap) {
            let Variant { size, most, log_prior, .. } = variant;
            let like = |known: &Variant| Variant { size, most, log_prior, ..*known } == variant;
            if !shared.as_ref().is_some_and(|(known, _)| like(known)) {
                context.checkpoint()?;
                if !framed.as_ref().is_some_and(|(cell, _)| *cell == variant.cell) {
                    framed = Framed::of(&ground.sums, variant.cell * variant.cell, &ground.present, context)?
                        .map(|one| (variant.cell, one));
                }
                let narrow = variant.narrow(&ground.sizes, &ground.dirty, &ground.always);
                let dirtied = match &framed {
                    Some((_, framed)) => framed.dirtied(variant, &narrow, context)?,
                    None => None,
                };
                shared = dirtied.map(|dirtied| (variant, Arc::new(dirtied)));
            }
            if let Some((_, shared)) = &shared {
                fields.push(Field::new(variant, Arc::clone(shared), &of_allowed, &ground.sizes));
            }
        }
        let within = sums.within();
        let (total, gauge) = (sums.total, sums.gauge);
        let effects = library.blocks.len();
        Ok(Self {
            blocks,
            packed,
            rivals,
            effects,
            fields,
            plain,
            sizes,
            allowed,
            total,
            within,
            gauge,
            ground,
        })
    }

    /// Looks through sets of blocks, with rivals that are in no library or without.
    ///
    /// # Errors
    /// Cancelled.
    pub fn explore(
        &self,
        seeds: &[Vec<usize>],
        most: usize,
        with_rivals: bool,
        context: &dyn JobContext,
    ) -> Result<Explored, GapError> {
        let known = |block: &&usize| with_rivals || **block < self.effects;
        let allowed: Vec<usize> = self.allowed.iter().filter(known).copied().collect();
        let space = Space {
            fields: &self.fields,
            blocks: &self.packed,
            allowed: &allowed,
            most,
            temperature: TEMPERATURE,
        };
        let explored = space.explore(seeds, context)?;
        let split: Vec<Vec<usize>> =
            self.split(&explored).into_iter().filter(|set| set.len() <= most).collect();
        let has_family = |set: &[usize]| set.iter().any(|&block| self.blocks[block].is_family);
        if !explored.models.first().is_some_and(|model| has_family(&model.set)) {
            return Ok(explored);
        }
        // One member of a family is far worse than the family where two are off, or where something else is off
        // beside it, so no way of single steps leads from one to the other: sets without families are looked
        // through by themselves.
        let single: Vec<usize> =
            allowed.iter().copied().filter(|&block| !self.blocks[block].is_family).collect();
        let alone = Space { allowed: &single, ..space }.explore(&[vec![]], context)?;
        let best = |explored: &Explored| -> Vec<Vec<usize>> {
            explored.models.iter().take(KEPT).map(|model| model.set.clone()).collect()
        };
        let seeds: Vec<Vec<usize>> =
            seeds.iter().cloned().chain(best(&explored)).chain(best(&alone)).chain(split).collect();
        space.explore(&seeds, context)
    }

    /// Steps at the moment that suits each of them best, beside the best set or in the place of one of its effects.
    /// The moments that were tried lie so far apart that some rows are on the wrong side of a step, which makes a large
    /// one look worse than something that only resembles it.
    pub fn steps(&self, explored: &Explored) -> Vec<usize> {
        let Some(field) = self.fields.get(self.likely(explored)) else { return vec![] };
        let best: Vec<usize> = explored.models.first().map_or(vec![], |model| {
            model.set.iter().copied().filter(|&block| block < self.effects).collect()
        });
        let without = (0..best.len()).map(|leave| {
            best.iter().enumerate().filter(|(k, _)| *k != leave).map(|(_, &block)| block).collect()
        });
        let bases: Vec<Vec<usize>> = without.chain([best.clone()]).collect();
        let is_step =
            |block: usize| matches!(self.blocks[block].kind, Some(Kind::SlippedHorn | Kind::ScreenBumped));
        let mut steps: BTreeMap<usize, (f64, usize)> = BTreeMap::new();
        for base in &bases {
            let given = field.given(base, &self.packed);
            for &block in self.allowed.iter().filter(|&&block| is_step(block)) {
                if base.iter().any(|&other| self.blocks[block].excludes(&self.blocks[other])) {
                    continue;
                }
                let gain = given.adds(&self.packed[block]);
                let own = steps.entry(self.blocks[block].name).or_insert((gain, block));
                if gain > own.0 {
                    *own = (gain, block);
                }
            }
        }
        steps.into_values().filter(|(gain, _)| *gain > LEAST_STEP).map(|(_, block)| block).collect()
    }

    /// The best set with its families exchanged for the members that stand out most.
    fn split(&self, explored: &Explored) -> Vec<Vec<usize>> {
        let Some(best) = explored.models.first() else { return vec![] };
        let Some(&family) = best.set.iter().find(|&&block| self.blocks[block].is_family) else {
            return vec![];
        };
        let kind = self.blocks[family].kind;
        let members: Vec<usize> = (0..self.effects)
            .filter(|&block| self.blocks[block].kind == kind && !self.blocks[block].is_family)
            .collect();
        if members.iter().map(|&block| self.blocks[block].len).sum::<usize>() != self.blocks[family].len {
            return vec![];
        }
        let (means, covariance) = self.fields[self.likely(explored)].given(&best.set, &self.packed).values();
        let before = best.set.iter().take_while(|&&block| block != family);
        let mut at: usize = before.map(|&block| self.blocks[block].len).sum();
        let mut stand_out: Vec<(f64, usize)> = vec![];
        for block in members {
            let len = self.blocks[block].len;
            let sigmas = (at..at + len).map(|k| means[k].abs() / covariance[(k, k)].sqrt());
            stand_out.push((sigmas.fold(0.0, f64::max), block));
            at += len;
        }
        stand_out.retain(|(sigmas, block)| *sigmas > STANDS_OUT && self.allowed.contains(block));
        stand_out.sort_by(|a, b| b.0.total_cmp(&a.0));
        (1..=stand_out.len().min(MOST_SPLIT))
            .map(|count| {
                let others = best.set.iter().copied().filter(|&block| block != family);
                let mut set: Vec<usize> =
                    others.chain(stand_out.iter().take(count).map(|(_, block)| *block)).collect();
                set.sort_unstable();
                set
            })
            .collect()
    }

    /// Root mean square of what values (usual sizes) of a block do to the rows, in floors.
    pub fn does(&self, block: usize, values: &[f64]) -> f64 {
        let columns = self.blocks[block].columns();
        let at = columns.start;
        let square: f64 = columns
            .clone()
            .flat_map(|r| columns.clone().map(move |c| (r, c)))
            .map(|(r, c)| values[r - at] * values[c - at] * self.plain.a[(r, c)])
            .sum();
        (square.max(0.0) / self.total).sqrt()
    }

    /// The same of what a block does that others beside it cannot do as well: two that make up for each other do little.
    pub fn does_beyond(&self, block: usize, values: &[f64], others: &[usize]) -> f64 {
        let own: Vec<usize> = self.blocks[block].columns().collect();
        let beside: Vec<usize> = others.iter().flat_map(|&other| self.blocks[other].columns()).collect();
        (square_beyond(&self.plain.a, &own, values, &beside) / self.total).sqrt()
    }

    /// Root mean square of what frames alone leave beyond the noise, in floors.
    pub fn gap(&self) -> f64 {
        (self.plain.square / self.total - 1.0).max(0.0).sqrt()
    }

    /// Place of the most probable variant.
    pub fn likely(&self, explored: &Explored) -> usize {
        (0..self.fields.len())
            .max_by(|&a, &b| explored.variants[a].total_cmp(&explored.variants[b]))
            .unwrap_or(0)
    }
}

/// Square of what values of some columns of a gram matrix do beyond the span of others.
fn square_beyond(gram: &DMatrix<f64>, own: &[usize], values: &[f64], beside: &[usize]) -> f64 {
    let part = |rows: &[usize], columns: &[usize]| {
        DMatrix::from_fn(rows.len(), columns.len(), |r, c| gram[(rows[r], columns[c])])
    };
    let mut among = part(beside, beside);
    for k in 0..among.nrows() {
        among[(k, k)] *= 1.0 + RIDGE;
    }
    let values = DVector::from_column_slice(values);
    let (does, mixed) = (part(own, own), part(beside, own));
    let taken = match Cholesky::new(among) {
        Some(among) if !beside.is_empty() => mixed.transpose() * among.solve(&mixed),
        _ => DMatrix::zeros(own.len(), own.len()),
    };
    values.dot(&((does - taken) * &values)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_makes_up_for_each_other_does_little_beyond_it() {
        // Columns: one, nearly the same again, and one across.
        let columns = DMatrix::from_columns(&[
            DVector::from_vec(vec![1.0, 1.0, 0.0, 0.0]),
            DVector::from_vec(vec![1.0, 1.0, 0.1, 0.0]),
            DVector::from_vec(vec![0.0, 0.0, 0.0, 1.0]),
        ]);
        let gram = columns.tr_mul(&columns);
        let alone = square_beyond(&gram, &[1], &[3.0], &[]);
        assert!((alone - 9.0 * 2.01).abs() < 1e-9, "alone it does what it does: {alone}");
        assert!(
            (square_beyond(&gram, &[1], &[3.0], &[2]) - alone).abs() < 1e-9,
            "what lies across takes nothing"
        );
        let beyond = square_beyond(&gram, &[1], &[3.0], &[0, 2]);
        assert!((beyond - 9.0 * 0.01).abs() < 1e-3, "{beyond}");
        assert!(square_beyond(&gram, &[0], &[3.0], &[0]) < 1e-4, "itself takes all");
    }
}
