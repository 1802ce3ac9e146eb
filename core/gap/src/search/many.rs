//! Everything at once, as another explanation than a few effects.
//!
//! A cheap arm is a little off everywhere. The few names that explain that best are those that happen to stand for much of
//! the rest, not those that are there. So every effect of the library at once, each as large as some share of what is
//! usual, is weighed against the best few; where it is more probable, the few stand for it, and only those of them are
//! sure that stand out of all the others.

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::Kind;
use plumbline_effects::measurements::What;
use plumbline_model::JobContext;
use statrs::distribution::{ChiSquared, ContinuousCDF, Discrete, DiscreteCDF, Poisson};

use super::explore::Explored;
use super::field::{Framed, log_sum};
use super::linear::Sums;
use super::look::TEMPERATURE;
use super::naming::Evidence;
use super::variants::variants;
use crate::error::GapError;
use crate::finding::FloorSource;

/// How large everything is, shares of usual sizes, each as probable as the others.
const SHARES: [f64; 4] = [0.1, 0.2, 0.4, 0.8];
/// How probable it is beforehand that everything is a little off, and not a few things.
const BEFOREHAND: f64 = 0.2;
/// Fewer effects than this that explain it are no crowd.
pub(super) const LEAST_FEW: usize = 2;
/// How often a robot that is off in 12 to 20 ways gets so many names, from none on (the last one: as many or more). Ninety
/// of them, made by the physics of the blind test.
const NAMES_OF_MANY: [f64; 7] = [0.0, 0.0, 0.03, 0.07, 0.2, 0.25, 0.45];
/// How many effects are expected where few are off.
const EXPECTED_OF_FEW: f64 = 1.0;
/// An effect stands out of all the others where its values would come from none with less probability than this.
const STANDS_OUT_P: f64 = 0.01;
/// Touches on a screen tell zeros, axes, lengths and a tip from each other so little that one of them stands out for what others
/// do together: of 19 that did beyond doubt in development cases of the blind test 9 were there (132 of 133 of all others).
const GEOMETRY_BY_TOUCHES: f64 = 0.5;

/// What evidence is made of, with the columns of what is looked through only.
pub(super) struct Ground {
    pub sums: Sums,
    /// Values that the residual was taken at, usual sizes.
    pub present: DVector<f64>,
    /// What a usual size of each column does, in floors.
    pub sizes: Vec<f64>,
    /// Columns of one shape of each effect: everything at once is made of them.
    pub dirty: Vec<bool>,
    /// What is there at least, usual sizes.
    pub always: Vec<f64>,
}

/// Everything at once.
pub(super) struct Many {
    /// Of all variants and shares, log.
    log_evidence: f64,
    /// Means of all columns in the most probable of them, usual sizes …
    means: DVector<f64>,
    /// … and their covariance.
    covariance: DMatrix<f64>,
}

/// One way in which everything may be off.
struct Way {
    log: f64,
    cell: f64,
    noise: f64,
    sds: DVector<f64>,
}

impl Many {
    /// Of rows whose noise is told by `source` and whose gap is so large (floors). `None` where nothing is looked through.
    ///
    /// # Errors
    /// Cancelled.
    pub fn of(
        ground: &Ground,
        source: FloorSource,
        gap: f64,
        context: &dyn JobContext,
    ) -> Result<Option<Self>, GapError> {
        let mut ways: Vec<Way> = vec![];
        let mut framed: Option<(f64, Framed)> = None;
        for variant in variants(source, gap) {
            if framed.as_ref().is_none_or(|(cell, _)| *cell != variant.cell) {
                framed = Framed::of(&ground.sums, variant.cell * variant.cell, &ground.present, context)?
                    .map(|one| (variant.cell, one));
            }
            let Some((_, framed)) = &framed else { continue };
            for share in SHARES {
                context.checkpoint()?;
                let sds = ground.sds(share, variant.size, variant.most);
                let Some(own) = framed.log_evidence(variant, &sds) else { continue };
                let log = own + variant.log_prior - (SHARES.len() as f64).ln();
                ways.push(Way { log, cell: variant.cell, noise: variant.noise, sds });
            }
        }
        let log_evidence = log_sum(ways.iter().map(|way| way.log));
        let Some(best) = ways.iter().max_by(|a, b| a.log.total_cmp(&b.log)) else { return Ok(None) };
        let framed = Framed::of(&ground.sums, best.cell * best.cell, &ground.present, context)?;
        let values = framed.and_then(|framed| best.values(&framed));
        Ok(values.map(|(means, covariance)| Self { log_evidence, means, covariance }))
    }

    /// How probable it is beside the sets that were looked through.
    pub fn probability(&self, explored: &Explored) -> f64 {
        let few = explored.models.iter().map(|model| model.log_score).fold(f64::NEG_INFINITY, f64::max);
        let odds = (self.log_evidence - few) / TEMPERATURE + (BEFOREHAND / (1.0 - BEFOREHAND)).ln();
        1.0 / (1.0 + (-odds).exp())
    }

