//! The detector that comes with the program: on images of the real eyes, which it has never learned
//! from, and on scenes of the twin that were kept aside.
#![allow(clippy::print_stderr)]

use std::path::PathBuf;

use plumbline_model::{Unattended, measured_data};
use plumbline_offline::{DetectEvalArgs, ModelReport, detect_eval};
use plumbline_twin::training_set::{self, SetError, SetOptions};
use plumbline_vision::detect::{DetectorOptions, shipped_detector};
use plumbline_vision::detect_score::EvaluateOptions;
use plumbline_vision::yolo_set::Split;

/// Classes that can be grasped.
const OBJECTS: [&str; 6] = ["Banana", "Duck", "Mushroom", "Onion", "Orange", "Tomato"];
const HANDS: [&str; 2] = ["LeftHand", "RightHand"];

fn judged(data: PathBuf) -> ModelReport {
    let args = DetectEvalArgs {
        models: vec![],
        data,
        split: Split::Val,
        csv: None,
        matrices: None,
        options: DetectorOptions::default(),
        judging: EvaluateOptions::default(),
    };
    let mut report = detect_eval(&args, &Unattended).expect("judged");
    assert!(report.failed.is_empty() && report.problems.is_empty(), "{:?}", report.problems);
    report.models.remove(0)
}

/// mAP50 of classes that are all in the set.
fn mean(report: &ModelReport, classes: &[&str]) -> f64 {
    let of = |class: &&str| report.per_class_map50[*class].expect("in the set");
    classes.iter().map(of).sum::<f64>() / classes.len() as f64
}

#[test]
fn it_is_small_and_names_the_published_classes_in_their_order() {
    let shipped = shipped_detector().expect("a detector comes with the program");
    let bytes = std::fs::metadata(&shipped.file).expect("a file").len();
    assert!(bytes <= 12_000_000, "{bytes} bytes");
    let detector = shipped.open(&DetectorOptions::default()).expect("opens");
    assert_eq!(detector.info().names, plumbline_model::ClassNames::published());
    assert!(detector.info().disagreement.is_none());
}

#[test]
fn it_finds_toys_and_hands_on_real_images() {
    let folder = match measured_data::folder("nico-scenes") {
        Ok(folder) => folder,
        Err(reason) => {
            eprintln!("{reason}");
            return;
        }
    };
    let report = judged(folder.join("data.yaml"));
    let (objects, hands) = (mean(&report, &OBJECTS), mean(&report, &HANDS));
    let tomato = report.per_class_map50["Tomato"].expect("in the set");
    eprintln!("mAP50 on real images: objects {objects:.3}, Tomato {tomato:.3}, hands {hands:.3}");
    assert!(objects >= 0.85 && tomato >= 0.95 && hands >= 0.5, "{:?}", report.per_class_map50);
}

#[test]
fn it_finds_toys_and_hands_of_the_twin() {
    let folder = tempfile::tempdir().expect("a folder");
    let options = SetOptions { pairs: 12, ..SetOptions::held_out_twin() };
    match training_set::generate(folder.path(), &options, &Unattended) {
        Ok(_) => {}
        Err(SetError::Render(error)) => {
            measured_data::left_out(error);
            return;
        }
        Err(error) => panic!("{error}"),
    }
    let report = judged(folder.path().join("data.yaml"));
    let (objects, hands) = (mean(&report, &OBJECTS), mean(&report, &HANDS));
    eprintln!("mAP50 on twelve pairs of the twin: objects {objects:.3}, hands {hands:.3}");
    // A quarter to a third below what is reached on all 150 pairs of this kind (objects 0.97, hands 0.99).
    assert!(objects >= 0.7 && hands >= 0.65, "{:?}", report.per_class_map50);
}
