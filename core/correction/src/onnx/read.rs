//! A graph becomes a network, walked from its output back to its input.

use std::collections::HashMap;
use std::path::Path;

use prost::Message;

use super::proto::{Attribute, Graph, Model, Node, Tensor};
use super::{HEIGHTS, SELF_TEST, TRUST};
use crate::file::bytes;
use crate::file_error::FileError;
use crate::model::CorrectionModel;
use crate::network::{Activation, Ensemble, Network, Scaling};
use crate::published::{normalization_of, normalize_as_published};
use crate::self_test::{Answer, ROUNDED_M};

impl CorrectionModel {
    /// Reads a network with one hidden layer, or an average of such networks, from ONNX: Gemm or
    /// MatMul and Add, Relu or Tanh. Its normalization is in the graph (Sub, Div, Mul, Add with
    /// constants), in the metadata (`input_mean`, `input_std`, `output_mean`, `output_std`, a number
    /// or a list as JSON), or that of the published networks where the shape is theirs.
    ///
    /// # Errors
    /// When the file cannot be read, or its graph is another one.
    pub fn read_onnx(file: &Path) -> Result<Self, FileError> {
        let model = Model::decode(bytes(file)?.as_slice())
            .map_err(|error| FileError::not_a_model(file, format!("it is no ONNX: {error}")))?;
        let graph = model.graph.as_ref().ok_or_else(|| FileError::graph(file, "it is empty"))?;
        let mut network = Walk::of(graph).ensemble().map_err(|reason| FileError::graph(file, reason))?;
        let mut remarks = vec![];
        if network.members.iter().all(|member| member.input == Scaling::none(2)) {
            let metadata = model.metadata.iter().map(|entry| (entry.key.as_str(), entry.value.as_str()));
            let given = Metadata::of(metadata);
            for member in &mut network.members {
                // A bias that was added after the output layer looks like a normalization: it goes
                // back into the layer, so that the normalization that follows does not replace it.
                *member = member.scaled_as(&Scaling::none(2), &Scaling::none(member.outputs()));
                let remark = match given.0.is_empty() {
                    true => normalize_as_published(member),
                    false => given.normalize(member),
                };
                let shape = member.shape();
                remarks.push(remark.ok_or(FileError::NoNormalization { file: file.to_path_buf(), shape })?);
            }
            remarks.dedup();
        }
        let own = |key: &str| model.metadata.iter().find(|entry| entry.key == key).map(|entry| &entry.value);
        let heights = own(HEIGHTS).map(|text| serde_json::from_str(text)).transpose();
        let heights = heights.map_err(|error| FileError::damaged(file, error))?;
        let trust = own(TRUST).map(|text| serde_json::from_str(text)).transpose();
        let mut imported = Self::imported(file, network, heights, remarks)?;
        imported.trust = trust.map_err(|error| FileError::damaged(file, error))?;
        imported.sound(file)?;
        let kept = own(SELF_TEST).map(|text| serde_json::from_str::<Vec<Answer>>(text)).transpose();
        let kept = kept.map_err(|error| FileError::damaged(file, error))?.unwrap_or_default();
        imported.check_answers(file, &kept, ROUNDED_M)?;
        imported.provenance.software =
            format!("{} {}", model.producer_name, model.producer_version).trim().to_owned();
        Ok(imported)
    }
}

/// Why a graph whose nodes work on their own results is refused.
const IN_A_CIRCLE: &str = "its nodes go in a circle";

/// Normalization from metadata: (of the output, a spread) and numbers.
struct Metadata(Vec<((bool, bool), Vec<f64>)>);

impl Metadata {
    fn of<'a>(entries: impl Iterator<Item = (&'a str, &'a str)>) -> Self {
        let numbers = |text: &str| {
            let list = serde_json::from_str::<Vec<f64>>(text);
            list.or_else(|_| serde_json::from_str::<f64>(text).map(|number| vec![number])).ok()
        };
        Self(
            entries
                .filter_map(|(key, value)| Some((normalization_of(&[key.to_lowercase()])?, numbers(value)?)))
                .collect(),
        )
    }

    fn normalize(&self, network: &mut Network) -> Option<String> {
        let of = |output: bool, spread: bool, channels: usize| {
            let (_, numbers) = self.0.iter().find(|(what, _)| *what == (output, spread))?;
            broadcast(numbers, channels)
        };
        let outputs = network.outputs();
        let input = Scaling { mean: of(false, false, 2)?, sd: of(false, true, 2)? };
        let output = Scaling { mean: of(true, false, outputs)?, sd: of(true, true, outputs)? };
        (network.input, network.output) = (input, output);
        Some("normalization from the metadata".to_owned())
    }
}

fn broadcast(numbers: &[f64], channels: usize) -> Option<Vec<f64>> {
    match numbers.len() {
        1 => Some(vec![numbers[0]; channels]),
        length if length == channels => Some(numbers.to_vec()),
        _ => None,
    }
}

/// `scale · value + shift`, per channel; lists of one number stand for all channels.
#[derive(Clone)]
struct Affine {
    scale: Vec<f64>,
    shift: Vec<f64>,
}

