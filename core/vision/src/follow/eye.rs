//! The picture of an eye that is remembered, and its corners found again.

use image::GrayImage;
use nalgebra::{Rotation3, Vector2, Vector3};
use opencv::core::{Mat, Point2f, Vector};
use plumbline_model::{Camera, Pixel, Raw};

use super::patch::{LEVELS, find};
use crate::health::HealthError;
use crate::mat;
use crate::pyramid::Pyramid;

/// Places that are remembered, and least distance between two, px.
const PLACES: i32 = 120;
const APART_PX: f64 = 16.0;
/// Against the strongest corner of the picture.
const LEAST_CORNER: f64 = 0.01;
/// Looking back must come within this of the start, px.
const CONFIRMED_PX: f64 = 0.3;
/// Sizes that are enough for places that are about where they were.
const NEAR_LEVELS: usize = 2;
/// Fewer places than these say nothing of an eye.
pub const LEAST_FOLLOWED: usize = 40;

/// A remembered place that was found again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed {
    /// Which of the remembered places.
    pub index: usize,
    /// Where it was.
    pub before: Pixel<Raw>,
    /// Where it is.
    pub now: Pixel<Raw>,
    /// Standard deviation of each coordinate, px.
    pub sigma_px: f64,
}

/// What an eye saw.
#[derive(Clone, Debug)]
pub struct RememberedEye {
    camera: Camera,
    picture: Pyramid,
    places: Vec<Pixel<Raw>>,
}

impl RememberedEye {
    /// Remembers a picture of an eye with this lens.
    ///
    /// # Errors
    /// When it is of another size, or there is too little to see in it.
    pub fn new(camera: &Camera, image: &GrayImage) -> Result<Self, HealthError> {
        check_size(camera, image)?;
        let mut found: Vector<Point2f> = Vector::new();
        opencv::imgproc::good_features_to_track(
            &mat::gray(image)?,
            &mut found,
            PLACES,
            LEAST_CORNER,
            APART_PX,
            &Mat::default(),
            5,
            false,
            0.04,
        )?;
        let places: Vec<Pixel<Raw>> =
            found.iter().map(|at| Pixel::new(f64::from(at.x), f64::from(at.y))).collect();
        if places.len() < LEAST_FOLLOWED {
            return Err(HealthError::TooFew { found: places.len(), needed: LEAST_FOLLOWED, pairs: 1 });
        }
        Ok(Self { camera: *camera, picture: Pyramid::new(image, LEVELS), places })
    }

    /// Its lens.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The remembered places.
    pub fn places(&self) -> &[Pixel<Raw>] {
        &self.places
    }

    /// Finds the places again in another picture of the eye, which has turned by about `near_rad` since.
    ///
    /// # Errors
    /// When the picture is of another size.
    pub fn follow(&self, image: &GrayImage, near_rad: &Vector3<f64>) -> Result<Vec<Followed>, HealthError> {
        check_size(&self.camera, image)?;
        let now = Pyramid::new(image, LEVELS);
        let turn = Rotation3::new(*near_rad);
        let one = |levels: usize, (index, before): (usize, &Pixel<Raw>)| {
            let at_px = before.vector();
            let guess = self.camera.project(&(turn * self.camera.unproject(*before).ok()?)).ok()?;
            let there = find(&self.picture, &now, at_px, guess.vector(), levels)?;
            let back = find(&now, &self.picture, there.at_px, at_px, 1)?;
            let confirmed = (back.at_px - at_px).norm() < CONFIRMED_PX;
            confirmed.then(|| Followed {
                index,
                before: *before,
                now: Pixel::from(Vector2::new(there.at_px.x, there.at_px.y)),
                sigma_px: there.sigma_px,
            })
        };
        let all = |levels: usize| -> Vec<Followed> {
            self.places.iter().enumerate().filter_map(|place| one(levels, place)).collect()
        };
        // Usually everything is about where it was; what jumped is looked for in smaller pictures first.
        let near = all(NEAR_LEVELS);
        let enough = near.len() >= LEAST_FOLLOWED && 2 * near.len() >= self.places.len();
        Ok(if enough { near } else { all(LEVELS) })
    }
}

fn check_size(camera: &Camera, image: &GrayImage) -> Result<(), HealthError> {
    let expected_px = camera.size_px();
    if image.dimensions() == expected_px { Ok(()) } else { Err(HealthError::Size { expected_px }) }
}
