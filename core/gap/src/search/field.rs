//! Evidence of any set of blocks, from sums whose size does not depend on the number of rows.
//!
//! The frame of each session is integrated out under a wide prior, small amounts of everything
//! under a narrow one ("dirt"), and an own amount of every cell. What is left for a set S of
//! blocks with standard-normal parameters is, up to a constant of the variant,
//!   log p(y|S) = ½ bᵀ(1 + A)⁻¹b − ½ log det(1 + A)
//! with A and b of the columns of S.

use std::sync::Arc;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::library::Block;
use super::linear::Sums;

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
    /// How large an effect of these sessions is, in units of the floor; none is larger beforehand
    /// than its usual size.
    pub size: f64,
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

impl Framed {
    /// Of sums, when cells are off by this variance; `present` are values (usual sizes) that the
    /// residual was taken at, by column: they are put back.
    pub fn of(sums: &Sums, cell_variance: f64, present: &DVector<f64>) -> Option<Self> {
        let (gram, log_det) = sums.gram(cell_variance);
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
        let gauge = Cholesky::new(gauge)?;
        let mixed = gram.view((0, g), (g, k)).clone_owned();
        let solved = gauge.solve(&mixed);
        let turned = gauge.solve(&b.rows(0, g).clone_owned());
        let a = gram.view((g, g), (k, k)) - mixed.tr_mul(&solved);
        let own = DVector::from_column_slice(b.rows(g, k).clone_owned().as_slice());
        let b_effects = own - mixed.tr_mul(&turned).column(0);
        square -= b.rows(0, g).column(0).dot(&turned.column(0));
        let logs = log_det + gauge.ln_determinant() + 2.0 * priors.map(f64::ln).sum();
        Some(Self {
            a: 0.5 * (&a + a.transpose()),
            b: b_effects,
            square,
            logs,
            gauge: g as f64,
            total: sums.total,
        })
    }

    /// Root mean square of what a usual size of each column does to the rows, in floors.
    pub fn sizes(&self) -> Vec<f64> {
        (0..self.a.ncols()).map(|k| (self.a[(k, k)].max(0.0) / self.total).sqrt()).collect()
    }

    /// With noise and dirt of a variant taken in. `sizes`: root mean square per column, of plain
    /// weights; `dirty`: columns that dirt is made of.
    pub fn dirtied(
        &self,
        variant: Variant,
        blocks: &[Block],
        sizes: &[f64],
        dirty: &[bool],
    ) -> Option<Dirtied> {
        let k = self.a.ncols();
        let noise = 1.0 / (variant.noise * variant.noise);
        let kinds = dirty.iter().filter(|dirty| **dirty).count().max(1) as f64;
        let mut narrow = DVector::zeros(k);
        for c in blocks.iter().flat_map(Block::columns).filter(|&c| dirty[c] && sizes[c] > 1e-9) {
            narrow[c] = (variant.dirt / kinds.sqrt() / sizes[c]).min(LARGEST_DIRT);
        }
        let small: Vec<usize> = (0..k).filter(|&c| narrow[c] > 0.0).collect();
        let mut log_evidence = -0.5 * (noise * self.square + self.logs + self.gauge * noise.ln())
            - self.total * variant.noise.ln();
        let (mut a, mut b, mut square) = (&self.a * noise, &self.b * noise, self.square * noise);
        if !small.is_empty() {
            let half = DMatrix::from_fn(small.len(), k, |r, c| a[(small[r], c)] * narrow[small[r]]);
            let mut inner =
                DMatrix::from_fn(small.len(), small.len(), |r, c| half[(r, small[c])] * narrow[small[c]]);
            inner.fill_diagonal_add(1.0);
            let inner = Cholesky::new(inner)?;
            let narrow_b = DVector::from_fn(small.len(), |r, _| b[small[r]] * narrow[small[r]]);
            let lower = inner.l();
            let right = lower.solve_lower_triangular(&half)?;
            let turned = lower.solve_lower_triangular(&narrow_b)?;
            a -= right.tr_mul(&right);
            b -= right.tr_mul(&turned);
            log_evidence += 0.5 * (turned.norm_squared() - inner.ln_determinant());
            square -= turned.norm_squared();
        }
        Some(Dirtied { a, b, log_evidence, square })
    }
}