impl Affine {
    fn none() -> Self {
        Self { scale: vec![1.0], shift: vec![0.0] }
    }

    /// What comes out when, before this, a node did `op` with a constant.
    fn after(&self, op: &str, constant: &[f64]) -> Result<Self, String> {
        let zip = |a: &[f64], b: &[f64], join: &dyn Fn(f64, f64) -> f64| -> Result<Vec<f64>, String> {
            let channels = a.len().max(b.len());
            match (broadcast(a, channels), broadcast(b, channels)) {
                (Some(a), Some(b)) => Ok(a.iter().zip(b).map(|(a, b)| join(*a, b)).collect()),
                _ => Err(format!("{op} joins {} and {} channels", a.len(), b.len())),
            }
        };
        let scaled = |constant: &[f64]| zip(&self.scale, constant, &|scale, c| scale * c);
        let (scale, shift): (Vec<f64>, Vec<f64>) = match op {
            "Add" => (self.scale.clone(), zip(&self.shift, &scaled(constant)?, &|shift, c| shift + c)?),
            "Sub" => (self.scale.clone(), zip(&self.shift, &scaled(constant)?, &|shift, c| shift - c)?),
            "Mul" => (scaled(constant)?, self.shift.clone()),
            _ => (zip(&self.scale, constant, &|scale, c| scale / c)?, self.shift.clone()),
        };
        Ok(Self { scale, shift })
    }

    fn wide(&self, channels: usize) -> Result<(Vec<f64>, Vec<f64>), String> {
        let both = broadcast(&self.scale, channels).zip(broadcast(&self.shift, channels));
        both.ok_or_else(|| format!("normalization does not fit {channels} channels"))
    }
}

/// A fully connected layer: per output its weights and its bias.
struct Dense {
    weights: Vec<Vec<f64>>,
    bias: Vec<f64>,
}

struct Walk<'a> {
    graph: &'a Graph,
    makers: HashMap<&'a str, &'a Node>,
    constants: HashMap<&'a str, &'a Tensor>,
}

impl<'a> Walk<'a> {
    fn of(graph: &'a Graph) -> Self {
        let makers =
            graph.nodes.iter().flat_map(|node| node.outputs.iter().map(move |name| (name.as_str(), node)));
        let mut constants: HashMap<&str, &Tensor> =
            graph.initializers.iter().map(|tensor| (tensor.name.as_str(), tensor)).collect();
        for node in graph.nodes.iter().filter(|node| node.op_type == "Constant") {
            let value = node.attributes.iter().find_map(|attribute| attribute.tensor.as_ref());
            constants.extend(node.outputs.first().map(String::as_str).zip(value));
        }
        Self { graph, makers: makers.collect(), constants }
    }

    fn ensemble(&self) -> Result<Ensemble, String> {
        let output = self.graph.outputs.first().ok_or("it has no output")?;
        let (affine, node) = self.to_node(&output.name, Affine::none())?;
        let branches: Vec<&str> = match node.op_type.as_str() {
            "Sum" | "Add" => node.inputs.iter().map(String::as_str).collect(),
            _ => vec![node.outputs[0].as_str()],
        };
        let count = branches.len() as f64;
        let members = branches.into_iter().map(|branch| self.member(branch, &affine, count));
        Ok(Ensemble { members: members.collect::<Result<_, String>>()? })
    }

    /// One network; `after` is what follows the sum of `count` of them.
    fn member(&self, name: &str, after: &Affine, count: f64) -> Result<Network, String> {
        let (inner, node) = self.to_node(name, Affine::none())?;
        let (output, from) = self.dense(node)?;
        let outputs = output.bias.len();
        let (inner_scale, inner_shift) = inner.wide(outputs)?;
        let (scale, shift) = after.wide(outputs)?;
        let bias = (0..outputs).map(|k| output.bias[k] * inner_scale[k] + inner_shift[k]).collect();
        let scaled =
            |(weights, scale): (Vec<f64>, &f64)| weights.iter().map(|weight| weight * scale).collect();
        let weights = output.weights.into_iter().zip(&inner_scale).map(scaled).collect();

        let node = self.maker(from)?;
        let activation = match node.op_type.as_str() {
            "Relu" => Activation::Relu,
            "Tanh" => Activation::Tanh,
            other => return Err(format!("{other} where Relu or Tanh is needed")),
        };
        let (inner, node) = self.to_node(input(node, 0)?, Affine::none())?;
        let (first, from) = self.dense(node)?;
        let units = first.bias.len();
        let (unit_scale, unit_shift) = inner.wide(units)?;
        let hidden = (0..units).map(|unit| match first.weights[unit].as_slice() {
            [u, v] => {
                let scale = unit_scale[unit];
                Ok([u * scale, v * scale, first.bias[unit] * scale + unit_shift[unit]])
            }
            other => Err(format!("{} inputs where a pixel (u, v) is needed", other.len())),
        });
        Ok(Network {
            activation,
            input: self.input_scaling(from)?,
            output: Scaling { mean: shift, sd: scale.iter().map(|scale| scale * count).collect() },
            hidden: hidden.collect::<Result<_, String>>()?,
            weights,
            bias,
        })
    }

