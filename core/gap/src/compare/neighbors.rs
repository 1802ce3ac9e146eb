//! Rows that were measured nearly alike.

use nalgebra::{DMatrix, DVector};
use plumbline_effects::measurements::{Measurements, Observation, What};
use plumbline_model::decompose;
use rayon::prelude::*;

use crate::statistics::median;

/// An arm's reach: what a rad of a joint moves, roughly, m.
const REACH_M: f64 = 0.3;
/// A quarter turn of a neighborhood needs this many directions at most.
const MOST_DIRECTIONS: usize = 3;
/// Directions in which rows spread less than this share of the widest do not count.
const THIN: f64 = 0.15;
/// Neighbors that differ by more than this (a third of a radian) in directions that were left out are not
/// near, m.
const FAR_M: f64 = 0.09;

/// What a second counts where one thing was watched: a minute is as far as a few centimeters, m.
const M_PER_S: f64 = 1e-3;

/// Rows of one kind as points, alike where they are near.
pub struct Points {
    /// Rows, by place in [`Measurements::rows`].
    pub rows: Vec<usize>,
    /// Coordinates along the directions in which rows differ, m or so; one row each.
    pub at: DMatrix<f64>,
    /// Rows of different context (session, side, weight, height) are no neighbors.
    pub context: Vec<usize>,
    /// Whether each was watched: before and after a jump are no neighbors, however few there are.
    watched: Vec<bool>,
    /// Spread (root mean square) along the directions that [`Self::at`] leaves out, m.
    hidden: f64,
}

impl Points {
    /// Rows of one kind among the chosen ones.
    pub fn of(measurements: &Measurements, what: What, chosen: impl Iterator<Item = usize>) -> Self {
        let rows: Vec<usize> = chosen.filter(|&i| measurements.rows[i].what == what).collect();
        let raw: Vec<Vec<f64>> = rows.iter().map(|&i| place(&measurements.rows[i])).collect();
        let wide = raw.iter().map(Vec::len).max().unwrap_or(0);
        let mut at = DMatrix::from_fn(rows.len(), wide, |i, c| raw[i].get(c).copied().unwrap_or(0.0));
        for mut column in at.column_iter_mut() {
            let mean = column.mean();
            column.add_scalar_mut(-mean);
        }
        let mut contexts: Vec<Vec<i64>> = vec![];
        let context = rows
            .iter()
            .map(|&i| {
                let key = context_key(&measurements.rows[i]);
                contexts.iter().position(|known| *known == key).unwrap_or_else(|| {
                    contexts.push(key);
                    contexts.len() - 1
                })
            })
            .collect();
        let (at, hidden) = principal(at);
        let watched = rows.iter().map(|&i| measurements.rows[i].stand.is_some()).collect();
        Self { rows, at, context, watched, hidden }
    }

    /// Only rows of the same group are neighbors, however few there are.
    pub fn split(&mut self, group: Vec<usize>) {
        self.context = group;
        self.watched.fill(true);
    }

    /// Whether neighbors are near in everything that was varied.
    pub fn are_near(&self) -> bool {
        self.hidden < FAR_M
    }

    /// Whether the farthest of these neighbors (see [`Self::nearest`]) of the usual point is near: of few rows all
    /// over the workspace the nearest are not, and what an arm errs by from one to the next would pass for noise.
    pub fn reach_near(&self, nearest: &[Vec<usize>]) -> bool {
        let apart = |i: usize, j: usize| (self.at.row(i) - self.at.row(j)).norm();
        let farthest = nearest.iter().enumerate().filter_map(|(i, around)| Some(apart(i, *around.last()?)));
        median(farthest).is_some_and(|farthest_m| farthest_m < FAR_M)
    }

    /// So many neighbors carry a plane through them well.
    pub fn of_a_plane(&self) -> usize {
        (3 * (self.directions() + 1)).min(self.rows.len().saturating_sub(1))
    }

    /// Number of directions in which rows differ.
    pub fn directions(&self) -> usize {
        self.at.ncols()
    }

