//! Renders flat textured things through any lens: images with a known truth, for tests and for
//! trying the program without a camera.
//!
//! Exact geometry, box-filtered pixels, Gaussian noise from a seed. No blur, shading or gloss.

use image::GrayImage;
use nalgebra::{Isometry3, Point3, Vector3};
use plumbline_model::{Camera, Chessboard, Eye, Pixel, StereoCameras};
use rayon::prelude::*;

/// Brightness (0..255) at a place on a plane, meters; `None` where the thing ends.
pub type Texture = Box<dyn Fn(f64, f64) -> Option<f64> + Send + Sync>;

/// A textured plane: its z = 0.
pub struct Plane {
    /// Pose of the plane in the left camera.
    pub left_from_plane: Isometry3<f64>,
    /// What is printed on it.
    pub texture: Texture,
}

/// What can be rendered. The nearest plane hides those behind it.
#[derive(Default)]
pub struct Scene {
    /// In any order.
    pub planes: Vec<Plane>,
    /// Brightness where there is nothing.
    pub background: f64,
}

/// Sub-samples per pixel, each way.
const SUBSAMPLES: u32 = 3;
/// Bright and dark print, gray levels: paper and ink under lamps are neither 255 nor 0.
const PAPER: f64 = 215.0;
const INK: f64 = 35.0;

impl Scene {
    /// Image of one eye with Gaussian noise of `sigma` gray levels.
    pub fn render(&self, cameras: &StereoCameras, eye: Eye, sigma: f64, seed: u64) -> GrayImage {
        let eye_from_left = match eye {
            Eye::Left => Isometry3::identity(),
            Eye::Right => cameras.right_from_left.isometry,
        };
        let planes_from_eye: Vec<Isometry3<f64>> =
            self.planes.iter().map(|p| (eye_from_left * p.left_from_plane).inverse()).collect();
        let camera = cameras.camera(eye);
        let width = camera.width_px as usize;
        let mut pixels = vec![0u8; width * camera.height_px as usize];
        pixels.par_chunks_mut(width).enumerate().for_each(|(v, row)| {
            let mut noise = Noise::new(seed ^ ((v as u64 + 1) << 20) ^ ((eye.index() as u64) << 60));
            for (u, value) in row.iter_mut().enumerate() {
                let brightness =
                    self.pixel(camera, &planes_from_eye, u as f64, v as f64) + sigma * noise.normal();
                *value = brightness.round().clamp(0.0, 255.0) as u8;
            }
        });
        GrayImage::from_fn(camera.width_px, camera.height_px, |u, v| {
            image::Luma([pixels[v as usize * width + u as usize]])
        })
    }

    /// Both eyes.
    pub fn render_pair(&self, cameras: &StereoCameras, sigma: f64, seed: u64) -> (GrayImage, GrayImage) {
        (self.render(cameras, Eye::Left, sigma, seed), self.render(cameras, Eye::Right, sigma, seed))
    }

    fn pixel(&self, camera: &Camera, planes_from_eye: &[Isometry3<f64>], u: f64, v: f64) -> f64 {
        let mut sum = 0.0;
        for j in 0..SUBSAMPLES {
            for i in 0..SUBSAMPLES {
                let offset = |k: u32| (f64::from(k) + 0.5) / f64::from(SUBSAMPLES) - 0.5;
                let ray = camera.unproject(Pixel::new(u + offset(i), v + offset(j)));
                sum += ray.map_or(0.0, |ray| self.along(planes_from_eye, &ray));
            }
        }
        sum / f64::from(SUBSAMPLES * SUBSAMPLES)
    }

    fn along(&self, planes_from_eye: &[Isometry3<f64>], ray: &Vector3<f64>) -> f64 {
        let mut nearest = (f64::INFINITY, self.background);
        for (plane, plane_from_eye) in self.planes.iter().zip(planes_from_eye) {
            let origin = plane_from_eye * Point3::origin();
            let direction = plane_from_eye.rotation * ray;
            let range = -origin.z / direction.z;
            if !(range > 0.0 && range < nearest.0) {
                continue;
            }
            let at = origin + direction * range;
            if let Some(brightness) = (plane.texture)(at.x, at.y) {
                nearest = (range, brightness);
            }
        }
        nearest.1
    }
}

/// The print of a chessboard with a white margin of one square; origin at the first inner corner.
pub fn chessboard_texture(board: &Chessboard) -> Texture {
    let (columns, rows) = board.squares();
    let square = board.square_m;
    Box::new(move |x, y| {
        let (i, j) = ((x / square).floor() + 1.0, (y / square).floor() + 1.0);
        let (columns, rows) = (f64::from(columns), f64::from(rows));
        if i < -1.0 || j < -1.0 || i > columns || j > rows {
            return None;
        }
        let on_board = i >= 0.0 && j >= 0.0 && i < columns && j < rows;
        Some(if on_board && (i + j) % 2.0 == 0.0 { INK } else { PAPER })
    })
}

/// Endless random blotches of about `grain_m`, such as granite.
pub fn granite_texture(grain_m: f64, seed: u64) -> Texture {
    let value = move |i: i64, j: i64| {
        let mut noise = Noise::new(
            seed ^ (i as u64).wrapping_mul(0x9e37_79b9) ^ (j as u64).wrapping_mul(0x85eb_ca6b_0000),
        );
        60.0 + 150.0 * noise.uniform()
    };
    Box::new(move |x, y| {
        let (x, y) = (x / grain_m, y / grain_m);
        let (i, j) = (x.floor(), y.floor());
        let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
        let (fx, fy) = (smooth(x - i), smooth(y - j));
        let (i, j) = (i as i64, j as i64);
        let top = value(i, j) * (1.0 - fx) + value(i + 1, j) * fx;
        let bottom = value(i, j + 1) * (1.0 - fx) + value(i + 1, j + 1) * fx;
        Some(top * (1.0 - fy) + bottom * fy)
    })
}

/// Small deterministic generator (SplitMix64), the same on every machine and version.
#[derive(Clone, Debug)]
pub struct Noise(u64);

impl Noise {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Uniform in 0..1.
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Standard normal.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// Uniform in a range.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }
}

/// Fisheye eyes with the published numbers of NICO's (f 150.7 px, baseline 69.9 mm); a stand-in
/// for tests, not a calibration.
pub fn nico_like_eyes() -> StereoCameras {
    let lens = |fx_px: f64, cx_px: f64, cy_px: f64, k: [f64; 4]| Camera {
        model: plumbline_model::CameraModel::Fisheye(plumbline_model::Fisheye {
            fx_px,
            fy_px: fx_px,
            cx_px,
            cy_px,
            skew_px: 0.0,
            k,
        }),
        width_px: 640,
        height_px: 480,
    };
    StereoCameras {
        left: lens(150.7, 321.3, 238.1, [-0.0084, -0.0080, 0.0017, -0.00026]),
        right: lens(150.95, 322.6, 235.3, [-0.0110, -0.0066, 0.0021, -0.00023]),
        right_from_left: plumbline_model::Pose::from_rotation_vector(
            Vector3::new(0.0035, -0.0089, 0.0057),
            Vector3::new(-0.06993, -0.00034, -0.00097),
        ),
    }
}
