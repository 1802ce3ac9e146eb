//! What the spread of repeats loses when it is fitted by something that was logged.

use nalgebra::{Cholesky, DMatrix, DVector};

use crate::statistics::f_tail;

/// Fewer deviations than this say nothing.
pub const FEWEST: usize = 40;
/// A dependence counts from this probability by chance on, all that were tried together.
pub const SIGNIFICANT: f64 = 1e-4;
/// A coordinate with less than this share of the widest one's squares does not spread (a height that follows
/// from the command).
const LEAST_SPREAD: f64 = 1e-4;
/// Keeps columns that are alike from being solved for.
const RIDGE: f64 = 1e-9;

/// Deviations of rows from the mean of their cell, one row each.
pub struct Spread {
    values: DMatrix<f64>,
    /// Degrees of freedom.
    free: f64,
    /// Squares of each coordinate.
    before: Vec<f64>,
    /// Coordinates that spread.
    pub counted: Vec<usize>,
}

/// What a fit leaves of it.
pub struct Left<'a> {
    of: &'a Spread,
    /// Squares of each coordinate.
    after: Vec<f64>,
    used: f64,
}

impl Spread {
    /// Of deviations with so many degrees of freedom.
    pub fn new(values: DMatrix<f64>, free: f64) -> Self {
        let before: Vec<f64> = values.column_iter().map(|column| column.norm_squared()).collect();
        let widest = before.iter().copied().fold(0.0, f64::max);
        let counted = (0..before.len()).filter(|&c| before[c] > LEAST_SPREAD * widest).collect();
        Self { values, free, before, counted }
    }

    /// Degrees of freedom of each coordinate.
    pub fn free(&self) -> f64 {
        self.free
    }

    /// Standard deviation of each coordinate.
    pub fn scales(&self) -> Vec<f64> {
        self.before.iter().map(|square| (square / self.free).sqrt().max(1e-300)).collect()
    }

    /// Coordinates that spread, one after the other, in units of their spread.
    pub fn whitened(&self) -> DVector<f64> {
        let (rows, scales) = (self.values.nrows(), self.scales());
        DVector::from_fn(rows * self.counted.len(), |at, _| {
            let c = self.counted[at / rows];
            self.values[(at % rows, c)] / scales[c]
        })
    }

    /// [`Left::shares`] of what a fit left of [`Self::whitened`], with so many parameters of each coordinate.
    pub fn shares_of(&self, left: &DVector<f64>, used: f64) -> Vec<f64> {
        let rows = self.values.nrows();
        let mut shares = vec![1.0; self.before.len()];
        for (k, &c) in self.counted.iter().enumerate() {
            let after = left.rows(k * rows, rows).norm_squared();
            shares[c] = (after / (self.free - used).max(1.0)).min(1.0);
        }
        shares
    }

    /// Fitted by these columns, by least squares; `None` where they cannot be told apart.
    pub fn fitted_by(&self, design: &DMatrix<f64>) -> Option<Left<'_>> {
        let mut normal = design.tr_mul(design);
        for k in 0..normal.ncols() {
            normal[(k, k)] += RIDGE * design.nrows() as f64;
        }
        let left = &self.values - design * Cholesky::new(normal)?.solve(&design.tr_mul(&self.values));
        let after = left.column_iter().map(|column| column.norm_squared()).collect();
        Some(Left { of: self, after, used: design.ncols() as f64 })
    }
}

impl Left<'_> {
    fn rest(&self) -> f64 {
        (self.of.free - self.used).max(1.0)
    }

    /// Logarithm of the share of squares that is left, over all coordinates that spread.
    pub fn log_share(&self) -> f64 {
        self.of.counted.iter().map(|&c| (self.after[c] / self.of.before[c]).max(1e-12).ln()).sum()
    }

    /// Probability by chance of the coordinate that loses most (F test), when so many fits were tried.
    pub fn p_value(&self, fits: usize) -> f64 {
        let chance = |&c: &usize| {
            let lost = (self.of.before[c] - self.after[c]) / self.used;
            f_tail(lost / (self.after[c] / self.rest()).max(1e-300), self.used, self.rest())
        };
        let tests = (fits * self.of.counted.len()) as f64;
        self.of.counted.iter().map(chance).fold(1.0, f64::min) * tests
    }

    /// Root mean square of what the fit explains over that of what it leaves, of the coordinate where that is
    /// most.
    pub fn largest(&self) -> f64 {
        let size =
            |&c: &usize| ((self.of.before[c] - self.after[c]).max(0.0) / self.after[c].max(1e-300)).sqrt();
        self.of.counted.iter().map(size).fold(0.0, f64::max)
    }

    /// Variance that is left over the variance that there was, per coordinate; 1 of what does not spread.
    pub fn shares(&self) -> Vec<f64> {
        let share = |c: usize| self.after[c] / self.of.before[c] * self.of.free / self.rest();
        let all = 0..self.after.len();
        all.map(|c| if self.of.counted.contains(&c) { share(c).min(1.0) } else { 1.0 }).collect()
    }
}