impl Field {
    /// With the sizes of a variant.
    pub fn new(variant: Variant, shared: Arc<Dirtied>, blocks: &[Block], sizes: &[f64]) -> Self {
        let mut scale = vec![1.0; sizes.len()];
        for block in blocks {
            for c in block.columns() {
                let reach = sizes[c] * (block.len as f64).sqrt();
                scale[c] = 1.0 / (1.0 + (reach / variant.size).powi(2)).sqrt();
            }
        }
        let constant = shared.log_evidence + variant.log_prior;
        Self { variant, shared, scale, constant }
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

/// 1 + A of a set, (1 + A)⁻¹A with all columns, and the means of its parameters.
type Solved = (Cholesky<f64, Dyn>, DMatrix<f64>, DVector<f64>);

/// A field given that some blocks are present.
pub(super) struct Given<'a> {
    field: &'a Field,
    columns: Vec<usize>,
    solved: Option<Solved>,
    /// Evidence of the set.
    pub log_evidence: f64,
}

impl Field {
    /// Given the blocks of a set.
    pub fn given<'a>(&'a self, set: &[usize], blocks: &[Block]) -> Given<'a> {
        let columns: Vec<usize> = set.iter().flat_map(|&block| blocks[block].columns()).collect();
        if columns.is_empty() {
            return Given { field: self, columns, solved: None, log_evidence: self.constant };
        }
        let mut own = DMatrix::from_fn(columns.len(), columns.len(), |r, c| self.a(columns[r], columns[c]));
        own.fill_diagonal_add(1.0);
        let b = DVector::from_iterator(columns.len(), columns.iter().map(|&c| self.b(c)));
        match Cholesky::new(own) {
            Some(cholesky) => {
                let means = cholesky.solve(&b);
                let rows = DMatrix::from_fn(columns.len(), self.scale.len(), |r, c| self.a(columns[r], c));
                let solved = cholesky.solve(&rows);
                let log_evidence = self.constant + 0.5 * (b.dot(&means) - cholesky.ln_determinant());
                Given { field: self, columns, solved: Some((cholesky, solved, means)), log_evidence }
            }
            None => Given { field: self, columns, solved: None, log_evidence: f64::NEG_INFINITY },
        }
    }
}

impl Given<'_> {
    /// How much evidence one more block adds.
    pub fn adds(&self, block: &Block) -> f64 {
        if block.len == 1 {
            let (a, b) = (self.rest(block.start, block.start), self.rest_b(block.start));
            let one = (1.0 + a).max(1e-12);
            return 0.5 * (b * b / one - one.ln());
        }
        let at = block.start;
        let mut own = DMatrix::from_fn(block.len, block.len, |r, c| self.rest(at + r, at + c));
        own.fill_diagonal_add(1.0);
        let b = DVector::from_fn(block.len, |r, _| self.rest_b(at + r));
        Cholesky::new(own)
            .map_or(f64::NEG_INFINITY, |own| 0.5 * (b.dot(&own.solve(&b)) - own.ln_determinant()))
    }

    /// A of two columns when the set is there already.
    fn rest(&self, r: usize, c: usize) -> f64 {
        let own = self.field.a(r, c);
        self.solved.as_ref().map_or(own, |(_, solved, _)| {
            let explained =
                self.columns.iter().enumerate().map(|(i, &column)| self.field.a(r, column) * solved[(i, c)]);
            own - explained.sum::<f64>()
        })
    }

    fn rest_b(&self, r: usize) -> f64 {
        let own = self.field.b(r);
        self.solved.as_ref().map_or(own, |(_, _, means)| {
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
        let explained = self.solved.as_ref().map_or(0.0, |(_, _, means)| {
            self.columns.iter().zip(means.iter()).map(|(&c, mean)| self.field.b(c) * mean).sum()
        });
        self.field.shared.square - explained
    }

    /// Means of the set's parameters and their covariance, in usual sizes.
    pub fn values(&self) -> (DVector<f64>, DMatrix<f64>) {
        let Some((cholesky, _, means)) = &self.solved else {
            return (DVector::zeros(0), DMatrix::zeros(0, 0));
        };
        let scale =
            DVector::from_iterator(self.columns.len(), self.columns.iter().map(|&c| self.field.scale[c]));
        let mut covariance = cholesky.inverse();
        for k in 0..scale.len() {
            covariance.column_mut(k).scale_mut(scale[k]);
            covariance.row_mut(k).scale_mut(scale[k]);
        }
        (means.component_mul(&scale), covariance)
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
