//! A pair of images at several sizes, sampled along epipolar rays.

use image::GrayImage;
use nalgebra::Vector2;
use plumbline_model::{Eye, Pixel, Raw};

use super::epipolar::{EpipolarGeometry, EpipolarRay};
use crate::pyramid::Pyramid;

/// Sizes kept: full, half, quarter.
pub(super) const LEVELS: usize = 3;

/// A pair of gray images ready for matching.
pub(crate) struct Scene {
    eyes: [Pyramid; 2],
}

impl Scene {
    pub fn new(left: &GrayImage, right: &GrayImage) -> Self {
        let (left, right) = rayon::join(|| Pyramid::new(left, LEVELS), || Pyramid::new(right, LEVELS));
        Self { eyes: [left, right] }
    }

    /// Size of the full image.
    pub fn size_px(&self, eye: Eye) -> (u32, u32) {
        self.eyes[eye.index()].size_px()
    }

    /// Brightness at a raw pixel, from the image reduced by 2^`level`; `None` outside.
    fn at(&self, eye: Eye, level: usize, pixel: Pixel<Raw>) -> Option<f32> {
        let reduced_px = Pyramid::reduced(level, Vector2::new(pixel.u_px, pixel.v_px));
        self.eyes[eye.index()].at(level, reduced_px)
    }

    /// Brightness along a ray; `None` where the eye does not see.
    pub fn along(
        &self,
        geometry: &EpipolarGeometry,
        eye: Eye,
        level: usize,
        ray: &EpipolarRay,
    ) -> Option<f32> {
        self.at(eye, level, geometry.pixel(eye, ray).ok()?)
    }
}
