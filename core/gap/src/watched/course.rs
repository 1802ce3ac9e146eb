//! What was seen of a thing in the order of time, and what functions of time leave of it.

use nalgebra::{Cholesky, DMatrix, DVector};
use plumbline_effects::Measurements;
use plumbline_effects::measurements::{Observation, What};

use crate::floor::finest;
use crate::statistics::{ALIKE, median};

/// Keeps columns that are alike from being solved for.
const RIDGE: f64 = 1e-9;
/// Median of the square of a standard normal value.
const USUAL_SQUARE: f64 = 0.4549;

/// A thing in the order of time.
pub(super) struct Course {
    /// Since the eyes were switched on, s.
    pub t_s: Vec<f64>,
    /// One row per look, one column per coordinate.
    pub values: DMatrix<f64>,
    /// What one unit of a coordinate is, seen from the eyes, rad.
    pub unit_rad: f64,
    /// Noise of each coordinate is no less, in its unit.
    pub least: Vec<f64>,
}

/// What a fit leaves.
pub(super) struct Left {
    /// Sum of squares of each coordinate.
    pub squares: Vec<f64>,
    /// Values of the last column, one per coordinate.
    pub last: Vec<f64>,
}

impl Course {
    /// Of rows of one kind: natural coordinates, in which the noise is alike wherever a thing stands.
    pub fn measured(measurements: &Measurements, rows: &[usize], rad_per_px: f64) -> Option<Self> {
        let seen: Vec<&Observation> =
            rows.iter().map(|&i| &measurements.rows[i]).filter(|row| row.t_secs.is_some()).collect();
        let what = seen.first()?.what;
        let values: Vec<&[f64]> = seen.iter().map(|row| &row.measured[..]).collect();
        let least = what.coordinates().iter().map(|(_, unit)| finest(*unit)).collect();
        let times = seen.iter().filter_map(|row| row.t_secs).collect();
        let unit_rad = if what == What::EyePoints { rad_per_px } else { 1.0 };
        Some(Self::new(times, what.len(), |r, c| values[r][c], least, unit_rad))
    }

    /// Of values at times; `least`: what is measured no finer, per coordinate.
    pub fn new(
        t_s: Vec<f64>,
        width: usize,
        value: impl Fn(usize, usize) -> f64,
        mut least: Vec<f64>,
        unit_rad: f64,
    ) -> Self {
        let count = t_s.len();
        let values = DMatrix::from_fn(count, width, |r, c| value(r, c) - value(0, c));
        // From look to look: neither a course nor one step counts for much there.
        let steps =
            |c: usize| (1..count).map(|r| (value(r, c) - value(r - 1, c)).powi(2) / 2.0).collect::<Vec<_>>();
        let sd = |c: usize| (median(steps(c)).unwrap_or(0.0) / USUAL_SQUARE).sqrt();
        let largest = (0..width).map(sd).fold(0.0, f64::max);
        // A detector that says the very same is not without noise for it.
        least.iter_mut().for_each(|least| *least = least.max(ALIKE * largest));
        Self { t_s, values, unit_rad, least }
    }

    /// Number of coordinates.
    pub fn width(&self) -> usize {
        self.values.ncols()
    }

    /// What a least-squares fit of functions of time leaves.
    pub fn fitted(&self, columns: &dyn Fn(f64) -> Vec<f64>) -> Option<Left> {
        let rows: Vec<DVector<f64>> = self.t_s.iter().map(|t_s| DVector::from_vec(columns(*t_s))).collect();
        let width = rows.first()?.len();
        let design = DMatrix::from_fn(rows.len(), width, |r, c| rows[r][c]);
        let mut normal = design.tr_mul(&design);
        for k in 0..width {
            normal[(k, k)] += RIDGE * rows.len() as f64;
        }
        let fit = Cholesky::new(normal)?.solve(&design.tr_mul(&self.values));
        let off = &self.values - design * &fit;
        Some(Left {
            squares: off.column_iter().map(|column| column.norm_squared()).collect(),
            last: fit.row(width - 1).iter().copied().collect(),
        })
    }

    /// Logarithm of the likelihood of what is left, each coordinate's noise as it fits best, less what so many columns
    /// more than none gain by chance (Schwarz 1978).
    pub fn score(&self, left: &Left, columns: usize) -> f64 {
        let count = self.t_s.len() as f64;
        let fits = left.squares.iter().zip(&self.least);
        let fit: f64 = fits.map(|(square, least)| (square / count + least * least).ln()).sum();
        -0.5 * count * fit - 0.5 * count.ln() * (columns * self.width()) as f64
    }
}
