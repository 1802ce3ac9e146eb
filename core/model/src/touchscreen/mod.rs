//! The one transform between the touchscreen's image and the robot, and where the screen lies.
//!
//! A touch pixel has its origin at the center of the top-left pixel; [`Touchscreen::origin`] is
//! the outer corner of that pixel, half a pixel up and left of it.

mod error;
mod file;
mod place;
#[cfg(test)]
mod tests;

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::frame::{Direction, Point, Robot};
use crate::pixel::Pixel;
use crate::session::{Screen, Touchscreen};

pub use error::PlacementError;
pub use place::{ScreenPlacement, USUAL_NOISE_M, place_screen};

impl Touchscreen {
    /// Distance of neighboring pixels along u and v, m.
    pub fn pitch_m(&self) -> [f64; 2] {
        [self.width_m / f64::from(self.width_px), self.height_m / f64::from(self.height_px)]
    }

    /// Where a pixel lies on the glass; pixels beside the image lie on its plane, too.
    pub fn point_at(&self, pixel: Pixel<Screen>) -> Point<Robot> {
        let [u_m, v_m] = self.pitch_m();
        let along_u = self.u_axis.vector() * ((pixel.u_px + 0.5) * u_m);
        let along_v = self.v_axis.vector() * ((pixel.v_px + 0.5) * v_m);
        Point::from(self.origin.coords + along_u + along_v)
    }

    /// The pixel at the foot of the perpendicular from a point to the glass. It lies beside the
    /// image when the point does: ask [`Self::contains`].
    pub fn pixel_at(&self, point: Point<Robot>) -> Pixel<Screen> {
        let (u, v) = (self.u_axis.vector(), self.v_axis.vector());
        let offset = point.coords - self.origin.coords;
        // The axes of a session may miss the right angle a little: projecting on each would not
        // undo `point_at` then.
        let skew = u.dot(&v);
        let inverse = Matrix2::new(1.0, -skew, -skew, 1.0) / (1.0 - skew * skew);
        let along_m = inverse * Vector2::new(offset.dot(&u), offset.dot(&v));
        let [u_m, v_m] = self.pitch_m();
        Pixel::new(along_m.x / u_m - 0.5, along_m.y / v_m - 0.5)
    }

    /// Direction out of the glass, towards whoever looks at it.
    pub fn normal(&self) -> Direction<Robot> {
        let across = self.v_axis.vector().cross(&self.u_axis.vector());
        Direction::new(across).expect("readers refuse axes that are not at right angles")
    }

    /// Height of a point above the glass, m; negative below it.
    pub fn height_above_m(&self, point: Point<Robot>) -> f64 {
        (point.coords - self.origin.coords).dot(&self.normal().vector())
    }

    /// Outer corners of the image: top left, top right, bottom right, bottom left as the image
    /// shows them.
    pub fn corners(&self) -> [Point<Robot>; 4] {
        let (right, bottom) = (f64::from(self.width_px) - 0.5, f64::from(self.height_px) - 0.5);
        [(-0.5, -0.5), (right, -0.5), (right, bottom), (-0.5, bottom)]
            .map(|(u_px, v_px)| self.point_at(Pixel::new(u_px, v_px)))
    }

    /// Middle of the image.
    pub fn middle(&self) -> Pixel<Screen> {
        Pixel::new(0.5 * (f64::from(self.width_px) - 1.0), 0.5 * (f64::from(self.height_px) - 1.0))
    }

    /// Whether a pixel lies on the image, outer halves of its border pixels included. Not so for
    /// a pixel that is not a number.
    pub fn contains(&self, pixel: Pixel<Screen>) -> bool {
        let on = |at_px: f64, count: u32| at_px >= -0.5 && at_px <= f64::from(count) - 0.5;
        on(pixel.u_px, self.width_px) && on(pixel.v_px, self.height_px)
    }

    /// The screen lifted along its normal, as on a block of that height (m).
    pub fn raised(&self, by_m: f64) -> Self {
        self.moved(&nalgebra::Isometry3::from_parts(
            (self.normal().vector() * by_m).into(),
            Default::default(),
        ))
    }

    /// The screen after a rigid motion of the robot frame.
    pub fn moved(&self, motion: &nalgebra::Isometry3<f64>) -> Self {
        let turn = |axis: &Direction<Robot>| {
            let turned: Vector3<f64> = motion.rotation * axis.vector();
            Direction::new(turned).unwrap_or(*axis)
        };
        Self {
            origin: Point::from(motion * self.origin.coords),
            u_axis: turn(&self.u_axis),
            v_axis: turn(&self.v_axis),
            ..self.clone()
        }
    }

    /// Whether it has a size, and axes that are numbers and nearly at right angles: what every
    /// reader checks. For screens that a program put together.
    pub fn is_usable(&self) -> bool {
        let sized = self.width_px > 0 && self.height_px > 0 && self.width_m > 0.0 && self.height_m > 0.0;
        let finite = self.width_m.is_finite() && self.height_m.is_finite();
        let placed = self.origin.coords.iter().all(|c| c.is_finite());
        sized && finite && placed && self.u_axis.vector().dot(&self.v_axis.vector()).abs() <= 0.02
    }
}
