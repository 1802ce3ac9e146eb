//! Models survive being written and read; files that are none are refused with what to do.

mod common;

use std::path::Path;

use common::{data, places};
use plumbline_correction::{CorrectionModel, FileError, Method, TrainOptions, train};
use plumbline_model::{Pixel, Unattended};
use serde_json::{Value, json};
use tempfile::tempdir;

fn trained(method: Method) -> CorrectionModel {
    let options = TrainOptions {
        session: "made up".to_owned(),
        software: "test 1".to_owned(),
        ..TrainOptions::default()
    };
    train(&data(60, 1e-3, 1), method, &options, &Unattended, &mut |_| ()).expect("it trains")
}

fn largest_difference_m(a: &CorrectionModel, b: &CorrectionModel) -> f64 {
    let distance = |place: [f64; 2]| {
        let pixel = Pixel::new(place[0], place[1]);
        let (a, b) = (a.correct(pixel), b.correct(pixel));
        assert_eq!(a.inside, b.inside);
        a.target.distance_m(&b.target)
    };
    places(200, 8).into_iter().chain([[-500.0, 2000.0]]).map(distance).fold(0.0, f64::max)
}

#[test]
fn a_model_is_read_as_it_was_written() {
    let folder = tempdir().expect("a folder");
    for method in Method::ALL {
        let file = folder.path().join(format!("{}.json", method.name()));
        let model = trained(method);
        model.write(&file).expect("written");
        let read = CorrectionModel::read(&file).expect("read");
        assert_eq!(read.method(), method);
        assert!(largest_difference_m(&model, &read) < 1e-14);
        assert_eq!(read.provenance().session, "made up");
        assert_eq!(read.provenance().touches.len(), 60);
        assert_eq!(read.provenance().options, model.provenance().options);
        let pixel = Pixel::new(900.0, 700.0);
        for (a, b) in model.correct(pixel).sd_m.iter().zip(read.correct(pixel).sd_m) {
            assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
        }
        assert!(CorrectionModel::import(&file).is_ok());
    }
    let names = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(names, 3, "no temporary file is left");
}

fn changed(model: &Path, to: &Path, change: impl FnOnce(&mut Value)) -> FileError {
    let text = std::fs::read(model).expect("it was written");
    let mut value: Value = serde_json::from_slice(&text).expect("it is JSON");
    change(&mut value);
    std::fs::write(to, value.to_string()).expect("written");
    CorrectionModel::read(to).expect_err("it was spoiled")
}

#[test]
fn spoiled_files_are_refused_in_a_sentence() {
    let folder = tempdir().expect("a folder");
    let (file, spoiled) = (folder.path().join("m3.json"), folder.path().join("spoiled.json"));
    trained(Method::M3).write(&file).expect("written");
    let version = changed(&file, &spoiled, |value| value["version"] = json!(2));
    assert!(version.to_string().contains("newer program"), "{version}");
    let null =
        changed(&file, &spoiled, |value| value["answer"]["network"]["members"][0]["bias"][1] = Value::Null);
    assert!(matches!(null, FileError::Damaged { .. }), "{null}");
    let short = changed(&file, &spoiled, |value| {
        value["answer"]["network"]["members"][1]["hidden"].as_array_mut().expect("a list").pop();
    });
    assert!(short.to_string().contains("2–63–3"), "{short}");
    let other = changed(&file, &spoiled, |value| value["format"] = json!("something else"));
    assert!(matches!(other, FileError::NotAModel { .. }), "{other}");
    let m2 = changed(&file, &spoiled, |value| value["answer"]["method"] = json!("m2"));
    assert!(matches!(m2, FileError::Damaged { .. }), "{m2}");
    std::fs::write(&spoiled, "{").expect("written");
    assert!(CorrectionModel::read(&spoiled).expect_err("cut off").to_string().contains("no JSON"));
    let absent = CorrectionModel::import(&folder.path().join("absent.json")).expect_err("absent");
    assert!(matches!(absent, FileError::File(_)));
}

