//! Corner positions to a few hundredths of a pixel.
//!
//! Förstner and Gülch (1987): at the corner q every brightness gradient g at a place p nearby is
//! at right angles to p − q, because all edges run through the corner. Least squares gives q.
//! OpenCV's `cornerSubPix` uses the same condition in a square window of fixed size; here the
//! window is one square of the board in size and has its shape, so that large squares use all
//! their pixels and small or oblique ones never reach their neighbors' edges.

use image::GrayImage;
use nalgebra::{Matrix2, Vector2};
use plumbline_model::{Chessboard, Pixel, Raw};

/// Standard deviation of the weight, in squares.
const WEIGHT_SQUARES: f64 = 0.3;
/// No pixel further than this counts, in squares: the next corner is at 1.
const REACH_SQUARES: f64 = 0.7;
/// Reach beyond the outermost corners where the outer squares are narrower than the others (boards
/// are often printed or cut so).
const REACH_NARROW_SQUARES: f64 = 0.35;
/// The window never has a smaller standard deviation than this, pixels: the lens blurs.
const LEAST_WEIGHT_PX: f64 = 0.9;
const MOST_ITERATIONS: usize = 30;
const CONVERGED_PX: f64 = 1e-4;

/// Refines all corners; `None` when one of them cannot be refined or wanders off by more than a
/// third of a square, as on something that is no chessboard.
pub(super) fn refine(
    gray: &GrayImage,
    board: &Chessboard,
    corners: &[Vector2<f64>],
) -> Option<Vec<Pixel<Raw>>> {
    let columns = board.inner_columns as usize;
    let outward = outward_reach(gray, corners, columns)?;
    (0..corners.len())
        .map(|k| {
            let px_from_squares = local_scale(corners, columns, k)?;
            let reach = |has_neighbor: bool, side: Side| {
                if has_neighbor { REACH_SQUARES } else { outward[side as usize] }
            };
            let reach = Reach {
                low: Vector2::new(reach(k % columns > 0, Side::Left), reach(k >= columns, Side::Top)),
                high: Vector2::new(
                    reach((k + 1) % columns != 0, Side::Right),
                    reach(k + columns < corners.len(), Side::Bottom),
                ),
            };
            let refined = refine_one(gray, corners[k], &px_from_squares, &reach)?;
            let moved = px_from_squares.try_inverse()? * (refined - corners[k]);
            (moved.norm() < 0.35).then(|| refined.into())
        })
        .collect()
}

/// How far the window goes from the corner towards smaller and larger board coordinates, squares.
struct Reach {
    low: Vector2<f64>,
    high: Vector2<f64>,
}

impl Reach {
    /// 0 at the corner, 1 at the rim of the window; larger outside.
    fn fraction(&self, squares: &Vector2<f64>) -> f64 {
        let one = |v: f64, low: f64, high: f64| if v < 0.0 { -v / low } else { v / high };
        one(squares.x, self.low.x, self.high.x).max(one(squares.y, self.low.y, self.high.y))
    }
}

/// Sides of the board, in its own coordinates.
#[derive(Clone, Copy)]
enum Side {
    Left,
    Right,
    Top,
    Bottom,
}

/// How far outward the window may go on each side: the full reach where the outer squares are wide
/// enough, which shows in the contrast across the edges that run outward.
fn outward_reach(gray: &GrayImage, corners: &[Vector2<f64>], columns: usize) -> Option<[f64; 4]> {
    /// Contrast lost between these two distances from the corner means that the square has ended.
    const NEAR_SQUARES: f64 = 0.3;
    const FAR_SQUARES: f64 = REACH_SQUARES + 0.1;
    const KEPT: f64 = 0.6;
    let rows = corners.len() / columns;
    let mut reach = [REACH_NARROW_SQUARES; 4];
    for side in [Side::Left, Side::Right, Side::Top, Side::Bottom] {
        let (line, outward): (Vec<usize>, Vector2<f64>) = match side {
            Side::Left => ((0..rows).map(|j| j * columns).collect(), -Vector2::x()),
            Side::Right => ((0..rows).map(|j| j * columns + columns - 1).collect(), Vector2::x()),
            Side::Top => ((0..columns).collect(), -Vector2::y()),
            Side::Bottom => (((rows - 1) * columns..rows * columns).collect(), Vector2::y()),
        };
        let aside = Vector2::new(outward.y, outward.x) * 0.25;
        let (mut near, mut far) = (0.0, 0.0);
        for k in line {
            let px_from_squares = local_scale(corners, columns, k)?;
            let at = |squares: Vector2<f64>| brightness(gray, corners[k] + px_from_squares * squares);
            let contrast =
                |distance: f64| Some(at(outward * distance + aside)? - at(outward * distance - aside)?);
            if let (Some(n), Some(f)) = (contrast(NEAR_SQUARES), contrast(FAR_SQUARES)) {
                near += n.abs();
                // Same edge: the same side must be the bright one.
                far += f * n.signum();
            }
        }
        if far > KEPT * near {
            reach[side as usize] = REACH_SQUARES;
        }
    }
    Some(reach)
}

