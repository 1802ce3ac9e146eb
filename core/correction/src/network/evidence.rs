//! Our training: the output layer is solved, its shrinkage comes from the evidence (MacKay 1992),
//! rows far off weigh less (Student's t), and the hidden layer takes a few quasi-Newton steps
//! while it is held to its random draw.
//!
//! Each member of an ensemble has its own draw to which it is held, so that the members differ
//! where the data say little ("anchored ensembles").

use nalgebra::{DMatrix, SymmetricEigen};
use plumbline_model::JobContext;
use plumbline_model::decompose;
use rand::rngs::StdRng;
use rand::{Rng, SeedableRng};

use super::lbfgs::{self, At};
use super::objective::{Evaluation, Objective, Precision};
use super::{Activation, FitError, Network, Samples, Scaling, Step};

/// Rounds of estimating precisions and row weights before the hidden layer moves.
const ROUNDS: usize = 2;
/// Updates of the precisions in a round.
const EVIDENCE_UPDATES: usize = 10;
/// Degrees of freedom of the noise: between heavy tails and a normal distribution.
const STUDENT_FREEDOM: f64 = 4.0;
/// Noise below this part of an output's spread is not told from none.
const LEAST_NOISE: f64 = 1e-5;
/// Ridge against the largest eigenvalue: smaller ones lose the output layer in rounding.
const LEAST_RIDGE: f64 = 1e-10;
/// Largest ridge, per row: with heavy tails in the noise the evidence shrinks what bends too much,
/// which shows where whole areas are held out.
const LARGEST_RIDGE: f64 = 2.5;
/// A tanh unit this flat is a straight line to 1e-8 of its range, and exact enough in 32 bits.
const FLAT: f64 = 1e-4;

/// How our training works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvidenceOptions {
    /// Hidden units, those that carry the plane included.
    pub units: usize,
    /// What the hidden units do.
    pub activation: Activation,
    /// Quasi-Newton steps of the hidden layer.
    pub iterations: usize,
    /// Standard deviation of the draw of the hidden layer, inputs scaled to 1.
    pub draw_sd: f64,
}

/// Trains a network; every step of the hidden layer goes to `after`. The same seed gives the
/// same network.
///
/// # Errors
/// When cancelled, or when no finite solution exists.
pub fn fit_evidence(
    samples: &Samples,
    held_out: Option<&Samples>,
    options: &EvidenceOptions,
    seed: u64,
    job: &dyn JobContext,
    after: &mut dyn FnMut(Step),
) -> Result<Network, FitError> {
    let input = Scaling::per_channel(&samples.inputs);
    let output = Scaling::per_channel(&samples.outputs);
    let inputs = DMatrix::from_fn(samples.inputs.len(), 3, |row, column| match column {
        2 => 1.0,
        _ => (samples.inputs[row][column] - input.mean[column]) / input.sd[column],
    });
    let outputs = DMatrix::from_fn(samples.outputs.len(), output.mean.len(), |row, column| {
        (samples.outputs[row][column] - output.mean[column]) / output.sd[column]
    });
    let fit = Fit { options: *options, input, output, inputs, outputs };
    let mut random = StdRng::seed_from_u64(seed);
    let carriers = fit.carriers().len();
    let free = options.units.saturating_sub(carriers).max(1);
    let draw = DMatrix::from_fn(3, free, |_, _| options.draw_sd * normal(&mut random));

    let mut row_weights = vec![1.0; samples.inputs.len()];
    let mut objective = fit.objective(&row_weights, &draw);
    for _ in 0..ROUNDS {
        job.checkpoint()?;
        objective.estimate_precision(&draw, &fit.output.sd)?;
        let layer = objective.evaluate(&draw).ok_or(FitError::Diverged { iteration: 0 })?;
        row_weights = fit.row_weights(&fit.residuals(&objective, &layer)?);
        let precision = objective.precision.clone();
        objective = fit.objective(&row_weights, &draw);
        objective.precision = precision;
    }
    objective.estimate_precision(&draw, &fit.output.sd)?;
    let evaluate = |place: DMatrix<f64>| {
        let layer = objective.evaluate(&place)?;
        Some(At { value: layer.value, gradient: layer.gradient.clone(), place, evaluation: layer })
    };
    let start = evaluate(draw.clone()).ok_or(FitError::Diverged { iteration: 0 })?;
    let end = lbfgs::minimize(start, options.iterations, evaluate, |iteration, at| {
        job.checkpoint()?;
        let residuals = fit.residuals(&objective, &at.evaluation)?;
        let held_out_rms_m = match held_out {
            Some(held_out) => Some(held_out.rms_2d_m(&fit.network(&objective, at)?)),
            None => None,
        };
        after(Step { iteration, train_rms_m: fit.rms_2d_m(&residuals), held_out_rms_m });
        Ok::<(), FitError>(())
    })?;
    let network = fit.network(&objective, &end)?;
    match network.fault() {
        None => Ok(network),
        Some(_) => Err(FitError::Diverged { iteration: options.iterations }),
    }
}

