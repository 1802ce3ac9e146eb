//! Rendered boards with a known truth.

use image::{GrayImage, imageops};
use nalgebra::{Isometry3, Vector3};
use plumbline_model::{Chessboard, Eye, InnerCorners, StereoCameras};

use super::{NotSeen, find, find_in_pair, glimpse, recognize};
use crate::synthetic::{Plane, Scene, chessboard_texture, granite_texture, nico_like_eyes};

fn board() -> Chessboard {
    Chessboard::new(8, 5, 0.03).expect("usable")
}

/// Board poses over the view of the fisheye: center, near the rim, oblique, turned, far.
fn poses() -> Vec<Isometry3<f64>> {
    let centered = Isometry3::translation(-0.105, -0.06, 0.0);
    [
        (Vector3::new(0.0, 0.0, 0.25), Vector3::new(0.0, 0.0, 0.0)),
        (Vector3::new(0.15, -0.1, 0.22), Vector3::new(0.3, -0.4, 0.2)),
        (Vector3::new(-0.25, 0.05, 0.18), Vector3::new(0.2, -0.5, -0.4)),
        (Vector3::new(0.02, 0.15, 0.3), Vector3::new(-0.8, 0.1, 1.4)),
        (Vector3::new(0.05, -0.05, 0.45), Vector3::new(0.1, 0.2, 2.8)),
    ]
    .map(|(place, turn)| Isometry3::new(place, turn) * centered)
    .to_vec()
}

fn scene(left_from_board: Isometry3<f64>, board: &Chessboard) -> Scene {
    let wall = Plane::new(Isometry3::translation(0.0, 0.0, 1.5), granite_texture(0.02, 11));
    let board = Plane::new(left_from_board, chessboard_texture(board));
    Scene { planes: vec![wall, board], background: 0.0, ..Scene::default() }
}

fn render(left_from_board: Isometry3<f64>, board: &Chessboard, eye: Eye, eyes: &StereoCameras) -> GrayImage {
    imageops::blur(&scene(left_from_board, board).render(eyes, eye, 2.0, 5), 0.7)
}

#[test]
fn every_corner_is_found_to_a_fraction_of_a_pixel_in_the_boards_order() {
    let eyes = nico_like_eyes();
    for (i, pose) in poses().into_iter().enumerate() {
        let found = find(&render(pose, &board(), Eye::Left, &eyes), &board()).expect("visible");
        let mut squared = 0.0;
        for (k, pixel) in found.iter().enumerate() {
            let truth = eyes.left.project(&(pose * board().corner(k).coords).coords).expect("visible");
            squared += pixel.distance_px(&truth).powi(2);
        }
        let rms_px = (squared / found.len() as f64).sqrt();
        assert!(rms_px < 0.12, "pose {i}: corners are off by {rms_px} px");
    }
}

#[test]
fn both_eyes_count_from_the_same_end() {
    let eyes = nico_like_eyes();
    // A board whose two ends look alike.
    let board = Chessboard::new(7, 5, 0.03).expect("usable");
    for pose in poses() {
        let [left, right] = Eye::BOTH.map(|eye| render(pose, &board, eye, &eyes));
        let seen = find_in_pair("a", &left, &right, &board);
        let (left, right) = (seen.observation.left.expect("seen"), seen.observation.right.expect("seen"));
        // From which end is open; that both eyes start from the same one is not.
        let far = |k: usize, truth: usize| {
            let (a, b) = (left[k].expect("measured"), right[k].expect("measured"));
            let point = eyes.triangulate(a, b).map(|p| p.coords.coords);
            point.map_or(f64::INFINITY, |p| (p - (pose * board.corner(truth).coords).coords).norm())
        };
        let last = board.corner_count() - 1;
        let straight = (0..=last).map(|k| far(k, k)).fold(0.0, f64::max);
        let turned = (0..=last).map(|k| far(k, last - k)).fold(0.0, f64::max);
        assert!(straight.min(turned) < 0.01, "corners are up to {} m off", straight.min(turned));
    }
}

#[test]
fn another_board_is_recognized_and_named() {
    let image = render(poses()[0], &board(), Eye::Left, &nico_like_eyes());
    assert_eq!(recognize(&image), Some(InnerCorners { columns: 8, rows: 5 }));
    let squares_for_corners = Chessboard::new(9, 6, 0.03).expect("usable");
    let error = find(&image, &squares_for_corners).expect_err("one too many each way");
    assert_eq!(error, NotSeen::OtherBoard { columns: 9, rows: 6, seen_columns: 8, seen_rows: 5 });
    let part = Chessboard::new(6, 4, 0.03).expect("usable");
    assert!(glimpse(&image, &part).is_none(), "a part of a bigger board is not the board");
}

#[test]
fn no_board_is_an_outcome() {
    let eyes = nico_like_eyes();
    let mut without = scene(poses()[0], &board());
    without.planes.pop();
    let image = without.render(&eyes, Eye::Left, 2.0, 5);
    assert_eq!(find(&image, &board()), Err(NotSeen::Nothing));
    assert_eq!(recognize(&image), None);
    assert!(matches!(find(&GrayImage::new(8, 8), &board()), Err(NotSeen::BadImage(_))));
    assert_eq!(find(&GrayImage::new(64, 64), &board()), Err(NotSeen::Nothing));
}

#[test]
fn a_board_half_out_of_view_is_not_the_board() {
    let pose = Isometry3::new(Vector3::new(0.0, 0.0, 0.25), Vector3::zeros());
    let mut image = render(pose, &board(), Eye::Left, &nico_like_eyes());
    // A hand in front of three columns.
    imageops::replace(&mut image, &GrayImage::from_pixel(60, 200, image::Luma([120])), 300, 200);
    assert!(find(&image, &board()).is_err());
}
