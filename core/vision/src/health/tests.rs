//! Rendered scenes with an eye turned by a known angle.

use image::GrayImage;
use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::{LeftCamera, Point, StereoCameras};

use super::*;
use crate::synthetic::{Ball, Plane, Scene, granite_texture, nico_like_eyes};

/// A table before the eyes, a wall behind it, toys.
fn scene(seed: u64) -> Scene {
    let table = Isometry3::new(Vector3::new(0.0, 0.25, 0.5), Vector3::new(1.9, 0.0, 0.0));
    let wall = Isometry3::translation(0.0, 0.0, 1.6);
    let toy = |x_m: f64, z_m: f64| Ball {
        center_in_left: Point3::new(x_m, 0.2, z_m),
        radius_m: 0.03,
        to_lamp: Vector3::new(0.3, -1.0, -0.2),
        tint: [1.0, 0.5, 0.4],
    };
    Scene {
        planes: vec![
            Plane::new(
                table,
                Box::new({
                    let granite = granite_texture(0.012, seed);
                    move |x, y| if x.abs() < 0.6 && y.abs() < 0.45 { granite(x, y) } else { None }
                }),
            ),
            Plane::new(wall, granite_texture(0.05, seed + 1)),
        ],
        balls: vec![toy(0.1, 0.45), toy(-0.12, 0.6)],
        background: 90.0,
    }
}

fn pairs(eyes: &StereoCameras, count: u64) -> Vec<(GrayImage, GrayImage)> {
    (0..count).map(|k| scene(10 * k).render_pair(eyes, 2.0, k)).collect()
}

fn far() -> Vec<Point<LeftCamera>> {
    vec![Point::new(-0.2, 0.2, 0.7), Point::new(0.0, 0.2, 0.7), Point::new(0.2, 0.2, 0.7)]
}

#[test]
fn a_turned_eye_is_measured() {
    let eyes = nico_like_eyes();
    for turn_deg in [[0.0, 0.5, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, -0.5], [1.2, -0.8, 0.6]] {
        let truth = Vector3::from(turn_deg).map(f64::to_radians);
        let (matches, count) = find_matches(&eyes, &pairs(&turned(&eyes, &truth), 2)).expect("matches");
        assert!(count.matched >= 300, "{count:?}");
        let turn = fit_turn(&eyes, &matches).expect("determined");
        let off_deg = (turn.rotation_rad - truth).map(f64::to_degrees);
        assert!(off_deg.norm() < 0.01, "{turn_deg:?}: off by {off_deg:?}");
        for axis in 0..3 {
            let sigma = turn.covariance_rad2[(axis, axis)].sqrt().to_degrees();
            assert!(off_deg[axis].abs() < 4.0 * sigma, "{turn_deg:?}, axis {axis}: {off_deg:?} at {sigma}");
        }
        let cost = cost(&eyes, &turn, &far()).expect("seen");
        assert!(cost.error_m > 0.005, "half a degree is nearly a centimeter far away: {cost:?}");
    }
}

#[test]
fn healthy_eyes_are_healthy() {
    let eyes = nico_like_eyes();
    let (matches, _) = find_matches(&eyes, &pairs(&eyes, 2)).expect("matches");
    let turn = fit_turn(&eyes, &matches).expect("determined");
    assert!(turn.angle_rad().to_degrees() < 0.01, "{turn:?}");
    let cost = cost(&eyes, &turn, &far()).expect("seen");
    assert!(cost.error_m < 0.001, "{cost:?}");
    assert!(epipolar_px(&eyes, &matches).expect("planes") < 0.2);
}

#[test]
fn of_two_calibrations_the_right_one_fits_better() {
    let eyes = nico_like_eyes();
    let off = turned(&eyes, &Vector3::new(0.003, 0.006, 0.0));
    let (matches, _) = find_matches(&off, &pairs(&eyes, 2)).expect("matches");
    assert!(fits_better_by(&off, &eyes, &matches).expect("planes") > 3.0);
    assert!(fits_better_by(&eyes, &off, &matches).expect("planes") < -3.0);
    assert_eq!(fits_better_by(&eyes, &eyes, &matches).expect("planes"), 0.0);
}

#[test]
fn lights_off_and_other_sizes_are_said() {
    let eyes = nico_like_eyes();
    let dark = GrayImage::from_pixel(640, 480, image::Luma([4]));
    let error = find_matches(&eyes, &[(dark.clone(), dark)]).expect_err("nothing to see");
    assert!(matches!(error, HealthError::TooFew { found: 0, .. }), "{error}");
    let small = GrayImage::new(320, 240);
    let error = find_matches(&eyes, &[(small.clone(), small)]).expect_err("other images");
    assert!(matches!(error, HealthError::Size { expected_px: (640, 480) }), "{error}");
}

#[test]
fn an_eye_that_is_covered_says_nothing() {
    let eyes = nico_like_eyes();
    let (left, _) = scene(3).render_pair(&eyes, 2.0, 1);
    let covered = GrayImage::from_pixel(640, 480, image::Luma([30]));
    assert!(matches!(find_matches(&eyes, &[(left, covered)]), Err(HealthError::TooFew { .. })));
}

#[test]
fn where_the_time_is_over_no_place_is_looked_for_and_that_is_said() {
    let eyes = nico_like_eyes();
    let error = find_matches_until(&eyes, &pairs(&eyes, 1), &|| true).expect_err("no time");
    assert!(matches!(error, HealthError::OutOfTime { found: 0, .. }), "{error}");
    assert!(error.to_string().contains("close other programs"), "{error}");
}
