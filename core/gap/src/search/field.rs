//! Evidence of any set of blocks, from sums whose size does not depend on the number of rows.
//!
//! The frame of each session is integrated out under a wide prior, small amounts of everything
//! under a narrow one ("dirt"), and an own amount of every cell. What is left for a set S of
//! blocks with standard-normal parameters is, up to a constant of the variant,
//!   log p(y|S) = ½ bᵀ(1 + A)⁻¹b − ½ log det(1 + A)
//! with A and b of the columns of S. What cannot be negative has half of that normal density, twice as high: its
//! evidence has 2Φ of mean over standard deviation more, and what fits with the wrong sign only is ruled out.

use std::cell::OnceCell;
use std::sync::Arc;

use nalgebra::{Cholesky, DMatrix, DVector};

use plumbline_effects::Kind;
use plumbline_model::JobContext;

use super::library::Block;
use super::linear::{Sums, gram_of};
use crate::error::GapError;
use crate::statistics::ln_not_negative;

/// Dirt is at most this share of a usual size.
const LARGEST_DIRT: f64 = 0.1;

/// How noise and prior sizes are taken to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Variant {
    /// The floor's standard deviation times this is the noise.
    pub noise: f64,
    /// Each cell is off by its own amount of this standard deviation, in units of the noise.
    pub cell: f64,
    /// Small amounts of everything, together this large, in units of the floor.
    pub dirt: f64,
    /// How large an effect of these sessions is, in units of the floor …
    pub size: f64,
    /// … and in usual sizes at most: where effects are large, some are larger than usual.
    pub most: f64,
    /// Logarithm of how probable this is beforehand.
    pub log_prior: f64,
}

/// A variant with everything worked out but the set.
pub(super) struct Field {
    pub variant: Variant,
    /// Columns per usual size, noise, cells and dirt taken in; shared by variants of the same.
    shared: Arc<Dirtied>,
    /// Standard deviation of each column's parameter beforehand, in usual sizes.
    scale: Vec<f64>,
    /// Columns of parameters that are never negative.
    one_sided: Vec<bool>,
    /// Evidence of the empty set and the variant's prior.
    constant: f64,
}

/// With noise, cells and dirt taken in.
pub(super) struct Dirtied {
    a: DMatrix<f64>,
    b: DVector<f64>,
    log_evidence: f64,
    /// Sum of squares of the residual in units of noise, cells and dirt.
    square: f64,
}

/// What does not depend on a variant's sizes: frames integrated out.
pub(super) struct Framed {
    pub a: DMatrix<f64>,
    pub b: DVector<f64>,
    /// Weighted sum of squares of the residual with every effect absent, frames fitted.
    pub square: f64,
    /// Log determinants.
    logs: f64,
    gauge: f64,
    total: f64,
}

impl Variant {
    /// How much of every column is there as dirt, usual sizes. `sizes`: root mean square per column, of plain weights;
    /// `dirty`: columns that dirt is made of; `always`: what is there at least, usual sizes.
    pub fn narrow(&self, sizes: &[f64], dirty: &[bool], always: &[f64]) -> DVector<f64> {
        let kinds = dirty.iter().filter(|dirty| **dirty).count().max(1) as f64;
        DVector::from_fn(sizes.len(), |c, _| {
            let is_there = dirty[c] && sizes[c] > 1e-9;
            let own = || (self.dirt / kinds.sqrt() / sizes[c]).min(LARGEST_DIRT).max(always[c]);
            if is_there { own() } else { 0.0 }
        })
    }
}

