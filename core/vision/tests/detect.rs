//! Detectors of every form, on tiny networks whose answers are known (`detectors/make.py`), and
//! what is said about files that are none. Needs ONNX Runtime, which `./plumbline setup` installs.

use std::path::{Path, PathBuf};

use image::{Rgb, RgbImage};
use plumbline_model::{ClassIndex, ClassNames, Detection};
use plumbline_vision::detect::{
    ClassFilter, DetectError, DetectSettings, Detector, DetectorOptions, Head, InputSize, NamesFrom,
    Precision, Provider,
};

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/detectors").join(format!("{name}.onnx"))
}

fn options() -> DetectorOptions {
    DetectorOptions { threads: Some(1), ..DetectorOptions::default() }
}

fn open(name: &str) -> Detector {
    Detector::open(&file(name), &options()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn picture() -> RgbImage {
    RgbImage::from_pixel(64, 64, Rgb([255, 128, 0]))
}

fn found(detector: &mut Detector, image: &RgbImage, settings: &DetectSettings) -> Vec<Detection> {
    let mut found = vec![];
    detector.detect(image, settings, &mut found).expect("the network runs");
    found
}

fn close(found: &Detection, class: usize, confidence: f32, edges: [f32; 4], tolerance: f32) -> bool {
    let area = found.area;
    let given = [area.x0_px, area.y0_px, area.x1_px, area.y1_px];
    found.class == ClassIndex(class)
        && (found.confidence - confidence).abs() <= tolerance
        && given.iter().zip(edges).all(|(given, wanted)| (given - wanted).abs() <= tolerance)
}

#[test]
fn raw_heads_are_read_either_way_round_and_in_either_precision() {
    let forms = [
        ("raw", Head::Raw, Precision::Float32),
        ("transposed", Head::RawTransposed, Precision::Float32),
        ("float16", Head::Raw, Precision::Float16),
        ("mixed", Head::Raw, Precision::Float32),
    ];
    for (name, head, precision) in forms {
        let mut detector = open(name);
        let info = detector.info();
        assert_eq!((info.head, info.precision), (head, precision), "{name}");
        assert_eq!(info.input, InputSize::Fixed { width_px: 64, height_px: 64 });
        let found = found(&mut detector, &picture(), &DetectSettings::default());
        assert_eq!(found.len(), 3, "{name}: one of two equal bananas goes: {found:?}");
        assert!(close(&found[0], 0, 0.9, [15.0, 26.0, 25.0, 34.0], 1e-3), "{name}: {found:?}");
        assert!(close(&found[1], 1, 0.7, [15.0, 26.0, 25.0, 34.0], 1e-3), "{name}: {found:?}");
        assert!(close(&found[2], 2, 0.6, [47.0, 34.0, 53.0, 46.0], 1e-3), "{name}: {found:?}");
    }
}

#[test]
fn end_to_end_heads_are_taken_as_they_are() {
    for (name, precision) in [("end-to-end", Precision::Float32), ("end-to-end-float16", Precision::Float16)]
    {
        let mut detector = open(name);
        assert_eq!((detector.info().head, detector.info().precision), (Head::EndToEnd, precision));
        let found = found(&mut detector, &picture(), &DetectSettings::default());
        assert_eq!(found.len(), 3, "{name}: {found:?}");
        assert!(close(&found[1], 1, 0.7, [15.0, 26.0, 25.0, 34.0], 1e-3), "{name}: {found:?}");
    }
}

#[test]
fn the_same_file_from_memory_is_the_same_detector() {
    let bytes = std::fs::read(file("raw")).expect("a file");
    let mut detector = Detector::from_bytes("in memory", &bytes, &options()).expect("a detector");
    assert_eq!(detector.info().name, "in memory");
    assert_eq!(detector.info().file, None);
    let settings = DetectSettings::default();
    assert_eq!(found(&mut detector, &picture(), &settings), found(&mut open("raw"), &picture(), &settings));
}

#[test]
fn what_is_asked_for_is_what_comes() {
    let mut detector = open("raw");
    let mut count = |settings: DetectSettings| found(&mut detector, &picture(), &settings).len();
    assert_eq!(count(DetectSettings { confidence: 0.65, ..DetectSettings::default() }), 2);
    assert_eq!(count(DetectSettings { iou: 0.95, ..DetectSettings::default() }), 4);
    assert_eq!(count(DetectSettings { most: 1, ..DetectSettings::default() }), 1);
    let hands = ClassFilter::only([ClassIndex(2)]);
    assert_eq!(count(DetectSettings { classes: hands, ..DetectSettings::default() }), 1);
    let ducks = vec![None, Some(0.75)];
    assert_eq!(count(DetectSettings { per_class_confidence: ducks, ..DetectSettings::default() }), 2);
}

/// The first network looks at its input: the middle of its box is (red, green) of the mean
/// color, its size blue.
#[test]
fn red_is_red_and_boxes_come_back_through_the_letterbox() {
    let mut detector = open("seeing");
    let settings = DetectSettings::default();
    let orange = RgbImage::from_pixel(64, 64, Rgb([204, 102, 51]));
    let found_square = found(&mut detector, &orange, &settings);
    // Means 0.8, 0.4, 0.2 of 64: middle (51.2, 25.6), size 12.8.
    assert!(close(&found_square[0], 0, 0.9, [44.8, 19.2, 57.6, 32.0], 1e-3), "{found_square:?}");

    // 128x64 is halved to 64x32, with 16 rows of gray above and below.
    let wide = RgbImage::from_pixel(128, 64, Rgb([204, 102, 51]));
    let found_wide = found(&mut detector, &wide, &settings);
    let gray = 114.0 / 255.0;
    let [red, green, blue] = [0.8, 0.4, 0.2].map(|color: f32| 64.0 * 0.5 * (color + gray));
    let edges = [
        2.0 * (red - 0.5 * blue),
        2.0 * (green - 0.5 * blue - 16.0),
        2.0 * (red + 0.5 * blue),
        2.0 * (green + 0.5 * blue - 16.0),
    ];
    assert!(close(&found_wide[0], 0, 0.9, edges, 1e-3), "{found_wide:?} but {edges:?}");
}

#[test]
fn a_network_of_any_size_sees_no_more_gray_than_it_needs() {
    let mut detector = open("seeing-any-size");
    assert_eq!(detector.info().input, InputSize::Dynamic { width_px: 64, height_px: 64, stride_px: 32 });
    let settings = DetectSettings::default();
    // 128x64 becomes 64x32 without any gray.
    let wide = RgbImage::from_pixel(128, 64, Rgb([204, 102, 51]));
    for _ in 0..3 {
        let found = found(&mut detector, &wide, &settings);
        assert!(close(&found[0], 0, 0.9, [89.6, 38.4, 115.2, 64.0], 1e-3), "{found:?}");
    }
    // Another shape afterwards, and the first again.
    let tall = RgbImage::from_pixel(64, 128, Rgb([102, 204, 51]));
    let found_tall = found(&mut detector, &tall, &settings);
    assert!(close(&found_tall[0], 0, 0.9, [38.4, 89.6, 64.0, 115.2], 1e-3), "{found_tall:?}");
    assert!(close(&found(&mut detector, &wide, &settings)[0], 0, 0.9, [89.6, 38.4, 115.2, 64.0], 1e-3));
}

#[test]
fn an_output_whose_sides_are_left_open_is_read_from_a_first_run() {
    let mut detector = open("open-shape");
    assert_eq!(detector.info().head, Head::Raw);
    assert_eq!(detector.info().names.len(), 3);
    assert_eq!(found(&mut detector, &picture(), &DetectSettings::default()).len(), 3);
}

#[test]
fn another_size_of_image_leaves_nothing_of_the_one_before() {
    let mut detector = open("seeing");
    let settings = DetectSettings::default();
    let white = RgbImage::from_pixel(64, 64, Rgb([255, 255, 255]));
    let wide = RgbImage::from_pixel(128, 64, Rgb([204, 102, 51]));
    let first = found(&mut detector, &wide, &settings);
    found(&mut detector, &white, &settings);
    assert_eq!(found(&mut detector, &wide, &settings), first);
}

#[test]
fn one_pixel_is_an_image_and_none_is_not() {
    let mut detector = open("raw");
    let settings = DetectSettings::default();
    let on_a_pixel = found(&mut detector, &RgbImage::from_pixel(1, 1, Rgb([9, 9, 9])), &settings);
    assert!(on_a_pixel.iter().all(|d| d.area.on_image((1, 1)) == Some(d.area)), "{on_a_pixel:?}");
    let mut found = vec![on_a_pixel[0]];
    for size in [(0, 0), (0, 5), (5, 0)] {
        let error = detector.detect(&RgbImage::new(size.0, size.1), &settings, &mut found);
        assert_eq!(error, Err(DetectError::EmptyImage { width_px: size.0, height_px: size.1 }));
        assert!(found.is_empty(), "nothing of the image before is left");
    }
}

#[test]
fn names_come_from_the_file_or_from_beside_it_and_never_silently_in_another_order() {
    let published = ClassNames::new(["Banana", "Duck", "LeftHand"]);
    let info = open("raw").info().clone();
    assert_eq!((&info.names, info.names_from, info.disagreement), (&published, NamesFrom::File, None));
    assert_eq!(info.made_by.as_deref(), Some("Plumbline tests 1"));

    let unnamed = open("unnamed").info().clone();
    assert_eq!(unnamed.names, ClassNames::new(["class 0", "class 1", "class 2"]));
    assert_eq!(unnamed.names_from, NamesFrom::Nowhere);
    assert!(unnamed.disagreement.expect("it is said").contains("only numbered"));

    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("data.yaml"), "names: [Banana, Duck, LeftHand]\n").expect("writing");
    let copy = |name: &str| {
        let to = folder.path().join(format!("{name}.onnx"));
        std::fs::copy(file(name), &to).expect("copying");
        Detector::open(&to, &options()).expect("a detector").info().clone()
    };
    let beside = copy("unnamed");
    assert_eq!((&beside.names, beside.names_from), (&published, NamesFrom::DataYaml));
    assert_eq!(copy("end-to-end-unnamed").names, published);
    let mixed_up = copy("reordered");
    assert_eq!(mixed_up.names, ClassNames::new(["Duck", "Banana", "LeftHand"]));
    assert_eq!(mixed_up.names_beside, Some(published));
    let told = mixed_up.disagreement.expect("it is said");
    assert!(told.contains("another order"), "{told}");
}

#[test]
fn files_that_are_no_detector_get_a_sentence() {
    let sentences = [
        ("eighty", "the network has 80 classes but 3 are named (Banana, Duck, LeftHand)"),
        ("segmenting", "is a network for segmentation"),
        ("posing", "is a network for poses"),
        ("classifying", "is a network for classification of whole images"),
        ("depth", "is a network for depth"),
        ("gray", "it takes gray images, one channel"),
        ("four-at-once", "it takes 4 images at once"),
        ("objectness", "has a confidence of its own for every box"),
        ("end-to-end-unnamed", "does not tell how many classes it has"),
    ];
    for (name, sentence) in sentences {
        let error = Detector::open(&file(name), &options()).expect_err(name).to_string();
        assert!(error.contains(sentence), "{name}: {error}");
        assert!(error.contains(name), "which file: {error}");
    }
}

#[test]
fn damaged_files_get_a_sentence() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = std::fs::read(file("raw")).expect("a file");
    let path = folder.path().join("broken.onnx");
    let error_of = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("writing");
        Detector::open(&path, &options()).expect_err("broken").to_string()
    };
    assert!(error_of(b"").contains("the file is empty"));
    assert!(error_of(b"this is no network").contains("is not a usable ONNX file"));
    for length in [1, 10, 100, whole.len() / 2, whole.len() - 20] {
        let error = error_of(&whole[..length]);
        assert!(error.contains("broken.onnx") && error.contains("export"), "{length}: {error}");
    }
    let jpeg: Vec<u8> = (0..5000u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    assert!(error_of(&jpeg).contains("is not a usable ONNX file"));
    let missing =
        Detector::open(&folder.path().join("none.onnx"), &options()).expect_err("missing").to_string();
    assert!(missing.contains("cannot be read"), "{missing}");
    let is_folder = Detector::open(folder.path(), &options()).expect_err("a folder").to_string();
    assert!(is_folder.contains("it is a folder"), "{is_folder}");
    assert!(Detector::from_bytes("nothing", &[], &options()).is_err());
}

