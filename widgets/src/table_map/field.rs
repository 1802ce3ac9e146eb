//! A quantity over the table.

use crate::format::Quantity;

/// Values on a regular grid over the table; between its nodes bilinear.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalarField {
    name: String,
    quantity: Quantity,
    x_m: [f64; 2],
    y_m: [f64; 2],
    rows: usize,
    columns: usize,
    values: Vec<Option<f64>>,
}

impl ScalarField {
    /// Evaluates `value` (SI; `None` where it has none) at `rows` × `columns` nodes, from the
    /// first to the second value of each range. At least two each way.
    pub fn sample(
        name: impl Into<String>,
        quantity: Quantity,
        x_m: [f64; 2],
        y_m: [f64; 2],
        [rows, columns]: [usize; 2],
        mut value: impl FnMut([f64; 2]) -> Option<f64>,
    ) -> Self {
        let (rows, columns) = (rows.max(2), columns.max(2));
        let mut field = Self {
            name: name.into(),
            quantity,
            x_m,
            y_m,
            rows,
            columns,
            values: Vec::with_capacity(rows * columns),
        };
        for row in 0..rows {
            for column in 0..columns {
                let at_m = field.node_m(row as f64, column as f64);
                field.values.push(value(at_m).filter(|value| value.is_finite()));
            }
        }
        field
    }

    /// Values that are there already: row by row from the first x, in each row from the first y.
    /// `None` when they do not fill whole rows, at least two of two.
    pub fn of_grid(
        name: impl Into<String>,
        quantity: Quantity,
        x_m: [f64; 2],
        y_m: [f64; 2],
        columns: usize,
        values: &[Option<f64>],
    ) -> Option<Self> {
        let rows = values.len().checked_div(columns)?;
        if rows < 2 || columns < 2 || rows * columns != values.len() {
            return None;
        }
        let values = values.iter().map(|value| value.filter(|value| value.is_finite())).collect();
        Some(Self { name: name.into(), quantity, x_m, y_m, rows, columns, values })
    }

    /// Its name on the scale.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the values are.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// Nodes along x and along y.
    pub fn nodes(&self) -> [usize; 2] {
        [self.rows, self.columns]
    }

    /// Value at a node.
    pub fn node(&self, row: usize, column: usize) -> Option<f64> {
        self.values[row * self.columns + column]
    }

    /// Smallest and largest value; `None` if there are none.
    pub fn extent(&self) -> Option<[f64; 2]> {
        let mut finite = self.values.iter().flatten().copied();
        let first = finite.next()?;
        Some(finite.fold([first, first], |[low, high], value| [low.min(value), high.max(value)]))
    }

    /// Position of a (fractional) node, meters.
    pub(crate) fn node_m(&self, row: f64, column: f64) -> [f64; 2] {
        let along =
            |range: [f64; 2], at: f64, n: usize| range[0] + (range[1] - range[0]) * at / (n - 1) as f64;
        [along(self.x_m, row, self.rows), along(self.y_m, column, self.columns)]
    }

    /// Value at a position; `None` outside the grid or where one of the four nodes around it has
    /// none.
    pub fn at(&self, at_m: [f64; 2]) -> Option<f64> {
        let index = |value: f64, range: [f64; 2], n: usize| {
            let at = (value - range[0]) / (range[1] - range[0]) * (n - 1) as f64;
            (0.0..=(n - 1) as f64).contains(&at).then(|| {
                let below = (at as usize).min(n - 2);
                (below, at - below as f64)
            })
        };
        let (row, down) = index(at_m[0], self.x_m, self.rows)?;
        let (column, across) = index(at_m[1], self.y_m, self.columns)?;
        let line = |row: usize| {
            let (a, b) = (self.node(row, column)?, self.node(row, column + 1)?);
            Some(a + (b - a) * across)
        };
        let (a, b) = (line(row)?, line(row + 1)?);
        Some(a + (b - a) * down)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane() -> ScalarField {
        let value = |[x, y]: [f64; 2]| (x < 0.55).then_some(2.0 * x - 3.0 * y + 1.0);
        ScalarField::sample("plane", Quantity::Length, [0.2, 0.6], [-0.4, 0.4], [5, 9], value)
    }

    #[test]
    fn a_plane_is_reproduced_between_the_nodes() {
        let value = plane().at([0.313, -0.171]).expect("inside");
        assert!((value - (2.0 * 0.313 + 3.0 * 0.171 + 1.0)).abs() < 1e-12);
    }

    #[test]
    fn a_grid_that_is_there_is_the_one_that_was_sampled() {
        let sampled = plane();
        let again = |columns| {
            ScalarField::of_grid(
                "plane",
                Quantity::Length,
                sampled.x_m,
                sampled.y_m,
                columns,
                &sampled.values,
            )
        };
        assert_eq!(again(9).as_ref(), Some(&sampled));
        for wrong in [0, 1, 7, 45] {
            assert_eq!(again(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn nothing_outside_and_nothing_beside_missing_nodes() {
        assert_eq!(plane().at([0.1, 0.0]), None);
        assert_eq!(plane().at([0.3, 0.5]), None);
        assert_eq!(plane().at([0.58, 0.0]), None);
        let [low, high] = plane().extent().expect("values");
        assert!((low - 0.2).abs() < 1e-12 && (high - 3.2).abs() < 1e-12);
    }
}
