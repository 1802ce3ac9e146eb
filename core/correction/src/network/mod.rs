//! Networks with one hidden layer, from a touch pixel to coordinates in the robot frame.
//!
//! `y = mean_y + sd_y · (c + W · a(V · (x − mean_x) / sd_x + b))`, a = ReLU or tanh. The scaling of
//! inputs and outputs belongs to the network: nobody can use one without the other.

mod adam;
mod evidence;
mod lbfgs;
mod objective;
#[cfg(test)]
mod tests;

pub use adam::{Adam, fit_published};
pub use evidence::{EvidenceOptions, fit_evidence};

use plumbline_model::Pixel;
use plumbline_model::session::Screen;
use serde::{Deserialize, Serialize};

/// What a hidden unit does with its sum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Activation {
    /// max(0, a), as published: straight lines outside of the data.
    #[default]
    Relu,
    /// Hyperbolic tangent: smooth, and what bends is constant far outside of the data.
    Tanh,
}

impl Activation {
    fn of(self, sum: f64) -> f64 {
        match self {
            Self::Relu => sum.max(0.0),
            // Three times as fast as `tanh`, and as exact to 1e-16.
            Self::Tanh => 1.0 - 2.0 / ((2.0 * sum).exp() + 1.0),
        }
    }

    /// Derivative where the sum is `sum` and the value `value`.
    fn slope(self, sum: f64, value: f64) -> f64 {
        match self {
            Self::Relu => f64::from(u8::from(sum > 0.0)),
            Self::Tanh => 1.0 - value * value,
        }
    }
}

/// `(raw − mean) / sd`, per channel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    /// Subtracted.
    pub mean: Vec<f64>,
    /// Divided by; positive.
    pub sd: Vec<f64>,
}

impl Scaling {
    /// Mean and standard deviation of each channel of these rows.
    pub fn per_channel(rows: &[Vec<f64>]) -> Self {
        let channels = rows.first().map_or(0, Vec::len);
        let of = |channel: usize| mean_and_sd(rows.iter().map(move |row| row[channel]));
        let (mean, sd) = (0..channels).map(of).unzip();
        Self { mean, sd }
    }

    /// One mean and one standard deviation over all channels together, as published.
    pub fn scalar(rows: &[Vec<f64>]) -> Self {
        let channels = rows.first().map_or(0, Vec::len);
        let (mean, sd) = mean_and_sd(rows.iter().flatten().copied());
        Self { mean: vec![mean; channels], sd: vec![sd; channels] }
    }

    /// Leaves everything as it is.
    pub fn none(channels: usize) -> Self {
        Self { mean: vec![0.0; channels], sd: vec![1.0; channels] }
    }

    /// Scaled.
    pub fn apply(&self, raw: &[f64]) -> Vec<f64> {
        raw.iter().zip(&self.mean).zip(&self.sd).map(|((raw, mean), sd)| (raw - mean) / sd).collect()
    }

    /// The other way.
    pub fn undo(&self, scaled: &[f64]) -> Vec<f64> {
        scaled.iter().zip(&self.mean).zip(&self.sd).map(|((scaled, mean), sd)| scaled * sd + mean).collect()
    }

    fn is_sound(&self, channels: usize) -> bool {
        self.mean.len() == channels
            && self.sd.len() == channels
            && self.mean.iter().all(|mean| mean.is_finite())
            && self.sd.iter().all(|sd| sd.is_finite() && *sd > 0.0)
    }
}

/// A channel that does not vary is only shifted.
fn mean_and_sd(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    let sd = variance.sqrt();
    (mean, if sd > 1e-12 { sd } else { 1.0 })
}

/// A network with one hidden layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Network {
    /// What its hidden units do.
    pub activation: Activation,
    /// Of the touch pixel, px.
    pub input: Scaling,
    /// Of the coordinates, m.
    pub output: Scaling,
    /// Per hidden unit its weights of u and v, and its bias.
    pub hidden: Vec<[f64; 3]>,
    /// Per output its weights of the hidden units.
    pub weights: Vec<Vec<f64>>,
    /// Per output its bias.
    pub bias: Vec<f64>,
}

impl Network {
    /// Number of outputs.
    pub fn outputs(&self) -> usize {
        self.bias.len()
    }

    /// Shape in the way of the literature: "2–64–3".
    pub fn shape(&self) -> String {
        format!("2–{}–{}", self.hidden.len(), self.outputs())
    }

    /// The answer for a pixel, m.
    pub fn at(&self, pixel: Pixel<Screen>) -> Vec<f64> {
        let x = self.input.apply(&[pixel.u_px, pixel.v_px]);
        let mut scaled = self.bias.clone();
        for (unit, [u, v, bias]) in self.hidden.iter().enumerate() {
            let value = self.activation.of(u * x[0] + v * x[1] + bias);
            for (output, weights) in scaled.iter_mut().zip(&self.weights) {
                *output += weights[unit] * value;
            }
        }
        self.output.undo(&scaled)
    }

