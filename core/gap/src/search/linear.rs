//! Residuals and tangents of all rows at the present model, and what they add up to.

use nalgebra::{DMatrix, DVector};
use plumbline_effects::Nuisance;
use plumbline_effects::measurements::{Measurements, What};
use plumbline_effects::{Assumed, Effect, Tangents};
use plumbline_model::JobContext;
use rayon::prelude::*;

use crate::beforehand::standard;
use crate::error::GapError;
use crate::floor::Floor;

/// Rows between two looks at whether to stop.
const CHUNK: usize = 256;
/// Columns of a product between two looks at whether to stop.
const PANEL: usize = 64;

/// Whitened by the floor: one line per coordinate of every row that is predicted.
pub(super) struct Linear {
    /// Number of gauge columns, one per nuisance; they come first.
    pub gauge: usize,
    /// What is found along with the effects: frames, and markers that were mounted anew.
    pub nuisances: Vec<Nuisance>,
    /// Gauge columns, effects, then free-form ones if any, then the residual as the last one.
    pub lines: DMatrix<f64>,
    /// Row of each line.
    pub row: Vec<usize>,
    /// Coordinate of each line.
    pub coordinate: Vec<usize>,
    /// Cell of each line, counted per coordinate and kind.
    pub cell: Vec<usize>,
    /// Number of those.
    pub cells: usize,
}

impl Linear {
    /// At the model `assumed`, for these effects.
    ///
    /// # Errors
    /// Cancelled.
    pub fn of(
        measurements: &Measurements,
        floor: &Floor,
        assumed: &Assumed,
        effects: &[Effect],
        context: &dyn JobContext,
    ) -> Result<Self, GapError> {
        let rows = &measurements.rows;
        let mut tangents: Vec<Option<Tangents>> = Vec::with_capacity(rows.len());
        for chunk in rows.chunks(CHUNK) {
            context.checkpoint()?;
            tangents.par_extend(
                chunk.par_iter().with_min_len(8).map(|row| measurements.tangents(row, assumed, effects)),
            );
        }
        let nuisances = measurements.nuisances();
        let gauge = nuisances.len();
        let columns: usize = effects.iter().map(|effect| effect.parameters().len()).sum();
        let used = |row: usize| Some((tangents[row].as_ref()?, floor.of(rows[row].what)?));
        let count: usize =
            (0..rows.len()).filter(|&i| used(i).is_some()).map(|i| rows[i].measured.len()).sum();
        let mut lines = DMatrix::zeros(count, gauge + columns + 1);
        let (mut row_of, mut coordinate, mut cell) = (vec![], vec![], vec![]);
        let mut cells = std::collections::HashMap::new();
        for (i, row) in rows.iter().enumerate() {
            let Some((tangents, floor)) = used(i) else { continue };
            for c in 0..row.measured.len() {
                let line = row_of.len();
                let sd = standard(row.what, c, floor.of_row(row, c));
                for (k, nuisance) in nuisances.iter().enumerate() {
                    lines[(line, k)] = measurements.nuisance_slope(row, tangents, c, *nuisance) / sd;
                }
                for k in 0..columns {
                    lines[(line, gauge + k)] = tangents.effects[(c, k)] / sd;
                }
                lines[(line, gauge + columns)] = (row.measured[c] - tangents.predicted[c]) / sd;
                let next = cells.len();
                cell.push(*cells.entry((row.cell, row.what, c)).or_insert(next));
                row_of.push(i);
                coordinate.push(c);
            }
        }
        Ok(Self { gauge, nuisances, lines, row: row_of, coordinate, cell, cells: cells.len() })
    }

    /// Number of columns without gauge and residual.
    pub fn effects(&self) -> usize {
        self.lines.ncols() - self.gauge - 1
    }

    /// Whitened residual of each row, in units of the floor: root mean square over coordinates.
    pub fn misses(&self, rows: usize, residual: &DVector<f64>) -> Vec<Option<f64>> {
        let mut sums = vec![(0.0, 0_usize); rows];
        for (line, &row) in self.row.iter().enumerate() {
            sums[row].0 += residual[line] * residual[line];
            sums[row].1 += 1;
        }
        sums.into_iter().map(|(sum, count)| (count > 0).then(|| (sum / count as f64).sqrt())).collect()
    }

    /// Puts more columns before the residual.
    pub fn append(&mut self, more: &DMatrix<f64>) {
        let old = self.lines.ncols();
        let lines = std::mem::replace(&mut self.lines, DMatrix::zeros(0, 0));
        let mut wide = lines.insert_columns(old - 1, more.ncols(), 0.0);
        wide.columns_mut(old - 1, more.ncols()).copy_from(more);
        self.lines = wide;
    }

