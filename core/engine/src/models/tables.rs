//! The tables of grasp height and yaw, and editing them.

mod editor;
pub mod work;

pub use editor::TablesEditor;
#[cfg(test)]
pub(super) use editor::palm;

use std::sync::Arc;

use plumbline_correction::tables::{HeightPoint, HeightTable, Node, Table, TableError, YawPoint, YawTable};

use crate::command::GraspTable;

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