impl Framed {
    /// Of sums, when cells are off by this variance; `present` are values (usual sizes) that the
    /// residual was taken at, by column: they are put back. `None` where frames cannot be told.
    ///
    /// # Errors
    /// Cancelled.
    pub fn of(
        sums: &Sums,
        cell_variance: f64,
        present: &DVector<f64>,
        context: &dyn JobContext,
    ) -> Result<Option<Self>, GapError> {
        let (gram, log_det) = sums.gram(cell_variance, context)?;
        let last = gram.ncols() - 1;
        let g = sums.gauge;
        let k = last - g;
        let mut b = gram.view((0, last), (last, 1)).clone_owned();
        let mut square = gram[(last, last)];
        let effects = gram.view((0, g), (last, k));
        let back = effects * present;
        square += 2.0 * present.dot(&b.rows(g, k).column(0)) + present.dot(&back.rows(g, k).column(0));
        b += back;
        let priors = DVector::from_iterator(g, sums.nuisances.iter().map(|nuisance| nuisance.prior_sd()));
        let gauge = gram.view((0, 0), (g, g)) + DMatrix::from_diagonal(&priors.map(|sd| 1.0 / (sd * sd)));
        let Some(gauge) = Cholesky::new(gauge) else { return Ok(None) };
        let mixed = gram.view((0, g), (g, k)).clone_owned();
        let solved = gauge.solve(&mixed);
        let turned = gauge.solve(&b.rows(0, g).clone_owned());
        let a = gram.view((g, g), (k, k)) - mixed.tr_mul(&solved);
        let own = DVector::from_column_slice(b.rows(g, k).clone_owned().as_slice());
        let b_effects = own - mixed.tr_mul(&turned).column(0);
        square -= b.rows(0, g).column(0).dot(&turned.column(0));
        let logs = log_det + gauge.ln_determinant() + 2.0 * priors.map(f64::ln).sum();
        Ok(Some(Self {
            a: 0.5 * (&a + a.transpose()),
            b: b_effects,
            square,
            logs,
            gauge: g as f64,
            total: sums.total,
        }))
    }

    /// Root mean square of what a usual size of each column does to the rows, in floors.
    pub fn sizes(&self) -> Vec<f64> {
        (0..self.a.ncols()).map(|k| (self.a[(k, k)].max(0.0) / self.total).sqrt()).collect()
    }

    /// Evidence of nothing but the noise of a variant, log.
    fn bare(&self, variant: Variant) -> f64 {
        let noise = 1.0 / (variant.noise * variant.noise);
        -0.5 * (noise * self.square + self.logs + self.gauge * noise.ln()) - self.total * variant.noise.ln()
    }

    /// Evidence of the noise of a variant and so much of every column (standard deviation, usual sizes), log.
    pub fn log_evidence(&self, variant: Variant, sds: &DVector<f64>) -> Option<f64> {
        let noise = 1.0 / (variant.noise * variant.noise);
        let there: Vec<usize> = (0..sds.len()).filter(|&c| sds[c] > 0.0).collect();
        let mut inner = DMatrix::from_fn(there.len(), there.len(), |r, c| {
            self.a[(there[r], there[c])] * noise * sds[there[r]] * sds[there[c]]
        });
        inner.fill_diagonal_add(1.0);
        let inner = Cholesky::new(inner)?;
        let b = DVector::from_fn(there.len(), |r, _| self.b[there[r]] * noise * sds[there[r]]);
        Some(self.bare(variant) + 0.5 * (b.dot(&inner.solve(&b)) - inner.ln_determinant()))
    }

    /// With the noise of a variant and so much of every column (standard deviation, usual sizes) taken in. `None` where
    /// numbers are beyond what can be worked out.
    ///
    /// # Errors
    /// Cancelled.
    pub fn dirtied(
        &self,
        variant: Variant,
        narrow: &DVector<f64>,
        context: &dyn JobContext,
    ) -> Result<Option<Dirtied>, GapError> {
        let k = self.a.ncols();
        let noise = 1.0 / (variant.noise * variant.noise);
        let small: Vec<usize> = (0..k).filter(|&c| narrow[c] > 0.0).collect();
        let mut log_evidence = self.bare(variant);
        let (mut a, mut b, mut square) = (&self.a * noise, &self.b * noise, self.square * noise);
        if !small.is_empty() {
            let half = DMatrix::from_fn(small.len(), k, |r, c| a[(small[r], c)] * narrow[small[r]]);
            let mut inner =
                DMatrix::from_fn(small.len(), small.len(), |r, c| half[(r, small[c])] * narrow[small[c]]);
            inner.fill_diagonal_add(1.0);
            let Some(inner) = Cholesky::new(inner) else { return Ok(None) };
            context.checkpoint()?;
            let narrow_b = DVector::from_fn(small.len(), |r, _| b[small[r]] * narrow[small[r]]);
            let lower = inner.l();
            let Some(right) = lower.solve_lower_triangular(&half) else { return Ok(None) };
            let Some(turned) = lower.solve_lower_triangular(&narrow_b) else { return Ok(None) };
            a -= gram_of(&right, context)?;
            b -= right.tr_mul(&turned);
            log_evidence += 0.5 * (turned.norm_squared() - inner.ln_determinant());
            square -= turned.norm_squared();
        }
        Ok(Some(Dirtied { a, b, log_evidence, square }))
    }
}

