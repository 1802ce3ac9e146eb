//! Tables of grasp height over (x, y) and of yaw over (x, y, z), interpolated by radial basis
//! functions.
//!
//! The points of a table were measured by hand or taken from the arm's pose; between them the
//! tables answer as the published software does, with Hardy's multiquadric (1971, J. Geophys.
//! Res. 76, 1905–1915) and smoothing:
//!
//! ```text
//! s(x) = Σ_j w_j φ(‖x − x_j‖)     φ(r) = √(1 + (r/ε)²)     (Φ − λ I) w = values
//! ```
//!
//! λ is the smoothing: 0.01 for heights, 0.1 for yaw. ε is the edge of a cell when the bounding
//! box of the points is cut into as many cells as there are points, directions in which it is flat
//! left out. Formula, default of ε and sign of λ are those of `scipy.interpolate.Rbf(function =
//! "multiquadric", smooth = λ)`, whose answers the tests hold. Without smoothing the interpolation
//! goes through the points.
//!
//! There is no constant among the functions: the interpolation is linear in the values, so adding
//! c to all of them adds c times the interpolation of ones, which is nearly 1 between the points
//! and is not 1 far from them. Neither is the interpolation to be trusted there: `inside` says
//! whether the place lies within the border of the points (see [`crate::border`]), and for yaw
//! between their lowest and highest z.
//!
//! # Leave one out
//!
//! The error of a point is what was measured there less what all *other* points predict, with the
//! same ε. It needs no further solving: with A = Φ − λ I it is w_k / (A⁻¹)_kk (Rippa 1999, Adv.
//! Comput. Math. 11, 193–210, here with smoothing: leaving a point out deletes its row and column
//! of A, and the Schur complement of what remains is 1 / (A⁻¹)_kk). The standard deviation of an
//! answer is the root mean square of these errors, weighted by a Gaussian of distance and blended
//! with that of all points; from fewer than eight points none is stated.
//!
//! # Angles
//!
//! Yaw is an angle, and the mean of 179° and −179° is not 0. Before interpolation the circle is
//! cut in the middle of its largest arc without any yaw, and all angles are counted from there, so
//! that neighbors across ±π are neighbors; the answer is turned back to (−π, π]. The published
//! angles, −0.76 to 1.82, stay as they are. A table whose angles leave no gap of 60° is refused:
//! no cut would be right.

mod error;
mod file;
mod height;
mod multiquadric;
mod table;
#[cfg(test)]
mod tests;
mod yaw;

pub use error::{Cell, TableError};
pub use height::{HeightPoint, HeightSurface, HeightTable};
pub use table::{Node, Table};
pub use yaw::{YawField, YawPoint, YawTable};

/// What a table answers for a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interpolated {
    /// Height in m, or yaw in rad, −π to π.
    pub value: f64,
    /// Whether the place lies among the points of the table. Outside the value is a guess.
    pub inside: bool,
    /// Standard deviation of the value for a point measured anew, in its unit, from the errors
    /// of the points near by when they are left out; outside it is too small. `None` for tables of
    /// fewer than eight points.
    pub sd: Option<f64>,
}
