//! Yaw of the hand over place and height.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::multiquadric::Multiquadric;
use super::table::{Node, Table};
use super::{Interpolated, TableError};
use crate::border::Region;

/// The angles must leave an arc of this length free.
const LEAST_GAP_RAD: f64 = PI / 3.0;
/// A place counts as inside this far below the lowest and above the highest point.
const Z_MARGIN_M: f64 = 0.005;

/// Yaw of a grasp at one place, in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct YawPoint {
    /// Forward, m.
    pub x_m: f64,
    /// To the left, m.
    pub y_m: f64,
    /// Up, m.
    pub z_m: f64,
    /// About the z axis, rad.
    pub yaw_rad: f64,
}

impl Node for YawPoint {
    const COLUMNS: &'static [&'static str] = &["x_m", "y_m", "z_m", "yaw_rad"];
    const SMOOTHING: f64 = 0.1;

    fn numbers(&self) -> Vec<f64> {
        vec![self.x_m, self.y_m, self.z_m, self.yaw_rad]
    }

    fn from_numbers(numbers: &[f64]) -> Self {
        Self { x_m: numbers[0], y_m: numbers[1], z_m: numbers[2], yaw_rad: numbers[3] }
    }
}

/// Yaw over (x, y, z).
pub type YawTable = Table<YawPoint>;

/// A yaw table made ready for many questions.
#[derive(Clone, Debug)]
pub struct YawField {
    field: Multiquadric,
    region: Region,
    z_range_m: (f64, f64),
}

impl YawTable {
    /// Solves the equations once.
    ///
    /// # Errors
    /// When the table cannot be used: which, and what to do.
    pub fn field(&self) -> Result<YawField, TableError> {
        let field = self.multiquadric()?;
        let points: Vec<_> = self.points.iter().map(|point| Vector2::new(point.x_m, point.y_m)).collect();
        let z_m = self.points.iter().map(|point| point.z_m);
        let z_range_m = (z_m.clone().fold(f64::INFINITY, f64::min), z_m.fold(f64::NEG_INFINITY, f64::max));
        let region = Region::around(&points).map_err(TableError::NoArea)?;
        Ok(YawField { field, region, z_range_m })
    }

    /// Yaw at one place; for many places take [`Self::field`].
    ///
    /// # Errors
    /// As [`Self::field`], and for a place that is not finite.
    pub fn interpolate(&self, x_m: f64, y_m: f64, z_m: f64) -> Result<Interpolated, TableError> {
        self.field()?.interpolate(x_m, y_m, z_m)
    }

    /// Error of each point, measured − predicted from the others, rad, −π to π.
    ///
    /// # Errors
    /// When the table cannot be used: which, and what to do.
    pub fn leave_one_out(&self) -> Result<Vec<f64>, TableError> {
        Ok(self.multiquadric()?.errors().iter().map(|&error| turned_back(error)).collect())
    }

    fn multiquadric(&self) -> Result<Multiquadric, TableError> {
        self.check()?;
        let places = self.points.iter().map(|point| vec![point.x_m, point.y_m, point.z_m]).collect();
        let yaw: Vec<f64> = self.points.iter().map(|point| point.yaw_rad).collect();
        let unrolled = unrolled(&yaw).ok_or(TableError::YawAllAround)?;
        Multiquadric::new(places, &unrolled, self.smoothing)
    }
}

impl YawField {
    /// Yaw at a place.
    ///
    /// # Errors
    /// For a place that is not finite.
    pub fn interpolate(&self, x_m: f64, y_m: f64, z_m: f64) -> Result<Interpolated, TableError> {
        super::table::check_finite(&YawPoint { x_m, y_m, z_m, yaw_rad: 0.0 })?;
        let place = [x_m, y_m, z_m];
        let (low, high) = self.z_range_m;
        Ok(Interpolated {
            value: turned_back(self.field.value(&place)),
            inside: self.region.contains(Vector2::new(x_m, y_m))
                && (low - Z_MARGIN_M..=high + Z_MARGIN_M).contains(&z_m),
            sd: self.field.sd(&place),
        })
    }
}

/// The angle within (−π, π].
fn turned_back(angle_rad: f64) -> f64 {
    let turned = angle_rad.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}

/// The angles on a circle that is cut open in the middle of its largest empty arc; the middle of
/// what they occupy lies within (−π, π]. `None` if no arc is large enough.
fn unrolled(angles_rad: &[f64]) -> Option<Vec<f64>> {
    let mut sorted: Vec<f64> = angles_rad.iter().map(|&angle| turned_back(angle)).collect();
    sorted.sort_by(f64::total_cmp);
    let next = |i: usize| sorted.get(i + 1).copied().unwrap_or(sorted[0] + TAU);
    let (last, gap) =
        (0..sorted.len()).map(|i| (i, next(i) - sorted[i])).max_by(|a, b| a.1.total_cmp(&b.1))?;
    if gap < LEAST_GAP_RAD {
        return None;
    }
    // The angles start behind the gap.
    let start = turned_back(next(last));
    let middle = turned_back(start + (TAU - gap) / 2.0);
    let start = middle - (TAU - gap) / 2.0;
    // The cut lies half a gap before them, so that rounding takes none of them around.
    let cut = start - gap / 2.0;
    Some(angles_rad.iter().map(|&angle| cut + (angle - cut).rem_euclid(TAU)).collect())
}
