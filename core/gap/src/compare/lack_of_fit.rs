//! Is there more between model and measurement than noise?
//!
//! With repeats: Fisher's F of cell means against the spread inside of cells. Without: whether the
//! residual depends on anything that is known of a row, a score test whose distribution is taken
//! from permutations of the rows inside of each session.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};
use plumbline_effects::measurements::{Measurements, What};
use plumbline_effects::{Assumed, Tangents};
use plumbline_model::JobContext;
use plumbline_model::decompose;
use rand::rngs::StdRng;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rayon::prelude::*;

use super::noise::Noise;
use super::sets;
use crate::covariates::Covariates;
use crate::error::GapError;
use crate::statistics::f_tail;

/// Permutations: the smallest probability that they can show is one over one more.
const PERMUTATIONS: usize = 399;
/// Mean square, in units of the noise, below which a residual says nothing.
const DUST: f64 = 0.1;
/// At most this many columns speak in the score test.
const MOST_COLUMNS: usize = 40;

/// What a test found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// Probability of as much by noise alone.
    pub p_value: f64,
    /// Residual beyond the noise, in standard deviations of one measurement.
    pub size_sigmas: f64,
}

/// Residuals in units of the floor, with what moves them when frames move.
struct Standardized {
    rows: Vec<usize>,
    /// First coordinate of each row in `residual`.
    start: Vec<usize>,
    residual: DVector<f64>,
    gauge: DMatrix<f64>,
}

/// Tests the residuals of rows that are no outliers.
///
/// # Errors
/// Cancelled.
pub fn misfit(
    measurements: &Measurements,
    residuals: &[Option<Vec<f64>>],
    noise: &Noise,
    assumed: &Assumed,
    covariates: &Covariates,
    seed: u64,
    context: &dyn JobContext,
) -> Result<Misfit, GapError> {
    let standardized = standardized(measurements, residuals, noise, assumed);
    let repeated = |what: What, c: usize| {
        let kind = noise.floor.kinds.iter().position(|kind| kind.what == what);
        kind.is_some_and(|kind| noise.repeated[kind][c])
    };
    let by_repeats = of_cells(measurements, &standardized, noise, &repeated);
    let any_not = measurements.rows.iter().any(|row| (0..row.measured.len()).any(|c| !repeated(row.what, c)));
    if let Some(found) = by_repeats.filter(|_| !any_not) {
        return Ok(found);
    }
    let once = standardized.once_per_cell(measurements);
    let mut by_dependence = of_dependence(measurements, &once, covariates, &repeated, seed, context)?;
    let told: Vec<(usize, &[f64])> = once.told(measurements);
    if let Some(by_sets) = sets::by_chance(measurements, &told, seed, context)? {
        by_dependence.p_value = sets::together(by_dependence.p_value, by_sets);
    }
    Ok(match by_repeats {
        None => by_dependence,
        // Two tests: twice the smaller probability.
        Some(found) if by_dependence.p_value < found.p_value => {
            Misfit { p_value: (2.0 * by_dependence.p_value).min(1.0), ..by_dependence }
        }
        Some(found) => Misfit { p_value: (2.0 * found.p_value).min(1.0), ..found },
    })
}

fn standardized(
    measurements: &Measurements,
    residuals: &[Option<Vec<f64>>],
    noise: &Noise,
    assumed: &Assumed,
) -> Standardized {
    let rows: Vec<usize> = (0..residuals.len()).filter(|&i| residuals[i].is_some()).collect();
    let mut start = vec![];
    let mut residual = vec![];
    for &i in &rows {
        start.push(residual.len());
        let row = &measurements.rows[i];
        let kind = noise.floor.of(row.what);
        for (c, value) in residuals[i].iter().flatten().enumerate() {
            residual.push(value / kind.map_or(1.0, |kind| kind.of_row(row, c)));
        }
    }
    let tangents: Vec<Option<Tangents>> =
        rows.par_iter().map(|&i| measurements.tangents(&measurements.rows[i], assumed, &[])).collect();
    let nuisances = measurements.nuisances();
    let mut gauge = DMatrix::zeros(residual.len(), nuisances.len());
    for ((&i, &at), tangents) in rows.iter().zip(&start).zip(&tangents) {
        let row = &measurements.rows[i];
        let kind = noise.floor.of(row.what);
        let Some(tangents) = tangents else { continue };
        for c in 0..row.measured.len() {
            let sd = kind.map_or(1.0, |kind| kind.of_row(row, c));
            for (k, nuisance) in nuisances.iter().enumerate() {
                gauge[(at + c, k)] = measurements.nuisance_slope(row, tangents, c, *nuisance) / sd;
            }
        }
    }
    Standardized { rows, start, residual: DVector::from_vec(residual), gauge }
}

