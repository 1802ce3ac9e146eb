//! The tables of grasp height and yaw, and editing them.

mod editor;
pub mod work;

pub use editor::TablesEditor;
#[cfg(test)]
pub(super) use editor::palm;

use std::sync::Arc;

use plumbline_correction::tables::{HeightPoint, HeightTable, Node, Table, TableError, YawPoint, YawTable};

use plumbline_model::counted;

use super::command::GraspTable;

/// Yaw points whose heights differ by no more were measured at one height, m.
const SAME_HEIGHT_M: f64 = 1e-3;
/// Every file writes round heights its own way, m.
const ROUNDING_M: f64 = 1e-9;

/// Both tables at one moment.
#[derive(Clone, Debug, Default)]
pub struct Tables {
    /// Height over (x, y); `None` before there is one.
    pub height: Option<Arc<HeightTable>>,
    /// Yaw over (x, y, z); `None` before there is one.
    pub yaw: Option<Arc<YawTable>>,
}

impl Tables {
    /// With a point more: place (m) and height (m) or yaw (rad).
    pub fn with_point(&self, table: GraspTable, at_m: [f64; 3], value: f64) -> Result<Self, TableError> {
        self.edited(
            table,
            |heights| heights.add(height_point(at_m, value)),
            |yaws| yaws.add(yaw_point(at_m, value)),
        )
    }

    /// With a point changed.
    pub fn with_changed(
        &self,
        table: GraspTable,
        point: usize,
        at_m: [f64; 3],
        value: f64,
    ) -> Result<Self, TableError> {
        self.edited(
            table,
            |heights| heights.move_to(point, height_point(at_m, value)),
            |yaws| yaws.move_to(point, yaw_point(at_m, value)),
        )
    }

    /// Without a point.
    pub fn without_point(&self, table: GraspTable, point: usize) -> Result<Self, TableError> {
        self.edited(table, |heights| taken_out(heights, point), |yaws| taken_out(yaws, point))
    }

    /// With what was read from a file, and what became of the points that were there, a sentence.
    ///
    /// Heights replace all heights. Yaw was measured at one height after the other, each with a file
    /// of its own, so only the points at the heights of the file are replaced (within 1 mm).
    pub fn with_read(&self, read: &ReadTable) -> (Self, String) {
        match read {
            ReadTable::Height(read) => {
                let said = format!("The height table was read: {}.", counted(read.points.len(), "point"));
                (Self { height: Some(read.clone()), yaw: self.yaw.clone() }, said)
            }
            ReadTable::Yaw(read) => {
                let there = self.yaw.as_ref().map_or(&[][..], |table| &table.points);
                let heights_m = heights_m(&read.points);
                let is_read = |point: &YawPoint| {
                    heights_m.iter().any(|z_m| (z_m - point.z_m).abs() <= SAME_HEIGHT_M + ROUNDING_M)
                };
                let kept: Vec<YawPoint> = there.iter().filter(|point| !is_read(point)).copied().collect();
                let said = yaw_sentence(read.points.len(), &heights_m, kept.len(), there.len() - kept.len());
                let table = YawTable {
                    points: kept.into_iter().chain(read.points.iter().copied()).collect(),
                    smoothing: read.smoothing,
                };
                (Self { height: self.height.clone(), yaw: Some(Arc::new(table)) }, said)
            }
        }
    }

    fn edited(
        &self,
        table: GraspTable,
        height: impl FnOnce(&mut HeightTable) -> Result<(), TableError>,
        yaw: impl FnOnce(&mut YawTable) -> Result<(), TableError>,
    ) -> Result<Self, TableError> {
        let mut tables = self.clone();
        match table {
            GraspTable::Height => tables.height = Some(changed(self.height.as_deref(), height)?),
            GraspTable::Yaw => tables.yaw = Some(changed(self.yaw.as_deref(), yaw)?),
        }
        Ok(tables)
    }
}

/// A table from a file.
#[derive(Clone, Debug)]
pub enum ReadTable {
    /// Height over (x, y).
    Height(Arc<HeightTable>),
    /// Yaw over (x, y, z), at one height or several.
    Yaw(Arc<YawTable>),
}

/// The heights of points, each once, from low to high, m.
fn heights_m(points: &[YawPoint]) -> Vec<f64> {
    let mut heights_m: Vec<f64> = points.iter().map(|point| point.z_m).collect();
    heights_m.sort_by(f64::total_cmp);
    heights_m.dedup();
    heights_m
}

/// "47 points at 70 mm read, 85 at other heights kept."
fn yaw_sentence(read: usize, heights_m: &[f64], kept: usize, replaced: usize) -> String {
    let at = match heights_m {
        [height_m] => format!("{} mm", round_mm(*height_m)),
        [low_m, .., high_m] => {
            format!("{} heights from {} to {} mm", heights_m.len(), round_mm(*low_m), round_mm(*high_m))
        }
        [] => "no height".to_owned(),
    };
    let replaced = match replaced {
        0 => String::new(),
        n => format!(", {n} replaced"),
    };
    let read = counted(read, "point");
    format!("Yaw table: {read} at {at} read{replaced}, {kept} at other heights kept.")
}

/// To a tenth, without a trailing zero.
fn round_mm(length_m: f64) -> f64 {
    (length_m * 1e4).round() / 10.0
}

fn changed<N: Node>(
    table: Option<&Table<N>>,
    change: impl FnOnce(&mut Table<N>) -> Result<(), TableError>,
) -> Result<Arc<Table<N>>, TableError> {
    let empty = || Table { points: Vec::new(), smoothing: N::SMOOTHING };
    let mut table =
        table.map_or_else(empty, |table| Table { points: table.points.clone(), smoothing: table.smoothing });
    change(&mut table)?;
    Ok(Arc::new(table))
}

/// A table that is only being made may have fewer points than it takes to interpolate.
fn taken_out<N: Node>(table: &mut Table<N>, point: usize) -> Result<(), TableError> {
    if point >= table.points.len() {
        return Err(TableError::NoSuchPoint { index: point, count: table.points.len() });
    }
    table.points.remove(point);
    Ok(())
}

fn height_point([x_m, y_m, _]: [f64; 3], height_m: f64) -> HeightPoint {
    HeightPoint { x_m, y_m, height_m }
}

fn yaw_point([x_m, y_m, z_m]: [f64; 3], yaw_rad: f64) -> YawPoint {
    YawPoint { x_m, y_m, z_m, yaw_rad }
}
