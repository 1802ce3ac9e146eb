//! What cannot be placed says why; nothing panics.

use image::RgbImage;
use nalgebra::Point3;
use plumbline_model::{ClassNames, Detection, Eye, PixelBox, StereoCalibration};

use super::{ball_box, detection};
use crate::detect_places::{NoPlace, ObjectPlace, PlaceFinder, PlaceOptions, Seen, Unpaired, places};
use crate::synthetic::{Noise, nico_like_eyes};

fn find(left: &[Detection], right: &[Detection], options: &PlaceOptions) -> Vec<ObjectPlace> {
    let image = RgbImage::new(640, 480);
    places(&StereoCalibration::bare(nico_like_eyes()), (&image, left), (&image, right), options)
}

fn why(place: &ObjectPlace) -> Unpaired {
    let Seen::One { why, .. } = place.seen else { panic!("is paired: {:?}", place.seen) };
    why
}

/// Boxes of a ball in both eyes.
fn boxes(x: f64, y: f64, z: f64, radius_m: f64) -> [PixelBox; 2] {
    Eye::BOTH.map(|eye| ball_box(&nico_like_eyes(), eye, &Point3::new(x, y, z), radius_m))
}

#[test]
fn off_the_line_says_by_how_much() {
    let [left, right] = boxes(0.0, 0.1, 0.4, 0.03);
    let lower = PixelBox::new(right.x0_px, right.y0_px + 20.0, right.x1_px, right.y1_px + 20.0);
    let found = find(&[detection(1, left)], &[detection(1, lower)], &PlaceOptions::default());
    assert_eq!(found.len(), 2);
    for place in &found {
        let Unpaired::OffEpipolarLine { by_px } = why(place) else { panic!("{place:?}") };
        assert!((17.0..23.0).contains(&by_px), "{by_px}");
        assert!(matches!(place.place, Err(NoPlace::OneEye(_))));
    }
}

#[test]
fn reasons_fit_the_case() {
    let options = PlaceOptions::default();
    let [left, right] = boxes(0.0, 0.1, 0.4, 0.03);
    let found = find(&[detection(1, left)], &[detection(2, right)], &options);
    assert_eq!(found.iter().map(why).collect::<Vec<_>>(), [Unpaired::NoneOfThatClass; 2]);

    let aside = [detection(1, PixelBox::new(20.0, 200.0, 50.0, 240.0))];
    assert_eq!(why(&find(&aside, &[], &options)[0]), Unpaired::OutsideLens);

    // In the right eye further to the right than anything can be.
    let beyond = PixelBox::new(left.x0_px + 12.0, left.y0_px, left.x1_px + 12.0, left.y1_px);
    let found = find(&[detection(1, left)], &[detection(1, beyond)], &options);
    assert_eq!(found.iter().map(why).collect::<Vec<_>>(), [Unpaired::BeyondInfinity; 2]);

    let [left, right] = boxes(0.0, 0.0, 0.1, 0.01);
    let found = find(&[detection(1, left)], &[detection(1, right)], &options);
    assert!(found.iter().all(|place| matches!(why(place), Unpaired::TooNear { range_m } if range_m < 0.15)));

    let [left, right] = boxes(0.0, 0.0, 6.0, 0.2);
    let found = find(&[detection(1, left)], &[detection(1, right)], &options);
    assert!(found.iter().all(|place| matches!(why(place), Unpaired::TooFar { range_m } if range_m > 5.0)));

    let [left, _] = boxes(0.0, 0.1, 0.4, 0.05);
    let [_, right] = boxes(0.0, 0.1, 0.4, 0.015);
    let found = find(&[detection(1, left)], &[detection(1, right)], &options);
    let ratios: Vec<f64> = found
        .iter()
        .map(|place| match why(place) {
            Unpaired::SizesDiffer { ratio } => ratio,
            other => panic!("{other:?}"),
        })
        .collect();
    assert!(ratios[0] < 0.4 && ratios[1] > 2.5, "{ratios:?}");

    // Two left boxes, one partner.
    let [left, right] = boxes(0.0, 0.1, 0.4, 0.03);
    let beside = PixelBox::new(left.x0_px + 3.0, left.y0_px + 2.0, left.x1_px + 3.0, left.y1_px + 2.0);
    let found = find(&[detection(1, beside), detection(1, left)], &[detection(1, right)], &options);
    assert!(matches!(found[0].seen, Seen::Both { left: 1, right: 0, .. }), "{found:?}");
    assert_eq!(why(&found[1]), Unpaired::FitsAnotherBetter);
}

#[test]
fn what_the_other_eye_cannot_see_is_not_held_against_it() {
    let mut cameras = nico_like_eyes();
    cameras.right.width_px = 200;
    let (wide, narrow) = (RgbImage::new(640, 480), RgbImage::new(200, 480));
    let [left, _] = boxes(0.0, 0.1, 0.4, 0.03);
    let left = [detection(1, left)];
    let calibration = StereoCalibration::bare(cameras);
    let found = places(&calibration, (&wide, &left), (&narrow, &[]), &PlaceOptions::default());
    assert_eq!(why(&found[0]), Unpaired::OutsideOtherView);
}

