//! A network becomes a graph.

use std::path::Path;

use prost::Message;

use super::proto::{
    Dimension, Entry, FLOAT, Graph, Model, Node, OperatorSet, Shape, Tensor, TensorType, Type, ValueInfo,
};
use super::{HEIGHTS, INPUT, METHOD, OUTPUT, SELF_TEST, TRUST};
use crate::file::replace;
use crate::file_error::FileError;
use crate::model::{CorrectionModel, Parts};
use crate::network::{Activation, Network};

/// Of the file format and of the operators.
const IR_VERSION: i64 = 7;
const OPSET: i64 = 13;

impl CorrectionModel {
    /// Writes the networks of an M2 or M3 as ONNX, normalization inside; see the module for the
    /// graph.
    ///
    /// # Errors
    /// For M1, which has no network, and when the file cannot be written.
    pub fn write_onnx(&self, file: &Path) -> Result<(), FileError> {
        self.sound(file)?;
        let network = self.parts.network().ok_or(FileError::NotANetwork)?;
        let mut metadata = vec![entry(METHOD, self.method().name().to_owned())];
        let text =
            |value: Result<String, serde_json::Error>| value.map_err(|error| FileError::damaged(file, error));
        if let Parts::M2 { heights, .. } = &self.parts {
            metadata.push(entry(HEIGHTS, text(serde_json::to_string(heights))?));
        }
        if let Some(trust) = &self.trust {
            metadata.push(entry(TRUST, text(serde_json::to_string(trust))?));
        }
        metadata.push(entry(SELF_TEST, text(serde_json::to_string(&self.answers()))?));
        let model = Model {
            ir_version: IR_VERSION,
            producer_name: "plumbline".to_owned(),
            producer_version: self.provenance.software.clone(),
            graph: Some(graph(&network.members)),
            opset_import: vec![OperatorSet { domain: String::new(), version: OPSET }],
            metadata,
        };
        replace(file, &model.encode_to_vec())
    }
}

fn entry(key: &str, value: String) -> Entry {
    Entry { key: key.to_owned(), value }
}

fn graph(members: &[Network]) -> Graph {
    let first = &members[0];
    let outputs = first.outputs();
    let mut builder = Builder::default();
    builder.constant("input_mean", &[2], first.input.mean.iter().copied());
    builder.constant("input_sd", &[2], first.input.sd.iter().copied());
    builder.node("Sub", &[INPUT, "input_mean"], "centered");
    builder.node("Div", &["centered", "input_sd"], "scaled");
    let mut answers = vec![];
    for (index, member) in members.iter().enumerate() {
        // One normalization serves all branches.
        answers.push(builder.branch(index, &member.scaled_as(&first.input, &first.output)));
    }
    let answers: Vec<&str> = answers.iter().map(String::as_str).collect();
    let sum = if answers.len() == 1 { answers[0] } else { "sum" };
    if answers.len() > 1 {
        builder.node("Sum", &answers, "sum");
    }
    let count = members.len() as f64;
    builder.constant("output_sd", &[outputs], first.output.sd.iter().map(|sd| sd / count));
    builder.constant("output_mean", &[outputs], first.output.mean.iter().copied());
    builder.node("Mul", &[sum, "output_sd"], "spread");
    builder.node("Add", &["spread", "output_mean"], OUTPUT);
    Graph {
        nodes: builder.nodes,
        name: "correction".to_owned(),
        initializers: builder.constants,
        inputs: vec![value_info(INPUT, 2)],
        outputs: vec![value_info(OUTPUT, outputs)],
    }
}

fn value_info(name: &str, channels: usize) -> ValueInfo {
    let dims = vec![
        Dimension { value: None, parameter: Some("N".to_owned()) },
        Dimension { value: Some(channels as i64), parameter: None },
    ];
    let tensor = TensorType { element: FLOAT, shape: Some(Shape { dims }) };
    ValueInfo { name: name.to_owned(), kind: Some(Type { tensor: Some(tensor) }) }
}

#[derive(Default)]
struct Builder {
    nodes: Vec<Node>,
    constants: Vec<Tensor>,
}

impl Builder {
    fn constant(&mut self, name: &str, dims: &[usize], numbers: impl Iterator<Item = f64>) {
        self.constants.push(Tensor {
            dims: dims.iter().map(|dim| *dim as i64).collect(),
            data_type: FLOAT,
            raw: numbers.flat_map(|number| (number as f32).to_le_bytes()).collect(),
            name: name.to_owned(),
            ..Tensor::default()
        });
    }

    fn node(&mut self, op_type: &str, inputs: &[&str], output: &str) {
        self.nodes.push(Node {
            inputs: inputs.iter().map(|&input| input.to_owned()).collect(),
            outputs: vec![output.to_owned()],
            name: format!("{op_type}_{output}"),
            op_type: op_type.to_owned(),
            attributes: vec![],
        });
    }

    /// The layers of one network; the name of their result.
    fn branch(&mut self, index: usize, network: &Network) -> String {
        let name = |what: &str| format!("{what}_{index}");
        let (units, outputs) = (network.hidden.len(), network.outputs());
        let kernel = (0..2).flat_map(|input| network.hidden.iter().map(move |unit| unit[input]));
        self.constant(&name("hidden_kernel"), &[2, units], kernel);
        self.constant(&name("hidden_bias"), &[units], network.hidden.iter().map(|unit| unit[2]));
        let kernel = (0..units).flat_map(|unit| network.weights.iter().map(move |weights| weights[unit]));
        self.constant(&name("output_kernel"), &[units, outputs], kernel);
        self.constant(&name("output_bias"), &[outputs], network.bias.iter().copied());
        let activation = match network.activation {
            Activation::Relu => "Relu",
            Activation::Tanh => "Tanh",
        };
        self.node("Gemm", &["scaled", &name("hidden_kernel"), &name("hidden_bias")], &name("hidden"));
        self.node(activation, &[&name("hidden")], &name("units"));
        self.node("Gemm", &[&name("units"), &name("output_kernel"), &name("output_bias")], &name("answer"));
        name("answer")
    }
}