    /// The `count` nearest others of each point, by place in [`Self::rows`], the nearest first; of
    /// the same context where it has enough of them.
    pub fn nearest(&self, count: usize) -> Vec<Vec<usize>> {
        let sizes = (0..=self.context.iter().copied().max().unwrap_or(0))
            .map(|context| self.context.iter().filter(|own| **own == context).count())
            .collect::<Vec<_>>();
        // Thousands of rows make tens of millions of pairs: plain arrays.
        let at: Vec<[f64; MOST_DIRECTIONS]> = (0..self.rows.len())
            .map(|i| std::array::from_fn(|c| if c < self.directions() { self.at[(i, c)] } else { 0.0 }))
            .collect();
        let apart =
            |i: usize, j: usize| -> f64 { (0..MOST_DIRECTIONS).map(|c| (at[i][c] - at[j][c]).powi(2)).sum() };
        (0..self.rows.len())
            .into_par_iter()
            .map(|i| {
                let alone = sizes[self.context[i]] <= count + 2 && !self.watched[i];
                let mut others: Vec<(f64, usize)> = (0..self.rows.len())
                    .filter(|&j| j != i && (alone || self.context[j] == self.context[i]))
                    .map(|j| (apart(i, j), j))
                    .collect();
                let kept = count.min(others.len());
                if kept < others.len() {
                    others.select_nth_unstable_by(kept, |a, b| a.0.total_cmp(&b.0));
                    others.truncate(kept);
                }
                others.sort_by(|a, b| a.0.total_cmp(&b.0));
                others.into_iter().map(|(_, j)| j).collect()
            })
            .collect()
    }

    /// Polynomials of second degree in the directions (without the constant), one row per point.
    pub fn quadratic(&self) -> DMatrix<f64> {
        let d = self.directions();
        let mut columns: Vec<DVector<f64>> = (0..d).map(|c| self.at.column(c).into_owned()).collect();
        for a in 0..d {
            for b in a..d {
                columns.push(self.at.column(a).component_mul(&self.at.column(b)));
            }
        }
        if columns.is_empty() { DMatrix::zeros(self.rows.len(), 0) } else { DMatrix::from_columns(&columns) }
    }
}

/// What makes two rows near: joint angles, the place, the posture of the neck; all in m or so.
fn place(row: &Observation) -> Vec<f64> {
    // All at one place: neighbors in time are near.
    if let (Some(_), Some(t_secs)) = (row.stand, row.t_secs) {
        return vec![t_secs * M_PER_S];
    }
    let mut place: Vec<f64> = row.angles_rad().iter().map(|angle| angle * REACH_M).collect();
    match (row.what, row.truth_m) {
        (What::Touch, _) => place.extend(&row.measured[..2]),
        (_, Some(truth)) => {
            place.extend(truth.iter());
            place.extend(row.neck_rad.iter().map(|angle| angle * REACH_M));
        }
        _ => (),
    }
    place
}

fn context_key(row: &Observation) -> Vec<i64> {
    let fine = |value: f64| (value * 1e3).round() as i64;
    let mut key = vec![row.session as i64, fine(row.payload_kg), fine(row.screen_height_m)];
    key.push(row.stand.map_or(-1, |stand| stand as i64));
    key.extend(row.direction.iter().map(|sign| fine(*sign)));
    key
}

/// The widest directions of a cloud of points, and its spread (root mean square) along the
/// others.
fn principal(centered: DMatrix<f64>) -> (DMatrix<f64>, f64) {
    if centered.nrows() < 2 || centered.ncols() == 0 {
        return (DMatrix::zeros(centered.nrows(), 0), 0.0);
    }
    let spread = centered.transpose() * &centered / centered.nrows() as f64;
    let Some(eigen) = decompose::symmetric_eigen(spread) else {
        return (DMatrix::zeros(centered.nrows(), 0), 0.0);
    };
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let widest = eigen.eigenvalues[order[0]].max(0.0).sqrt();
    order.retain(|&k| widest > 0.0 && eigen.eigenvalues[k].max(0.0).sqrt() > THIN * widest);
    order.truncate(MOST_DIRECTIONS);
    let axes: Vec<DVector<f64>> = order.iter().map(|&k| eigen.eigenvectors.column(k).into_owned()).collect();
    if axes.is_empty() {
        return (DMatrix::zeros(centered.nrows(), 0), 0.0);
    }
    let shown: f64 = order.iter().map(|&k| eigen.eigenvalues[k].max(0.0)).sum();
    let whole: f64 = eigen.eigenvalues.iter().map(|value| value.max(0.0)).sum();
    (centered * DMatrix::from_columns(&axes), (whole - shown).max(0.0).sqrt())
}
