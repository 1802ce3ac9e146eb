//! Points of a table, and changing them.

use plumbline_model::plausible::{self, Quantity};
use serde::{Deserialize, Serialize};

use super::TableError;

/// A table of fewer points is not interpolated.
pub(super) const FEWEST: usize = 4;
/// Points nearer than this (m) are at one place.
const SAME_PLACE_M: f64 = 1e-4;

/// A point of a table: where, and what was measured there.
pub trait Node: Copy {
    /// Columns of the file, the value last.
    const COLUMNS: &'static [&'static str];
    /// Smoothing as published.
    const SMOOTHING: f64;

    /// In the order of the columns.
    fn numbers(&self) -> Vec<f64>;
    /// From as many numbers as there are columns.
    fn from_numbers(numbers: &[f64]) -> Self;
}

/// Points of a table and its smoothing. Functions of the table check what stands here; what is
/// changed with [`Table::add`], [`Table::move_to`] and [`Table::remove`] stays valid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Table<N> {
    /// The points, in any order.
    pub points: Vec<N>,
    /// λ of the interpolation, see the description of the module; 0 goes through all points.
    pub smoothing: f64,
}

impl<N: Node> Table<N> {
    /// A table with the published smoothing.
    ///
    /// # Errors
    /// For fewer than four points, two at one place, or a number that is not finite.
    pub fn new(points: Vec<N>) -> Result<Self, TableError> {
        let table = Self { points, smoothing: N::SMOOTHING };
        table.check()?;
        Ok(table)
    }

    /// Whether the table can be used.
    pub(super) fn check(&self) -> Result<(), TableError> {
        if !(self.smoothing >= 0.0 && self.smoothing.is_finite()) {
            return Err(TableError::Smoothing { found: self.smoothing });
        }
        if self.points.len() < FEWEST {
            return Err(TableError::TooFew { found: self.points.len() });
        }
        for (i, point) in self.points.iter().enumerate() {
            check_finite(point)?;
            if let Some(index) = self.points[..i].iter().position(|other| is_same_place(other, point)) {
                return Err(TableError::Duplicate { index });
            }
        }
        Ok(())
    }

    /// Adds a point.
    ///
    /// # Errors
    /// Where a point is already, and for a number that is not finite; the table is unchanged.
    pub fn add(&mut self, point: N) -> Result<(), TableError> {
        self.check_place(&point, None)?;
        self.points.push(point);
        Ok(())
    }

    /// Replaces a point: its place, its value or both.
    ///
    /// # Errors
    /// Without such a point, where another one is, and for a number that is not finite; the table
    /// is unchanged.
    pub fn move_to(&mut self, index: usize, point: N) -> Result<(), TableError> {
        self.check_index(index)?;
        self.check_place(&point, Some(index))?;
        self.points[index] = point;
        Ok(())
    }

    /// Takes a point out.
    ///
    /// # Errors
    /// Without such a point, and when too few would be left; the table is unchanged.
    pub fn remove(&mut self, index: usize) -> Result<N, TableError> {
        self.check_index(index)?;
        if self.points.len() <= FEWEST {
            return Err(TableError::TooFew { found: self.points.len() - 1 });
        }
        Ok(self.points.remove(index))
    }

    fn check_index(&self, index: usize) -> Result<(), TableError> {
        let count = self.points.len();
        if index < count { Ok(()) } else { Err(TableError::NoSuchPoint { index, count }) }
    }

    /// Whether `point` may stand in the table, in the place of point `except`.
    fn check_place(&self, point: &N, except: Option<usize>) -> Result<(), TableError> {
        check_finite(point)?;
        let taken = |(i, other): (usize, &N)| Some(i) != except && is_same_place(other, point);
        match self.points.iter().enumerate().position(taken) {
            Some(index) => Err(TableError::Duplicate { index }),
            None => Ok(()),
        }
    }
}

pub(super) fn check_finite<N: Node>(point: &N) -> Result<(), TableError> {
    match point.numbers().iter().position(|number| !number.is_finite()) {
        Some(k) => Err(TableError::NotFinite { column: N::COLUMNS[k] }),
        None => N::COLUMNS.iter().zip(point.numbers()).try_for_each(|(&column, number)| {
            let wrong = |what| TableError::ImplausiblePoint { column, what: Box::new(what) };
            quantity(column).map_or(Ok(()), |quantity| quantity.check(number)).map_err(wrong)
        }),
    }
}

/// What a column of a table holds.
pub(super) fn quantity(column: &str) -> Option<Quantity> {
    match column {
        "x_m" | "y_m" => Some(plausible::TARGET_M),
        "z_m" | "height_m" => Some(plausible::GRASP_HEIGHT_M),
        "yaw_rad" => Some(plausible::ANGLE_RAD),
        _ => None,
    }
}

/// Whether two points are at one place, whatever their values.
pub(super) fn is_same_place<N: Node>(a: &N, b: &N) -> bool {
    let dimensions = N::COLUMNS.len() - 1;
    let squares = a.numbers().into_iter().zip(b.numbers()).take(dimensions).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt() < SAME_PLACE_M
}
