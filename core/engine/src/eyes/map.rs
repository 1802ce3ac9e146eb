//! A length at every place of the table.

/// A regular grid over the table, robot frame, with a length at each node.
#[derive(Clone, Debug, PartialEq)]
pub struct TableMap {
    /// Nodes along x (forward), at least 2.
    pub columns_x: usize,
    /// Nodes along y (left), at least 2.
    pub rows_y: usize,
    /// Least and greatest x, meters.
    pub x_range_m: (f64, f64),
    /// Least and greatest y, meters.
    pub y_range_m: (f64, f64),
    /// Height of the plane, meters.
    pub z_m: f64,
    /// Node (ix, iy) is at `iy * columns_x + ix`; meters, `None` where both eyes do not see it.
    pub values_m: Vec<Option<f64>>,
}

impl TableMap {
    /// Computes a value at every node; `value` gets (x, y, z) in the robot frame, meters.
    pub fn fill(
        columns_x: usize,
        rows_y: usize,
        x_range_m: (f64, f64),
        y_range_m: (f64, f64),
        z_m: f64,
        mut value: impl FnMut(f64, f64, f64) -> Option<f64>,
    ) -> Self {
        let at = |range: (f64, f64), i: usize, n: usize| {
            range.0 + (range.1 - range.0) * i as f64 / (n.max(2) - 1) as f64
        };
        let mut values_m = Vec::with_capacity(columns_x * rows_y);
        for iy in 0..rows_y {
            for ix in 0..columns_x {
                values_m.push(value(at(x_range_m, ix, columns_x), at(y_range_m, iy, rows_y), z_m));
            }
        }
        Self { columns_x, rows_y, x_range_m, y_range_m, z_m, values_m }
    }

    /// Value at a node; `None` outside the grid too.
    pub fn at(&self, ix: usize, iy: usize) -> Option<f64> {
        if ix >= self.columns_x || iy >= self.rows_y {
            return None;
        }
        self.values_m[iy * self.columns_x + ix]
    }

    /// Greatest value; `None` when the grid has none.
    pub fn greatest_m(&self) -> Option<f64> {
        self.values_m.iter().flatten().copied().reduce(f64::max)
    }

    /// Median value; `None` when the grid has none.
    pub fn median_m(&self) -> Option<f64> {
        let mut values: Vec<f64> = self.values_m.iter().flatten().copied().collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied()
    }
}