#[test]
fn onnx_keeps_the_answers_the_border_and_the_heights() {
    let folder = tempdir().expect("a folder");
    for method in [Method::M2, Method::M3] {
        let file = folder.path().join(format!("{}.onnx", method.name()));
        let model = trained(method);
        model.write_onnx(&file).expect("written");
        let read = CorrectionModel::import(&file).expect("read");
        assert_eq!(read.method(), method);
        assert_eq!(read.network_shape(), model.network_shape());
        let difference_m = largest_difference_m(&model, &read);
        assert!(difference_m < 1e-6, "{difference_m}");
        assert!(read.provenance().touches.is_empty());
    }
    let m1 = trained(Method::M1).write_onnx(&folder.path().join("m1.onnx")).expect_err("no network");
    assert!(m1.to_string().contains("JSON"));
    let file = folder.path().join("none.onnx");
    std::fs::write(&file, b"this is no graph").expect("written");
    assert!(matches!(CorrectionModel::read_onnx(&file), Err(FileError::NotAModel { .. })));
    std::fs::write(&file, b"").expect("written");
    assert!(matches!(CorrectionModel::read_onnx(&file), Err(FileError::Graph { .. })));
}

/// Kernel and bias of a network 2–H–K in the order of Keras.
fn weights(units: usize, outputs: usize) -> [Value; 4] {
    let number = |index: usize| (index as f64 * 0.7).sin();
    let matrix = |rows: usize, columns: usize| {
        json!(
            (0..rows)
                .map(|r| (0..columns).map(|c| number(r * columns + c)).collect::<Vec<_>>())
                .collect::<Vec<_>>()
        )
    };
    let vector = |length: usize| json!((0..length).map(|i| number(i + 5)).collect::<Vec<_>>());
    [matrix(2, units), vector(units), matrix(units, outputs), vector(outputs)]
}

/// The answer of those weights, as Keras computes it.
fn keras(weights: &[Value; 4], x: [f64; 2]) -> Vec<f64> {
    let number = |value: &Value| value.as_f64().expect("a number");
    let units = weights[1].as_array().expect("a list").len();
    let outputs = weights[3].as_array().expect("a list").len();
    let hidden: Vec<f64> = (0..units)
        .map(|h| (0..2).map(|i| x[i] * number(&weights[0][i][h])).sum::<f64>() + number(&weights[1][h]))
        .map(|sum| sum.max(0.0))
        .collect();
    (0..outputs)
        .map(|k| {
            (0..units).map(|h| hidden[h] * number(&weights[2][h][k])).sum::<f64>() + number(&weights[3][k])
        })
        .collect()
}

#[test]
fn published_weights_are_read_in_every_dress() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("weights.json");
    let w = weights(64, 3);
    let dresses = [
        json!(w),
        json!({"dense": {"kernel": w[0], "bias": w[1]}, "dense_1": {"kernel": w[2], "bias": w[3]}}),
        json!({"layers": [{"name": "hidden", "weights": [w[0], w[1]]}, {"name": "output", "weights": [w[2], w[3]]}]}),
        json!({"output/bias:0": w[3], "hidden/kernel:0": w[0], "output/kernel:0": w[2], "hidden/bias:0": w[1]}),
    ];
    let scaled = [(700.0 - 799.52245) / 363.95520, (500.0 - 799.52245) / 363.95520];
    let expected: Vec<f64> = keras(&w, scaled).iter().map(|y| y * 0.175916 + 0.141192).collect();
    for dress in dresses {
        std::fs::write(&file, dress.to_string()).expect("written");
        let model = CorrectionModel::import(&file).expect("published weights");
        let answer = model.correct(Pixel::new(700.0, 500.0));
        for (a, b) in answer.target.coords.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
        assert!(!answer.inside && answer.sd_m[0].is_infinite());
        assert!(
            model.provenance().remarks[0].contains("published 2–64–3"),
            "{:?}",
            model.provenance().remarks
        );
    }
}

