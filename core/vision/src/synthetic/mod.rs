//! Renders textured planes and balls through any lens: images with a known truth, for tests and for
//! trying the program without a camera.
//!
//! Exact geometry, box-filtered pixels, Gaussian noise from a seed. No lens blur, no gloss, no cast shadows.

pub mod sample;

use image::{GrayImage, RgbImage};
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
    /// Factors of red, green and blue.
    pub tint: [f64; 3],
}

impl Plane {
    /// A gray one.
    pub fn new(left_from_plane: Isometry3<f64>, texture: Texture) -> Self {
        Self { left_from_plane, texture, tint: [1.0; 3] }
    }

    /// The same in color.
    #[must_use]
    pub fn tinted(mut self, tint: [f64; 3]) -> Self {
        self.tint = tint;
        self
    }
}

/// A matt ball under a lamp overhead.
pub struct Ball {
    /// Center in the left camera, meters.
    pub center_in_left: Point3<f64>,
    /// Radius, meters.
    pub radius_m: f64,
    /// Direction towards the lamp, in the left camera.
    pub to_lamp: Vector3<f64>,
    /// Factors of red, green and blue.
    pub tint: [f64; 3],
}

/// What can be rendered. The nearest thing hides those behind it.
#[derive(Default)]
pub struct Scene {
    /// In any order.
    pub planes: Vec<Plane>,
    /// In any order.
    pub balls: Vec<Ball>,
    /// Brightness where there is nothing.
    pub background: f64,
}

/// Places within a pixel that are averaged: one in each eighth of the rows and of the columns, so
/// that an edge along either crosses them one by one.
const SUBSAMPLES: [[f64; 2]; 8] = [
    [-0.4375, -0.0625],
    [-0.3125, 0.3125],
    [-0.1875, -0.3125],
    [-0.0625, 0.1875],
    [0.0625, -0.4375],
    [0.1875, 0.4375],
    [0.3125, -0.1875],
    [0.4375, 0.0625],
];
/// Bright and dark print, gray levels: paper and ink under lamps are neither 255 nor 0.
const PAPER: f64 = 215.0;
const INK: f64 = 35.0;
/// Nothing reaches the sensor from further off the axis than this, rad.
const LENS_EDGE_RAD: f64 = 1.62;

/// One eye's view of a scene.
struct View<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    planes_from_eye: Vec<Isometry3<f64>>,
    balls_in_eye: Vec<Point3<f64>>,
    lamps_in_eye: Vec<Vector3<f64>>,
}

impl Scene {
    /// Gray image of one eye with Gaussian noise of `sigma` gray levels.
    pub fn render(&self, cameras: &StereoCameras, eye: Eye, sigma: f64, seed: u64) -> GrayImage {
        let mut image = GrayImage::new(cameras.camera(eye).width_px, cameras.camera(eye).height_px);
        self.fill(cameras, eye, seed, &mut image, 1, |rgb, noise, pixel| {
            let gray = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
            pixel[0] = (gray + sigma * noise.normal()).round().clamp(0.0, 255.0) as u8;
        });
        image
    }

    /// Color image of one eye with Gaussian noise of `sigma` levels per channel.
    pub fn render_rgb(&self, cameras: &StereoCameras, eye: Eye, sigma: f64, seed: u64) -> RgbImage {
        let mut image = RgbImage::new(cameras.camera(eye).width_px, cameras.camera(eye).height_px);
        self.fill(cameras, eye, seed, &mut image, 3, |rgb, noise, pixel| {
            for (value, brightness) in pixel.iter_mut().zip(rgb) {
                *value = (brightness + sigma * noise.normal()).round().clamp(0.0, 255.0) as u8;
            }
        });
        image
    }

    /// Both eyes in gray.
    pub fn render_pair(&self, cameras: &StereoCameras, sigma: f64, seed: u64) -> (GrayImage, GrayImage) {
        (self.render(cameras, Eye::Left, sigma, seed), self.render(cameras, Eye::Right, sigma, seed))
    }

    /// Computes every pixel, row by row, each row with its own noise.
    fn fill(
        &self,
        cameras: &StereoCameras,
        eye: Eye,
        seed: u64,
        image: &mut [u8],
        channels: usize,
        write: impl Fn([f64; 3], &mut Noise, &mut [u8]) + Sync,
    ) {
        let eye_from_left = match eye {
            Eye::Left => Isometry3::identity(),
            Eye::Right => cameras.right_from_left.isometry,
        };
        let camera = cameras.camera(eye);
        let view = View {
            scene: self,
            camera,
            planes_from_eye: self
                .planes
                .iter()
                .map(|p| (eye_from_left * p.left_from_plane).inverse())
                .collect(),
            balls_in_eye: self.balls.iter().map(|b| eye_from_left * b.center_in_left).collect(),
            lamps_in_eye: self.balls.iter().map(|b| eye_from_left.rotation * b.to_lamp.normalize()).collect(),
        };
        let row_bytes = camera.width_px as usize * channels;
        image.par_chunks_mut(row_bytes).enumerate().for_each(|(v, row)| {
            let mut noise = Noise::new(seed ^ ((v as u64 + 1) << 20) ^ ((eye.index() as u64) << 60));
            for (u, pixel) in row.chunks_mut(channels).enumerate() {
                write(view.pixel(u as f64, v as f64), &mut noise, pixel);
            }
        });
    }
}

impl View<'_> {
    fn pixel(&self, u: f64, v: f64) -> [f64; 3] {
        let mut sum = Vector3::zeros();
        for [du, dv] in SUBSAMPLES {
            if let Ok(ray) = self.camera.unproject(Pixel::new(u + du, v + dv))
                && ray.z > LENS_EDGE_RAD.cos()
            {
                sum += self.along(&ray);
            }
        }
        (sum / SUBSAMPLES.len() as f64).into()
    }

    /// Color of whatever a ray meets first.
    fn along(&self, ray: &Vector3<f64>) -> Vector3<f64> {
        let mut nearest = (f64::INFINITY, Vector3::repeat(self.scene.background));
        for (plane, plane_from_eye) in self.scene.planes.iter().zip(&self.planes_from_eye) {
            let origin = plane_from_eye * Point3::origin();
            let direction = plane_from_eye.rotation * ray;
            let range = -origin.z / direction.z;
            if range > 0.0 && range < nearest.0 {
                let at = origin + direction * range;
                if let Some(brightness) = (plane.texture)(at.x, at.y) {
                    nearest = (range, Vector3::from(plane.tint) * brightness);
                }
            }
        }
        for ((ball, center), to_lamp) in
            self.scene.balls.iter().zip(&self.balls_in_eye).zip(&self.lamps_in_eye)
        {
            let along = ray.dot(&center.coords);
            let inside = ball.radius_m.powi(2) - (center.coords - ray * along).norm_squared();
            let range = along - inside.max(0.0).sqrt();
            if inside > 0.0 && range > 0.0 && range < nearest.0 {
                let normal = (ray * range - center.coords) / ball.radius_m;
                let brightness = 70.0 + 170.0 * normal.dot(to_lamp).max(0.0);
                nearest = (range, Vector3::from(ball.tint) * brightness);
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