struct Fit {
    options: EvidenceOptions,
    input: Scaling,
    output: Scaling,
    inputs: DMatrix<f64>,
    outputs: DMatrix<f64>,
}

impl Fit {
    fn objective(&self, row_weights: &[f64], draw: &DMatrix<f64>) -> Objective<'_> {
        let held = self.options.draw_sd.powi(-2);
        Objective::new(self.options.activation, &self.inputs, &self.outputs, row_weights, draw.clone(), held)
    }

    /// Predicted − given, scaled outputs, n × k.
    fn residuals(&self, objective: &Objective<'_>, layer: &Evaluation) -> Result<DMatrix<f64>, FitError> {
        let plane = objective.plane_weights(&layer.features, &layer.weights);
        let plane = plane.ok_or(FitError::Diverged { iteration: 0 })?;
        Ok(&layer.features * &layer.weights + &self.inputs * plane - &self.outputs)
    }

    /// Squared 2D distance of a row, m².
    fn square_m2(&self, residuals: &DMatrix<f64>, row: usize) -> f64 {
        (0..2).map(|axis| (residuals[(row, axis)] * self.output.sd[axis]).powi(2)).sum()
    }

    fn rms_2d_m(&self, residuals: &DMatrix<f64>) -> f64 {
        let count = residuals.nrows();
        ((0..count).map(|row| self.square_m2(residuals, row)).sum::<f64>() / count as f64).sqrt()
    }

    /// Weights of Student's t in the plane; their mean is 1.
    fn row_weights(&self, residuals: &DMatrix<f64>) -> Vec<f64> {
        let squares: Vec<f64> = (0..residuals.nrows()).map(|row| self.square_m2(residuals, row)).collect();
        let mut sorted = squares.clone();
        sorted.sort_by(f64::total_cmp);
        // The median of the squared length of a 2D normal vector is 2 ln 2 variances.
        let variance = sorted[sorted.len() / 2] / (2.0 * std::f64::consts::LN_2);
        if !(variance > 0.0) {
            return vec![1.0; squares.len()];
        }
        let weight = |square: &f64| (STUDENT_FREEDOM + 2.0) / (STUDENT_FREEDOM + square / variance);
        let weights: Vec<f64> = squares.iter().map(weight).collect();
        let mean = weights.iter().sum::<f64>() / weights.len() as f64;
        weights.iter().map(|weight| weight / mean).collect()
    }

    /// Hidden units that together carry a plane, and per unit the factors of its slopes along u
    /// and v. ReLU does it exactly: relu(a) − relu(−a) = a.
    fn carriers(&self) -> Vec<([f64; 3], [f64; 2])> {
        match self.options.activation {
            Activation::Relu => vec![
                ([1.0, 0.0, 0.0], [1.0, 0.0]),
                ([-1.0, 0.0, 0.0], [-1.0, 0.0]),
                ([0.0, 1.0, 0.0], [0.0, 1.0]),
                ([0.0, -1.0, 0.0], [0.0, -1.0]),
            ],
            Activation::Tanh => {
                vec![([FLAT, 0.0, 0.0], [1.0 / FLAT, 0.0]), ([0.0, FLAT, 0.0], [0.0, 1.0 / FLAT])]
            }
        }
    }

    fn network(&self, objective: &Objective<'_>, at: &At<Evaluation>) -> Result<Network, FitError> {
        let layer = &at.evaluation;
        let plane = objective.plane_weights(&layer.features, &layer.weights);
        let plane = plane.ok_or(FitError::Diverged { iteration: 0 })?;
        let mut hidden: Vec<[f64; 3]> =
            at.place.column_iter().map(|unit| [unit[0], unit[1], unit[2]]).collect();
        let mut weights: Vec<Vec<f64>> =
            layer.weights.column_iter().map(|column| column.iter().copied().collect()).collect();
        for (unit, [along_u, along_v]) in self.carriers() {
            hidden.push(unit);
            for (output, weights) in weights.iter_mut().enumerate() {
                weights.push(along_u * plane[(0, output)] + along_v * plane[(1, output)]);
            }
        }
        Ok(Network {
            activation: self.options.activation,
            input: self.input.clone(),
            output: self.output.clone(),
            hidden,
            weights,
            bias: plane.row(2).iter().copied().collect(),
        })
    }
}