impl Field {
    /// With the sizes of a variant.
    pub fn new(variant: Variant, shared: Arc<Dirtied>, blocks: &[Block], sizes: &[f64]) -> Self {
        let mut scale = vec![1.0; sizes.len()];
        let mut one_sided = vec![false; sizes.len()];
        for block in blocks {
            for c in block.columns() {
                one_sided[c] = block.is_one_sided;
                let reach = sizes[c] * (block.len as f64).sqrt();
                // Nobody logs an angle more than all of the way too early.
                let most = if block.kind == Some(Kind::EarlyLog) { 1.0 } else { variant.most };
                scale[c] = 1.0 / (most.powi(-2) + (reach / variant.size).powi(2)).sqrt();
            }
        }
        let constant = shared.log_evidence + variant.log_prior;
        Self { variant, shared, scale, one_sided, constant }
    }

    fn a(&self, r: usize, c: usize) -> f64 {
        self.shared.a[(r, c)] * self.scale[r] * self.scale[c]
    }

    fn b(&self, c: usize) -> f64 {
        self.shared.b[c] * self.scale[c]
    }
}

trait AddDiagonal {
    fn fill_diagonal_add(&mut self, value: f64);
}

impl AddDiagonal for DMatrix<f64> {
    fn fill_diagonal_add(&mut self, value: f64) {
        for k in 0..self.nrows() {
            self[(k, k)] += value;
        }
    }
}

/// A parameter that is never negative.
struct OneSided {
    /// Its place in the set.
    place: usize,
    mean: f64,
    variance: f64,
    /// What being never negative adds to the evidence.
    adds: f64,
}

/// Of a set: (1 + A)⁻¹, and the means of its parameters.
type Solved = (DMatrix<f64>, DVector<f64>);

/// A field given that some blocks are present.
pub(super) struct Given<'a> {
    field: &'a Field,
    columns: Vec<usize>,
    solved: Option<Solved>,
    /// (1 + A)⁻¹A with all columns: only where more blocks are tried beside the set.
    following: OnceCell<DMatrix<f64>>,
    /// Those of its parameters that are never negative.
    one_sided: Vec<OneSided>,
    /// Evidence of the set.
    pub log_evidence: f64,
}

impl Field {
    /// Given the blocks of a set.
    pub fn given<'a>(&'a self, set: &[usize], blocks: &[Block]) -> Given<'a> {
        let columns: Vec<usize> = set.iter().flat_map(|&block| blocks[block].columns()).collect();
        let following = OnceCell::new();
        if columns.is_empty() {
            let log_evidence = self.constant;
            return Given { field: self, columns, solved: None, following, one_sided: vec![], log_evidence };
        }
        let mut own = DMatrix::from_fn(columns.len(), columns.len(), |r, c| self.a(columns[r], columns[c]));
        own.fill_diagonal_add(1.0);
        let b = DVector::from_iterator(columns.len(), columns.iter().map(|&c| self.b(c)));
        let Some(cholesky) = Cholesky::new(own) else {
            let log_evidence = f64::NEG_INFINITY;
            return Given { field: self, columns, solved: None, following, one_sided: vec![], log_evidence };
        };
        // Every parameter has a variance beforehand, so the inverse is as good as a solution column by column, and
        // its product with all columns several times faster.
        let inverse = cholesky.inverse();
        let means = &inverse * &b;
        let places = (0..columns.len()).filter(|&k| self.one_sided[columns[k]]);
        let of_place = |place: usize| {
            let (mean, variance) = (means[place], inverse[(place, place)]);
            OneSided { place, mean, variance, adds: ln_not_negative(mean, variance) }
        };
        let one_sided: Vec<OneSided> = places.map(of_place).collect();
        let halves: f64 = one_sided.iter().map(|one| one.adds).sum();
        let log_evidence = self.constant + 0.5 * (b.dot(&means) - cholesky.ln_determinant()) + halves;
        Given { field: self, columns, solved: Some((inverse, means)), following, one_sided, log_evidence }
    }
}

