//! Measured heights on a grid over the table, interpolated between its nodes.

use plumbline_model::{Point, Robot};
use serde::{Deserialize, Serialize};

use crate::data::{Touch, TouchData};

/// Rows and columns of a grid where the session has none: those of the published one.
const ROWS: usize = 4;
const COLUMNS: usize = 9;
/// Set of a session whose touches form a grid.
const GRID_SET: &str = "grid";
/// Places this near to each other are the same line of a grid, m.
const SAME_LINE_M: f64 = 2e-3;
/// Width of the window around a node, as a part of the grid's spacing.
const WINDOW: f64 = 0.75;
/// Keeps a slope from being made of one or two touches, in touches.
const SLOPE_RIDGE: f64 = 0.1;

/// Heights over a grid of x and y, robot frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeightGrid {
    /// Lines of the grid along x, growing, m.
    pub x_m: Vec<f64>,
    /// Lines of the grid along y, growing, m.
    pub y_m: Vec<f64>,
    /// Per line of x the heights along y, m.
    pub z_m: Vec<Vec<f64>>,
}

impl HeightGrid {
    /// The height at a place, bilinear between the four nodes around it. Beyond the grid it is
    /// the height at the nearest place of the grid's edge, as published.
    pub fn at(&self, x_m: f64, y_m: f64) -> f64 {
        let (i, s) = between(&self.x_m, x_m);
        let (j, t) = between(&self.y_m, y_m);
        let along_y = |line: &[f64]| line[j] * (1.0 - t) + line[(j + 1).min(line.len() - 1)] * t;
        along_y(&self.z_m[i]) * (1.0 - s) + along_y(&self.z_m[(i + 1).min(self.z_m.len() - 1)]) * s
    }

    /// The published table, m; x 0.30 to 0.45 m, y −0.20 to 0.20 m, every 0.05 m.
    pub fn published() -> Self {
        let millimeters = [
            [72, 70, 67, 66, 65, 67, 70, 69, 71],
            [77, 74, 73, 73, 71, 72, 73, 73, 77],
            [83, 80, 76, 75, 75, 74, 77, 80, 83],
            [91, 87, 85, 84, 84, 85, 85, 87, 95],
        ];
        let lines = |first: i32, count: i32| (0..count).map(|i| f64::from(first + 5 * i) / 100.0).collect();
        let z_m = millimeters.map(|row| row.map(|mm| f64::from(mm) / 1000.0).to_vec()).to_vec();
        Self { x_m: lines(30, 4), y_m: lines(-20, 9), z_m }
    }

    /// Heights from touches: at the nodes of the session's own grid if it has one (touches of the
    /// set "grid" on every crossing of their lines), else at 4 × 9 nodes over the touched area,
    /// each from a plane through the touches around it.
    pub fn of_touches(data: &TouchData) -> Self {
        Self::of_grid_set(data).unwrap_or_else(|| Self::of_planes(data))
    }

    fn of_grid_set(data: &TouchData) -> Option<Self> {
        let touches: Vec<&Touch> =
            data.touches.iter().filter(|touch| touch.set.as_deref() == Some(GRID_SET)).collect();
        let x_m = lines(touches.iter().map(|touch| touch.sent.coords.x));
        let y_m = lines(touches.iter().map(|touch| touch.sent.coords.y));
        if x_m.len() < 2 || y_m.len() < 2 {
            return None;
        }
        let node = |x: f64, y: f64| {
            let here = touches
                .iter()
                .map(|touch| touch.sent.coords)
                .filter(|sent| (sent.x - x).abs() <= SAME_LINE_M && (sent.y - y).abs() <= SAME_LINE_M);
            let heights: Vec<f64> = here.map(|sent| sent.z).collect();
            (!heights.is_empty()).then(|| heights.iter().sum::<f64>() / heights.len() as f64)
        };
        let line = |x: f64| y_m.iter().map(|y| node(x, *y)).collect::<Option<Vec<f64>>>();
        let z_m = x_m.iter().map(|x| line(*x)).collect::<Option<Vec<_>>>()?;
        Some(Self { x_m, y_m, z_m })
    }

