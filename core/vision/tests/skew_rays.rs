//! How far the middle between skew rays, by which places are found, lies from where both pixels together would put
//! the point with the least change of the rays' directions (Lee and Civera 2019): where pixels leave each other's
//! epipolar line, the middle comes out too near.
#![allow(clippy::print_stdout, reason = "figures for who reads the test's output")]

use nalgebra::{DMatrix, Vector3};
use plumbline_model::robot::default_rig;
use plumbline_model::{Pixel, Point, Raw, StereoCameras, decompose};

/// Both rays turned as little as possible (sum of squared sines) until they meet, left camera, m.
fn least_turned(cameras: &StereoCameras, left: Pixel<Raw>, right: Pixel<Raw>) -> Vector3<f64> {
    let left_from_right = cameras.right_from_left.isometry.inverse();
    let ray_left = cameras.left.unproject(left).expect("in the image").normalize();
    let ray_right =
        left_from_right.rotation * cameras.right.unproject(right).expect("in the image").normalize();
    let origin = left_from_right.translation.vector;
    let along = origin.normalize();
    let off = |ray: Vector3<f64>| ray - along * ray.dot(&along);
    let (a, b) = (off(ray_left), off(ray_right));
    // The plane through both eyes that both rays are nearest to.
    let both = DMatrix::from_fn(3, 3, |r, c| a[r] * a[c] + b[r] * b[c]);
    let eigen = decompose::symmetric_eigen(both).expect("finite");
    let upright =
        (0..3).max_by(|k, l| eigen.eigenvalues[*k].total_cmp(&eigen.eigenvalues[*l])).expect("three");
    let in_plane = Vector3::from_fn(|c, _| eigen.eigenvectors[(c, upright)]);
    let flat = |ray: Vector3<f64>| along * ray.dot(&along) + in_plane * ray.dot(&in_plane);
    let (p, q) = (flat(ray_left), flat(ray_right));
    // p s = origin + q t in that plane.
    let (px, py, qx, qy) = (p.dot(&along), p.dot(&in_plane), q.dot(&along), q.dot(&in_plane));
    p * (origin.norm() * qy / (px * qy - py * qx))
}

/// Straight ahead and aside, near, middle and far on the table, left camera, m.
fn places() -> impl Iterator<Item = Vector3<f64>> {
    [0.35, 0.6, 0.85].into_iter().flat_map(|z| [0.0, 0.25].map(|x| Vector3::new(x * z, 0.1 * z, z)))
}

fn seen(cameras: &StereoCameras, at: Vector3<f64>) -> [Pixel<Raw>; 2] {
    let in_right = cameras.right_from_left * Point::new(at.x, at.y, at.z);
    [cameras.left.project(&at), cameras.right.project(&in_right.coords.coords)].map(|px| px.expect("in view"))
}

#[test]
fn without_skew_both_are_the_point() {
    let cameras = default_rig().eyes.cameras;
    for at in places() {
        let [left, right] = seen(&cameras, at);
        let middle = cameras.triangulate(left, right).expect("in front").coords.coords;
        assert!((middle - at).norm() < 1e-9 && (least_turned(&cameras, left, right) - at).norm() < 1e-9);
    }
}

#[test]
fn noise_of_ordinary_pixels_shortens_the_middle_by_about_a_millimeter_at_most() {
    let cameras = default_rig().eyes.cameras;
    let mut state = 5_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
    for at in places() {
        let [left, right] = seen(&cameras, at);
        let (mut shorter_m, count) = (0.0, 4000);
        for _ in 0..count {
            let mut off = |px: Pixel<Raw>| Pixel::new(px.u_px + 0.3 * normal(), px.v_px + 0.3 * normal());
            let (left, right) = (off(left), off(right));
            let middle = cameras.triangulate(left, right).expect("in front").coords.coords;
            shorter_m += least_turned(&cameras, left, right).norm() - middle.norm();
        }
        let shorter_mm = 1e3 * shorter_m / f64::from(count);
        println!("{:.2} m, 0.3 px of noise: the middle is {shorter_mm:.3} mm nearer", at.norm());
        assert!((0.0..1.2).contains(&shorter_mm), "{shorter_mm}");
    }
}

/// What an eye that has nodded or rolled does to everything, and the boxes of a detector to a thing.
#[test]
fn rays_that_pass_each_other_shorten_the_middle_by_the_square_of_how_far() {
    let cameras = default_rig().eyes.cameras;
    for at in places() {
        let [left, right] = seen(&cameras, at);
        let shorter_mm = |px: f64| {
            let right = Pixel::new(right.u_px, right.v_px + px);
            let middle = cameras.triangulate(left, right).expect("in front").coords.coords;
            1e3 * (least_turned(&cameras, left, right).norm() - middle.norm())
        };
        let [one, three] = [1.0, 3.0].map(shorter_mm);
        println!("{:.2} m: 1 px past each other {one:.2} mm nearer, 3 px {three:.2} mm", at.norm());
        assert!(one > 0.0 && (three / one - 9.0).abs() < 1.0, "{one}, {three}");
    }
}
