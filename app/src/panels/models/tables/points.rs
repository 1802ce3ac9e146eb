//! The points of a table as rows, and how they look on the map.

use plumbline_engine::GraspTable;
use plumbline_widgets::colormap::{ColorScale, Colormap};
use plumbline_widgets::overlay::Ink;
use plumbline_widgets::table_map::{ScalarField, TablePoint};
use plumbline_widgets::theme::Role;

use super::panel::{TablesPanel, quantity};
use super::rows::{LAYER_M, PointRow};

/// Value of a point that is added where nothing is known: a palm just above the table, m.
const FIRST_HEIGHT_M: f64 = 0.05;

/// Radius of a point without an error, and of the one with the largest, points.
const RADII: [f64; 2] = [4.5, 9.0];

/// The others stay in sight, faint, and cannot be touched.
fn is_faint(row: &PointRow, panel: &TablesPanel) -> bool {
    panel.table == GraspTable::Yaw && panel.layer_m.is_some_and(|z| (row.at_m[2] - z).abs() >= LAYER_M)
}

fn shown_value(row: &PointRow, by_error: bool) -> Option<f64> {
    if by_error { row.error.map(f64::abs) } else { Some(row.value) }
}

/// Colors of the points; `None` where there is nothing to color.
pub(super) fn scale(rows: &[PointRow], by_error: bool) -> Option<ColorScale> {
    let values = rows.iter().filter_map(|row| shown_value(row, by_error));
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    (low <= high).then(|| colors([if by_error { 0.0 } else { low }, high]))
}

/// Colors of values or errors: none where there are none.
fn colors(range: [f64; 2]) -> ColorScale {
    // A table of one value still needs a range.
    let [low, high] = range;
    let pad = if high > low { 0.0 } else { 0.5 * high.abs().max(1e-3) };
    ColorScale::new(Colormap::Viridis, [(low - pad) as f32, (high + pad) as f32])
}

/// The points as the map draws them: colored by value or error, larger where they miss by more.
pub(super) fn on_map(rows: &[PointRow], panel: &TablesPanel, scale: Option<ColorScale>) -> Vec<TablePoint> {
    let largest = rows.iter().filter_map(|row| row.error).map(f64::abs).fold(0.0, f64::max);
    let radius = |row: &PointRow| {
        let part = row.error.filter(|_| largest > 0.0).map_or(0.0, |error| error.abs() / largest);
        (RADII[0] + (RADII[1] - RADII[0]) * part) as f32
    };
    let point = |row: &PointRow| {
        let color = shown_value(row, panel.by_error).and_then(|value| scale?.color(value as f32));
        let moved = panel.moved.as_ref().filter(|moved| moved.point == row.index);
        TablePoint {
            at_m: moved.map_or([row.at_m[0], row.at_m[1]], |moved| moved.at_m),
            radius: radius(row),
            ink: color.map_or(Ink::Role(Role::NoiseFloor), Ink::Color),
            label: label(row, panel.table),
            faint: is_faint(row, panel),
        }
    };
    rows.iter().map(point).collect()
}

/// "Point 3: 41.0 mm, left out +2.10 mm".
pub(super) fn label(row: &PointRow, table: GraspTable) -> String {
    let quantity = quantity(table);
    let error = match row.error {
        Some(error) => format!(", missed by {} when left out", quantity.text(error)),
        None => String::new(),
    };
    format!("Point {}: {}{error}", row.index + 1, quantity.text(row.value))
}

/// What a new point starts with: what the table says there, else its nearest point's value.
pub(super) fn value_at(
    rows: &[PointRow],
    field: Option<&ScalarField>,
    at_m: [f64; 2],
    table: GraspTable,
) -> f64 {
    let distance = |row: &PointRow| (row.at_m[0] - at_m[0]).hypot(row.at_m[1] - at_m[1]);
    let nearest = rows.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).map(|row| row.value);
    let unknown = if table == GraspTable::Height { FIRST_HEIGHT_M } else { 0.0 };
    field.and_then(|field| field.at(at_m)).or(nearest).unwrap_or(unknown)
}

#[cfg(test)]
mod tests {
    use super::super::rows::layers_m;
    use super::*;

    fn row(index: usize, z_m: f64, error: Option<f64>) -> PointRow {
        PointRow { index, at_m: [0.3, 0.1 * index as f64, z_m], value: 0.04 + 0.01 * index as f64, error }
    }

    #[test]
    fn layers_are_told_apart_and_counted_once() {
        let rows = [row(0, 0.06, None), row(1, 0.021, None), row(2, 0.02, None), row(3, 0.06, None)];
        assert_eq!(layers_m(&rows), [0.02, 0.06]);
        let panel = TablesPanel { table: GraspTable::Yaw, layer_m: Some(0.02), ..TablesPanel::default() };
        let faint: Vec<bool> = on_map(&rows, &panel, None).iter().map(|point| point.faint).collect();
        assert_eq!(faint, [true, false, false, true]);
    }

    #[test]
    fn points_that_miss_by_more_are_larger() {
        let rows = [row(0, 0.0, Some(-0.004)), row(1, 0.0, Some(0.001)), row(2, 0.0, None)];
        let points = on_map(&rows, &TablesPanel::default(), scale(&rows, false));
        assert!(points[0].radius > points[1].radius && points[1].radius > points[2].radius);
        assert_eq!(points[0].label, "Point 1: 40.0 mm, missed by −4.00 mm when left out");
        assert_eq!(points[2].label, "Point 3: 60.0 mm");
    }

    #[test]
    fn a_new_point_starts_with_what_is_known_there() {
        let rows = [row(0, 0.0, None), row(3, 0.0, None)];
        assert_eq!(value_at(&rows, None, [0.3, 0.28], GraspTable::Height), 0.07);
        assert_eq!(value_at(&[], None, [0.3, 0.0], GraspTable::Height), FIRST_HEIGHT_M);
        assert_eq!(value_at(&[], None, [0.3, 0.0], GraspTable::Yaw), 0.0);
    }
}
