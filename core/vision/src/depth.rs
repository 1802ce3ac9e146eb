//! From disparities to places in space.

use plumbline_model::aim::AimedPair;
use plumbline_model::frame::LeftCamera;
use plumbline_model::{Pixel, Point, Rectified};
use rayon::prelude::*;

use crate::disparity::{DisparityMap, Origin};

/// Where a pixel has no disparity.
const UNKNOWN: f32 = f32::INFINITY;

/// A place in space for every pixel of the left view that has a disparity.
#[derive(Clone, Debug, PartialEq)]
pub struct PointMap {
    width_px: u32,
    height_px: u32,
    /// x, y, z in the left camera's frame, meters.
    points_m: Vec<[f32; 3]>,
    /// Along the aimed axis, meters.
    depths_m: Vec<f32>,
}

/// A map that does not belong to the pair.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the disparity map is {map_width_px}x{map_height_px} px but the aimed views are {width_px}x{height_px} px: compute it from views of this pair"
)]
pub struct SizeMismatch {
    /// Width of the map.
    pub map_width_px: u32,
    /// Height of the map.
    pub map_height_px: u32,
    /// Width of the views.
    pub width_px: u32,
    /// Height of the views.
    pub height_px: u32,
}

impl PointMap {
    /// Turns every disparity, measured or filled in, into a point.
    ///
    /// # Errors
    /// [`SizeMismatch`] when the map was not made from views of this pair.
    pub fn new(map: &DisparityMap, pair: &AimedPair) -> Result<Self, SizeMismatch> {
        check(map, pair)?;
        let width = map.width_px() as usize;
        let mut points_m = vec![[UNKNOWN; 3]; map.as_slice().len()];
        let mut depths_m = vec![UNKNOWN; map.as_slice().len()];
        let depth_of_one_px = (pair.f_px * pair.baseline_m) as f32;
        // The ray of a pixel, turned into the real camera, grows evenly along rows and columns.
        let left_from_rectified = pair.left_rectified_from_left.rotation().transpose();
        let across = left_from_rectified.column(0) / pair.f_px;
        let down = left_from_rectified.column(1) / pair.f_px;
        let first = left_from_rectified.column(2) - across * pair.cx_px - down * pair.cy_px;
        points_m
            .par_chunks_exact_mut(width)
            .zip(depths_m.par_chunks_exact_mut(width))
            .zip(map.as_slice().par_chunks_exact(width))
            .enumerate()
            .for_each(|(y, ((points, depths), disparities))| {
                let start = (first + down * y as f64).cast::<f32>();
                let step = across.cast::<f32>();
                for (x, ((point, depth), d)) in points.iter_mut().zip(depths).zip(disparities).enumerate() {
                    if *d > 0.0 && *d < UNKNOWN {
                        *depth = depth_of_one_px / d;
                        *point = ((start + step * x as f32) * *depth).into();
                    }
                }
            });
        Ok(Self { width_px: map.width_px(), height_px: map.height_px(), points_m, depths_m })
    }

    /// Place of what the left view shows at a pixel; `None` where that is not known or outside.
    pub fn point(&self, x_px: u32, y_px: u32) -> Option<Point<LeftCamera>> {
        let [x, y, z] = self.points_m[self.index(x_px, y_px)?];
        (x < UNKNOWN).then(|| Point::new(f64::from(x), f64::from(y), f64::from(z)))
    }

    /// Depth along the aimed axis, meters.
    pub fn depth_m(&self, x_px: u32, y_px: u32) -> Option<f32> {
        self.index(x_px, y_px).map(|i| self.depths_m[i]).filter(|depth| *depth < UNKNOWN)
    }

    fn index(&self, x_px: u32, y_px: u32) -> Option<usize> {
        (x_px < self.width_px && y_px < self.height_px)
            .then(|| y_px as usize * self.width_px as usize + x_px as usize)
    }
}

fn check(map: &DisparityMap, pair: &AimedPair) -> Result<(), SizeMismatch> {
    if (map.width_px(), map.height_px()) == pair.size_px() {
        return Ok(());
    }
    Err(SizeMismatch {
        map_width_px: map.width_px(),
        map_height_px: map.height_px(),
        width_px: pair.width_px,
        height_px: pair.height_px,
    })
}

