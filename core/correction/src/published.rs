//! Published networks: weights as JSON in the order of Keras.
//!
//! Either a list of four arrays (kernel 2×H, bias H, kernel H×K, bias K), or objects and lists that
//! hold the same four under any names of layers and weights. Numbers whose name says mean or std,
//! of input or output, are the normalization.

use std::path::Path;

use plumbline_model::files::shortened;
use serde_json::Value;

use crate::file::json;
use crate::file_error::FileError;
use crate::heights::HeightGrid;
use crate::model::{CorrectionModel, Parts, Provenance};
use crate::network::{Activation, Ensemble, Network, Scaling};
use crate::self_test::EXACT_M;

/// Mean and spread of all inputs of the published networks, px.
const INPUT: (f64, f64) = (799.522_45, 363.955_20);
/// Of all outputs of the published M2 (2–16–2), m.
const OUTPUT_M2: (f64, f64) = (0.179_296, 0.205_056);
/// Of all outputs of the published M3 (2–64–3), m.
const OUTPUT_M3: (f64, f64) = (0.141_192, 0.175_916);

impl CorrectionModel {
    /// Reads a published network: ReLU, weights in the order of Keras. A network of two outputs
    /// becomes an M2 with the published table of heights. Its touches are not in the file, so
    /// nothing is known of its border.
    ///
    /// # Errors
    /// When the file cannot be read, the shapes are wrong, a number is missing, or an unpublished
    /// shape comes without normalization.
    pub fn read_published(file: &Path) -> Result<Self, FileError> {
        let mut found = Found::default();
        found.gather(&json(file)?, &mut vec![]);
        let (hidden, weights, bias) = found
            .layers()
            .ok_or_else(|| FileError::Shapes { file: file.to_path_buf(), found: found.shapes() })?;
        let mut network = Network {
            activation: Activation::Relu,
            input: Scaling { mean: vec![0.0; 2], sd: vec![1.0; 2] },
            output: Scaling { mean: vec![0.0; bias.len()], sd: vec![1.0; bias.len()] },
            hidden,
            weights,
            bias,
        };
        // Half a normalization is not made whole by another network's.
        let remark = match found.normalization.is_empty() {
            true => normalize_as_published(&mut network),
            false => found.normalize(&mut network),
        };
        let Some(remark) = remark else {
            let shape = network.shape();
            return Err(FileError::NoNormalization { file: file.to_path_buf(), shape });
        };
        Self::imported(file, Ensemble { members: vec![network] }, None, vec![remark])
    }

    /// A model of networks from elsewhere.
    pub(crate) fn imported(
        file: &Path,
        network: Ensemble,
        heights: Option<HeightGrid>,
        mut remarks: Vec<String>,
    ) -> Result<Self, FileError> {
        let parts = if network.outputs() == 2 {
            if heights.is_none() {
                remarks.push("the height is that of the published table".to_owned());
            }
            Parts::M2 { network, heights: heights.unwrap_or_else(HeightGrid::published) }
        } else {
            Parts::M3 { network }
        };
        let provenance = Provenance {
            session: file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default(),
            software: String::new(),
            made: jiff::Timestamp::now(),
            touches: vec![],
            left_out: vec![],
            options: None,
            without: None,
            training: None,
            cross_validation: None,
            remarks,
        };
        let model = Self { parts, trust: None, provenance };
        model.sound(file)?;
        model.check_answers(file, &[], EXACT_M)?;
        Ok(model)
    }
}

/// Gives a network of a published shape the published normalization and says so.
pub(crate) fn normalize_as_published(network: &mut Network) -> Option<String> {
    let output = match (network.hidden.len(), network.outputs()) {
        (16, 2) => OUTPUT_M2,
        (64, 3) => OUTPUT_M3,
        _ => return None,
    };
    let scaling =
        |(mean, sd): (f64, f64), channels| Scaling { mean: vec![mean; channels], sd: vec![sd; channels] };
    network.input = scaling(INPUT, 2);
    network.output = scaling(output, network.outputs());
    Some(format!("the file holds no normalization: that of the published {} was used", network.shape()))
}

/// Arrays of a JSON document.
#[derive(Default)]
struct Found {
    matrices: Vec<Vec<Vec<f64>>>,
    vectors: Vec<Vec<f64>>,
    /// (of the output, a spread, numbers)
    normalization: Vec<(bool, bool, Vec<f64>)>,
    /// Lists of lists whose lengths differ.
    ragged: usize,
}

/// Hidden units, output weights, output biases.
type Layers = (Vec<[f64; 3]>, Vec<Vec<f64>>, Vec<f64>);