#[test]
fn look_alikes_are_paired_and_flagged() {
    let names = ClassNames::published();
    let options = PlaceOptions::for_classes(&names);
    let [left, right] = boxes(0.0, 0.1, 0.4, 0.03);
    let [tomato, orange] = ["Tomato", "Orange"].map(|name| names.index_of(name).expect("published").0);
    let surer = Detection { confidence: 0.99, ..detection(orange, right) };
    let found = find(&[detection(tomato, left)], &[surer], &options);
    let Seen::Both { eyes_disagree: Some([l, r]), .. } = found[0].seen else { panic!("{found:?}") };
    assert_eq!((l.0, r.0, found[0].class.0), (tomato, orange, orange));
    // The right name is preferred where there is one.
    let found = find(&[detection(tomato, left)], &[surer, detection(tomato, right)], &options);
    assert!(matches!(found[0].seen, Seen::Both { right: 1, eyes_disagree: None, .. }), "{found:?}");
}

#[test]
fn without_calibration_there_are_boxes_only() {
    let [left, right] = boxes(0.0, 0.1, 0.4, 0.03);
    let image = RgbImage::new(640, 480);
    let mut out = Vec::new();
    let mut finder = PlaceFinder::new(None, PlaceOptions::default());
    finder.find((&image, &[detection(1, left)]), (&image, &[detection(1, right)]), &mut out);
    assert_eq!(out.len(), 2);
    assert!(out.iter().all(|place| place.place == Err(NoPlace::NoCalibration)));

    let small = RgbImage::new(64, 48);
    let calibration = StereoCalibration::bare(nico_like_eyes());
    let found =
        places(&calibration, (&small, &[detection(1, left)]), (&image, &[]), &PlaceOptions::default());
    assert_eq!(found[0].place, Err(NoPlace::OtherSize));

    let mut together = nico_like_eyes();
    together.right_from_left.isometry.translation.vector.fill(0.0);
    let found = places(
        &StereoCalibration::bare(together),
        (&image, &[detection(1, left)]),
        (&image, &[]),
        &PlaceOptions::default(),
    );
    assert_eq!(found[0].place, Err(NoPlace::NoBaseline));
}

#[test]
fn odd_boxes_are_answered() {
    let odd = [
        PixelBox::new(f32::NAN, 0.0, 10.0, 10.0),
        PixelBox::new(0.0, 0.0, f32::INFINITY, 10.0),
        PixelBox::new(10.0, 10.0, 10.0, 10.0),
        PixelBox::new(30.0, 30.0, 10.0, 10.0),
        PixelBox::new(-50.0, 0.0, -10.0, 10.0),
        PixelBox::new(700.0, 500.0, 710.0, 510.0),
    ];
    let odd: Vec<_> = odd.iter().map(|area| detection(0, *area)).collect();
    let found = find(&odd, &odd, &PlaceOptions::default());
    assert_eq!(found.len(), 12);
    assert!(found.iter().all(|place| why(place) == Unpaired::NotABox), "{found:?}");
    let tiny = [
        PixelBox::new(320.0, 240.0, 321.0, 241.0),
        PixelBox::new(0.0, 0.0, 640.0, 480.0),
        PixelBox::new(0.0, 100.0, 640.0, 101.0),
        PixelBox::new(319.9, 0.0, 320.0, 480.0),
    ];
    let tiny: Vec<_> = tiny.iter().map(|area| detection(0, *area)).collect();
    let shifted: Vec<_> = tiny
        .iter()
        .map(|d| {
            detection(0, PixelBox::new(d.area.x0_px - 20.0, d.area.y0_px, d.area.x1_px - 20.0, d.area.y1_px))
        })
        .collect();
    let found = find(&tiny, &shifted, &PlaceOptions::default());
    for place in found.iter().filter_map(|object| object.place.as_ref().ok()) {
        assert!(
            place.middle.point.coords.iter().all(|x| x.is_finite()) && place.middle.sigma_m().is_finite()
        );
    }
}

#[test]
fn every_box_is_answered_once_among_hundreds() {
    let mut noise = Noise::new(8);
    let mut many = |count: usize| -> Vec<Detection> {
        (0..count)
            .map(|i| {
                let mut between = |low, high| noise.between(low, high) as f32;
                let area = PixelBox::from_middle(
                    between(0.0, 640.0),
                    between(0.0, 480.0),
                    between(1.0, 60.0),
                    between(1.0, 60.0),
                );
                Detection { confidence: between(0.0, 1.0), ..detection(i % 8, area) }
            })
            .collect()
    };
    let (left, right) = (many(300), many(200));
    let found = find(&left, &right, &PlaceOptions::for_classes(&ClassNames::published()));
    for (eye, count) in [(Eye::Left, 300), (Eye::Right, 200)] {
        let mut indices: Vec<_> = found.iter().filter_map(|place| place.seen.index(eye)).collect();
        indices.sort_unstable();
        assert_eq!(indices, (0..count).collect::<Vec<_>>());
    }
    assert!(
        found.iter().any(|place| matches!(place.seen, Seen::One { why: Unpaired::TooMany { most: 64 }, .. }))
    );
}