impl Given<'_> {
    /// How much evidence one more block adds.
    pub fn adds(&self, block: &Block) -> f64 {
        if block.len == 1 {
            let (a, b) = (self.rest(block.start, block.start), self.rest_b(block.start));
            let one = (1.0 + a).max(1e-12);
            let (mean, variance) = (b / one, 1.0 / one);
            let own = if block.is_one_sided { ln_not_negative(mean, variance) } else { 0.0 };
            let moved = |k: usize| {
                let along = self.along(k, block.start);
                (along * mean, along * along * variance)
            };
            return 0.5 * (b * b / one - one.ln()) + own + self.halves_with(moved);
        }
        let at = block.start;
        // A Cholesky decomposition reads nothing above the diagonal.
        let lower = |r: usize, c: usize| if r < c { 0.0 } else { self.rest(at + r, at + c) };
        let mut own = DMatrix::from_fn(block.len, block.len, lower);
        own.fill_diagonal_add(1.0);
        let b = DVector::from_fn(block.len, |r, _| self.rest_b(at + r));
        let Some(own) = Cholesky::new(own) else { return f64::NEG_INFINITY };
        let means = own.solve(&b);
        let log = 0.5 * (b.dot(&means) - own.ln_determinant());
        if self.one_sided.is_empty() {
            return log;
        }
        let inverse = own.inverse();
        let moved = |k: usize| {
            let along = DVector::from_fn(block.len, |c, _| self.along(k, at + c));
            (along.dot(&means), along.dot(&(&inverse * &along)))
        };
        log + self.halves_with(moved)
    }

    /// How parameters of the set follow those of all columns.
    fn following(&self) -> Option<&DMatrix<f64>> {
        let (inverse, _) = self.solved.as_ref()?;
        let columns = &self.columns;
        let made = || {
            let count = self.field.scale.len();
            inverse * DMatrix::from_fn(columns.len(), count, |r, c| self.field.a(columns[r], c))
        };
        Some(self.following.get_or_init(made))
    }

    /// How a parameter of the set follows one of another column.
    fn along(&self, k: usize, column: usize) -> f64 {
        self.following().map_or(0.0, |following| following[(k, column)])
    }

    /// How the evidence of the set's one-sided parameters changes when another block moves their means back and
    /// widens their variances by so much.
    fn halves_with(&self, moved: impl Fn(usize) -> (f64, f64)) -> f64 {
        let change = |one: &OneSided| {
            let (back, wider) = moved(one.place);
            ln_not_negative(one.mean - back, one.variance + wider) - one.adds
        };
        self.one_sided.iter().map(change).sum()
    }

    /// A of two columns when the set is there already.
    fn rest(&self, r: usize, c: usize) -> f64 {
        let own = self.field.a(r, c);
        self.following().map_or(own, |following| {
            let explained = self
                .columns
                .iter()
                .enumerate()
                .map(|(i, &column)| self.field.a(r, column) * following[(i, c)]);
            own - explained.sum::<f64>()
        })
    }

    fn rest_b(&self, r: usize) -> f64 {
        let own = self.field.b(r);
        self.solved.as_ref().map_or(own, |(_, means)| {
            own - self
                .columns
                .iter()
                .zip(means.iter())
                .map(|(&column, mean)| self.field.a(r, column) * mean)
                .sum::<f64>()
        })
    }

    /// Sum of squares that the set leaves, in units of noise, cells and dirt.
    pub fn square_left(&self) -> f64 {
        let explained = self.solved.as_ref().map_or(0.0, |(_, means)| {
            self.columns.iter().zip(means.iter()).map(|(&c, mean)| self.field.b(c) * mean).sum()
        });
        self.field.shared.square - explained
    }

    /// Means of the set's parameters and their covariance, in usual sizes.
    pub fn values(&self) -> (DVector<f64>, DMatrix<f64>) {
        let Some((inverse, means)) = &self.solved else {
            return (DVector::zeros(0), DMatrix::zeros(0, 0));
        };
        let scale =
            DVector::from_iterator(self.columns.len(), self.columns.iter().map(|&c| self.field.scale[c]));
        let mut covariance = inverse.clone();
        for k in 0..scale.len() {
            covariance.column_mut(k).scale_mut(scale[k]);
            covariance.row_mut(k).scale_mut(scale[k]);
        }
        (means.component_mul(&scale), covariance)
    }

    /// Covariance (usual sizes) were each parameter as large as usual beforehand, or as the variant has it where that
    /// is more. What effects of these sessions do to the rows says nothing of a direction in which two parameters
    /// do next to nothing together: there the interval is as wide as what is usual.
    pub fn wide(&self) -> DMatrix<f64> {
        let count = self.columns.len();
        let sd = self.field.variant.most.max(1.0);
        let a = &self.field.shared.a;
        let mut normal = DMatrix::from_fn(count, count, |r, c| a[(self.columns[r], self.columns[c])]);
        normal.fill_diagonal_add(sd.powi(-2));
        Cholesky::new(normal).map_or_else(|| DMatrix::identity(count, count) * (sd * sd), |n| n.inverse())
    }
}