    fn of_planes(data: &TouchData) -> Self {
        let sent: Vec<Point<Robot>> = data.touches.iter().map(|touch| touch.sent).collect();
        let x_m = spaced(sent.iter().map(|point| point.coords.x), ROWS);
        let y_m = spaced(sent.iter().map(|point| point.coords.y), COLUMNS);
        let step = |lines: &[f64]| if lines.len() > 1 { lines[1] - lines[0] } else { 0.05 };
        let spacing = (step(&x_m), step(&y_m));
        let line = |x: f64| y_m.iter().map(|y| plane_at(&sent, (x, *y), spacing)).collect();
        let z_m = x_m.iter().map(|x| line(*x)).collect();
        Self { x_m, y_m, z_m }
    }

    /// Why it cannot be used; `None` when it can.
    pub fn fault(&self) -> Option<String> {
        let growing = |lines: &[f64]| {
            !lines.is_empty()
                && lines.iter().all(|m| m.is_finite())
                && lines.windows(2).all(|pair| pair[0] < pair[1])
        };
        if !growing(&self.x_m) || !growing(&self.y_m) {
            return Some("the lines of the height grid do not grow".to_owned());
        }
        let (rows, columns) = (self.x_m.len(), self.y_m.len());
        if self.z_m.len() != rows || self.z_m.iter().any(|row| row.len() != columns) {
            return Some(format!("the heights are not {rows} × {columns} numbers, as their lines ask for"));
        }
        let finite = self.z_m.iter().flatten().all(|m| m.is_finite());
        (!finite).then(|| "a height is not a finite number".to_owned())
    }
}

/// Index of the line before `m`, and the part of the way to the next; the ends beyond the grid.
fn between(lines: &[f64], m: f64) -> (usize, f64) {
    let last = lines.len() - 1;
    let after = lines.partition_point(|line| *line <= m);
    match after {
        0 => (0, 0.0),
        after if after > last => (last, 0.0),
        after => (after - 1, (m - lines[after - 1]) / (lines[after] - lines[after - 1])),
    }
}

/// Distinct values, growing; near ones are one line, at their mean.
fn lines(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let groups = values.chunk_by(|a, b| b - a <= SAME_LINE_M);
    groups.map(|group| group.iter().sum::<f64>() / group.len() as f64).collect()
}

/// Lines over the range of the values.
fn spaced(values: impl Iterator<Item = f64> + Clone, count: usize) -> Vec<f64> {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    if high - low < SAME_LINE_M {
        return vec![0.5 * (low + high)];
    }
    (0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect()
}

/// Height at a node of the plane that fits the touches around it best; its slopes are shrunk
/// where few touches are near.
fn plane_at(sent: &[Point<Robot>], node: (f64, f64), spacing: (f64, f64)) -> f64 {
    use nalgebra::{Matrix3, Vector3};
    // Far from all touches a narrow window would hold nothing but rounding; widen it then.
    let mut window = WINDOW;
    loop {
        let (mut normal, mut right, mut total) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
        for point in sent {
            let dx = (point.coords.x - node.0) / spacing.0;
            let dy = (point.coords.y - node.1) / spacing.1;
            let weight = (-0.5 * (dx * dx + dy * dy) / (window * window)).exp();
            let row = Vector3::new(1.0, dx, dy);
            normal += weight * row * row.transpose();
            right += weight * point.coords.z * row;
            total += weight;
        }
        if total > 1.5 {
            normal[(1, 1)] += SLOPE_RIDGE;
            normal[(2, 2)] += SLOPE_RIDGE;
            if let Some(factor) = normal.cholesky() {
                return factor.solve(&right).x;
            }
        }
        window *= 1.5;
    }
}
