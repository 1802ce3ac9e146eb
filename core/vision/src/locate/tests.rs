//! Rendered worlds with a known truth.

use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::{Chessboard, Eye, Pixel, Raw, StereoCalibration};

use super::{Locator, NotLocated};
use crate::synthetic::{Noise, Plane, Scene, chessboard_texture, granite_texture, nico_like_eyes};

/// A granite table, 0.45 m away and tilted like NICO's.
fn table() -> (Scene, Isometry3<f64>) {
    let left_from_plane = Isometry3::new(Vector3::new(0.0, 0.1, 0.45), Vector3::new(-0.9, 0.0, 0.1));
    let plane = Plane::new(left_from_plane, granite_texture(0.008, 3));
    (Scene { planes: vec![plane], background: 0.0, ..Scene::default() }, left_from_plane)
}

fn pixels(count: usize) -> Vec<Pixel<Raw>> {
    let mut noise = Noise::new(1);
    (0..count).map(|_| Pixel::new(noise.between(200.0, 440.0), noise.between(180.0, 330.0))).collect()
}

/// Where the left ray of a pixel meets the plane.
fn truth(left_from_plane: &Isometry3<f64>, pixel: Pixel<Raw>) -> Point3<f64> {
    let ray = nico_like_eyes().left.unproject(pixel).expect("on the image");
    let normal = left_from_plane.rotation * Vector3::z();
    Point3::from(ray * (left_from_plane.translation.vector.dot(&normal) / ray.dot(&normal)))
}

#[test]
fn places_on_a_textured_table_are_found_within_their_stated_uncertainty() {
    let eyes = nico_like_eyes();
    let (scene, left_from_plane) = table();
    let (left, right) = scene.render_pair(&eyes, 2.0, 7);
    let mut locator = Locator::new(&StereoCalibration::bare(eyes)).expect("has a baseline");
    // Rendered images have neither blur nor mosaic nor compression.
    locator.image_sigma_px = 0.0;
    let pixels = pixels(150);
    let found = locator.locate(&left, &right, &pixels);
    let (mut squared_px, mut normalized) = (Vec::new(), Vec::new());
    for (result, pixel) in found.iter().zip(&pixels) {
        let Ok(located) = result else { continue };
        let truth = truth(&left_from_plane, *pixel);
        let in_right = eyes.right.project(&(eyes.right_from_left.isometry * truth).coords).expect("visible");
        squared_px.push(located.match_in_right.distance_px(&in_right).powi(2));
        normalized.push((located.point.coords - truth).norm() / located.sigma_m);
    }
    assert!(normalized.len() > 135, "only {} of {} found", normalized.len(), pixels.len());
    let rms_px = (squared_px.iter().sum::<f64>() / squared_px.len() as f64).sqrt();
    assert!(rms_px < 0.15, "matches are off by {rms_px} px");
    normalized.sort_by(f64::total_cmp);
    let (p68, p95) = (normalized[normalized.len() * 68 / 100], normalized[normalized.len() * 95 / 100]);
    // A standard deviation: 68 % below one, 95 % below two, and not hugely pessimistic either.
    assert!(
        (0.35..1.3).contains(&p68) && p95 < 2.6,
        "68 % within {p68}, 95 % within {p95} of the stated sigma"
    );
}

#[test]
fn a_uniform_wall_is_not_found_and_says_why() {
    let eyes = nico_like_eyes();
    let scene = Scene { planes: Vec::new(), background: 128.0, ..Scene::default() };
    let (left, right) = scene.render_pair(&eyes, 1.0, 2);
    let locator = Locator::new(&StereoCalibration::bare(eyes)).expect("has a baseline");
    for result in locator.locate(&left, &right, &pixels(10)) {
        assert!(result.is_err(), "{result:?}");
    }
}

