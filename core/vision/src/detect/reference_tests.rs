//! Letterbox, boxes and suppression against numbers of the reference: `LetterBox`,
//! `scale_boxes` and `non_max_suppression` of ultralytics 8.4.190, on made-up images and heads.

use image::{Rgb, RgbImage};
use plumbline_model::detection::ClassIndex;
use serde::Deserialize;

use super::Letterbox;
use super::filler::Filler;
use super::heads::Reader;
use super::suppress::suppress;
use super::{ClassFilter, DetectSettings, Head, InputSize};

#[derive(Deserialize)]
struct Reference {
    letterbox: Vec<BoxedImage>,
    boxes: Vec<Boxes>,
    nms: Vec<Suppression>,
}

#[derive(Deserialize)]
struct BoxedImage {
    image: (u32, u32),
    input: (u32, u32),
    stride: u32,
    result: (u32, u32),
    scaled: (u32, u32),
    offset: (u32, u32),
    sum: u64,
    weighted: u64,
}

#[derive(Deserialize)]
struct Boxes {
    image: (u32, u32),
    input: (u32, u32),
    stride: u32,
    boxes: Vec<[f32; 4]>,
    on_image: Vec<[f32; 4]>,
}

#[derive(Deserialize)]
struct Suppression {
    classes: usize,
    head: Vec<Vec<f32>>,
    runs: Vec<Run>,
}

#[derive(Deserialize)]
struct Run {
    confidence: f32,
    iou: f32,
    most: usize,
    classes: Option<Vec<usize>>,
    several: bool,
    kept: Vec<(f32, f32, f32, f32, f32, usize)>,
}

fn reference() -> Reference {
    serde_json::from_str(include_str!("../../tests/detectors/reference.json")).expect("the numbers")
}

/// The image that the reference was given.
fn picture((width, height): (u32, u32)) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| {
        Rgb([7 * x + 13 * y, x * y, x * x + 3 * y].map(|value| (value % 256) as u8))
    })
}

fn size((width_px, height_px): (u32, u32), stride_px: u32) -> InputSize {
    match stride_px {
        0 => InputSize::Fixed { width_px, height_px },
        _ => InputSize::Dynamic { width_px, height_px, stride_px },
    }
}

#[test]
fn images_are_boxed_as_by_the_reference_to_the_last_bit() {
    for case in reference().letterbox {
        let about = format!("{:?} into {:?}, stride {}", case.image, case.input, case.stride);
        let letterbox = Letterbox::new(case.image, size(case.input, case.stride)).expect("an image");
        assert_eq!(letterbox.scaled, case.scaled, "{about}");
        assert_eq!(letterbox.offset, case.offset, "{about}");
        assert_eq!(letterbox.input, case.result, "{about}");
        let plane = (case.result.0 * case.result.1) as usize;
        let mut input = vec![0.0f32; 3 * plane];
        Filler::new().fill(&picture(case.image), &letterbox, &mut input).expect("it fits");
        // Pixel by pixel, as the reference's image lies in memory.
        let interleaved = (0..3 * plane).map(|i| (input[i % 3 * plane + i / 3] * 255.0).round() as u64);
        let (mut sum, mut weighted) = (0, 0);
        for (i, value) in interleaved.enumerate() {
            sum += value;
            weighted += value * (i as u64 % 251);
        }
        assert_eq!((sum, weighted), (case.sum, case.weighted), "{about}");
    }
}

#[test]
fn boxes_come_back_as_by_the_reference() {
    let mut largest = 0.0f32;
    for case in reference().boxes {
        let letterbox = Letterbox::new(case.image, size(case.input, case.stride)).expect("an image");
        for (given, wanted) in case.boxes.iter().zip(&case.on_image) {
            let back = letterbox.on_image(*given);
            let back = [back.x0_px, back.y0_px, back.x1_px, back.y1_px];
            let off = back.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            // The numbers are rounded to four digits.
            assert!(off < 3e-4, "{:?} into {:?}: {back:?} but {wanted:?}", case.image, case.input);
            largest = largest.max(off);
        }
    }
    eprintln!("largest difference {largest} px");
}

#[test]
fn the_same_boxes_are_kept_as_by_the_reference() {
    let mut compared = 0;
    for case in reference().nms {
        let values: Vec<f32> = case.head.concat();
        let columns = case.head[0].len();
        let turned: Vec<f32> = (0..columns).flat_map(|i| case.head.iter().map(move |row| row[i])).collect();
        for run in case.runs {
            let classes = run.classes.clone();
            let settings = DetectSettings {
                confidence: run.confidence,
                iou: run.iou,
                most: run.most,
                classes: classes
                    .map_or(ClassFilter::All, |some| ClassFilter::only(some.into_iter().map(ClassIndex))),
                several_classes_per_box: run.several,
                ..DetectSettings::default()
            };
            for (head, values) in [(Head::Raw, &values), (Head::RawTransposed, &turned)] {
                let mut kept = Vec::new();
                let read = Reader::default().read(head, case.classes, values, &settings, &mut kept);
                assert_eq!(read, Ok(()));
                suppress(&mut kept, settings.iou, settings.most);
                let about = format!("{} classes, {head}, {} {}", case.classes, run.confidence, run.iou);
                assert_eq!(kept.len(), run.kept.len(), "{about}");
                let mut ours: Vec<_> = kept.iter().map(|c| (c.confidence, c.class.0, c.edges)).collect();
                let mut theirs: Vec<_> = run.kept.iter().map(|k| (k.4, k.5, [k.0, k.1, k.2, k.3])).collect();
                // Which of two equally sure boxes comes first is nobody's rule.
                let order = |a: &(f32, usize, [f32; 4]), b: &(f32, usize, [f32; 4])| {
                    let key = |c: &(f32, usize, [f32; 4])| {
                        ((c.0 * -1000.0).round() as i64, c.1, (c.2[0] * 10.0) as i64)
                    };
                    key(a).cmp(&key(b))
                };
                ours.sort_by(order);
                theirs.sort_by(order);
                for (ours, theirs) in ours.iter().zip(&theirs) {
                    assert_eq!(ours.1, theirs.1, "{about}");
                    assert!((ours.0 - theirs.0).abs() < 1e-3, "{about}: {ours:?} {theirs:?}");
                    assert!(ours.2.iter().zip(theirs.2).all(|(a, b)| (a - b).abs() < 2e-3), "{about}");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 500, "{compared} boxes compared");
}
