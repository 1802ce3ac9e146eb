//! Graphs of other programs: what they mean, and that damaged ones are refused rather than followed.

use std::path::{Path, PathBuf};

use plumbline_model::Pixel;
use prost::Message;
use tempfile::tempdir;

use super::proto::{FLOAT, Graph, Model, Node, Tensor, ValueInfo};
use crate::file_error::FileError;
use crate::model::CorrectionModel;

fn node(op_type: &str, inputs: &[&str], output: &str) -> Node {
    Node {
        inputs: inputs.iter().map(|input| (*input).to_owned()).collect(),
        outputs: vec![output.to_owned()],
        op_type: op_type.to_owned(),
        ..Node::default()
    }
}

fn tensor(name: &str, dims: &[i64], number: impl Fn(usize) -> f32) -> Tensor {
    let count = dims.iter().product::<i64>().unsigned_abs() as usize;
    Tensor {
        dims: dims.to_vec(),
        data_type: FLOAT,
        floats: (0..count).map(number).collect(),
        name: name.to_owned(),
        ..Tensor::default()
    }
}

/// Weights of the shape of the published M3.
fn constants() -> Vec<Tensor> {
    vec![
        tensor("w", &[2, 64], |i| (i as f32 * 0.7).sin()),
        tensor("b", &[64], |i| (i as f32 * 0.3).cos()),
        tensor("v", &[64, 3], |i| (i as f32 * 0.9).sin() / 64.0),
        tensor("c", &[3], |i| 0.5 + i as f32),
    ]
}

fn written(folder: &Path, nodes: Vec<Node>, initializers: Vec<Tensor>) -> PathBuf {
    let outputs = vec![ValueInfo { name: "y".to_owned(), ..ValueInfo::default() }];
    let graph = Graph { nodes, initializers, outputs, ..Graph::default() };
    let file = folder.join("network.onnx");
    let model = Model { ir_version: 7, graph: Some(graph), ..Model::default() };
    std::fs::write(&file, model.encode_to_vec()).expect("written");
    file
}

fn gemm() -> Vec<Node> {
    vec![node("Gemm", &["x", "w", "b"], "p"), node("Relu", &["p"], "q"), node("Gemm", &["q", "v", "c"], "y")]
}

#[test]
fn a_bias_that_is_added_after_the_layer_is_no_normalization() {
    let folder = tempdir().expect("a folder");
    let whole = CorrectionModel::read_onnx(&written(folder.path(), gemm(), constants())).expect("read");
    // The same network as Keras exports it.
    let apart = vec![
        node("MatMul", &["x", "w"], "a"),
        node("Add", &["a", "b"], "p"),
        node("Relu", &["p"], "q"),
        node("MatMul", &["q", "v"], "s"),
        node("Add", &["s", "c"], "y"),
    ];
    let apart = CorrectionModel::read_onnx(&written(folder.path(), apart, constants())).expect("read");
    assert_eq!(whole.provenance().remarks, apart.provenance().remarks);
    for place in [[0.0, 0.0], [700.0, 500.0], [1900.0, 1000.0]] {
        let pixel = Pixel::new(place[0], place[1]);
        let distance_m = whole.correct(pixel).target.distance_m(&apart.correct(pixel).target);
        assert!(distance_m < 1e-9, "{distance_m}");
    }
}

#[test]
fn a_graph_that_goes_in_a_circle_is_refused() {
    let folder = tempdir().expect("a folder");
    let mut before = vec![node("Add", &["x2", "c"], "x1"), node("Add", &["x1", "c"], "x2")];
    before.extend(gemm());
    before[2].inputs[0] = "x2".to_owned();
    for nodes in [vec![node("Identity", &["y"], "y")], before] {
        let refused = CorrectionModel::read_onnx(&written(folder.path(), nodes, constants()));
        let message = refused.expect_err("a circle").to_string();
        assert!(message.contains("circle"), "{message}");
    }
}

#[test]
fn sizes_that_no_constant_has_are_refused() {
    let folder = tempdir().expect("a folder");
    for dims in [[-2, -64], [0, 1 << 40], [1 << 62, 8]] {
        let mut constants = constants();
        constants[0].dims = dims.to_vec();
        if dims[0] == 0 {
            constants[0].floats.clear();
        }
        let refused = CorrectionModel::read_onnx(&written(folder.path(), gemm(), constants));
        assert!(matches!(refused, Err(FileError::Graph { .. })), "{dims:?}");
    }
}
