//! Both eyes at once, and parts of their images.

use std::path::{Path, PathBuf};

use image::{Rgb, RgbImage};
use plumbline_model::detection::Detection;
use plumbline_model::measured_data;
use plumbline_vision::detect::{
    DetectError, DetectSettings, Detector, DetectorOptions, EyesDetector, Part, Region, shipped_detector,
};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/detectors").join(format!("{name}.onnx"))
}

fn eyes(name: &str, threads: usize) -> EyesDetector {
    let options = DetectorOptions { threads: Some(threads), ..DetectorOptions::default() };
    EyesDetector::open(&file(name), &options).expect("a detector")
}

#[test]
fn both_eyes_at_once_see_what_each_sees_alone() {
    let images = [[204, 102, 51], [102, 204, 51]].map(|color| RgbImage::from_pixel(128, 64, Rgb(color)));
    let settings = DetectSettings::default();
    let mut alone =
        Detector::open(&file("seeing-any-size"), &DetectorOptions::default()).expect("a detector");
    let expected: Vec<Vec<Detection>> = images
        .iter()
        .map(|image| {
            let mut found = vec![];
            alone.detect_in(image, Part::Whole, &settings, &mut found).expect("it runs");
            found
        })
        .collect();
    assert_ne!(expected[0], expected[1]);
    for threads in [1, 2] {
        let mut eyes = eyes("seeing-any-size", threads);
        let (mut left, mut right) = (vec![], vec![]);
        for _ in 0..3 {
            let timing = eyes
                .detect_in([&images[0], &images[1]], [Part::Whole; 2], &settings, [&mut left, &mut right])
                .expect("it runs");
            assert_eq!(timing.at_once, threads == 2);
            let [of_left, of_right] = timing.eyes.map(|eye| eye.total());
            let passed = if threads == 2 { of_left.max(of_right) } else { of_left + of_right };
            assert_eq!(timing.passed().total(), passed);
            assert_eq!([&left, &right], [&expected[0], &expected[1]]);
        }
    }
}

#[test]
fn an_eye_that_fails_leaves_nothing_half_seen() {
    let (good, empty) = (RgbImage::from_pixel(128, 64, Rgb([204, 102, 51])), RgbImage::new(0, 64));
    let settings = DetectSettings::default();
    for threads in [1, 2] {
        let mut eyes = eyes("seeing-any-size", threads);
        let (mut left, mut right) = (vec![], vec![]);
        for images in [[&good, &empty], [&empty, &good]] {
            let error = eyes.detect_in(images, [Part::Lit; 2], &settings, [&mut left, &mut right]);
            assert_eq!(error, Err(DetectError::EmptyImage { width_px: 0, height_px: 64 }));
            assert!(left.is_empty() && right.is_empty());
        }
        eyes.detect_in([&good, &good], [Part::Lit; 2], &settings, [&mut left, &mut right])
            .expect("it goes on");
        assert_eq!((left.len(), right.len()), (1, 1));
    }
}

/// A photograph of the real eyes.
fn photograph() -> Result<RgbImage, String> {
    let folder = measured_data::folder("nico-scenes").map_err(|reason| reason.to_string())?;
    let file = folder.join("images/left_1767632602.4357998.jpg");
    Ok(image::open(&file).map_err(|error| error.to_string())?.into_rgb8())
}

#[test]
fn what_is_seen_in_a_part_is_what_is_seen_there_in_all() {
    let image = match photograph() {
        Ok(image) => image,
        Err(reason) => return measured_data::left_out(reason),
    };
    let shipped = shipped_detector().expect("comes with the program");
    let mut detector = shipped.open(&DetectorOptions::default()).expect("opens");
    let settings = DetectSettings::default();
    let mut find = |part| {
        let mut found = vec![];
        detector.detect_in(&image, part, &settings, &mut found).expect("it runs");
        found
    };
    let all = find(Part::Whole);
    let region = Region { x_px: 130, y_px: 180, width_px: 360, height_px: 200 };
    // Well inside, where the network sees around each thing what it sees in all of the image.
    let inner = Region { x_px: 150, y_px: 200, width_px: 320, height_px: 160 };
    let there: Vec<&Detection> = all.iter().filter(|found| inner.holds(&found.area)).collect();
    assert!(there.len() >= 3, "{all:?}");
    let in_part = find(Part::Region(region));
    for seen in there {
        let again =
            in_part.iter().find(|found| found.class == seen.class && found.area.iou(&seen.area) > 0.8);
        let again = again.unwrap_or_else(|| panic!("{seen:?} is not in {in_part:?}"));
        assert!((again.confidence - seen.confidence).abs() < 0.15, "{again:?}, {seen:?}");
    }
    // Where a part is not on the image, or has no extent, all of it is looked at.
    for nothing in [Region { x_px: 640, ..region }, Region { width_px: 0, ..region }] {
        assert_eq!(find(Part::Region(nothing)), all);
    }
    // A part that leaves the image is the part of it that is on the image.
    let over = Region { x_px: 400, y_px: 300, width_px: 4000, height_px: 4000 };
    let on_it = Region { x_px: 400, y_px: 300, width_px: 240, height_px: 180 };
    assert_eq!(find(Part::Region(over)), find(Part::Region(on_it)));
}