/// Bilinear brightness; `None` outside the image.
fn brightness(gray: &GrayImage, at: Vector2<f64>) -> Option<f64> {
    let inside = at.x >= 0.0
        && at.y >= 0.0
        && at.x < f64::from(gray.width()) - 1.0
        && at.y < f64::from(gray.height()) - 1.0;
    if !inside {
        return None;
    }
    let (x, y) = (at.x as u32, at.y as u32);
    let (fx, fy) = (at.x - f64::from(x), at.y - f64::from(y));
    let value = |dx: u32, dy: u32| f64::from(gray.get_pixel(x + dx, y + dy)[0]);
    let top = value(0, 0) * (1.0 - fx) + value(1, 0) * fx;
    let bottom = value(0, 1) * (1.0 - fx) + value(1, 1) * fx;
    Some(top * (1.0 - fy) + bottom * fy)
}

/// Columns: how many pixels one square is along the board's x and y, around corner `k`.
fn local_scale(corners: &[Vector2<f64>], columns: usize, k: usize) -> Option<Matrix2<f64>> {
    let along = |step: usize, has_before: bool, has_after: bool| match (has_before, has_after) {
        (true, true) => Some((corners[k + step] - corners[k - step]) * 0.5),
        (true, false) => Some(corners[k] - corners[k - step]),
        (false, true) => Some(corners[k + step] - corners[k]),
        (false, false) => None,
    };
    let x = along(1, !k.is_multiple_of(columns), !(k + 1).is_multiple_of(columns))?;
    let y = along(columns, k >= columns, k + columns < corners.len())?;
    Some(Matrix2::from_columns(&[x, y]))
}

fn refine_one(
    gray: &GrayImage,
    start: Vector2<f64>,
    px_from_squares: &Matrix2<f64>,
    reach: &Reach,
) -> Option<Vector2<f64>> {
    // Weight exp(−½ dᵀ M d) with M from the square's shape, rounded up by the lens blur.
    let shape = px_from_squares * px_from_squares.transpose() * WEIGHT_SQUARES.powi(2)
        + Matrix2::identity() * LEAST_WEIGHT_PX.powi(2);
    let information = shape.try_inverse()?;
    let squares_from_px = px_from_squares.try_inverse()?;
    let half = Vector2::new(
        px_from_squares.row(0).abs().sum() * REACH_SQUARES,
        px_from_squares.row(1).abs().sum() * REACH_SQUARES,
    );
    let mut at = start;
    for _ in 0..MOST_ITERATIONS {
        let next = forstner_step(gray, at, half, &information, &squares_from_px, reach)?;
        let moved = (next - at).norm();
        at = next;
        if moved < CONVERGED_PX {
            return Some(at);
        }
    }
    // Still moving by more than the tolerance, but bounded by the caller's check.
    Some(at)
}

/// Where the weighted gradients around `at` meet.
fn forstner_step(
    gray: &GrayImage,
    at: Vector2<f64>,
    half: Vector2<f64>,
    information: &Matrix2<f64>,
    squares_from_px: &Matrix2<f64>,
    reach: &Reach,
) -> Option<Vector2<f64>> {
    let (width, height) = (gray.width() as usize, gray.height() as usize);
    let low = |v: f64| v.ceil().max(1.0) as usize;
    let high = |v: f64, size: usize| (v.floor().max(0.0) as usize).min(size.saturating_sub(2));
    let pixels = gray.as_raw();
    let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
    for y in low(at.y - half.y)..=high(at.y + half.y, height) {
        for x in low(at.x - half.x)..=high(at.x + half.x, width) {
            let d = Vector2::new(x as f64 - at.x, y as f64 - at.y);
            let squares = squares_from_px * d;
            let fraction = reach.fraction(&squares);
            if fraction > 1.0 {
                continue;
            }
            let value = |dx: usize, dy: usize| f64::from(pixels[(y + dy - 1) * width + x + dx - 1]);
            let gradient = Vector2::new(value(2, 1) - value(0, 1), value(1, 2) - value(1, 0));
            // Fades to zero at the rim, so that no pixel enters or leaves at once.
            let rim = 1.0 - fraction.powi(4);
            let weight = (-0.5 * d.dot(&(information * d))).exp() * rim;
            let outer = gradient * gradient.transpose() * weight;
            normal += outer;
            right += outer * d;
        }
    }
    // Gradients that all point one way leave the corner free to slide along its edge.
    let (trace, determinant) = (normal.trace(), normal.determinant());
    if !(determinant > 1e-3 * trace * trace) {
        return None;
    }
    Some(at + normal.try_inverse()? * right)
}
