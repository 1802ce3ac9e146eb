//! What holds for any rig: uncertainty against the one of single points, curves through the truth.

use nalgebra::{DMatrix, Point3, Vector3};
use plumbline_model::{Eye, ParameterCovariance, Pixel, Raw, StereoCalibration};

use crate::detect_places::uncertainty::by_calibration;
use crate::detect_places::{PlaceFinder, PlaceOptions};
use crate::locate::from_calibration;
use crate::synthetic::{Noise, nico_like_eyes};

#[test]
fn the_calibrations_part_is_the_one_found_by_differences() {
    let cameras = nico_like_eyes();
    let mut noise = Noise::new(2);
    let scale = |i: usize| match i {
        0..4 | 8..12 => 0.1,
        4..8 | 12..16 => 0.001,
        16..19 => 0.0005,
        _ => 0.0002,
    };
    let root = DMatrix::from_fn(22, 22, |i, _| scale(i) * noise.normal() / 5.0);
    let covariance = ParameterCovariance { matrix: &root * root.transpose() };
    for (x, y, z) in [(0.0, 0.1, 0.4), (-0.2, -0.05, 0.5), (0.25, 0.2, 0.3), (0.0, 0.0, 1.0)] {
        let point = Point3::new(x, y, z);
        let left = cameras.left.project(&point.coords).expect("visible");
        let in_right = cameras.right_from_left.isometry * point;
        let right = cameras.right.project(&in_right.coords).expect("visible");
        let here = by_calibration(&cameras, &covariance, &point.coords).expect("visible");
        let there = from_calibration(&cameras, &covariance, left, right).expect("visible");
        assert!((here - there).norm() < 0.02 * there.norm(), "{here} instead of {there}");
    }
    let wrong = ParameterCovariance { matrix: DMatrix::identity(6, 6) };
    assert_eq!(by_calibration(&cameras, &wrong, &Vector3::z()), None);
}

#[test]
fn epipolar_curves_pass_through_the_other_eyes_pixel() {
    let cameras = nico_like_eyes();
    let finder = PlaceFinder::new(Some(&StereoCalibration::bare(cameras)), PlaceOptions::default());
    let mut noise = Noise::new(4);
    let mut curve: Vec<Pixel<Raw>> = Vec::new();
    for _ in 0..40 {
        let point = Point3::new(noise.between(-0.2, 0.2), noise.between(-0.2, 0.2), noise.between(0.3, 1.0));
        let left = cameras.left.project(&point.coords).expect("visible");
        let right =
            cameras.right.project(&(cameras.right_from_left.isometry * point).coords).expect("visible");
        for (from, pixel, other) in [(Eye::Left, left, right), (Eye::Right, right, left)] {
            finder.epipolar_curve(from, pixel, &mut curve);
            let off_px = curve
                .windows(2)
                .map(|ends| {
                    let (a, b, p) = (ends[0].vector(), ends[1].vector(), other.vector());
                    let t = ((p - a).dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
                    (a + (b - a) * t - p).norm()
                })
                .fold(f64::INFINITY, f64::min);
            assert!(off_px < 0.1, "the curve misses by {off_px} px");
        }
    }
    PlaceFinder::new(None, PlaceOptions::default()).epipolar_curve(Eye::Left, curve[0], &mut curve);
    assert!(curve.is_empty());
}