#[test]
fn normalization_in_the_file_goes_before_the_published_one() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("weights.json");
    let w = weights(16, 2);
    let document = json!({"weights": w, "input_mean": 800.0, "input_std": [300.0, 200.0], "output": {"mean": 0.1, "std": 0.2}});
    std::fs::write(&file, document.to_string()).expect("written");
    let model = CorrectionModel::read_published(&file).expect("published weights");
    assert_eq!(model.method(), Method::M2);
    let expected = keras(&w, [(700.0 - 800.0) / 300.0, (500.0 - 800.0) / 200.0]);
    let answer = model.correct(Pixel::new(700.0, 500.0)).target.coords;
    assert!((answer.x - (0.1 + 0.2 * expected[0])).abs() < 1e-12);
    assert!((answer.y - (0.1 + 0.2 * expected[1])).abs() < 1e-12);
    assert!(model.provenance().remarks.iter().any(|remark| remark.contains("published table")));
}

#[test]
fn weights_of_another_shape_name_the_shapes() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("weights.json");
    let refused = |document: Value| {
        std::fs::write(&file, document.to_string()).expect("written");
        CorrectionModel::read_published(&file).expect_err("another shape")
    };
    let joints = refused(json!(weights(128, 6)));
    assert!(joints.to_string().contains("2×128, 128×6, 128, 6"), "{joints}");
    let [kernel, bias, output, _] = weights(64, 3);
    assert!(matches!(refused(json!([kernel, bias, output])), FileError::Shapes { .. }));
    assert!(refused(json!({})).to_string().contains("none"));
    let unpublished = refused(json!(weights(32, 3)));
    assert!(matches!(unpublished, FileError::NoNormalization { .. }), "{unpublished}");
    assert!(unpublished.to_string().contains("2–32–3"));
}

#[test]
fn weights_that_could_mean_another_network_are_refused() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("weights.json");
    let refused = |document: Value| {
        std::fs::write(&file, document.to_string()).expect("written");
        CorrectionModel::import(&file).expect_err("not told which network")
    };
    // Transposed kernels of a 2–H–2 have the shapes of its kernels in the other order.
    let [kernel, bias, output, output_bias] = weights(16, 2);
    let transposed = refused(json!([output, bias, kernel, output_bias]));
    assert!(matches!(transposed, FileError::Shapes { .. }), "{transposed}");
    // Half a normalization is not replaced by the published one.
    for half in [
        json!({"input_mean": 900}),
        json!({"input_mean": [1, 2, 3], "input_std": 1, "output_mean": 0, "output_std": 1}),
    ] {
        let mut document = half;
        document["weights"] = json!(weights(64, 3));
        let message = refused(document);
        assert!(matches!(message, FileError::NoNormalization { .. }), "{message}");
    }
    assert!(matches!(refused(json!([])), FileError::Shapes { .. }));
}

#[test]
fn a_layer_may_come_before_the_one_that_it_works_on() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("weights.json");
    let [kernel, bias, output, output_bias] = weights(16, 2);
    let answers = [json!([kernel, bias, output, output_bias]), json!([output, output_bias, kernel, bias])]
        .map(|weights| {
            std::fs::write(&file, weights.to_string()).expect("written");
            CorrectionModel::import(&file).expect("weights").correct(Pixel::new(700.0, 500.0)).target
        });
    assert_eq!(answers[0], answers[1]);
}

#[test]
fn a_byte_order_mark_is_no_fault_of_a_model() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("weights.json");
    std::fs::write(&file, format!("\u{feff}{}", json!(weights(64, 3)))).expect("written");
    assert_eq!(CorrectionModel::import(&file).expect("weights").method(), Method::M3);
}

#[test]
fn a_spread_that_was_shrunk_is_damage() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("m1.json");
    trained(Method::M1).write(&file).expect("written");
    let mut document: Value = serde_json::from_slice(&std::fs::read(&file).expect("there")).expect("JSON");
    document["trust"]["of_sets_m"] = json!([-1.0, 0.0, 0.0]);
    std::fs::write(&file, document.to_string()).expect("written");
    assert!(matches!(CorrectionModel::read(&file), Err(FileError::Damaged { .. })));
}

/// Multiplies the largest of a model's numbers in a list by a thousand.
fn thousandfold(list: &mut Value) {
    let numbers = list.as_array_mut().expect("a list");
    let size = |value: &Value| value.as_f64().expect("a number").abs();
    let largest = numbers.iter_mut().max_by(|a, b| size(a).total_cmp(&size(b))).expect("numbers");
    *largest = json!(1000.0 * largest.as_f64().expect("a number"));
}