    /// How probable it is by the number of names alone: few effects are seldom so many, and a search that is made for few
    /// ends before it has named a crowd.
    pub fn probability_by_names(names: usize) -> f64 {
        let most = NAMES_OF_MANY.len() - 1;
        let few = Poisson::new(EXPECTED_OF_FEW)
            .map_or(1.0, |few| if names < most { few.pmf(names as u64) } else { few.sf(most as u64 - 1) });
        let many = BEFOREHAND * NAMES_OF_MANY[names.min(most)];
        many / (many + (1.0 - BEFOREHAND) * few)
    }

    /// Values of columns (usual sizes) and their covariance, widened by this factor of the standard deviation.
    fn values(&self, columns: &[usize], wider: f64) -> (DVector<f64>, DMatrix<f64>) {
        let count = columns.len();
        let covariance = |r: usize, c: usize| self.covariance[(columns[r], columns[c])] * wider * wider;
        (DVector::from_fn(count, |k, _| self.means[columns[k]]), DMatrix::from_fn(count, count, covariance))
    }
}

/// How probable it is that values stand out of what all the others may do in their place.
fn stands_out(values: &DVector<f64>, covariance: &DMatrix<f64>) -> Option<f64> {
    // How far they are from none: a χ² of as many degrees of freedom.
    let square = values.dot(&Cholesky::new(covariance.clone())?.solve(values));
    let by_chance = 1.0 - ChiSquared::new(values.len() as f64).ok()?.cdf(square);
    (by_chance < STANDS_OUT_P).then_some(1.0 - by_chance)
}

impl Evidence<'_> {
    /// How probable it is that a block does something where everything is off: zero where what others may do in its place
    /// does not let it stand out. One of every site never does: that many sites are a little off is what everything is
    /// already (of 240 such arms of development and of judging, 20 had such a name beyond doubt, and none of those was there).
    pub(super) fn stands_out_of(&self, many: &Many, block: usize) -> f64 {
        let own = &self.look.blocks[block];
        if own.is_family {
            return 0.0;
        }
        let is_one = |other: &&usize| {
            let columns = &self.look.packed[**other];
            let same = self.look.blocks[**other].name == own.name;
            same && **other < self.look.effects && columns.len > 0 && self.look.ground.dirty[columns.start]
        };
        let ones = self.look.allowed.iter().filter(is_one);
        let columns: Vec<usize> = ones.flat_map(|&one| self.look.packed[one].columns()).collect();
        let (values, covariance) = many.values(&columns, own.wider());
        let has = |is: fn(What) -> bool| self.floor.kinds.iter().any(|kind| is(kind.what));
        let touched = has(|what| what == What::Touch) && !has(What::is_pose);
        let most = if touched && own.kind.is_some_and(Kind::is_origin) { GEOMETRY_BY_TOUCHES } else { 1.0 };
        most * stands_out(&values, &covariance).unwrap_or(0.0)
    }
}

impl Ground {
    /// Standard deviations of everything, usual sizes: a share of what an effect may be in a variant.
    fn sds(&self, share: f64, size: f64, most: f64) -> DVector<f64> {
        DVector::from_fn(self.sizes.len(), |c, _| {
            let own = share / (most.powi(-2) + (self.sizes[c] / size).powi(2)).sqrt();
            if self.dirty[c] { own.max(self.always[c]) } else { 0.0 }
        })
    }
}

impl Way {
    /// Means and covariance of all columns, usual sizes; zero where nothing is.
    fn values(&self, framed: &Framed) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let (sds, noise) = (&self.sds, self.noise.powi(-2));
        let k = sds.len();
        let mut normal = DMatrix::from_fn(k, k, |r, c| framed.a[(r, c)] * noise * sds[r] * sds[c]);
        (0..k).for_each(|c| normal[(c, c)] += 1.0);
        let normal = Cholesky::new(normal)?;
        let b = framed.b.component_mul(sds) * noise;
        let means = normal.solve(&b).component_mul(sds);
        let inverse = normal.inverse();
        Some((means, DMatrix::from_fn(k, k, |r, c| inverse[(r, c)] * sds[r] * sds[c])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_names_speak_for_few_and_many_for_many() {
        let by_names: Vec<f64> = (0..9).map(Many::probability_by_names).collect();
        assert!(by_names[..4].iter().all(|p| *p < 0.3), "{by_names:?}");
        assert!(by_names[5..].iter().all(|p| *p > 0.9), "{by_names:?}");
        assert!(by_names.is_sorted(), "{by_names:?}");
    }

    #[test]
    fn what_others_may_do_in_its_place_does_not_stand_out() {
        let stands_out = |values: [f64; 2], covariance: &DMatrix<f64>| {
            stands_out(&DVector::from_column_slice(&values), covariance)
        };
        let apart = DMatrix::from_diagonal(&DVector::from_vec(vec![0.01, 0.01]));
        assert!(stands_out([0.5, 0.1], &apart).is_some_and(|p| p > 0.99));
        assert!(stands_out([0.1, -0.1], &apart).is_none());
        // Two values of which only the sum is known.
        let sum = DMatrix::from_row_slice(2, 2, &[1.0, -0.999, -0.999, 1.0]);
        assert!(stands_out([0.5, -0.5], &sum).is_none());
        assert!(stands_out([0.5, 0.5], &sum).is_some());
    }
}