impl Standardized {
    /// Each row with its residual, in units of the floor.
    fn told(&self, measurements: &Measurements) -> Vec<(usize, &[f64])> {
        let residual = self.residual.as_slice();
        let len = |row: usize| measurements.rows[row].what.len();
        self.rows.iter().zip(&self.start).map(|(&row, &at)| (row, &residual[at..at + len(row)])).collect()
    }

    /// Means of cells, each in the place of the cell's first row: repeats do not speak twice of
    /// what they depend on.
    fn once_per_cell(&self, measurements: &Measurements) -> Self {
        let mut cells = BTreeMap::<usize, Vec<usize>>::new();
        for (k, &i) in self.rows.iter().enumerate() {
            cells.entry(measurements.rows[i].cell).or_default().push(k);
        }
        let mut members: Vec<Vec<usize>> = cells.into_values().collect();
        members.sort_by_key(|members| members[0]);
        let size = |k: usize| measurements.rows[self.rows[k]].what.len();
        let total = members.iter().map(|members| size(members[0])).sum();
        let mut once = Self {
            rows: vec![],
            start: vec![],
            residual: DVector::zeros(total),
            gauge: DMatrix::zeros(total, self.gauge.ncols()),
        };
        let mut at = 0;
        for members in members {
            once.rows.push(self.rows[members[0]]);
            once.start.push(at);
            let weight = 1.0 / (members.len() as f64).sqrt();
            for c in 0..size(members[0]) {
                for &k in &members {
                    once.residual[at + c] += weight * self.residual[self.start[k] + c];
                    for g in 0..self.gauge.ncols() {
                        once.gauge[(at + c, g)] += weight * self.gauge[(self.start[k] + c, g)];
                    }
                }
            }
            at += size(members[0]);
        }
        once
    }
}

/// What a basis cannot explain.
struct Projector(DMatrix<f64>);

impl Projector {
    /// Off the columns; those that depend on others count once.
    fn off(mut columns: DMatrix<f64>) -> Self {
        for mut column in columns.column_iter_mut() {
            let norm = column.norm();
            if norm > 0.0 {
                column /= norm;
            }
        }
        if columns.ncols() == 0 || columns.nrows() == 0 {
            return Self(DMatrix::zeros(columns.nrows(), 0));
        }
        let Some(eigen) = decompose::symmetric_eigen(columns.transpose() * &columns) else {
            return Self(DMatrix::zeros(columns.nrows(), 0));
        };
        let kept: Vec<DVector<f64>> = (0..eigen.eigenvalues.len())
            .filter(|&k| eigen.eigenvalues[k] > 1e-8)
            .map(|k| &columns * eigen.eigenvectors.column(k) / eigen.eigenvalues[k].sqrt())
            .collect();
        Self(if kept.is_empty() { DMatrix::zeros(columns.nrows(), 0) } else { DMatrix::from_columns(&kept) })
    }

    fn rank(&self) -> usize {
        self.0.ncols()
    }

    fn apply(&self, values: &DVector<f64>) -> DVector<f64> {
        values - &self.0 * (self.0.tr_mul(values))
    }

    fn inside(&self, values: &DVector<f64>) -> f64 {
        self.0.tr_mul(values).norm_squared()
    }
}