#[test]
fn a_model_that_answers_otherwise_than_it_did_is_refused() {
    let folder = tempdir().expect("a folder");
    let (file, spoiled) = (folder.path().join("model.json"), folder.path().join("spoiled.json"));
    trained(Method::M3).write(&file).expect("written");
    let of_weight =
        |value: &mut Value| thousandfold(&mut value["answer"]["network"]["members"][2]["weights"][1]);
    let of_spread = |value: &mut Value| value["trust"]["of_sets_m"] = json!([0.5, 0.0, 0.0]);
    let of_bias = |value: &mut Value| value["answer"]["network"]["members"][0]["bias"][0] = json!(0.731);
    let of_border = |value: &mut Value| {
        let outline = value["trust"]["border"].as_object_mut().expect("a border");
        let points = outline.values_mut().filter_map(Value::as_array_mut).max_by_key(|list| list.len());
        let points = points.expect("a list of points");
        let half = points.len() / 2;
        points.truncate(half);
    };
    let said = changed(&file, &spoiled, of_border).to_string();
    assert!(said.contains("spoiled.json"), "{said}");
    for change in [of_weight as fn(&mut Value), of_spread, of_bias] {
        let said = changed(&file, &spoiled, change).to_string();
        assert!(said.contains("spoiled.json no longer answers as it did"), "{said}");
        assert!(said.contains("mm off") && said.contains("train again"), "{said}");
    }
    trained(Method::M1).write(&file).expect("written");
    let heights = changed(&file, &spoiled, |value| value["answer"]["heights"]["z_m"][1][3] = json!(0.5));
    assert!(matches!(heights, FileError::OtherAnswers { .. }), "{heights}");
}

/// Files of older programs hold their touches and how well these are met.
#[test]
fn a_model_without_kept_answers_is_held_to_its_own_touches() {
    let folder = tempdir().expect("a folder");
    let (file, older) = (folder.path().join("model.json"), folder.path().join("older.json"));
    for method in Method::ALL {
        trained(method).write(&file).expect("written");
        let mut value: Value = serde_json::from_slice(&std::fs::read(&file).expect("there")).expect("JSON");
        assert!(value.as_object_mut().expect("a document").remove("self_test").is_some());
        std::fs::write(&older, value.to_string()).expect("written");
        CorrectionModel::read(&older).expect("still read");
        match method {
            Method::M1 => value["answer"]["placement"]["x"][2] = json!(0.9),
            _ => thousandfold(&mut value["answer"]["network"]["members"][0]["weights"][0]),
        }
        std::fs::write(&older, value.to_string()).expect("written");
        let said = CorrectionModel::read(&older).expect_err("it misses its touches").to_string();
        assert!(said.contains("no longer answers as it did"), "{said}");
    }
}

#[test]
fn imported_networks_that_send_the_arm_nowhere_are_refused() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("weights.json");
    let mut w = weights(64, 3);
    w[2].as_array_mut().expect("rows").iter_mut().for_each(thousandfold);
    std::fs::write(&file, json!(w).to_string()).expect("written");
    let said = CorrectionModel::import(&file).expect_err("meters away").to_string();
    assert!(said.contains("damaged") && said.contains("a point sent to the arm"), "{said}");

    // ONNX keeps the answers beside the graph.
    let model = trained(Method::M2);
    let (good, bad) = (folder.path().join("m2.onnx"), folder.path().join("bad.onnx"));
    model.write_onnx(&good).expect("written");
    let mut bytes = std::fs::read(&good).expect("there");
    let heights = b"\"z_m\":[[0.0";
    let at = bytes.windows(heights.len()).position(|window| window == heights).expect("heights");
    bytes[at + heights.len() - 1] = b'9';
    bytes[at + heights.len() - 2] = b'.';
    std::fs::write(&bad, bytes).expect("written");
    let said = CorrectionModel::import(&bad).expect_err("another height").to_string();
    assert!(said.contains("no longer answers as it did"), "{said}");
}