#[test]
fn what_only_the_left_eye_sees_is_not_found() {
    let eyes = nico_like_eyes();
    let (scene, _) = table();
    let left = scene.render(&eyes, Eye::Left, 2.0, 1);
    let left_from_plane = Isometry3::new(Vector3::new(0.0, 0.1, 0.45), Vector3::new(-0.9, 0.0, 0.1));
    let plane = Plane::new(left_from_plane, granite_texture(0.008, 99));
    let other = Scene { planes: vec![plane], background: 0.0, ..Scene::default() };
    let right = other.render(&eyes, Eye::Right, 2.0, 1);
    let locator = Locator::new(&StereoCalibration::bare(eyes)).expect("has a baseline");
    let pixels = pixels(60);
    let claimed = locator.locate(&left, &right, &pixels).iter().filter(|r| r.is_ok()).count();
    assert!(claimed <= 1, "{claimed} of {} places were claimed in unrelated images", pixels.len());
}

#[test]
fn endless_repetition_is_called_ambiguous() {
    let eyes = nico_like_eyes();
    let stripes = Plane::new(
        Isometry3::translation(0.0, 0.0, 0.4),
        Box::new(|x, y| {
            Some(if ((x / 0.012).floor() + (y / 0.012).floor()) % 2.0 == 0.0 { 60.0 } else { 200.0 })
        }),
    );
    let (left, right) =
        Scene { planes: vec![stripes], background: 0.0, ..Scene::default() }.render_pair(&eyes, 1.0, 5);
    let locator = Locator::new(&StereoCalibration::bare(eyes)).expect("has a baseline");
    let results = locator.locate(&left, &right, &pixels(20));
    let ambiguous = results.iter().filter(|r| matches!(r, Err(NotLocated::Ambiguous))).count();
    let claimed = results.iter().filter(|r| r.is_ok()).count();
    assert!(ambiguous >= 10 && claimed <= 4, "{ambiguous} ambiguous, {claimed} claimed of 20");
}

#[test]
fn pixels_off_the_image_and_off_the_lens_are_refused() {
    let eyes = nico_like_eyes();
    let (scene, _) = table();
    let (left, right) = scene.render_pair(&eyes, 1.0, 2);
    let locator = Locator::new(&StereoCalibration::bare(eyes)).expect("has a baseline");
    let results = locator.locate(
        &left,
        &right,
        &[Pixel::new(-1.0, 5.0), Pixel::new(f64::NAN, 5.0), Pixel::new(639.0, 200.0)],
    );
    assert_eq!(results[0], Err(NotLocated::OutsideImage));
    assert_eq!(results[1], Err(NotLocated::OutsideImage));
    assert!(results[2].is_err());
}

#[test]
fn corners_of_a_board_are_told_apart() {
    let eyes = nico_like_eyes();
    let board = Chessboard::new(8, 5, 0.03).expect("usable");
    let left_from_board = Isometry3::new(Vector3::new(-0.1, -0.06, 0.3), Vector3::new(0.2, -0.3, 0.1));
    let scene = Scene {
        planes: vec![
            Plane::new(left_from_board, chessboard_texture(&board)),
            Plane::new(Isometry3::translation(0.0, 0.0, 1.2), granite_texture(0.05, 8)),
        ],
        ..Scene::default()
    };
    let (left, right) = scene.render_pair(&eyes, 1.5, 4);
    let locator = Locator::new(&StereoCalibration::bare(eyes)).expect("has a baseline");
    let corners: Vec<_> = board.corners().iter().map(|c| left_from_board * c.coords).collect();
    let pixels: Vec<_> = corners.iter().map(|c| eyes.left.project(&c.coords).expect("visible")).collect();
    let (mut found, mut wrong) = (0, 0);
    for (result, corner) in locator.locate(&left, &right, &pixels).iter().zip(&corners) {
        if let Ok(located) = result {
            found += 1;
            wrong += usize::from((located.point.coords - corner).norm() > 0.005);
        }
    }
    assert!(found >= 34 && wrong == 0, "{found} of 40 found, {wrong} of them wrong");
}