    /// Sums over rows, each with its weight.
    ///
    /// # Errors
    /// Cancelled.
    pub fn sums(&self, weights: &[f64], context: &dyn JobContext) -> Result<Sums, GapError> {
        let mut scaled = self.lines.clone();
        let mut counts = vec![0.0; self.cells];
        let mut total = 0.0;
        for line in 0..scaled.nrows() {
            let weight = weights[self.row[line]];
            counts[self.cell[line]] += weight;
            total += weight;
            scaled.row_mut(line).scale_mut(weight.sqrt());
        }
        let gram = gram_of(&scaled, context)?;
        let repeated = counts.iter().any(|count| *count > 1.0);
        let means = if repeated {
            let mut means = DMatrix::zeros(self.cells, self.lines.ncols());
            for line in 0..self.lines.nrows() {
                let weight = weights[self.row[line]];
                let mut into = means.row_mut(self.cell[line]);
                into.zip_apply(&self.lines.row(line), |sum, value| *sum += weight * value);
            }
            Some(means)
        } else {
            None
        };
        Ok(Sums { gauge: self.gauge, nuisances: self.nuisances.clone(), gram, means, counts, total })
    }
}

/// MᵀM. By a transposed copy, since the product of whole matrices goes by blocks that fit the cache, and a product
/// of columns, dot by dot, does not. In panels of what lies on and below the diagonal.
///
/// # Errors
/// Cancelled.
pub(super) fn gram_of(matrix: &DMatrix<f64>, context: &dyn JobContext) -> Result<DMatrix<f64>, GapError> {
    let transposed = matrix.transpose();
    let columns = matrix.ncols();
    let mut gram = DMatrix::zeros(columns, columns);
    for from in (0..columns).step_by(PANEL) {
        context.checkpoint()?;
        let (width, below) = (PANEL.min(columns - from), columns - from);
        gram.view_mut((from, from), (below, width)).gemm(
            1.0,
            &transposed.rows(from, below),
            &matrix.columns(from, width),
            0.0,
        );
    }
    gram.fill_upper_triangle_with_lower_triangle();
    Ok(gram)
}

/// What evidence needs of the rows; its size does not depend on their number, cells apart.
pub(super) struct Sums {
    /// Gauge columns.
    pub gauge: usize,
    /// One per gauge column.
    pub nuisances: Vec<Nuisance>,
    gram: DMatrix<f64>,
    /// Per cell, weighted sum of its lines; `None` when no cell has more than one.
    means: Option<DMatrix<f64>>,
    counts: Vec<f64>,
    /// Sum of the weights of all lines.
    pub total: f64,
}

impl Sums {
    /// Gram matrix of all columns and the residual when each cell is off by an own amount of this
    /// variance (in squares of the floor), and the logarithm of the determinant of the covariance.
    ///
    /// # Errors
    /// Cancelled.
    pub fn gram(
        &self,
        cell_variance: f64,
        context: &dyn JobContext,
    ) -> Result<(DMatrix<f64>, f64), GapError> {
        let log_det: f64 = self.counts.iter().map(|count| (1.0 + cell_variance * count).ln()).sum();
        let shrink = |count: f64| cell_variance / (1.0 + cell_variance * count);
        let gram = match &self.means {
            // Cells of one line each: w/(1 + s w), nearly w/(1 + s) for the few with a weight below 1.
            None => &self.gram / (1.0 + cell_variance),
            Some(means) => {
                let mut scaled = means.clone();
                for (cell, count) in self.counts.iter().enumerate() {
                    scaled.row_mut(cell).scale_mut(shrink(*count).sqrt());
                }
                &self.gram - gram_of(&scaled, context)?
            }
        };
        Ok((gram, log_det))
    }
}

/// Names of coordinates, for people.
pub(super) fn coordinate_name(what: What, coordinate: usize) -> &'static str {
    what.coordinates()[coordinate].0
}

impl Sums {
    /// With some columns only, in the order given; frames and residual stay.
    pub fn only(&self, columns: &[usize]) -> Self {
        let last = self.gram.ncols() - 1;
        let kept: Vec<usize> =
            (0..self.gauge).chain(columns.iter().map(|c| self.gauge + c)).chain([last]).collect();
        Self {
            gauge: self.gauge,
            nuisances: self.nuisances.clone(),
            gram: DMatrix::from_fn(kept.len(), kept.len(), |r, c| self.gram[(kept[r], kept[c])]),
            means: self.means.as_ref().map(|means| means.select_columns(&kept)),
            counts: self.counts.clone(),
            total: self.total,
        }
    }

    /// Sum of squares of the residual about the means of cells, and its degrees of freedom.
    pub fn within(&self) -> (f64, f64) {
        let Some(means) = &self.means else { return (0.0, 0.0) };
        let last = self.gram.ncols() - 1;
        let used = self.counts.iter().filter(|count| **count > 0.0).count() as f64;
        let between: f64 = self
            .counts
            .iter()
            .enumerate()
            .filter(|(_, count)| **count > 0.0)
            .map(|(cell, count)| means[(cell, last)].powi(2) / count)
            .sum();
        ((self.gram[(last, last)] - between).max(0.0), (self.total - used).max(0.0))
    }
}
