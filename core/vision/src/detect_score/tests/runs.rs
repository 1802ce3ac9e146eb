//! Models on sets, with a detector that needs no network.

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use image::RgbImage;
use plumbline_model::{Cancelled, ClassIndex, ClassNames, Detection, JobContext, PixelBox, Unattended};
use tempfile::TempDir;

use super::super::*;
use crate::detect::{DetectError, DetectSettings, DetectTiming, Detector, DetectorOptions};
use crate::yolo_set::{LabeledBox, LabeledImage, YoloSet, scene_of};

/// Knows every image by the color of its first pixel, and answers with what it was told.
struct Oracle {
    names: ClassNames,
    /// Per image, classes in the oracle's own numbers; `None`: it fails.
    answers: Vec<Option<Vec<usize>>>,
}

fn place(class: usize) -> PixelBox {
    let x = 10.0 * class as f32;
    PixelBox::new(x, 5.0, x + 8.0, 20.0)
}

impl Detect for Oracle {
    fn name(&self) -> String {
        "oracle".to_owned()
    }
    fn names(&self) -> &ClassNames {
        &self.names
    }
    fn detect(
        &mut self,
        image: &RgbImage,
        settings: &DetectSettings,
        found: &mut Vec<Detection>,
    ) -> Result<DetectTiming, DetectError> {
        assert_eq!(settings.confidence, 0.001);
        found.clear();
        let answer = &self.answers[image.get_pixel(0, 0)[0] as usize];
        let (width_px, height_px) = image.dimensions();
        let classes = answer.as_ref().ok_or(DetectError::EmptyImage { width_px, height_px })?;
        found.extend(classes.iter().map(|&class| {
            // It sees things where the set has them: by name.
            let there =
                ["Tomato", "Duck"].iter().position(|name| self.names.get(ClassIndex(class)) == Some(name));
            Detection { class: ClassIndex(class), confidence: 0.9, area: place(there.unwrap_or(3)) }
        }));
        let ms = Duration::from_millis;
        Ok(DetectTiming { before: ms(1), network: ms(20), after: ms(3) })
    }
}

/// Six images, each with a tomato and a duck.
fn set(folder: &Path) -> YoloSet {
    let image = |index: u8| {
        let path = folder.join(format!("{index}.png"));
        RgbImage::from_pixel(64, 32, image::Rgb([index; 3])).save(&path).expect("saved");
        let boxes = (0..2).map(|class| LabeledBox { class: ClassIndex(class), area: place(class) });
        LabeledImage { scene: scene_of(&path), path, size_px: (64, 32), boxes: boxes.collect(), split: None }
    };
    YoloSet { names: ClassNames::new(["Tomato", "Duck"]), images: (0..6).map(image).collect() }
}

#[test]
fn a_model_with_its_classes_in_another_order_is_judged_by_name() {
    let folder = TempDir::new().expect("a folder");
    let set = set(folder.path());
    let names = ClassNames::new(["Duck", "Lemon", "Tomato"]);
    let mut oracle = Oracle { names, answers: vec![Some(vec![0, 1, 2]); 6] };
    let judged = evaluate(&mut oracle, &set, &EvaluateOptions::default(), &Unattended).expect("judged");
    assert!((judged.scores.overall.ap.expect("truth") - 1.0).abs() < 1e-9);
    assert_eq!(judged.agreement.renumbered, ["Tomato", "Duck"]);
    assert_eq!(judged.agreement.unknown_to_set, ["Lemon"]);
    assert!(judged.agreement.sentence().expect("told").contains("other numbers"));
    assert!((judged.timing.network_s - 0.02).abs() < 1e-9 && (judged.timing.total_s - 0.024).abs() < 1e-9);
    assert_eq!(judged.found[0].len(), 2, "lemons are not looked at");
    let csv = scores_csv(&[judged]);
    assert_eq!(csv.lines().count(), 4);
    assert!(csv.lines().nth(1).expect("a row").starts_with("oracle,Tomato,6,6,1.000000,"), "{csv}");
    assert!(csv.lines().all(|line| line.split(',').count() == 19), "{csv}");
}

#[test]
fn a_model_that_is_judged_by_boxes_of_its_own_is_told_from_one_that_is_only_good() {
    let folder = TempDir::new().expect("a folder");
    let own = set(folder.path());
    // By a label file a box comes back within its rounding; by hand it does not.
    let moved = |set: &YoloSet, images: usize, by_px: f32| {
        let mut moved = set.clone();
        for label in moved.images.iter_mut().take(images).flat_map(|image| &mut image.boxes) {
            label.area.x1_px += by_px;
        }
        moved
    };
    let judged = |set: &YoloSet| {
        let mut oracle = Oracle { names: set.names.clone(), answers: vec![Some(vec![0, 1]); 6] };
        let judged = evaluate(&mut oracle, set, &EvaluateOptions::default(), &Unattended).expect("judged");
        assert!(judged.scores.overall.ap.expect("truth") > 0.8);
        (judged.own_labels(), judged.judged_by_itself())
    };
    let (count, said) = judged(&moved(&own, 6, 0.01));
    assert_eq!(count, 12);
    assert!(said.expect("told").starts_with("judged by itself: 12 of 12 labels stand exactly where"));
    let (count, said) = judged(&moved(&own, 5, 0.4));
    assert_eq!((count, said.is_some()), (2, true), "those of one image of six");
    assert_eq!(judged(&moved(&own, 6, 0.4)), (0, None), "drawn by hand");
}

