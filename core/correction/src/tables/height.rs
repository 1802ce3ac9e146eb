//! Grasp height over the table.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::multiquadric::Multiquadric;
use super::table::{Node, Table};
use super::{Interpolated, TableError};
use crate::border::Region;

/// Height of a grasp at one place, in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeightPoint {
    /// Forward, m.
    pub x_m: f64,
    /// To the left, m.
    pub y_m: f64,
    /// Height to send, m.
    pub height_m: f64,
}

impl Node for HeightPoint {
    const COLUMNS: &'static [&'static str] = &["x_m", "y_m", "height_m"];
    const SMOOTHING: f64 = 0.01;

    fn numbers(&self) -> Vec<f64> {
        vec![self.x_m, self.y_m, self.height_m]
    }

    fn from_numbers(numbers: &[f64]) -> Self {
        Self { x_m: numbers[0], y_m: numbers[1], height_m: numbers[2] }
    }
}

/// Heights over (x, y).
pub type HeightTable = Table<HeightPoint>;

/// A height table made ready for many questions.
#[derive(Clone, Debug)]
pub struct HeightSurface {
    surface: Multiquadric,
    region: Region,
}

impl HeightTable {
    /// Solves the equations once.
    ///
    /// # Errors
    /// When the table cannot be used: which, and what to do.
    pub fn surface(&self) -> Result<HeightSurface, TableError> {
        let points: Vec<_> = self.points.iter().map(|point| Vector2::new(point.x_m, point.y_m)).collect();
        let region = Region::around(&points).map_err(TableError::NoArea);
        Ok(HeightSurface { surface: self.multiquadric()?, region: region? })
    }

    /// Height at one place; for many places take [`Self::surface`].
    ///
    /// # Errors
    /// As [`Self::surface`], and for a place that is not finite.
    pub fn interpolate(&self, x_m: f64, y_m: f64) -> Result<Interpolated, TableError> {
        self.surface()?.interpolate(x_m, y_m)
    }

    /// Error of each point, measured − predicted from the others, m.
    ///
    /// # Errors
    /// When the table cannot be used: which, and what to do.
    pub fn leave_one_out(&self) -> Result<Vec<f64>, TableError> {
        Ok(self.multiquadric()?.errors().to_vec())
    }

    fn multiquadric(&self) -> Result<Multiquadric, TableError> {
        self.check()?;
        let places = self.points.iter().map(|point| vec![point.x_m, point.y_m]).collect();
        let heights: Vec<f64> = self.points.iter().map(|point| point.height_m).collect();
        Multiquadric::new(places, &heights, self.smoothing)
    }
}

impl HeightSurface {
    /// Height at a place.
    ///
    /// # Errors
    /// For a place that is not finite.
    pub fn interpolate(&self, x_m: f64, y_m: f64) -> Result<Interpolated, TableError> {
        super::table::check_finite(&HeightPoint { x_m, y_m, height_m: 0.0 })?;
        Ok(Interpolated {
            value: self.surface.value(&[x_m, y_m]),
            inside: self.region.contains(Vector2::new(x_m, y_m)),
            sd: self.surface.sd(&[x_m, y_m]),
        })
    }

    /// Edges of the area of the points: corners (x, y) in m, the outer one first, then holes and
    /// other parts.
    pub fn rings_m(&self) -> &[Vec<Vector2<f64>>] {
        self.region.rings()
    }
}
