//! Puts together what a search found.

use nalgebra::{Cholesky, DMatrix};
use plumbline_effects::measurements::{Measurements, What};
use plumbline_effects::{Assumed, Effect, Present};
use plumbline_model::JobContext;

use super::explore::{Explored, Model};
use super::library::Library;
use super::linear::Linear;
use super::look::{Look, TEMPERATURE};
use super::many::Many;
use super::naming::{Evidence, Named, WIDER, parameters};
use super::refit::{Fitted, frames, refit};
use super::undetermined::undetermined;
use super::{Doubt, Found, Hypothesis, knowledge, masses};
use crate::error::GapError;
use crate::finding::{Dependence, Unexplained, Verdict};
use crate::floor::Floor;
use crate::options::Options;

/// At most so many sets are told.
const MOST_HYPOTHESES: usize = 8;
/// Sets less probable than this are not told.
const LEAST_HYPOTHESIS: f64 = 0.01;
/// At most so many covariates that the rest depends on.
const MOST_DEPENDENCES: usize = 3;

/// All that the answer is made of.
pub(super) struct Finish<'a> {
    pub measurements: &'a Measurements,
    pub floor: &'a Floor,
    pub options: &'a Options,
    pub library: &'a Library,
    pub look: &'a Look,
    pub explored: &'a Explored,
    pub alone: Option<&'a Explored>,
    pub many: Option<&'a Many>,
}

