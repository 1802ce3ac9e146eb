//! After the first frames places cost no memory.

mod counting;

use counting::{allocations, assert_counts};
use image::{Rgb, RgbImage};
use nalgebra::Vector3;
use plumbline_model::{ClassIndex, Detection, PixelBox, Pose, StereoCalibration};
use plumbline_vision::detect_places::{PlaceFinder, PlaceOptions, RangeFrom, Rates};
use plumbline_vision::synthetic::nico_like_eyes;

/// Ten boxes, `shift_px` further to the left.
fn boxes(shift_px: f32) -> Vec<Detection> {
    (0..10u8)
        .map(|i| {
            let (x, y) = (200.0 + 60.0 * f32::from(i % 5), 200.0 + 90.0 * f32::from(i / 5));
            let size_px = 20.0 + 2.0 * f32::from(i);
            let area = PixelBox::from_middle(x - shift_px, y, size_px, size_px);
            Detection { class: ClassIndex(usize::from(i % 8)), confidence: 0.5, area }
        })
        .collect()
}

#[test]
fn nothing_is_allocated_after_the_first_frames() {
    assert_counts();
    // A picture whose right view is the left one moved by 20 px.
    let picture = |shift: u32| {
        RgbImage::from_fn(640, 480, |x, y| {
            let (x, y) = (f64::from(x + shift), f64::from(y));
            let wave = |a: f64, b: f64| (127.0 + 60.0 * (a * x + b * y).sin()) as u8;
            Rgb([wave(0.31, 0.05), wave(0.17, 0.23), wave(0.07, 0.29)])
        })
    };
    let (left, right) = (picture(0), picture(20));
    let (left_boxes, right_boxes) = (boxes(0.0), boxes(20.0));
    let mut cameras = nico_like_eyes();
    cameras.right = cameras.left;
    cameras.right_from_left = Pose::from_rotation_vector(Vector3::zeros(), Vector3::new(-0.07, 0.0, 0.0));
    let calibration = StereoCalibration::bare(cameras);
    let mut finder = PlaceFinder::new(Some(&calibration), PlaceOptions::default());
    let (mut out, mut curve, mut rates) = (Vec::new(), Vec::new(), Rates::new(8, 30));
    let mut frame = |left_boxes: &[Detection], right_boxes: &[Detection]| {
        finder.find((&left, left_boxes), (&right, right_boxes), &mut out);
        finder.epipolar_curve(plumbline_model::Eye::Left, left_boxes[0].area.middle(), &mut curve);
        rates.add(&out);
        let own = |place: &plumbline_vision::detect_places::Place| place.from == RangeFrom::OwnPixelsAndBoxes;
        out.iter().filter(|object| object.place.as_ref().is_ok_and(own)).count()
    };
    for _ in 0..3 {
        assert!(frame(&left_boxes, &right_boxes) >= 5, "the whole path has to be used");
        frame(&left_boxes[..4], &right_boxes[3..]);
    }
    let before = allocations();
    for _ in 0..20 {
        frame(&left_boxes, &right_boxes);
        frame(&left_boxes[..4], &right_boxes[3..]);
    }
    let allocated = allocations() - before;
    assert_eq!(allocated, 0, "{allocated} allocations in 40 frames");
}
