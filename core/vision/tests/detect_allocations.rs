//! After the first images a detector allocates nothing (counted on the Rust side; what ONNX
//! Runtime and OpenCV do inside is theirs).

mod counting;

use std::path::Path;

use counting::{allocations, assert_counts};
use image::{Rgb, RgbImage};
use plumbline_vision::detect::{DetectSettings, Detector, DetectorOptions};

#[test]
fn nothing_is_allocated_after_the_first_images() {
    assert_counts();
    let settings = DetectSettings::default();
    let pictures: Vec<RgbImage> = (0..3u8)
        .map(|i| RgbImage::from_fn(640, 480, |x, y| Rgb([x as u8 ^ i, y as u8, (x + y) as u8])))
        .collect();
    for name in ["raw", "transposed", "float16", "mixed", "end-to-end", "seeing", "seeing-any-size"] {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/detectors").join(format!("{name}.onnx"));
        let mut detector = Detector::open(&file, &DetectorOptions::default()).expect("a detector");
        let mut found = Vec::new();
        for picture in &pictures {
            detector.detect(picture, &settings, &mut found).expect("it runs");
        }
        let before = allocations();
        for picture in pictures.iter().cycle().take(20) {
            detector.detect(picture, &settings, &mut found).expect("it runs");
        }
        let allocated = allocations() - before;
        assert_eq!(allocated, 0, "{name}: {allocated} allocations in 20 images");
    }
}