    /// The same network with other scalings: its weights make up for them.
    pub fn scaled_as(&self, input: &Scaling, output: &Scaling) -> Self {
        let mut hidden = self.hidden.clone();
        for unit in &mut hidden {
            for channel in 0..2 {
                let (mean, sd) = (self.input.mean[channel], self.input.sd[channel]);
                unit[2] += unit[channel] * (input.mean[channel] - mean) / sd;
                unit[channel] *= input.sd[channel] / sd;
            }
        }
        let (mut weights, mut bias) = (self.weights.clone(), self.bias.clone());
        for (channel, (weights, bias)) in weights.iter_mut().zip(&mut bias).enumerate() {
            let ratio = self.output.sd[channel] / output.sd[channel];
            weights.iter_mut().for_each(|weight| *weight *= ratio);
            *bias = *bias * ratio + (self.output.mean[channel] - output.mean[channel]) / output.sd[channel];
        }
        let (input, output) = (input.clone(), output.clone());
        Self { activation: self.activation, input, output, hidden, weights, bias }
    }

    /// Why the network cannot be used; `None` when it can.
    pub fn fault(&self) -> Option<String> {
        let (units, outputs) = (self.hidden.len(), self.outputs());
        let numbers = self.weights.iter().flatten().chain(&self.bias).chain(self.hidden.iter().flatten());
        if units == 0 || !(2..=3).contains(&outputs) {
            Some(format!("a network has to be 2–H–2 or 2–H–3, this one is {}", self.shape()))
        } else if self.weights.len() != outputs || self.weights.iter().any(|weights| weights.len() != units) {
            let rows: Vec<usize> = self.weights.iter().map(Vec::len).collect();
            Some(format!("the output weights of a network {} have the lengths {rows:?}", self.shape()))
        } else if !self.input.is_sound(2) || !self.output.is_sound(outputs) {
            Some(
                "the normalization of a network is incomplete, or has a spread that is not positive"
                    .to_owned(),
            )
        } else if numbers.into_iter().any(|number| !number.is_finite()) {
            Some("a weight of a network is not a finite number".to_owned())
        } else {
            None
        }
    }
}

/// Networks of one shape whose answers are averaged. The average of networks of a shape is again
/// a network with one hidden layer, of the units of all of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ensemble {
    /// At least one.
    pub members: Vec<Network>,
}

impl Ensemble {
    /// The mean answer for a pixel, m.
    pub fn at(&self, pixel: Pixel<Screen>) -> Vec<f64> {
        let mut sum = vec![0.0; self.outputs()];
        for member in &self.members {
            for (sum, value) in sum.iter_mut().zip(member.at(pixel)) {
                *sum += value;
            }
        }
        sum.iter().map(|sum| sum / self.members.len() as f64).collect()
    }

    /// Number of outputs.
    pub fn outputs(&self) -> usize {
        self.members.first().map_or(0, Network::outputs)
    }

    /// Why it cannot be used; `None` when it can.
    pub fn fault(&self) -> Option<String> {
        if self.members.is_empty() {
            return Some("there is no network in the model".to_owned());
        }
        if self.members.iter().any(|member| member.outputs() != self.outputs()) {
            return Some("the networks of the model have different numbers of outputs".to_owned());
        }
        self.members.iter().find_map(Network::fault)
    }
}

/// What a network learns from: rows of inputs (px) and outputs (m).
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Touch pixels (u, v), px.
    pub inputs: Vec<Vec<f64>>,
    /// Coordinates, m.
    pub outputs: Vec<Vec<f64>>,
}

impl Samples {
    /// Root of the mean squared distance between the network's answers and the outputs, m, over
    /// x and y only: what the loss curves show.
    pub fn rms_2d_m(&self, network: &Network) -> f64 {
        let squares = self.inputs.iter().zip(&self.outputs).map(|(input, output)| {
            let answer = network.at(Pixel::new(input[0], input[1]));
            (answer[0] - output[0]).powi(2) + (answer[1] - output[1]).powi(2)
        });
        (squares.sum::<f64>() / self.inputs.len().max(1) as f64).sqrt()
    }
}

/// How far training has got.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Counted from 1: an epoch of the published recipe, a step of the hidden layer of ours.
    pub iteration: usize,
    /// 2D rms of the samples that are learned from, m.
    pub train_rms_m: f64,
    /// 2D rms of samples that are not, m.
    pub held_out_rms_m: Option<f64>,
}

/// Why a network could not be trained.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// It was cancelled.
    #[error(transparent)]
    Cancelled(#[from] plumbline_model::Cancelled),
    /// Its weights grew beyond all bounds.
    #[error(
        "training diverged in iteration {iteration}: look for wild values among the touches, or choose another seed or recipe"
    )]
    Diverged {
        /// Where.
        iteration: usize,
    },
}
