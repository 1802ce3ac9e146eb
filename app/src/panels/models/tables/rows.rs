//! The points of either table as rows.

use plumbline_engine::GraspTable;
use plumbline_engine::view::TablesView;

/// Points nearer in height than this are of one layer, m.
pub(super) const LAYER_M: f64 = 0.005;

/// A point of either table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PointRow {
    /// Its place in the table, counted from 0.
    pub index: usize,
    /// Robot frame, m; z is 0 in the table of heights.
    pub at_m: [f64; 3],
    /// Height, m, or yaw, rad.
    pub value: f64,
    /// Measured minus predicted by the others, in the unit of the value.
    pub error: Option<f64>,
}

/// The points of a table in its order.
pub(super) fn rows(tables: &TablesView, table: GraspTable) -> Vec<PointRow> {
    let row = |index: usize, at_m, value, errors: &[f64]| {
        let error = errors.get(index).copied().filter(|error| error.is_finite());
        PointRow { index, at_m, value, error }
    };
    match table {
        GraspTable::Height => {
            let points = tables.height.iter().flat_map(|height| height.points.iter().enumerate());
            points.map(|(i, p)| row(i, [p.x_m, p.y_m, 0.0], p.height_m, &tables.height_errors_m)).collect()
        }
        GraspTable::Yaw => {
            let points = tables.yaw.iter().flat_map(|yaw| yaw.points.iter().enumerate());
            points.map(|(i, p)| row(i, [p.x_m, p.y_m, p.z_m], p.yaw_rad, &tables.yaw_errors_rad)).collect()
        }
    }
}

/// Heights of the layers, lowest first.
pub(super) fn layers_m(rows: &[PointRow]) -> Vec<f64> {
    let mut heights: Vec<f64> = rows.iter().map(|row| row.at_m[2]).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup_by(|a, b| (*a - *b).abs() < LAYER_M);
    heights
}