/// What there is at one pixel of the left view.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    /// The place.
    pub point: Point<LeftCamera>,
    /// Distance from the left eye, meters.
    pub range_m: f64,
    /// Standard deviation of the range, meters, from the scatter of the disparities around the
    /// pixel. What the calibration itself is wrong by comes on top.
    pub sigma_m: f64,
    /// The disparity, pixels.
    pub disparity_px: f64,
    /// Its standard deviation, pixels.
    pub disparity_sigma_px: f64,
}

/// Why a pixel has no place.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProbeFailure {
    /// Not a pixel of the view.
    #[error("there is no pixel ({u_px:.0}, {v_px:.0}) in the view")]
    Outside {
        /// Column asked for.
        u_px: f64,
        /// Row asked for.
        v_px: f64,
    },
    /// The lens does not see it, or nothing around it could be matched either.
    #[error("no depth here: one of the eyes does not see this place")]
    Unseen,
    /// The views disagree; what the map shows here is a guess from the surroundings.
    #[error(
        "no depth here: the right eye does not show the same thing (hidden behind an edge, or too bare, shiny or repetitive to be matched)"
    )]
    Unmatched,
    /// So far away that the disparity vanishes.
    #[error("no depth here: too far away to be told from infinity")]
    Far,
    /// The map is of another pair.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
}

/// Half side of the neighborhood whose scatter tells the uncertainty, pixels.
const HALF_WINDOW_PX: u32 = 3;
/// Neighbors that differ by more belong to another surface, pixels.
const SAME_SURFACE_PX: f64 = 1.0;
/// Part of the error that neighbors share, because they are matched with overlapping windows
/// and seen through the same part of the lens; found on the table in real images, whose
/// disparities should lie on a plane. Pixels.
const SHARED_SIGMA_PX: f64 = 0.15;

/// The place that the left view shows at `pixel` (the nearest whole pixel is taken).
pub fn probe(map: &DisparityMap, pair: &AimedPair, pixel: Pixel<Rectified>) -> Result<Probe, ProbeFailure> {
    check(map, pair)?;
    if !pixel.is_inside(pair.size_px()) {
        return Err(ProbeFailure::Outside { u_px: pixel.u_px, v_px: pixel.v_px });
    }
    let (x_px, y_px) = (pixel.u_px.round() as u32, pixel.v_px.round() as u32);
    let disparity_px = match (map.get(x_px, y_px), map.origin(x_px, y_px)) {
        (Some(disparity), Some(Origin::Measured)) => f64::from(disparity),
        (Some(_), _) => return Err(ProbeFailure::Unmatched),
        (None, _) => return Err(ProbeFailure::Unseen),
    };
    let point = pair.point(pixel, disparity_px).ok_or(ProbeFailure::Far)?;
    let scatter_px = scatter(map, x_px, y_px, disparity_px);
    let disparity_sigma_px = SHARED_SIGMA_PX.hypot(scatter_px);
    let range_m = point.range_m();
    // Range is inversely proportional to disparity.
    let sigma_m = range_m * disparity_sigma_px / disparity_px;
    Ok(Probe { point, range_m, sigma_m, disparity_px, disparity_sigma_px })
}

/// Standard deviation of the measured disparities around a pixel from the plane through them.
fn scatter(map: &DisparityMap, x_px: u32, y_px: u32, own_px: f64) -> f64 {
    let mut normal = nalgebra::Matrix3::<f64>::zeros();
    let mut right = nalgebra::Vector3::<f64>::zeros();
    let (mut squares, mut count) = (0.0, 0u32);
    for y in y_px.saturating_sub(HALF_WINDOW_PX)..=y_px + HALF_WINDOW_PX {
        for x in x_px.saturating_sub(HALF_WINDOW_PX)..=x_px + HALF_WINDOW_PX {
            let Some(d) = map.measured(x, y).map(|d| f64::from(d) - own_px) else { continue };
            if d.abs() <= SAME_SURFACE_PX {
                let row = nalgebra::Vector3::new(
                    1.0,
                    f64::from(x) - f64::from(x_px),
                    f64::from(y) - f64::from(y_px),
                );
                normal += row * row.transpose();
                right += row * d;
                squares += d * d;
                count += 1;
            }
        }
    }
    let plane = normal.cholesky().filter(|_| count > 6).map(|cholesky| cholesky.solve(&right));
    // Too few neighbors for a plane: nothing supports this pixel, so it may be wrong by as
    // much as its neighbors were allowed to differ.
    plane.map_or(SAME_SURFACE_PX, |plane| {
        ((squares - plane.dot(&right)).max(0.0) / f64::from(count - 3)).sqrt()
    })
}