/// log Σ exp.
pub(super) fn log_sum(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let most = values.clone().fold(f64::NEG_INFINITY, f64::max);
    if !most.is_finite() {
        return most;
    }
    most + values.map(|value| (value - most).exp()).sum::<f64>().ln()
}

#[cfg(test)]
mod tests {
    use plumbline_model::Unattended;

    use super::*;

    fn block(start: usize, is_one_sided: bool) -> Block {
        Block {
            start,
            len: 1,
            kind: None,
            is_family: false,
            is_of_all: false,
            is_one_sided,
            grows: None,
            name: start,
            log_prior: 0.0,
        }
    }

    /// Three columns that look partly alike; the first fits with this pull.
    fn field(pull: f64, one_sided: [bool; 3]) -> (Field, Vec<Block>) {
        let a = DMatrix::from_row_slice(3, 3, &[9.0, 4.0, 2.0, 4.0, 16.0, -3.0, 2.0, -3.0, 4.0]);
        let b = DVector::from_vec(vec![pull, 5.0, -2.0]);
        let shared = Arc::new(Dirtied { a, b, log_evidence: 0.0, square: 100.0 });
        let blocks: Vec<Block> = (0..3).map(|k| block(k, one_sided[k])).collect();
        let variant = Variant { noise: 1.0, cell: 0.0, dirt: 0.0, size: 3.0, most: 1.0, log_prior: 0.0 };
        (Field::new(variant, shared, &blocks, &[3.0, 4.0, 2.0]), blocks)
    }

    #[test]
    fn a_block_adds_the_same_evidence_whichever_way_its_set_is_reached() {
        for one_sided in [[false; 3], [true, false, true], [true; 3]] {
            for pull in [-20.0, 3.0, 20.0] {
                let (field, blocks) = field(pull, one_sided);
                for (base, more) in [(vec![0, 1], 2), (vec![1, 2], 0), (vec![0], 1)] {
                    let mut all = base.clone();
                    all.push(more);
                    all.sort_unstable();
                    let given = field.given(&base, &blocks);
                    let whole = field.given(&all, &blocks).log_evidence;
                    let step = given.log_evidence + given.adds(&blocks[more]);
                    assert!((whole - step).abs() < 1e-8, "{one_sided:?} {pull} {base:?}: {whole} {step}");
                }
            }
        }
    }

    #[test]
    fn evidence_alone_is_that_of_everything_taken_in() {
        let a = DMatrix::from_row_slice(3, 3, &[9.0, 4.0, 2.0, 4.0, 16.0, -3.0, 2.0, -3.0, 4.0]);
        let b = DVector::from_vec(vec![7.0, 5.0, -2.0]);
        let framed = Framed { a, b, square: 100.0, logs: 1.5, gauge: 2.0, total: 40.0 };
        let variant = Variant { noise: 0.7, cell: 0.0, dirt: 0.0, size: 3.0, most: 1.0, log_prior: 0.0 };
        for sds in [[0.0; 3], [0.3, 0.0, 0.8], [0.1, 0.2, 0.4]] {
            let sds = DVector::from_column_slice(&sds);
            let taken = framed.dirtied(variant, &sds, &Unattended).expect("not cancelled");
            let taken = taken.expect("can be taken in").log_evidence;
            let alone = framed.log_evidence(variant, &sds).expect("has evidence");
            assert!((taken - alone).abs() < 1e-9, "{sds}: {taken} {alone}");
        }
    }

    #[test]
    fn what_gives_way_against_its_load_is_no_explanation() {
        let evidence = |pull: f64, sided: bool| {
            let (field, blocks) = field(pull, [sided, false, false]);
            field.given(&[0], &blocks).log_evidence
        };
        assert!(evidence(-20.0, false) > 1.0, "it would explain something");
        assert!(evidence(-20.0, true) < 0.0, "{}", evidence(-20.0, true));
        assert!((evidence(20.0, true) - evidence(20.0, false) - 2_f64.ln()).abs() < 1e-3);
    }
}