impl Objective<'_> {
    /// Estimates the precisions for a hidden layer: those under which the outputs are likeliest.
    /// x and y share the precision of their weights, in meters: the same table bends both. `unit_m`
    /// is the size of a scaled output.
    fn estimate_precision(&mut self, hidden: &DMatrix<f64>, unit_m: &[f64]) -> Result<(), FitError> {
        let (_, features) = self.features(hidden);
        let bent = self.bent(&features);
        let transposed = bent.transpose();
        let SymmetricEigen { eigenvalues, eigenvectors } =
            decompose::symmetric_eigen(&transposed * &bent).ok_or(FitError::Diverged { iteration: 0 })?;
        let along = eigenvectors.transpose() * (&transposed * &self.bend);
        let largest = eigenvalues.max().max(f64::MIN_POSITIVE);
        let (rows, least) = (bent.nrows() as f64, LEAST_RIDGE * largest);
        let limits = Limits { rows, ridge: (least, (LARGEST_RIDGE / rows).max(least)) };
        let precision = &self.precision;
        let outputs = (0..self.bend.ncols()).map(|output| Output {
            spectrum: eigenvalues
                .iter()
                .zip(along.column(output).iter())
                .map(|(e, a)| (e.max(0.0), *a))
                .collect(),
            square: self.bend.column(output).norm_squared(),
            unit_m: unit_m[output],
            ridge: precision.weights[output] / precision.noise[output],
            noise: precision.noise[output],
        });
        let mut outputs: Vec<Output> = outputs.collect();
        let (plane, height) = outputs.split_at_mut(2);
        for shared in [plane, height] {
            for _ in 0..EVIDENCE_UPDATES {
                update(shared, &limits);
            }
        }
        self.precision = Precision {
            noise: outputs.iter().map(|output| output.noise).collect(),
            weights: outputs.iter().map(|output| output.ridge * output.noise).collect(),
        };
        Ok(())
    }
}

/// One output while its precisions are estimated.
struct Output {
    /// Eigenvalues of the features' Gram matrix, and what of the output lies along each.
    spectrum: Vec<(f64, f64)>,
    /// Squared length of what the plane leaves.
    square: f64,
    unit_m: f64,
    /// α / β.
    ridge: f64,
    /// β, scaled.
    noise: f64,
}

struct Limits {
    rows: f64,
    ridge: (f64, f64),
}

/// MacKay's update for outputs that share the precision of their weights in meters.
fn update(shared: &mut [Output], limits: &Limits) {
    let (mut effective, mut length_m2) = (0.0, 0.0);
    for output in shared.iter_mut() {
        let at =
            Solution::at(&output.spectrum, output.square, output.ridge.clamp(limits.ridge.0, limits.ridge.1));
        effective += at.effective;
        length_m2 += at.length * output.unit_m * output.unit_m;
        let least = limits.rows * LEAST_NOISE * LEAST_NOISE;
        output.noise = (limits.rows - 3.0 - at.effective).max(1.0) / at.residual.max(least);
    }
    let weights_per_m2 = effective / length_m2.max(f64::MIN_POSITIVE);
    for output in shared {
        let noise_per_m2 = output.noise / (output.unit_m * output.unit_m);
        output.ridge = (weights_per_m2 / noise_per_m2).clamp(limits.ridge.0, limits.ridge.1);
    }
}

/// One output at one ridge.
struct Solution {
    /// Parameters that the data determine (MacKay's γ).
    effective: f64,
    /// Squared length of the weights.
    length: f64,
    /// Squared residual.
    residual: f64,
}

impl Solution {
    fn at(spectrum: &[(f64, f64)], square: f64, ridge: f64) -> Self {
        let mut solution = Self { effective: 0.0, length: 0.0, residual: square };
        for (eigenvalue, along) in spectrum {
            let weight = along / (eigenvalue + ridge);
            solution.effective += eigenvalue / (eigenvalue + ridge);
            solution.length += weight * weight;
            solution.residual += weight * (weight * eigenvalue - 2.0 * along);
        }
        solution
    }
}

/// Standard normal (Box and Muller).
pub(super) fn normal(random: &mut StdRng) -> f64 {
    let radius = (-2.0 * (1.0 - random.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.random::<f64>()).cos()
}