    /// Steps back over arithmetic with constants, to the node that makes what it works on.
    fn to_node(&self, name: &str, mut affine: Affine) -> Result<(Affine, &'a Node), String> {
        let mut node = self.maker(name)?;
        for _ in 0..=self.graph.nodes.len() {
            let Some((next, from)) = self.arithmetic(node, &affine)? else { return Ok((affine, node)) };
            affine = next;
            node = self.maker(from)?;
        }
        Err(IN_A_CIRCLE.to_owned())
    }

    fn input_scaling(&self, mut name: &'a str) -> Result<Scaling, String> {
        let (mut affine, mut steps) = (Affine::none(), 0);
        while let Some(node) = self.makers.get(name) {
            steps += 1;
            if steps > self.graph.nodes.len() {
                return Err(IN_A_CIRCLE.to_owned());
            }
            let step = self.arithmetic(node, &affine)?;
            (affine, name) = step.ok_or_else(|| format!("{} before the hidden layer", node.op_type))?;
        }
        let (scale, shift) = affine.wide(2)?;
        Ok(Scaling {
            mean: shift.iter().zip(&scale).map(|(shift, scale)| -shift / scale + 0.0).collect(),
            sd: scale.iter().map(|scale| 1.0 / scale).collect(),
        })
    }

    /// A node that only adds, subtracts, multiplies or divides by a constant: what comes out, and
    /// what it works on. `None` for any other node.
    fn arithmetic(&self, node: &'a Node, affine: &Affine) -> Result<Option<(Affine, &'a str)>, String> {
        let op = node.op_type.as_str();
        if op == "Identity" {
            return Ok(Some((affine.clone(), input(node, 0)?)));
        }
        if !["Add", "Sub", "Mul", "Div"].contains(&op) || node.inputs.len() != 2 {
            return Ok(None);
        }
        let (first, second) = (node.inputs[0].as_str(), node.inputs[1].as_str());
        match (self.constants.contains_key(first), self.constants.contains_key(second)) {
            (false, true) => Ok(Some((affine.after(op, &self.numbers(second)?)?, first))),
            (true, false) if ["Add", "Mul"].contains(&op) => {
                Ok(Some((affine.after(op, &self.numbers(first)?)?, second)))
            }
            (true, _) => Err(format!("{op} of a constant by what is computed")),
            (false, false) => Ok(None),
        }
    }

    /// A layer and what it works on.
    fn dense(&self, node: &'a Node) -> Result<(Dense, &'a str), String> {
        if node.op_type != "Gemm" && node.op_type != "MatMul" {
            return Err(format!("{} where Gemm or MatMul is needed", node.op_type));
        }
        let kernel = input(node, 1)?;
        let tensor = self.constants.get(kernel).ok_or("a kernel that is no constant")?;
        let numbers = self.numbers(kernel)?;
        let [rows, columns] = tensor.dims[..] else {
            return Err(format!("a kernel with {} dimensions", tensor.dims.len()));
        };
        let (rows, columns) = (rows as usize, columns as usize);
        let attribute = |name: &str| node.attributes.iter().find(|attribute| attribute.name == name);
        let int = |name: &str| attribute(name).and_then(|Attribute { int, .. }| *int).unwrap_or(0);
        let float = |name: &str| f64::from(attribute(name).and_then(|a| a.float).unwrap_or(1.0));
        if int("transA") != 0 {
            return Err("a transposed input".to_owned());
        }
        let transposed = int("transB") != 0;
        let (inputs, outputs) = if transposed { (columns, rows) } else { (rows, columns) };
        let at = |output: usize, input: usize| {
            if transposed { numbers[output * columns + input] } else { numbers[input * columns + output] }
        };
        let row = |output: usize| (0..inputs).map(|input| float("alpha") * at(output, input)).collect();
        let bias = match node.inputs.get(2).filter(|name| !name.is_empty()) {
            Some(name) => {
                broadcast(&self.numbers(name)?, outputs).ok_or("a bias of another length than its layer")?
            }
            None => vec![0.0; outputs],
        };
        let bias = bias.iter().map(|bias| float("beta") * bias).collect();
        Ok((Dense { weights: (0..outputs).map(row).collect(), bias }, input(node, 0)?))
    }

    fn maker(&self, name: &str) -> Result<&'a Node, String> {
        self.makers.get(name).copied().ok_or_else(|| format!("nothing computes \"{name}\""))
    }

    fn numbers(&self, name: &str) -> Result<Vec<f64>, String> {
        let tensor = self.constants.get(name).ok_or_else(|| format!("\"{name}\" is no constant"))?;
        tensor.numbers().ok_or_else(|| format!("the constant \"{name}\" is not of floating point numbers"))
    }
}

fn input(node: &Node, index: usize) -> Result<&str, String> {
    let name = node.inputs.get(index).map(String::as_str);
    name.ok_or_else(|| format!("{} without its input {index}", node.op_type))
}
