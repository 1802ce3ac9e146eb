//! A small piece of a picture found again in another.

use nalgebra::{Matrix4, Vector2, Vector4};

use crate::pyramid::Pyramid;

/// Sizes kept: full, half, quarter, eighth.
pub(super) const LEVELS: usize = 4;
/// Pixels to each side of the middle of a patch, at every size.
const HALF_PX: i32 = 7;
const MOST_ITERATIONS: usize = 12;
const CONVERGED_PX: f64 = 5e-3;
/// What moves farther than this within one size has found something else, px.
const MOST_MOVE_PX: f64 = 6.0;
/// Patches less alike than this are not the same place.
const LEAST_CORRELATION: f64 = 0.9;

/// A patch that was found again.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Where, px of the full size.
    pub at_px: Vector2<f64>,
    /// Standard deviation of each coordinate by the patch's own brightness, px.
    pub sigma_px: f64,
}

/// Looks in `now` for what was at `at_px` of `before`, first near `near_px` and in the smallest of so many
/// sizes. `None`: it left the picture, is
/// not alike, or does not settle.
pub(super) fn find(
    before: &Pyramid,
    now: &Pyramid,
    at_px: Vector2<f64>,
    near_px: Vector2<f64>,
    levels: usize,
) -> Option<Found> {
    let mut shift_px = near_px - at_px;
    let mut sigma_px = f64::INFINITY;
    for level in (0..levels.min(LEVELS)).rev() {
        let shrink = f64::from(1u32 << level);
        let (at, start) = (Pyramid::reduced(level, at_px), shift_px / shrink);
        match align((before, now), level, at, start) {
            Some((shift, sigma)) => (shift_px, sigma_px) = (shift * shrink, sigma * shrink),
            // A small picture may hold too little of it; the next larger one decides.
            None if level > 0 => {}
            None => return None,
        }
    }
    Some(Found { at_px: at_px + shift_px, sigma_px })
}

/// Shift, and gain and offset of brightness, by least squares, in pixels of a size. In the full size it
/// has to be alike.
fn align(
    (before, now): (&Pyramid, &Pyramid),
    level: usize,
    at: Vector2<f64>,
    start: Vector2<f64>,
) -> Option<(Vector2<f64>, f64)> {
    let brightness = |of: &Pyramid, x: f64, y: f64| of.at(level, Vector2::new(x, y)).map(f64::from);
    let offsets = || (-HALF_PX..=HALF_PX).flat_map(|y| (-HALF_PX..=HALF_PX).map(move |x| (x, y)));
    let mut patch = Vec::with_capacity(225);
    for (x, y) in offsets() {
        let (x, y) = (f64::from(x), f64::from(y));
        patch.push((x, y, brightness(before, at.x + x, at.y + y)?));
    }
    let mut p = Vector4::new(start.x, start.y, 1.0, 0.0);
    for _ in 0..MOST_ITERATIONS {
        let (mut normal, mut right, mut square) = (Matrix4::zeros(), Vector4::zeros(), 0.0);
        for (x, y, value) in &patch {
            let (u, v) = (at.x + x + p[0], at.y + y + p[1]);
            let there = brightness(now, u, v)?;
            let along = brightness(now, u + 0.5, v)? - brightness(now, u - 0.5, v)?;
            let down = brightness(now, u, v + 0.5)? - brightness(now, u, v - 0.5)?;
            let jacobian = Vector4::new(p[2] * along, p[2] * down, there, 1.0);
            let residual = value - (p[2] * there + p[3]);
            square += residual * residual;
            normal += jacobian * jacobian.transpose();
            right += jacobian * residual;
        }
        let factor = normal.cholesky()?;
        let delta = factor.solve(&right);
        p += delta;
        if !((p[0] - start.x).hypot(p[1] - start.y) <= MOST_MOVE_PX) {
            return None;
        }
        if delta[0].hypot(delta[1]) < CONVERGED_PX {
            let count = patch.len() as f64;
            let mean = patch.iter().map(|(_, _, value)| value).sum::<f64>() / count;
            let spread = patch.iter().map(|(_, _, value)| (value - mean).powi(2)).sum::<f64>();
            // What is left against what there was: 1 − r².
            if level == 0 && square > (1.0 - LEAST_CORRELATION.powi(2)) * spread {
                return None;
            }
            let inverse = factor.inverse();
            let sigma = (0.5 * (inverse[(0, 0)] + inverse[(1, 1)]) * square / (count - 4.0)).sqrt();
            return Some((Vector2::new(p[0], p[1]), sigma));
        }
    }
    None
}