#[test]
fn networks_that_fail_on_an_image_get_a_sentence_and_go_on() {
    let settings = DetectSettings::default();
    let mut found = vec![];
    for (name, sentence) in [
        ("throwing", "failed on this image"),
        ("nan", "answered with 1 values that are no numbers"),
        ("alien-class", "answered with class 7, but it has 3 classes"),
    ] {
        let mut detector = open(name);
        let error = detector.detect(&picture(), &settings, &mut found).expect_err(name).to_string();
        assert!(error.contains(sentence), "{name}: {error}");
        assert!(found.is_empty());
    }
    // Black asks for the first row, which there is.
    let mut detector = open("throwing");
    for _ in 0..3 {
        assert!(detector.detect(&picture(), &settings, &mut found).is_err());
        let black = RgbImage::new(64, 64);
        detector.detect(&black, &settings, &mut found).expect("the next image is well");
        assert!(!found.is_empty());
    }
}

#[test]
fn a_provider_that_is_not_there_is_said() {
    let wanted = DetectorOptions { provider: Provider::CoreMl, ..options() };
    let error = Detector::open(&file("raw"), &wanted).expect_err("not on this system").to_string();
    assert!(error.contains("CoreML cannot run the detector here"), "{error}");
    assert!(error.contains("choose the processor"), "{error}");
    let either = DetectorOptions { or_processor: true, ..wanted };
    let info = Detector::open(&file("raw"), &either).expect("the processor").info().clone();
    assert_eq!(info.provider_used, Provider::Cpu);
    assert!(info.provider_note.expect("it is said").contains("CoreML was asked for"));
}

#[test]
fn thresholds_out_of_range_are_refused() {
    let settings = DetectSettings { confidence: 1.5, ..DetectSettings::default() };
    let error = open("raw").detect(&picture(), &settings, &mut vec![]).expect_err("out of range");
    assert_eq!(error.to_string(), "the confidence threshold must be between 0 and 1, not 1.5");
}

#[test]
fn a_detector_can_go_to_another_thread() {
    let mut detector = open("raw");
    let count = std::thread::Builder::new()
        .name("detector".to_owned())
        .spawn(move || found(&mut detector, &picture(), &DetectSettings::default()).len())
        .expect("a thread")
        .join();
    assert_eq!(count.ok(), Some(3));
}