impl Found {
    fn gather(&mut self, value: &Value, path: &mut Vec<String>) {
        if let Some((output, spread)) = normalization_of(path)
            && let Some(numbers) = numbers(value).or_else(|| Some(vec![value.as_f64()?]))
        {
            return self.normalization.push((output, spread, numbers));
        }
        match value {
            Value::Object(entries) => {
                for (name, value) in entries {
                    path.push(name.to_lowercase());
                    self.gather(value, path);
                    path.pop();
                }
            }
            Value::Array(items) => {
                if let Some(vector) = numbers(value) {
                    self.vectors.push(vector);
                } else if let Some(matrix) =
                    items.iter().map(numbers).collect::<Option<Vec<_>>>().filter(|rows| !rows.is_empty())
                {
                    let even = matrix.windows(2).all(|rows| rows[0].len() == rows[1].len());
                    if even { self.matrices.push(matrix) } else { self.ragged += 1 }
                } else {
                    items.iter().for_each(|item| self.gather(item, path));
                }
            }
            _ => {}
        }
    }

    /// The four arrays, told apart by their shapes, in the order of the file where shapes agree.
    fn layers(&self) -> Option<Layers> {
        let ([first, second], [a, b]) = (self.matrices.as_slice(), self.vectors.as_slice()) else {
            return None;
        };
        let fits = |kernel: &[Vec<f64>], next: &[Vec<f64>]| {
            kernel.len() == 2 && kernel[0].len() == next.len() && (2..=3).contains(&next[0].len())
        };
        let (kernel, output) = match (fits(first, second), fits(second, first)) {
            (true, _) => (first, second),
            (_, true) => (second, first),
            _ => return None,
        };
        let (units, outputs) = (output.len(), output[0].len());
        // Of a 2–H–2 the transposed kernels (H×2, 2×H, as PyTorch has them) have the shapes of these
        // in the other order: only biases in the order of their kernels tell which they are.
        let paired = [first, second].map(|kernel| kernel[0].len()) == [a.len(), b.len()];
        if outputs == 2 && !paired {
            return None;
        }
        let (bias, output_bias) =
            match (a.len() == units && b.len() == outputs, b.len() == units && a.len() == outputs) {
                (true, _) => (a, b),
                (_, true) => (b, a),
                _ => return None,
            };
        let hidden = (0..units).map(|unit| [kernel[0][unit], kernel[1][unit], bias[unit]]).collect();
        let weights = (0..outputs).map(|k| output.iter().map(|unit| unit[k]).collect()).collect();
        Some((hidden, weights, output_bias.clone()))
    }

    /// Uses the file's normalization if it is complete; says so.
    fn normalize(&self, network: &mut Network) -> Option<String> {
        let of = |output: bool, spread: bool, channels: usize| {
            let mut found = self.normalization.iter().filter(|(o, s, _)| *o == output && *s == spread);
            let (_, _, numbers) = found.next()?;
            match numbers.len() {
                1 => Some(vec![numbers[0]; channels]),
                length if length == channels => Some(numbers.clone()),
                _ => None,
            }
        };
        let outputs = network.outputs();
        let input = Scaling { mean: of(false, false, 2)?, sd: of(false, true, 2)? };
        let output = Scaling { mean: of(true, false, outputs)?, sd: of(true, true, outputs)? };
        (network.input, network.output) = (input, output);
        Some("normalization from the file".to_owned())
    }

    fn shapes(&self) -> String {
        let matrices = self.matrices.iter().map(|m| format!("{}×{}", m.len(), m[0].len()));
        let vectors = self.vectors.iter().map(|v| v.len().to_string());
        let ragged = (0..self.ragged).map(|_| "rows of different lengths".to_owned());
        let shapes: Vec<String> = matrices.chain(vectors).chain(ragged).collect();
        if shapes.is_empty() { "none".to_owned() } else { shortened(&shapes.join(", ")) }
    }
}

/// Numbers only, and at least one.
fn numbers(value: &Value) -> Option<Vec<f64>> {
    let items = value.as_array().filter(|items| !items.is_empty())?;
    items.iter().map(Value::as_f64).collect()
}

/// Whether these names mean a normalization: (of the output, a spread).
pub(crate) fn normalization_of(path: &[String]) -> Option<(bool, bool)> {
    let joined = path.join("_");
    let words: Vec<&str> = joined.split(|c: char| !c.is_alphanumeric()).collect();
    let has = |names: &[&str]| words.iter().any(|word| names.contains(word));
    let spread = match (has(&["mean", "means"]), has(&["std", "sd", "scale", "stds"])) {
        (true, false) => false,
        (false, true) => true,
        _ => return None,
    };
    match (has(&["input", "inputs", "in", "x"]), has(&["output", "outputs", "out", "target", "targets", "y"]))
    {
        (true, false) => Some((false, spread)),
        (false, true) => Some((true, spread)),
        _ => None,
    }
}