#[test]
fn a_class_that_the_model_does_not_know_counts_as_missed() {
    let folder = TempDir::new().expect("a folder");
    let set = set(folder.path());
    let mut oracle = Oracle { names: ClassNames::new(["Duck"]), answers: vec![Some(vec![0]); 6] };
    let judged = evaluate(&mut oracle, &set, &EvaluateOptions::default(), &Unattended).expect("judged");
    assert_eq!(judged.scores.per_class[0].summary.ap50, Some(0.0));
    assert_eq!(judged.agreement.unknown_to_model, ["Tomato"]);
    assert_eq!(judged.matrix.count(Cell { truth: Some(ClassIndex(0)), found: None }), 6);
    let mut stranger = Oracle { names: ClassNames::new(["class 0"]), answers: Vec::new() };
    let error =
        evaluate(&mut stranger, &set, &EvaluateOptions::default(), &Unattended).expect_err("nothing common");
    assert!(error.to_string().contains("not one name is the same"), "{error}");
}

#[test]
fn a_failing_model_and_a_lost_image_do_not_end_the_work() {
    let folder = TempDir::new().expect("a folder");
    let set = set(folder.path());
    std::fs::write(&set.images[5].path, "gone").expect("written");
    let mut answers = vec![Some(vec![0, 1]); 6];
    answers[1] = None;
    let mut oracle = Oracle { names: set.names.clone(), answers };
    let judged = evaluate(&mut oracle, &set, &EvaluateOptions::default(), &Unattended).expect("judged");
    assert_eq!(judged.images.len(), 5);
    let counts: Vec<bool> = judged.skipped.iter().map(|skipped| skipped.counts).collect();
    assert_eq!(counts, [true, false]);
    let recall = judged.scores.overall.ar_100.expect("truth");
    assert!((recall - 0.8).abs() < 1e-9, "the image on which it failed counts: {recall}");
    let mut broken = Oracle { names: set.names.clone(), answers: vec![None; 6] };
    let error =
        evaluate(&mut broken, &set, &EvaluateOptions::default(), &Unattended).expect_err("always fails");
    assert!(matches!(error, EvaluateError::FailsAlways { .. }), "{error}");
    let nothing = YoloSet { images: vec![set.images[5].clone()], ..set };
    let error =
        evaluate(&mut oracle, &nothing, &EvaluateOptions::default(), &Unattended).expect_err("no image");
    assert!(matches!(error, EvaluateError::NoImages { .. }), "{error}");
}

#[test]
fn judging_can_be_cancelled() {
    struct Impatient(AtomicUsize);
    impl JobContext for Impatient {
        fn checkpoint(&self) -> Result<(), Cancelled> {
            if self.0.fetch_add(1, Ordering::Relaxed) < 2 { Ok(()) } else { Err(Cancelled) }
        }
        fn report(&self, fraction: f64, _doing: &str) {
            assert!((0.5..=1.0).contains(&fraction), "the second part of two");
        }
    }
    let folder = TempDir::new().expect("a folder");
    let set = set(folder.path());
    let mut oracle = Oracle { names: set.names.clone(), answers: vec![Some(vec![0, 1]); 6] };
    let impatient = Impatient(AtomicUsize::new(0));
    let part = PartOfJob { whole: &impatient, part: 1, parts: 2 };
    let result = evaluate(&mut oracle, &set, &EvaluateOptions::default(), &part);
    assert!(matches!(result, Err(EvaluateError::Cancelled(_))));
}

/// Tiny networks that answer the same to every image, as in the tests of `detect`; in the set their
/// classes have the opposite order. Needs ONNX Runtime.
#[test]
fn a_network_is_judged_by_the_names_in_its_file() {
    let folder = TempDir::new().expect("a folder");
    let tiny = |name: &str| {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/detectors").join(name);
        let options = DetectorOptions { threads: Some(1), ..DetectorOptions::default() };
        Detector::open(&file, &options).unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    let mut detector = tiny("raw.onnx");
    let theirs: Vec<String> = detector.info().names.iter().map(|(_, name)| name.to_owned()).collect();
    let names = ClassNames::new(theirs.iter().rev());
    let last = names.len() - 1;
    let boxes = [(0, [15.0, 26.0, 25.0, 34.0]), (1, [15.0, 26.0, 25.0, 34.0]), (2, [47.0, 34.0, 53.0, 46.0])]
        .map(|(class, [x0, y0, x1, y1])| LabeledBox {
            class: ClassIndex(last - class),
            area: PixelBox::new(x0, y0, x1, y1),
        });
    let image = |index: u8| {
        let path = folder.path().join(format!("{index}.png"));
        RgbImage::from_pixel(64, 64, image::Rgb([255, 128, 0])).save(&path).expect("saved");
        LabeledImage { scene: scene_of(&path), path, size_px: (64, 64), boxes: boxes.to_vec(), split: None }
    };
    let set = YoloSet { names, images: (0..6).map(image).collect() };
    let judged = evaluate(&mut detector, &set, &EvaluateOptions::default(), &Unattended).expect("judged");
    assert_eq!(judged.scores.per_class[last].things, 6);
    for class in 0..3 {
        let ap50 = judged.scores.per_class[last - class].summary.ap50.expect("there is truth");
        assert!((ap50 - 1.0).abs() < 1e-9, "{class}: {ap50}");
    }
    assert!(judged.timing.network_s > 0.0);
    let error = evaluate(&mut tiny("throwing.onnx"), &set, &EvaluateOptions::default(), &Unattended);
    assert!(error.is_err(), "it fails on every image, or has none of the classes: {error:?}");
}
