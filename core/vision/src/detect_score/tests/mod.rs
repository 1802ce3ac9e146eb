//! Against the reference tool, and the laws of the score.

mod laws;
mod runs;

use std::collections::BTreeMap;

use plumbline_model::{ClassIndex, measured_data};
use serde_json::Value;

use super::*;

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn score_box(value: &Value) -> ScoreBox {
    let n: Vec<f64> = value.as_array().expect("a box").iter().map(number).collect();
    ScoreBox { x_px: n[0], y_px: n[1], width_px: n[2], height_px: n[3] }
}

fn same(ours: [Option<f64>; 12], reference: &Value) {
    for (index, (ours, reference)) in ours.iter().zip(reference.as_array().expect("twelve")).enumerate() {
        match (ours, reference.as_f64().filter(|value| *value >= 0.0)) {
            (Some(ours), Some(reference)) => {
                assert!((ours - reference).abs() < 1e-9, "number {index}: {ours} instead of {reference}");
            }
            (ours, reference) => assert_eq!(*ours, reference, "number {index}"),
        }
    }
}

/// Crowds, equally sure boxes, all sizes, more than a hundred boxes on an image, a class without
/// truth.
#[test]
fn made_up_boxes_score_as_in_the_reference_tool() {
    let file: Value = serde_json::from_str(include_str!("../fixtures/made_up_boxes.json")).expect("JSON");
    let mut images = vec![ScoredImage::default(); file["images"].as_u64().expect("a count") as usize];
    for row in file["truth"].as_array().expect("rows") {
        images[row[0].as_u64().expect("an image") as usize].truth.push(TruthBox {
            class: ClassIndex(row[1].as_u64().expect("a class") as usize),
            area: score_box(&row[2]),
            thing_px2: Some(number(&row[3])),
            crowd: row[4] == 1,
        });
    }
    for row in file["found"].as_array().expect("rows") {
        images[row[0].as_u64().expect("an image") as usize].found.push(FoundBox {
            class: ClassIndex(row[1].as_u64().expect("a class") as usize),
            confidence: number(&row[2]),
            area: score_box(&row[3]),
        });
    }
    let scores = average_precision(&images, 4, &IouThresholds::coco());
    same(scores.overall.in_order(), &file["overall"]);
    for (class, reference) in scores.per_class.iter().zip(file["per_class"].as_array().expect("classes")) {
        same(class.summary.in_order(), reference);
    }
    assert_eq!(scores.per_class[3].summary, Summary::default(), "no truth, no score");
}

#[test]
fn coco_boxes_score_as_in_the_reference_tool() {
    let folder = match measured_data::folder("detection-eval") {
        Ok(folder) => folder,
        Err(skipped) => return eprintln!("{skipped}"),
    };
    let json = |name: &str| -> Value {
        let text = std::fs::read_to_string(folder.join(name)).expect("readable");
        serde_json::from_str(&text).expect("JSON")
    };
    let (truth, found) =
        (json("instances_val2014_100.json"), json("instances_val2014_fakebbox100_results.json"));
    let numbered = |rows: &Value| -> BTreeMap<u64, usize> {
        let mut ids: Vec<u64> =
            rows.as_array().expect("rows").iter().map(|row| row["id"].as_u64().expect("an id")).collect();
        ids.sort_unstable();
        ids.into_iter().enumerate().map(|(index, id)| (id, index)).collect()
    };
    let (image_of, class_of) = (numbered(&truth["images"]), numbered(&truth["categories"]));
    let id = |row: &Value, key: &str| row[key].as_u64().expect("an id");
    let mut images = vec![ScoredImage::default(); image_of.len()];
    for row in truth["annotations"].as_array().expect("rows") {
        images[image_of[&id(row, "image_id")]].truth.push(TruthBox {
            class: ClassIndex(class_of[&id(row, "category_id")]),
            area: score_box(&row["bbox"]),
            thing_px2: Some(number(&row["area"])),
            crowd: id(row, "iscrowd") == 1,
        });
    }
    for row in found.as_array().expect("rows") {
        images[image_of[&id(row, "image_id")]].found.push(FoundBox {
            class: ClassIndex(class_of[&id(row, "category_id")]),
            confidence: number(&row["score"]),
            area: score_box(&row["bbox"]),
        });
    }
    let scores = average_precision(&images, class_of.len(), &IouThresholds::coco());
    // What the reference tool says of these files.
    let reference = serde_json::json!([
        0.5045806987249628,
        0.6969727247299577,
        0.5729816669904824,
        0.5856257209410443,
        0.5193996948036719,
        0.5013978986347466,
        0.38681277964578054,
        0.5936795762842003,
        0.595352982877607,
        0.6398109626113442,
        0.5664205978994309,
        0.5642905982905982
    ]);
    same(scores.overall.in_order(), &reference);
}

#[test]
fn the_toy_set_scores_as_published() {
    let folder = match measured_data::folder("detection-eval") {
        Ok(folder) => folder.join("padilla_toy"),
        Err(skipped) => return eprintln!("{skipped}"),
    };
    let mut images = Vec::new();
    for number in 1..=7 {
        let rows = |kind: &str| -> Vec<Vec<f64>> {
            let text = std::fs::read_to_string(folder.join(kind).join(format!("{number:05}.txt")));
            let numbers =
                |line: &str| line.split_whitespace().skip(1).map(|n| n.parse().expect("a number")).collect();
            text.expect("readable").lines().map(numbers).collect()
        };
        let area = |n: &[f64]| ScoreBox { x_px: n[0], y_px: n[1], width_px: n[2], height_px: n[3] };
        let class = ClassIndex(0);
        images.push(ScoredImage {
            truth: rows("groundtruths").iter().map(|n| TruthBox::new(class, area(n))).collect(),
            found: rows("detections")
                .iter()
                .map(|n| FoundBox { class, confidence: n[0], area: area(&n[1..]) })
                .collect(),
        });
    }
    let ap = average_precision(&images, 1, &IouThresholds::one(0.3)).overall.ap.expect("there is truth");
    assert!((ap - 0.23008).abs() < 1e-6, "{ap}");
}
