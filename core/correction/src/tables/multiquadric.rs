//! Radial basis interpolation with the multiquadric.

use nalgebra::{DMatrix, DVector};

use super::TableError;

/// A standard deviation is stated from this many points on.
const FEWEST_FOR_SD: usize = 8;
/// The errors of all points count like this many near ones.
const GLOBAL_WEIGHT: f64 = 4.0;

/// An interpolation of values over places of any dimension.
#[derive(Clone, Debug)]
pub(super) struct Multiquadric {
    places: Vec<Vec<f64>>,
    epsilon: f64,
    weights: DVector<f64>,
    /// Of each point, when it is left out: measured − predicted.
    errors: Vec<f64>,
}

impl Multiquadric {
    /// `places` are distinct, as many as `values`, and of equal dimension.
    pub fn new(places: Vec<Vec<f64>>, values: &[f64], smoothing: f64) -> Result<Self, TableError> {
        let epsilon = epsilon(&places).ok_or(TableError::Singular)?;
        let n = places.len();
        let matrix = DMatrix::from_fn(n, n, |i, j| {
            basis(distance(&places[i], &places[j]), epsilon) - if i == j { smoothing } else { 0.0 }
        });
        let inverse = matrix.clone().try_inverse().ok_or(TableError::Singular)?;
        let weights = matrix.lu().solve(&DVector::from_row_slice(values)).ok_or(TableError::Singular)?;
        let errors: Vec<f64> = (0..n).map(|k| weights[k] / inverse[(k, k)]).collect();
        if errors.iter().chain(weights.iter()).all(|value| value.is_finite()) {
            Ok(Self { places, epsilon, weights, errors })
        } else {
            Err(TableError::Singular)
        }
    }

    pub fn value(&self, place: &[f64]) -> f64 {
        let term = |(at, weight): (&Vec<f64>, &f64)| weight * basis(distance(at, place), self.epsilon);
        self.places.iter().zip(&self.weights).map(term).sum()
    }

    pub fn errors(&self) -> &[f64] {
        &self.errors
    }

    /// Root mean square of the errors of the points near a place.
    pub fn sd(&self, place: &[f64]) -> Option<f64> {
        let n = self.places.len();
        if n < FEWEST_FOR_SD {
            return None;
        }
        let mean = self.errors.iter().map(|error| error.powi(2)).sum::<f64>() / n as f64;
        let (mut weights, mut sum) = (GLOBAL_WEIGHT, GLOBAL_WEIGHT * mean);
        for (at, error) in self.places.iter().zip(&self.errors) {
            let weight = (-0.5 * (distance(at, place) / self.epsilon).powi(2)).exp();
            weights += weight;
            sum += weight * error.powi(2);
        }
        Some((sum / weights).sqrt())
    }
}

fn basis(distance: f64, epsilon: f64) -> f64 {
    (1.0 + (distance / epsilon).powi(2)).sqrt()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Edge of a cell of the bounding box, one cell per place; flat directions do not count. `None`
/// if all places are one.
pub(super) fn epsilon(places: &[Vec<f64>]) -> Option<f64> {
    let edges: Vec<f64> = (0..places.first()?.len())
        .map(|k| {
            let along = places.iter().map(|place| place[k]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        })
        .filter(|&edge| edge != 0.0)
        .collect();
    let volume = edges.iter().product::<f64>() / places.len() as f64;
    (!edges.is_empty()).then(|| volume.powf(1.0 / edges.len() as f64))
}