impl Finish<'_> {
    /// The answer. `bare`: frames alone; `fitted`: with the most probable set.
    pub fn found(&self, bare: &Fitted, fitted: &Fitted, context: &dyn JobContext) -> Result<Found, GapError> {
        let evidence = Evidence {
            library: self.library,
            look: self.look,
            explored: self.explored,
            alone: self.alone,
            many: self.many.map(|many| (many, many.probability(self.explored))),
            floor: self.floor,
            floor_m: floor_m(self.measurements, self.floor),
            temperature: TEMPERATURE,
        };
        let mut named = evidence.name();
        let effects: Vec<Present> = named
            .blocks
            .iter()
            .zip(&named.effects)
            .map(|(&block, effect)| Present {
                effect: self.library.effects[block].clone(),
                values: effect.values.clone(),
            })
            .collect();
        let families = effects.iter().any(|present| present.effect.is_of_every_site());
        let of_fit = &fitted.assumed.effects;
        let is_fitted = |one: &Present| of_fit.iter().any(|other| other.effect == one.effect);
        let named_all = effects.len() == of_fit.len() && effects.iter().all(is_fitted) && !families;
        let start = Assumed { effects, ..fitted.assumed.clone() };
        // Values that were found beside effects that get no name are not theirs alone.
        let (assumed, doubt, sds) = if named_all {
            let assumed = frames(self.measurements, self.floor, &start, context)?;
            let doubt = self.doubt(&assumed, &fitted.weights, None, context)?;
            let sds = vec![1.0; doubt.covariance.nrows() - doubt.nuisances.len()];
            (assumed, doubt, sds)
        } else {
            let kept: Vec<Effect> = start.effects.iter().map(|present| present.effect.clone()).collect();
            let own = refit(self.measurements, self.floor, &start, &kept, context)?;
            let doubt = self.doubt(&own.assumed, &fitted.weights, Some(&own.sds), context)?;
            let mut at = 0;
            for (effect, present) in named.effects.iter_mut().zip(&own.assumed.effects) {
                let count = present.values.len();
                effect.values.clone_from(&present.values);
                let covariance = if families {
                    let typical = present.effect.parameters();
                    let wider = |r: usize, c: usize| WIDER * WIDER * typical[r].typical * typical[c].typical;
                    DMatrix::from_fn(count, count, |r, c| wider(r, c) * doubt.covariance[(at + r, at + c)])
                } else {
                    DMatrix::from_row_slice(count, count, &effect.covariance)
                };
                at += count;
                effect.covariance = covariance.transpose().iter().copied().collect();
                effect.parameters = parameters(&present.effect, &effect.values, &covariance);
            }
            (own.assumed, doubt, own.sds)
        };
        self.widen_by_masses(&mut named, &assumed, &fitted.weights, &sds, context)?;
        evidence.widen_by_shapes(&mut named);
        let undetermined = undetermined(self.measurements, &assumed.effects, &doubt.covariance, &sds);
        let hypotheses = self.hypotheses(&assumed, named.many.is_some(), context)?;
        let after = self.misses(&assumed, context)?;
        // The noise may have been taken anew since.
        let before = self.misses(&bare.assumed, context)?;
        let share = share_left(&before, &after, &fitted.weights, doubt.noise_scale);
        let unexplained = Unexplained {
            p_value: named.p_value,
            probability: named.unknown,
            depends_on: self.depends_on(&named),
            share,
        };
        let candidates = knowledge::candidates(self.library, self.look, &named);
        Ok(Found {
            assumed,
            probable: fitted.assumed.clone(),
            verdict: named.verdict,
            effects: named.effects,
            candidates,
            unexplained,
            weights: fitted.weights.clone(),
            doubt,
            hypotheses,
            undetermined,
            floor: self.floor.clone(),
            many: named.many,
        })
    }

    /// Masses are not quite those of the description: what was found from loads is known no better.
    fn widen_by_masses(
        &self,
        named: &mut Named,
        assumed: &Assumed,
        weights: &[f64],
        sds: &[f64],
        context: &dyn JobContext,
    ) -> Result<(), GapError> {
        let variant = self.look.fields.get(self.look.likely(self.explored)).map(|field| field.variant);
        let scale = variant.map_or((1.0, 0.0), |variant| (variant.noise, variant.cell));
        let added = masses::doubt(self.measurements, self.floor, assumed, weights, scale, sds, context)?;
        let Some(added) = added else { return Ok(()) };
        let mut at = 0;
        for (effect, present) in named.effects.iter_mut().zip(&assumed.effects) {
            let typical = present.effect.parameters();
            let count = typical.len();
            let own = DMatrix::from_row_slice(count, count, &effect.covariance);
            let wider = DMatrix::from_fn(count, count, |r, c| {
                own[(r, c)] + typical[r].typical * typical[c].typical * added[(at + r, at + c)]
            });
            at += count;
            if present.effect.kind.is_of_load() {
                effect.covariance = wider.transpose().iter().copied().collect();
                effect.parameters = parameters(&present.effect, &effect.values, &wider);
            }
        }
        Ok(())
    }

    fn misses(&self, assumed: &Assumed, context: &dyn JobContext) -> Result<Vec<Option<f64>>, GapError> {
        let linear = Linear::of(self.measurements, self.floor, assumed, &[], context)?;
        let residual = linear.lines.column(linear.lines.ncols() - 1).clone_owned();
        Ok(linear.misses(self.measurements.rows.len(), &residual))
    }

    /// Covariance of values and frames at the model that was found.
    /// `sds`: of each value beforehand, in usual sizes; without them each is as large as usual.
    fn doubt(
        &self,
        assumed: &Assumed,
        weights: &[f64],
        sds: Option<&[f64]>,
        context: &dyn JobContext,
    ) -> Result<Doubt, GapError> {
        let effects: Vec<Effect> = assumed.effects.iter().map(|present| present.effect.clone()).collect();
        let linear = Linear::of(self.measurements, self.floor, assumed, &effects, context)?;
        let variant = self.look.fields.get(self.look.likely(self.explored)).map(|field| field.variant);
        let (noise, cell, dirt) = variant.map_or((1.0, 0.0, 0.0), |v| (v.noise, v.cell, v.dirt));
        let (gram, _) = linear.sums(weights, context)?.gram(cell * cell, context)?;
        let own = gram.ncols() - 1;
        let mut normal = gram.view((0, 0), (own, own)) / (noise * noise);
        for k in 0..own {
            let sd = linear.nuisances.get(k).map_or_else(
                || sds.and_then(|sds| sds.get(k - linear.gauge)).copied().unwrap_or(1.0),
                |nuisance| nuisance.prior_sd(),
            );
            normal[(k, k)] += sd.powi(-2);
        }
        let inverse =
            Cholesky::new(normal).map_or_else(|| DMatrix::identity(own, own), |normal| normal.inverse());
        // From nuisances first to effects first.
        let count = own - linear.gauge;
        let place = |k: usize| if k < count { linear.gauge + k } else { k - count };
        let covariance = DMatrix::from_fn(own, own, |r, c| inverse[(place(r), place(c))]);
        Ok(Doubt {
            effects,
            nuisances: linear.nuisances,
            covariance,
            dirt_sigmas: cell.hypot(dirt),
            noise_scale: noise,
        })
    }

    fn hypotheses(
        &self,
        best: &Assumed,
        is_many: bool,
        context: &dyn JobContext,
    ) -> Result<Vec<Hypothesis>, GapError> {
        if !self.options.advise || is_many {
            return Ok(vec![]);
        }
        let mut merged: Vec<(Vec<usize>, f64)> = vec![];
        for model in &self.explored.models {
            let set = self.of_library(model);
            match merged.iter_mut().find(|(known, _)| *known == set) {
                Some((_, probability)) => *probability += model.probability,
                None => merged.push((set, model.probability)),
            }
        }
        merged.sort_by(|a, b| b.1.total_cmp(&a.1));
        let likely = &self.look.fields[self.look.likely(self.explored)];
        merged
            .into_iter()
            .take(MOST_HYPOTHESES)
            .filter(|(_, probability)| *probability >= LEAST_HYPOTHESIS)
            .map(|(set, probability)| {
                let (means, _) = likely.given(&set, &self.look.packed).values();
                let mut at = 0;
                let effects = set
                    .iter()
                    .map(|&block| {
                        let effect = self.library.effects[block].clone();
                        let values = effect
                            .parameters()
                            .iter()
                            .map(|parameter| {
                                at += 1;
                                means[at - 1] * parameter.typical
                            })
                            .collect();
                        Present { effect, values }
                    })
                    .collect();
                let names = set.iter().map(|&block| self.library.effects[block].name()).collect();
                let start = Assumed { effects, ..best.clone() };
                let assumed = frames(self.measurements, self.floor, &start, context)?;
                Ok(Hypothesis { names, probability, assumed })
            })
            .collect()
    }

    fn of_library(&self, model: &Model) -> Vec<usize> {
        model.set.iter().copied().filter(|&block| block < self.look.effects).collect()
    }

    /// What the rest depends on, when something unknown is at work.
    fn depends_on(&self, named: &Named) -> Vec<Dependence> {
        if named.verdict != Verdict::NotInLibrary {
            return vec![];
        }
        let Some(top) = self.explored.models.first() else { return vec![] };
        let set = self.of_library(top);
        let field = &self.look.fields[self.look.likely(self.explored)];
        let given = field.given(&set, &self.look.packed);
        let left = given.square_left() - self.look.within.0;
        let free = self.look.total - self.look.within.1 - self.look.gauge as f64;
        let mut all: Vec<Dependence> = self
            .look
            .allowed
            .iter()
            .filter(|&&block| block >= self.look.effects)
            .map(|&block| {
                let rival = &self.look.rivals[block - self.look.effects];
                let mut with = set.clone();
                with.push(block);
                let less = field.given(&with, &self.look.packed).square_left() - self.look.within.0;
                let share = ((left - less) / (left - 0.8 * free).max(left - less).max(1e-9)).clamp(0.0, 1.0);
                Dependence { on: rival.on.clone(), of: rival.of.clone(), share, formula: None }
            })
            .collect();
        all.sort_by(|a, b| b.share.total_cmp(&a.share));
        // A step is tried at many angles, and is told once.
        let mut told = std::collections::HashSet::new();
        all.retain(|one| told.insert((one.on.clone(), one.of.clone())));
        all.truncate(MOST_DEPENDENCES);
        all
    }
}

