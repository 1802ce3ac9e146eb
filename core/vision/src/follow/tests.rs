//! Rendered scenes before and after an eye has turned by a known angle, and a ball was moved.

use image::GrayImage;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use plumbline_model::{Pose, StereoCameras};

use super::*;
use crate::health::turned;
use crate::synthetic::{Ball, Plane, Scene, granite_texture, nico_like_eyes};

fn scene(ball_x_m: f64) -> Scene {
    let table = Isometry3::new(Vector3::new(0.0, 0.25, 0.5), Vector3::new(1.9, 0.0, 0.0));
    let wall = Isometry3::translation(0.0, 0.0, 1.6);
    Scene {
        planes: vec![
            Plane::new(table, granite_texture(0.012, 7)),
            Plane::new(wall, granite_texture(0.05, 8)),
        ],
        balls: vec![Ball {
            center_in_left: Point3::new(ball_x_m, 0.2, 0.45),
            radius_m: 0.05,
            to_lamp: Vector3::new(0.3, -1.0, -0.2),
            tint: [1.0, 0.5, 0.4],
        }],
        background: 90.0,
    }
}

fn pair(eyes: &StereoCameras, ball_x_m: f64, noise: u64) -> [GrayImage; 2] {
    let (left, right) = scene(ball_x_m).render_pair(eyes, 2.0, noise);
    [left, right]
}

fn right_turn(eyes: &StereoCameras, before: &[GrayImage; 2], now: &[GrayImage; 2]) -> Option<EyeTurn> {
    let remembered = RememberedEye::new(&eyes.right, &before[1]).expect("texture");
    fit_eye_turn(&eyes.right, &remembered.follow(&now[1], &Vector3::zeros()).expect("the same size"))
}

#[test]
fn a_turned_eye_is_measured_by_itself() {
    let eyes = nico_like_eyes();
    let before = pair(&eyes, 0.1, 1);
    for turn_deg in [[0.0, 0.5, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, -0.5], [0.9, -0.8, 0.3], [0.0, 0.0, 0.0]] {
        let truth = Vector3::from(turn_deg).map(f64::to_radians);
        let now = pair(&turned(&eyes, &truth), 0.1, 2);
        let turn = right_turn(&eyes, &before, &now).expect("most places go along");
        let off_deg = (turn.rotation_rad - truth).map(f64::to_degrees);
        assert!(off_deg.norm() < 0.006, "{turn_deg:?}: off by {off_deg:?}");
        let left = RememberedEye::new(&eyes.left, &before[0]).expect("texture");
        let followed = left.follow(&now[0], &Vector3::zeros()).expect("the same size");
        let still = fit_eye_turn(&eyes.left, &followed).expect("most places go along");
        assert!(still.rotation_rad.norm().to_degrees() < 0.006, "the other eye stands: {still:?}");
    }
}

/// A page with print lies in the picture, its corner at this pixel.
fn lay_page(image: &mut GrayImage, at_px: [u32; 2]) {
    let mut state = 7_u32;
    for cell in 0..100 {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let ink = if state >> 31 == 0 { 30 } else { 220 };
        for pixel in 0..64 {
            let (u, v) = (8 * (cell % 10) + pixel % 8, 8 * (cell / 10) + pixel / 8);
            image.put_pixel(at_px[0] + u, at_px[1] + v, image::Luma([ink]));
        }
    }
}

#[test]
fn what_moves_by_itself_is_told_from_the_eye() {
    let eyes = nico_like_eyes();
    let (mut before, mut now) = (pair(&eyes, 0.1, 1), pair(&eyes, 0.1, 2));
    lay_page(&mut before[1], [280, 240]);
    lay_page(&mut now[1], [285, 240]);
    let turn = right_turn(&eyes, &before, &now).expect("most places go along");
    assert!(turn.rotation_rad.norm().to_degrees() < 0.006, "{:?}", turn.rotation_rad);
    let own = turn.went_along.iter().filter(|along| !**along).count();
    let most = turn.residuals_px.iter().map(|[u, v]| u.hypot(*v)).fold(0.0, f64::max);
    assert!(own >= 1 && (most - 5.0).abs() < 1.0, "{own} places of the page moved, most {most} px");
}

#[test]
fn another_view_and_the_dark_say_nothing() {
    let eyes = nico_like_eyes();
    let before = pair(&eyes, 0.1, 1);
    let dark = GrayImage::from_pixel(640, 480, image::Luma([4]));
    let remembered = RememberedEye::new(&eyes.right, &before[1]).expect("texture");
    let followed = remembered.follow(&dark, &Vector3::zeros()).expect("the same size");
    assert!(fit_eye_turn(&eyes.right, &followed).is_none());
    assert!(RememberedEye::new(&eyes.right, &dark).is_err());
    // The whole head went elsewhere.
    let there = Isometry3::from_parts(
        Vector3::new(0.1, 0.0, 0.0).into(),
        UnitQuaternion::from_scaled_axis(Vector3::new(0.2, 0.4, 0.0)),
    );
    let mut elsewhere = eyes;
    elsewhere.right_from_left = Pose::new(there * eyes.right_from_left.isometry);
    assert!(right_turn(&eyes, &before, &pair(&elsewhere, 0.1, 2)).is_none());
}
