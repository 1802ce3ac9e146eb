//! The epipolar curve of a pixel in the other eye's raw image.

use plumbline_model::{Eye, Pixel, Raw};

use crate::locate::epipolar::{EpipolarGeometry, EpipolarRay};

/// Points of a curve; between two of them it is straight enough to draw.
const POINTS: usize = 24;

/// Visits the pixels, in the other eye, of what could be along a ray of `from` between two ranges
/// (m), nearest first, evenly in disparity; those off the other image are left out.
pub(super) fn walk(
    geometry: &EpipolarGeometry,
    from: Eye,
    ray: &EpipolarRay,
    [nearest_m, farthest_m]: [f64; 2],
    mut visit: impl FnMut(Pixel<Raw>),
) {
    let other = if from == Eye::Left { Eye::Right } else { Eye::Left };
    let size_px = geometry.cameras.camera(other).size_px();
    let (most, least) = (1.0 / nearest_m, 1.0 / farthest_m);
    for i in 0..POINTS {
        let inverse_m = most + (least - most) * i as f64 / (POINTS - 1) as f64;
        let distance_from_baseline_m = ray.along_rad.cos() / inverse_m;
        let there = geometry.in_other_eye(from, ray, distance_from_baseline_m);
        if let Some(pixel) = geometry.pixel(other, &there).ok().filter(|pixel| pixel.is_inside(size_px)) {
            visit(pixel);
        }
    }
}