/// Of what lies beyond the floor, how much is left.
fn share_left(before: &[Option<f64>], after: &[Option<f64>], weights: &[f64], noise: f64) -> f64 {
    let beyond = |misses: &[Option<f64>]| {
        let (mut sum, mut count) = (0.0, 0.0);
        for (miss, weight) in misses.iter().zip(weights) {
            if let Some(miss) = miss {
                sum += weight * miss * miss;
                count += weight;
            }
        }
        (sum / f64::max(count, 1e-9) - noise * noise).max(0.0).sqrt()
    };
    let gap = beyond(before);
    if gap > 0.0 { (beyond(after) / gap).min(1.0) } else { 0.0 }
}

/// Length of one floor on the table, m; of eye points, px.
fn floor_m(measurements: &Measurements, floor: &Floor) -> f64 {
    let Some(kind) = floor.kinds.first() else { return 0.0 };
    let length = |sd: &[f64]| sd.iter().map(|sd| sd * sd).sum::<f64>().sqrt();
    match kind.what {
        What::Touch => length(&kind.sd[..2]),
        What::Pose | What::OrientedPose => length(&kind.sd[..3]),
        What::EyePoints => length(&kind.sd),
        What::Place => {
            let lengths = measurements.rows.iter().filter(|row| row.what == What::Place).filter_map(|row| {
                let eyes = measurements.apparatus(row).eyes.as_ref()?;
                let range_m = eyes.place(&row.measured)?.coords.norm();
                // Across the ray; along it both rays meet the farther off the flatter they do.
                let along_m = range_m / row.measured.get(2)?.sin();
                Some((range_m * kind.sd[0].hypot(kind.sd[1])).hypot(along_m * kind.sd[2]))
            });
            crate::compare::median(lengths).unwrap_or(0.0)
        }
    }
}
