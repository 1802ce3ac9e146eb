//! The published training: Adam (Kingma & Ba 2015) on the mean squared error, small batches, one
//! mean and one spread for all inputs and one for all outputs.

use plumbline_model::JobContext;
use rand::rngs::StdRng;
use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};

use super::{Activation, FitError, Network, Samples, Scaling, Step};

/// Settings of the published training.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adam {
    /// Hidden units.
    pub units: usize,
    /// Step length.
    pub rate: f64,
    /// Rows per step.
    pub batch: usize,
    /// Times that every row is seen.
    pub epochs: usize,
}

impl Adam {
    /// As published, with this many hidden units.
    pub fn published(units: usize) -> Self {
        Self { units, rate: 1e-3, batch: 16, epochs: 200 }
    }
}

/// Decay of the mean of gradients, and of their squares; what keeps a division from zero. The
/// defaults of Keras.
const DECAY: (f64, f64) = (0.9, 0.999);
const FLOOR: f64 = 1e-7;

/// Trains a ReLU network in the published way; every epoch goes to `after`.
///
/// # Errors
/// When cancelled, or when the weights diverge.
pub fn fit_published(
    samples: &Samples,
    held_out: Option<&Samples>,
    settings: &Adam,
    seed: u64,
    job: &dyn JobContext,
    after: &mut dyn FnMut(Step),
) -> Result<Network, FitError> {
    let mut random = StdRng::seed_from_u64(seed);
    let (input, output) = (Scaling::scalar(&samples.inputs), Scaling::scalar(&samples.outputs));
    let rows: Vec<[f64; 2]> =
        samples.inputs.iter().map(|row| input.apply(row)).map(|x| [x[0], x[1]]).collect();
    let targets: Vec<Vec<f64>> = samples.outputs.iter().map(|row| output.apply(row)).collect();
    let outputs = output.mean.len();
    let mut layers = Layers::drawn(settings.units, outputs, &mut random);
    let mut state = State::new(layers.parameters.len());
    let mut gradient = vec![0.0; layers.parameters.len()];
    let mut order: Vec<usize> = (0..rows.len()).collect();
    for epoch in 1..=settings.epochs {
        job.checkpoint()?;
        order.shuffle(&mut random);
        for batch in order.chunks(settings.batch.max(1)) {
            gradient.fill(0.0);
            for row in batch {
                layers.add_gradient(&rows[*row], &targets[*row], batch.len(), &mut gradient);
            }
            state.step(&mut layers.parameters, &gradient, settings.rate);
        }
        let network = layers.network(&input, &output);
        let train_rms_m = samples.rms_2d_m(&network);
        if network.fault().is_some() || !train_rms_m.is_finite() {
            return Err(FitError::Diverged { iteration: epoch });
        }
        let held_out_rms_m = held_out.map(|held_out| held_out.rms_2d_m(&network));
        after(Step { iteration: epoch, train_rms_m, held_out_rms_m });
    }
    Ok(layers.network(&input, &output))
}

/// All weights in one list: per unit (u, v, bias), then per output its unit weights and bias.
struct Layers {
    units: usize,
    outputs: usize,
    parameters: Vec<f64>,
    /// Values of the hidden units for the row at hand.
    values: Vec<f64>,
}

impl Layers {
    /// Uniform in ±√(6 / (inputs + outputs)) of a layer (Glorot & Bengio 2010); biases zero.
    fn drawn(units: usize, outputs: usize, random: &mut StdRng) -> Self {
        let bound = |fan_in: usize, fan_out: usize| (6.0 / (fan_in + fan_out) as f64).sqrt();
        let (first, second) = (bound(2, units), bound(units, outputs));
        let mut parameters = vec![];
        for _ in 0..units {
            let mut draw = || random.random_range(-first..first);
            parameters.extend([draw(), draw(), 0.0]);
        }
        for _ in 0..outputs {
            parameters.extend((0..units).map(|_| random.random_range(-second..second)));
            parameters.push(0.0);
        }
        Self { units, outputs, parameters, values: vec![0.0; units] }
    }

    /// Adds this row's part of the gradient of the mean squared error.
    fn add_gradient(&mut self, input: &[f64; 2], target: &[f64], batch: usize, gradient: &mut [f64]) {
        let (hidden, output) = self.parameters.split_at(3 * self.units);
        for (value, unit) in self.values.iter_mut().zip(hidden.chunks_exact(3)) {
            *value = (unit[0] * input[0] + unit[1] * input[1] + unit[2]).max(0.0);
        }
        let (of_hidden, of_output) = gradient.split_at_mut(3 * self.units);
        let layers = output.chunks_exact(self.units + 1).zip(of_output.chunks_exact_mut(self.units + 1));
        for ((weights, of_weights), target) in layers.zip(target) {
            let (weights, bias) = weights.split_at(self.units);
            let answer: f64 = bias[0] + weights.iter().zip(&self.values).map(|(w, v)| w * v).sum::<f64>();
            let slope = 2.0 * (answer - target) / (batch * self.outputs) as f64;
            of_weights[self.units] += slope;
            for (unit, value) in self.values.iter().enumerate() {
                of_weights[unit] += slope * value;
                if *value > 0.0 {
                    let by_sum = slope * weights[unit];
                    of_hidden[3 * unit] += by_sum * input[0];
                    of_hidden[3 * unit + 1] += by_sum * input[1];
                    of_hidden[3 * unit + 2] += by_sum;
                }
            }
        }
    }

    fn network(&self, input: &Scaling, output: &Scaling) -> Network {
        let (hidden, layer) = self.parameters.split_at(3 * self.units);
        let rows = layer.chunks_exact(self.units + 1);
        Network {
            activation: Activation::Relu,
            input: input.clone(),
            output: output.clone(),
            hidden: hidden.chunks_exact(3).map(|unit| [unit[0], unit[1], unit[2]]).collect(),
            weights: rows.clone().map(|row| row[..self.units].to_vec()).collect(),
            bias: rows.map(|row| row[self.units]).collect(),
        }
    }
}

/// Adam's running means.
struct State {
    steps: i32,
    mean: Vec<f64>,
    square: Vec<f64>,
}

impl State {
    fn new(parameters: usize) -> Self {
        Self { steps: 0, mean: vec![0.0; parameters], square: vec![0.0; parameters] }
    }

    fn step(&mut self, parameters: &mut [f64], gradient: &[f64], rate: f64) {
        self.steps += 1;
        let rate = rate * (1.0 - DECAY.1.powi(self.steps)).sqrt() / (1.0 - DECAY.0.powi(self.steps));
        let means = self.mean.iter_mut().zip(&mut self.square);
        for ((parameter, slope), (mean, square)) in parameters.iter_mut().zip(gradient).zip(means) {
            *mean += (1.0 - DECAY.0) * (slope - *mean);
            *square += (1.0 - DECAY.1) * (slope * slope - *square);
            *parameter -= rate * *mean / (square.sqrt() + FLOOR);
        }
    }
}