/// Lack of fit of cell means, with the coordinates whose noise repeats tell.
fn of_cells(
    measurements: &Measurements,
    all: &Standardized,
    noise: &Noise,
    repeated: &dyn Fn(What, usize) -> bool,
) -> Option<Misfit> {
    let mut cells = BTreeMap::<(usize, usize), Vec<usize>>::new();
    for (&i, &at) in all.rows.iter().zip(&all.start) {
        let row = &measurements.rows[i];
        for c in (0..row.measured.len()).filter(|&c| repeated(row.what, c)) {
            cells.entry((row.cell, c)).or_default().push(at + c);
        }
    }
    if cells.is_empty() {
        return None;
    }
    let mean = |members: &[usize], k: Option<usize>| {
        let sum: f64 =
            members.iter().map(|&at| k.map_or_else(|| all.residual[at], |k| all.gauge[(at, k)])).sum();
        sum / (members.len() as f64).sqrt()
    };
    let means = DVector::from_iterator(cells.len(), cells.values().map(|members| mean(members, None)));
    let gauge = DMatrix::from_row_iterator(
        cells.len(),
        all.gauge.ncols(),
        cells
            .values()
            .flat_map(|members| (0..all.gauge.ncols()).map(|k| mean(members, Some(k))).collect::<Vec<_>>()),
    );
    let off = Projector::off(gauge);
    let above = cells.len() as f64 - off.rank() as f64;
    if above < 1.0 {
        return None;
    }
    let square = off.apply(&means).norm_squared() / above;
    let below: f64 = noise
        .floor
        .kinds
        .iter()
        .zip(&noise.repeated)
        .map(|(kind, known)| kind.degrees_of_freedom * known.iter().filter(|known| **known).count() as f64)
        .sum();
    let repeats = cells.values().map(Vec::len).sum::<usize>() as f64 / cells.len() as f64;
    Some(Misfit {
        p_value: f_tail(square, above, below),
        size_sigmas: ((square - 1.0) / repeats).max(0.0).sqrt(),
    })
}

/// Dependence of residuals on what is known of the rows.
fn of_dependence(
    measurements: &Measurements,
    all: &Standardized,
    covariates: &Covariates,
    repeated: &dyn Fn(What, usize) -> bool,
    seed: u64,
    context: &dyn JobContext,
) -> Result<Misfit, GapError> {
    let basis = bases(measurements, all, covariates);
    let off = Projector::off(all.gauge.clone());
    let statistic = |residual: &DVector<f64>| -> f64 {
        basis
            .iter()
            .map(|basis| {
                (0..basis.what.len())
                    .map(|c| {
                        let own = DVector::from_iterator(
                            basis.at.len(),
                            basis.at.iter().map(|at| residual[at + c]),
                        );
                        // What is far below the noise is the dust of rounding.
                        let whole = own.norm_squared().max(DUST * own.len() as f64);
                        let share = (basis.projector.inside(&own) / whole).min(1.0 - 1e-9);
                        -(own.len() as f64) * (1.0 - share).ln()
                    })
                    .sum::<f64>()
            })
            .sum()
    };
    let observed = statistic(&off.apply(&all.residual));
    let rounds: Vec<u64> = (0..PERMUTATIONS as u64).collect();
    let larger: Result<Vec<bool>, GapError> = rounds
        .par_iter()
        .map(|round| {
            context.checkpoint()?;
            let mut random = StdRng::seed_from_u64(seed.wrapping_mul(0x9E37_79B9).wrapping_add(*round));
            let permuted = permuted(measurements, all, &mut random);
            Ok(statistic(&off.apply(&permuted)) >= observed)
        })
        .collect();
    let larger = larger?.into_iter().filter(|larger| *larger).count();
    let kept = off.apply(&all.residual);
    let free = kept.len() as f64 - off.rank() as f64;
    // The size counts only what the noise of repeats did not already speak of.
    let (mut squares, mut count) = (0.0, 0usize);
    for (&i, &at) in all.rows.iter().zip(&all.start) {
        let row = &measurements.rows[i];
        let all_repeated = (0..row.measured.len()).all(|c| repeated(row.what, c));
        for c in (0..row.measured.len()).filter(|&c| all_repeated || !repeated(row.what, c)) {
            squares += kept[at + c] * kept[at + c];
            count += 1;
        }
    }
    let square = squares / (count as f64 * free.max(1.0) / kept.len().max(1) as f64).max(1.0);
    Ok(Misfit {
        p_value: (larger + 1) as f64 / (PERMUTATIONS + 1) as f64,
        size_sigmas: (square - 1.0).max(0.0).sqrt(),
    })
}

/// Columns on which residuals of one kind may depend.
struct Basis {
    what: What,
    /// First coordinates of the rows of this kind.
    at: Vec<usize>,
    projector: Projector,
}

