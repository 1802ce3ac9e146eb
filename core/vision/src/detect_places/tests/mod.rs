//! Rendered worlds with a known truth.

mod failures;
mod laws;
mod leak;
mod truth;

use image::RgbImage;
use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::{CameraModel, ClassIndex, Detection, Eye, PixelBox, StereoCameras};

use crate::synthetic::{Ball, Noise, Plane, Scene, Texture, nico_like_eyes};

pub(super) fn detection(class: usize, area: PixelBox) -> Detection {
    Detection { class: ClassIndex(class), confidence: 0.9, area }
}

/// The middle of the view of NICO-like eyes, 320×240 px: quicker to render.
pub(super) fn small_eyes() -> StereoCameras {
    let mut cameras = nico_like_eyes();
    for camera in [&mut cameras.left, &mut cameras.right] {
        let CameraModel::Fisheye(lens) = &mut camera.model else { continue };
        (lens.cx_px, lens.cy_px) = (lens.cx_px - 160.0, lens.cy_px - 120.0);
        (camera.width_px, camera.height_px) = (320, 240);
    }
    cameras
}

/// Random blotches of about `grain_m`, repeated after 64 of them; quick to look up.
pub(super) fn blotches(grain_m: f64, seed: u64) -> Texture {
    let mut noise = Noise::new(seed);
    let values: Vec<f64> = (0..64 * 64).map(|_| noise.between(60.0, 210.0)).collect();
    Box::new(move |x, y| {
        let (x, y) = (x / grain_m, y / grain_m);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let value = |i: i64, j: i64| values[((j & 63) * 64 + (i & 63)) as usize];
        let (i, j) = (x.floor() as i64, y.floor() as i64);
        let top = value(i, j) * (1.0 - fx) + value(i + 1, j) * fx;
        let below = value(i, j + 1) * (1.0 - fx) + value(i + 1, j + 1) * fx;
        Some(top * (1.0 - fy) + below * fy)
    })
}

/// Box of everything that an eye would see of a ball that nothing hides.
pub(super) fn ball_box(
    cameras: &StereoCameras,
    eye: Eye,
    center_in_left: &Point3<f64>,
    radius_m: f64,
) -> PixelBox {
    let eye_from_left = match eye {
        Eye::Left => Isometry3::identity(),
        Eye::Right => cameras.right_from_left.isometry,
    };
    let mut area = PixelBox::new(f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY);
    for i in 0..40 {
        for j in 0..80 {
            let (a, b) =
                (f64::from(i) / 40.0 * std::f64::consts::PI, f64::from(j) / 40.0 * std::f64::consts::PI);
            let normal = Vector3::new(a.sin() * b.cos(), a.sin() * b.sin(), a.cos());
            let point = eye_from_left * (center_in_left + normal * radius_m);
            let Ok(pixel) = cameras.camera(eye).project(&point.coords) else { continue };
            let (x, y) = (pixel.u_px as f32 + 0.5, pixel.v_px as f32 + 0.5);
            area = PixelBox::new(area.x0_px.min(x), area.y0_px.min(y), area.x1_px.max(x), area.y1_px.max(y));
        }
    }
    area
}

/// The same with every edge wrong by chance.
pub(super) fn shaken(area: &PixelBox, sigma_px: f64, noise: &mut Noise) -> PixelBox {
    let mut edge = |value: f32| value + (sigma_px * noise.normal()) as f32;
    PixelBox::new(edge(area.x0_px), edge(area.y0_px), edge(area.x1_px), edge(area.y1_px))
}

fn left_from_table() -> Isometry3<f64> {
    Isometry3::new(Vector3::new(0.0, 0.25, 0.45), Vector3::new(-1.0, 0.0, 0.05))
}

/// Whether a ball is not sunk into the table.
pub(super) fn is_above_table(center_in_left: &Point3<f64>, radius_m: f64) -> bool {
    let height_m = |point: &Point3<f64>| left_from_table().inverse_transform_point(point).z;
    height_m(center_in_left) * height_m(&Point3::origin()).signum() > radius_m
}

/// Balls before a textured wall at `wall_m` and over a table like NICO's.
pub(super) fn scene(balls: Vec<Ball>, wall_m: f64, seed: u64) -> Scene {
    let table = left_from_table();
    Scene {
        planes: vec![
            Plane::new(Isometry3::translation(0.0, 0.0, wall_m), blotches(0.06 * wall_m, seed))
                .tinted([0.8, 0.75, 0.7]),
            Plane::new(table, blotches(0.012, seed + 1)).tinted([0.55, 0.5, 0.45]),
        ],
        balls,
        ..Scene::default()
    }
}

pub(super) const TINTS: [[f64; 3]; 4] =
    [[1.0, 0.16, 0.12], [1.0, 0.55, 0.1], [0.95, 0.9, 0.85], [1.0, 0.9, 0.2]];

pub(super) fn ball(center_in_left: Point3<f64>, radius_m: f64, tint: usize) -> Ball {
    Ball { center_in_left, radius_m, to_lamp: Vector3::new(0.2, -1.0, -0.5), tint: TINTS[tint % TINTS.len()] }
}

/// Both eyes with the blur of a cheap lens and noise.
pub(super) fn images(scene: &Scene, seed: u64) -> [RgbImage; 2] {
    Eye::BOTH.map(|eye| image::imageops::blur(&scene.render_rgb(&small_eyes(), eye, 2.0, seed), 0.6))
}