fn bases(measurements: &Measurements, all: &Standardized, covariates: &Covariates) -> Vec<Basis> {
    What::ALL
        .into_iter()
        .filter_map(|what| {
            let chosen: Vec<usize> =
                (0..all.rows.len()).filter(|&k| measurements.rows[all.rows[k]].what == what).collect();
            if chosen.len() < 12 {
                return None;
            }
            let rows: Vec<usize> = chosen.iter().map(|&k| all.rows[k]).collect();
            let at = chosen.iter().map(|&k| all.start[k]).collect();
            let most = MOST_COLUMNS.min(rows.len() / 4);
            Some(Basis {
                what,
                at,
                projector: Projector::off(columns(measurements, covariates, &rows, most)),
            })
        })
        .collect()
}

/// The widest directions of the standardized covariates, and their squares and products.
fn columns(
    measurements: &Measurements,
    covariates: &Covariates,
    rows: &[usize],
    most: usize,
) -> DMatrix<f64> {
    let count = rows.len();
    // What is constant of a stand is fitted: only what differs within it tells.
    let stands = |i: usize| measurements.rows[i].stand;
    let less_mean = |column: DVector<f64>| {
        let mut sums = BTreeMap::<Option<usize>, (f64, f64)>::new();
        for (value, &i) in column.iter().zip(rows) {
            let sum = sums.entry(stands(i)).or_default();
            *sum = (sum.0 + value, sum.1 + 1.0);
        }
        let mean = |i: usize| sums.get(&stands(i)).map_or(0.0, |(sum, count)| sum / count);
        DVector::from_iterator(count, column.iter().zip(rows).map(|(value, &i)| value - mean(i)))
    };
    let mut linear: Vec<DVector<f64>> = vec![];
    for c in 0..covariates.names.len() {
        let known: Vec<f64> = rows.iter().filter_map(|&i| covariates.values[i][c]).collect();
        if known.len() < count / 2 {
            continue;
        }
        let mean = known.iter().sum::<f64>() / known.len() as f64;
        let column = DVector::from_iterator(
            count,
            rows.iter().map(|&i| covariates.values[i][c].map_or(0.0, |value| value - mean)),
        );
        let column = if rows.iter().any(|&i| stands(i).is_some()) { less_mean(column) } else { column };
        let norm = column.norm();
        if norm > 1e-9 {
            linear.push(column / norm);
        }
    }
    if linear.is_empty() {
        return DMatrix::zeros(count, 0);
    }
    let matrix = DMatrix::from_columns(&linear);
    let Some(eigen) = decompose::symmetric_eigen(matrix.transpose() * &matrix) else {
        return DMatrix::zeros(count, 0);
    };
    let mut order: Vec<usize> = (0..linear.len()).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let directions: Vec<DVector<f64>> = order
        .iter()
        .filter(|&&k| eigen.eigenvalues[k] > 1e-4)
        .map(|&k| &matrix * eigen.eigenvectors.column(k) / eigen.eigenvalues[k].sqrt())
        .collect();
    let mut columns: Vec<DVector<f64>> = vec![DVector::from_element(count, 1.0)];
    columns.extend(directions.iter().take(most.saturating_sub(1) * 2 / 3).cloned());
    'products: for a in 0..directions.len() {
        for b in 0..=a {
            if columns.len() >= most {
                break 'products;
            }
            let product = directions[a].component_mul(&directions[b]);
            columns.push(less_mean(product));
        }
    }
    // The constant is part of it only where no frame takes it up; it does no harm where one does.
    DMatrix::from_columns(&columns)
}

/// Residuals of whole rows, exchanged among rows of the same kind and session. Where no frame is
/// free, a residual that is the same everywhere is a misfit too: there signs are drawn instead.
fn permuted(measurements: &Measurements, all: &Standardized, random: &mut StdRng) -> DVector<f64> {
    let mut blocks = BTreeMap::<(usize, What), Vec<usize>>::new();
    for (k, &i) in all.rows.iter().enumerate() {
        let row = &measurements.rows[i];
        blocks.entry((row.session, row.what)).or_default().push(k);
    }
    let mut result = all.residual.clone();
    for ((_, what), members) in blocks {
        if !what.is_placed() {
            for &k in &members {
                if random.random::<bool>() {
                    (0..what.len()).for_each(|c| result[all.start[k] + c] *= -1.0);
                }
            }
            continue;
        }
        let mut from = members.clone();
        from.shuffle(random);
        for (to, from) in members.iter().zip(&from) {
            for c in 0..what.len() {
                result[all.start[*to] + c] = all.residual[all.start[*from] + c];
            }
        }
    }
    result
}
